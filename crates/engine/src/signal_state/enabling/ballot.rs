//! A sample of a transition's instances votes for what it may have waited for: each looks back over
//! the last few events of its group, and a state stands where several have met it.

use prefetch_index::prefetch_index;

use crate::log::{Nanoseconds, SECOND};
use crate::signal_state::states::StateId;

use super::entries::Entry;
use super::happenings::Happenings;
use super::window;

/// Instances that vote; one bit each.
pub(super) const VOTERS: usize = 32;
const VOTER_BITS: u32 = VOTERS.ilog2();
/// Events of the group a voter looks back over.
const LOOK_BACK: usize = 48;
/// Each partner of a join must explain at least this share alone.
const PARTNER: f64 = 0.08;

/// One transition looks for what it waits for.
pub(super) struct Election<'a> {
    /// Its instances, in the order they happened.
    pub(super) instances: &'a [Entry],
    /// The states it leads from and to.
    pub(super) current: StateId,
    pub(super) next: StateId,
    /// Delays that agree within this are steady, in seconds.
    pub(super) steady: f64,
    /// Those that agree within this differ by no more than scans do.
    pub(super) close: f64,
}

impl Election<'_> {
    /// How many instances vote.
    pub(super) fn voters(&self) -> usize {
        self.instances.len().min(VOTERS)
    }

    /// A voter's instance, each at another place of a long log.
    fn instance(&self, voter: usize) -> &Entry {
        &self.instances[voter * self.instances.len() / self.voters()]
    }
}

/// Voters that met a state at nearly one distance, and the least and greatest of those distances
/// in seconds.
pub(super) type Window = (u32, (f64, f64));

/// A candidate after the vote.
#[derive(Clone)]
pub(super) struct Candidate {
    pub(super) state: StateId,
    /// How many voters met it.
    pub(super) met: u32,
    /// Those that met it at one steady distance.
    pub(super) steady: Window,
    /// The same within the width that scans alone explain: what partners of a join share.
    pub(super) close: Window,
}

/// How long ago a state was met, and the voter in the low bits: numbers sort several times faster.
fn meeting(ago: u64, voter: usize) -> u64 {
    ago << VOTER_BITS | voter as u64
}

fn ago(meeting: u64) -> u64 {
    meeting >> VOTER_BITS
}

fn voter(meeting: u64) -> u32 {
    meeting as u32 & (VOTERS as u32 - 1)
}

/// Where a state was met in a vote.
#[derive(Clone, Copy, Default)]
struct Tally {
    /// The last that met it: voters are numbered through all votes, from 1.
    by: u32,
    /// Where its next meeting goes.
    next: u32,
}

/// Counts votes; its tables are kept from one vote to the next.
pub(super) struct Ballot {
    /// By state.
    tallies: Vec<Tally>,
    /// The last voter, and the first one of this vote.
    voter: u32,
    first: u32,
    /// The states that were met.
    met: Vec<StateId>,
    number: usize,
    /// Their meetings, with room for one with each voter.
    meetings: Vec<u64>,
}

impl Ballot {
    /// Among so many states.
    pub(super) fn new(states: usize) -> Self {
        Self {
            tallies: vec![Tally::default(); states],
            voter: 0,
            first: 1,
            met: Vec::new(),
            number: 0,
            meetings: Vec::new(),
        }
    }

    /// Opens a vote: whether some state but the own last event's is met by so many of the first
    /// few voters at one steady distance. Most transitions wait for nothing: this is most of the
    /// search, and asks for little.
    pub(super) fn promises(
        &mut self,
        index: Happenings<'_>,
        election: &Election<'_>,
        (screeners, enough): (usize, usize),
    ) -> bool {
        self.open();
        self.ask(index, election, screeners_of(election, screeners));
        (0..self.number).any(|at| {
            let state = self.met[at];
            let meetings = self.meetings_of(at);
            state != election.current
                && meetings.len() >= enough
                && are_steady(meetings, election.steady, enough)
                && may_enable(index, state, election.next, meetings)
        })
    }

    /// Lets the voters vote that have not yet, after so many screeners.
    pub(super) fn complete(
        &mut self,
        index: Happenings<'_>,
        election: &Election<'_>,
        screeners: usize,
    ) {
        let mut asked = screeners_of(election, screeners).peekable();
        let others = (0..election.voters()).filter(|voter| asked.next_if_eq(voter).is_none());
        self.ask(index, election, others.collect::<Vec<_>>().into_iter());
    }

    /// Lets all voters vote.
    pub(super) fn vote(&mut self, index: Happenings<'_>, election: &Election<'_>) {
        self.open();
        self.ask(index, election, 0..election.voters());
    }

    /// The candidates that so many have met and `worth` takes, by state; the own last event always
    /// stands for election.
    pub(super) fn candidates(
        &mut self,
        index: Happenings<'_>,
        election: &Election<'_>,
        votes: std::ops::Range<usize>,
        worth: impl Fn(&[u64]) -> bool,
    ) -> Vec<Candidate> {
        let least = (PARTNER * election.voters() as f64).ceil() as u32;
        let mut candidates = Vec::new();
        for at in 0..self.number {
            let state = self.met[at];
            let meetings = self.meetings_of(at);
            let met = meetings.len();
            let is_own = state == election.current && votes.end > VOTERS;
            if !is_own && !(votes.contains(&met) && worth(meetings)) {
                continue;
            }
            meetings.sort_unstable();
            if may_enable(index, state, election.next, meetings)
                && let Some(steady) = densest(meetings, election.steady)
                && let Some(close) = densest(meetings, election.close.min(election.steady))
                && (steady.0.count_ones() >= least || state == election.current)
            {
                candidates.push(Candidate { state, met: met as u32, steady, close });
            }
        }
        candidates.sort_unstable_by_key(|candidate| candidate.state);
        candidates
    }

    fn meetings_of(&mut self, at: usize) -> &mut [u64] {
        let end = self.tallies[self.met[at] as usize].next as usize;
        &mut self.meetings[at * VOTERS..end]
    }

    fn open(&mut self) {
        if self.voter >= u32::MAX - VOTERS as u32 {
            self.tallies.fill(Tally::default());
            self.voter = 0;
        }
        self.first = self.voter + 1;
        self.number = 0;
    }

    fn ask(
        &mut self,
        index: Happenings<'_>,
        election: &Election<'_>,
        voters: impl Iterator<Item = usize> + Clone,
    ) {
        for voter in voters.clone() {
            let place = election.instance(voter).place as usize;
            // Four events a cache line.
            for back in [0, 4, 8] {
                prefetch_index(index.happenings, place.saturating_sub(back));
            }
        }
        for voter in voters {
            self.look_back(index, election, voter);
        }
    }

    /// One voter: what happened while its device waited, latest first, each state once.
    fn look_back(&mut self, index: Happenings<'_>, election: &Election<'_>, voter: usize) {
        let &Entry { time: now, took, place, .. } = election.instance(voter);
        let (earlier, later) = index.happenings.split_at(place as usize);
        let since = now - took;
        // Of the same time, but later in the file: the order inside a scan means nothing.
        let together = later[1..].iter().take_while(|other| other.time == now).count();
        self.make_room(1 + together + LOOK_BACK);
        self.voter += 1;
        let (by, first, next) = (self.voter, self.first, election.next);
        let (tallies, meetings) = (self.tallies.as_mut_slice(), self.meetings.as_mut_slice());
        let met = self.met.as_mut_slice();
        let mut number = self.number;
        let mut meet = |state: StateId, time: Nanoseconds| {
            let tally = &mut tallies[state as usize];
            if state == next || tally.by == by {
                return;
            }
            // Nobody can foretell which states are new: no branch.
            let is_new = tally.by < first;
            met[number] = state;
            let at = if is_new { (number * VOTERS) as u32 } else { tally.next };
            number += usize::from(is_new);
            *tally = Tally { by, next: at + 1 };
            meetings[at as usize] = meeting((now - time).max(0) as u64, voter);
        };
        meet(election.current, since);
        for other in &later[1..=together] {
            meet(other.state, other.time);
        }
        for other in earlier.iter().rev().take(LOOK_BACK).take_while(|other| other.time >= since) {
            meet(other.state, other.time);
        }
        self.number = number;
    }

    /// For so many more states.
    fn make_room(&mut self, states: usize) {
        let number = self.number + states;
        if self.met.len() < number {
            self.met.resize(number, 0);
            self.meetings.resize(number * VOTERS, 0);
        }
    }
}

/// Voters whose instances are those that so many alone would have, had they asked by themselves.
fn screeners_of(
    election: &Election<'_>,
    screeners: usize,
) -> impl Iterator<Item = usize> + Clone + use<> {
    let voters = election.voters();
    (0..screeners).map(move |screener| screener * voters / screeners)
}

/// Whether so many meetings are within this of one another, in seconds.
fn are_steady(meetings: &mut [u64], steady: f64, enough: usize) -> bool {
    let steady = in_nanoseconds(steady);
    meetings.sort_unstable();
    meetings.windows(enough).any(|few| ago(few[enough - 1]) - ago(few[0]) <= steady)
}

/// An event of the same instant may be the cause of ours only where an input enables an
/// output; otherwise it may as well be its effect.
fn may_enable(index: Happenings<'_>, state: StateId, next: StateId, meetings: &[u64]) -> bool {
    let together = meetings.iter().filter(|&&meeting| ago(meeting) == 0).count();
    together * 5 <= meetings.len()
        || (!index.is_output[state as usize] && index.is_output[next as usize])
}

/// The window of width `steady` that holds most of the meetings, sorted by distance: its voters
/// and ends.
fn densest(meetings: &[u64], steady: f64) -> Option<Window> {
    let steady = in_nanoseconds(steady);
    let apart = |start: usize, end: usize| ago(meetings[end]) - ago(meetings[start]) > steady;
    window::densest(meetings.len(), apart).map(|(start, end)| {
        let mask = voters_of(&meetings[start..=end]);
        (mask, (seconds(ago(meetings[start])), seconds(ago(meetings[end]))))
    })
}

/// One bit each.
pub(super) fn voters_of(meetings: &[u64]) -> u32 {
    meetings.iter().fold(0u32, |voters, &meeting| voters | 1 << voter(meeting))
}

fn in_nanoseconds(seconds: f64) -> u64 {
    (seconds * SECOND as f64) as u64
}

fn seconds(nanoseconds: u64) -> f64 {
    nanoseconds as f64 / SECOND as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_densest_window_names_its_voters() {
        let met = |voter: u64, ms: u64| (ms * 1_000_000) << VOTER_BITS | voter;
        let meetings = [met(3, 100), met(0, 110), met(2, 120), met(1, 7000)];
        let (mask, (low, high)) = densest(&meetings, 0.05).unwrap_or_default();
        assert_eq!(mask, 0b1101);
        assert!((high - low - 0.02).abs() < 1e-9);
    }
}
