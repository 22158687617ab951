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

/// Voters that met a state at nearly one distance, and the least and greatest of those distances
/// in seconds.
pub(super) type Window = (u32, (f64, f64));

/// A candidate after the vote.
pub(super) struct Candidate {
    pub(super) state: StateId,
    /// How many voters met it.
    pub(super) met: u32,
    /// Those that met it at one steady distance.
    pub(super) mask: u32,
    /// Least and greatest of those distances, in seconds.
    pub(super) window: (f64, f64),
    /// The same within the width that scans alone explain: what partners of a join share.
    pub(super) close: Window,
}

/// A state, and a voter that met it some time ago.
#[derive(Clone, Copy)]
struct Meeting {
    state: StateId,
    /// How long ago, and the voter in the low bits: numbers sort several times faster.
    key: u64,
}

fn ago(meeting: u64) -> u64 {
    meeting >> VOTER_BITS
}

fn voter(meeting: u64) -> u32 {
    meeting as u32 & (VOTERS as u32 - 1)
}

/// How often a state was met in a vote.
#[derive(Clone, Copy, Default)]
struct Tally {
    /// The last that met it: voters are numbered through all votes, from 1.
    by: u32,
    votes: u32,
}

/// Counts votes; its tables are kept from one vote to the next.
pub(super) struct Ballot {
    /// Per state.
    tallies: Vec<Tally>,
    /// The last voter.
    voter: u32,
    meetings: Vec<Meeting>,
    met: Vec<StateId>,
    sorted: Vec<u64>,
}

impl Ballot {
    pub(super) fn new(states: usize) -> Self {
        Self {
            tallies: vec![Tally::default(); states],
            voter: 0,
            meetings: Vec::new(),
            met: Vec::new(),
            sorted: Vec::new(),
        }
    }

    /// Whether some state but the own last event's is met by so many of the voters at one steady
    /// distance. Most transitions wait for nothing: this is most of the search, and asks for little.
    pub(super) fn promises(
        &mut self,
        index: Happenings<'_>,
        election: &Election<'_>,
        (voters, enough): (usize, u32),
    ) -> bool {
        self.ask(index, election, voters);
        self.count(election.current, enough);
        let mut start = 0;
        for &state in &self.met {
            let end = self.tallies[state as usize].votes as usize;
            let meetings = &mut self.sorted[start..end];
            start = end;
            if state == election.current || meetings.len() < enough as usize {
                continue;
            }
            meetings.sort_unstable();
            if may_enable(index, state, election.next, meetings)
                && densest(meetings, election.steady)
                    .is_some_and(|(mask, _)| mask.count_ones() >= enough)
            {
                return true;
            }
        }
        false
    }

    /// Lets a sample of the instances look back; the own last event always stands for election.
    pub(super) fn vote(
        &mut self,
        index: Happenings<'_>,
        election: &Election<'_>,
        voters: usize,
    ) -> Vec<Candidate> {
        self.ask(index, election, voters);
        let least = (PARTNER * voters as f64).ceil() as u32;
        self.count(election.current, least);
        let mut candidates = Vec::new();
        let mut start = 0;
        for &state in &self.met {
            let end = self.tallies[state as usize].votes as usize;
            let meetings = &mut self.sorted[start..end];
            start = end;
            meetings.sort_unstable();
            if may_enable(index, state, election.next, meetings)
                && let Some((mask, window)) = densest(meetings, election.steady)
                && let Some(close) = densest(meetings, election.close.min(election.steady))
                && (mask.count_ones() >= least || state == election.current)
            {
                let met = meetings.len() as u32;
                candidates.push(Candidate { state, met, mask, window, close });
            }
        }
        candidates
    }

    /// All voters look back, each at another place of a long log.
    fn ask(&mut self, index: Happenings<'_>, election: &Election<'_>, voters: usize) {
        self.open(voters);
        let sample = |voter: usize| voter * election.instances.len() / voters;
        for voter in 0..voters {
            let place = election.instances[sample(voter)].place as usize;
            // Four events a cache line.
            for back in [0, 4, 8] {
                prefetch_index(index.happenings, place.saturating_sub(back));
            }
        }
        for voter in 0..voters {
            let at = sample(voter);
            self.look_back(index, election, voter, at);
        }
    }

    fn open(&mut self, voters: usize) {
        if self.voter >= u32::MAX - voters as u32 {
            self.tallies.fill(Tally::default());
            self.voter = 0;
        }
        self.meetings.clear();
        self.met.clear();
    }

    /// One voter: what happened while its device waited, latest first, each state once.
    fn look_back(
        &mut self,
        index: Happenings<'_>,
        election: &Election<'_>,
        voter: usize,
        at: usize,
    ) {
        let Entry { time: now, took, place, .. } = election.instances[at];
        let (earlier, later) = index.happenings.split_at(place as usize);
        let since = now - took;
        let first_voter = self.voter - voter as u32 + 1;
        self.voter += 1;
        let (by, next) = (self.voter, election.next);
        let (tallies, meetings, met) = (&mut self.tallies, &mut self.meetings, &mut self.met);
        let mut meet = |state: StateId, time: Nanoseconds| {
            let tally = &mut tallies[state as usize];
            if state == next || tally.by == by {
                return;
            }
            if tally.by < first_voter {
                tally.votes = 0;
                met.push(state);
            }
            *tally = Tally { by, votes: tally.votes + 1 };
            let ago = (now - time).max(0) as u64;
            meetings.push(Meeting { state, key: ago << VOTER_BITS | voter as u64 });
        };
        meet(election.current, since);
        // Of the same time, but later in the file: the order inside a scan means nothing.
        for other in later[1..].iter().take_while(|other| other.time == now) {
            meet(other.state, other.time);
        }
        for other in earlier.iter().rev().take(LOOK_BACK).take_while(|other| other.time >= since) {
            meet(other.state, other.time);
        }
    }

    /// Puts the meetings with the states that enough have met side by side, by state; a state's
    /// tally says where they end.
    fn count(&mut self, current: StateId, least: u32) {
        let tallies = &mut self.tallies;
        self.met.retain(|&state| tallies[state as usize].votes >= least || state == current);
        self.met.sort_unstable();
        // A state that does not stand has no place, wherever it was met.
        let stands = u32::MAX;
        let mut place = 0;
        for &state in &self.met {
            let tally = &mut tallies[state as usize];
            let begin = place;
            place += tally.votes;
            *tally = Tally { by: stands, votes: begin };
        }
        self.sorted.clear();
        self.sorted.resize(place as usize, 0);
        for meeting in &self.meetings {
            let tally = &mut tallies[meeting.state as usize];
            if tally.by == stands {
                self.sorted[tally.votes as usize] = meeting.key;
                tally.votes += 1;
            }
        }
        for &state in &self.met {
            tallies[state as usize].by = 0;
        }
    }
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
    let steady = (steady * SECOND as f64) as u64;
    let apart = |start: usize, end: usize| ago(meetings[end]) - ago(meetings[start]) > steady;
    window::densest(meetings.len(), apart).map(|(start, end)| {
        let mask = meetings[start..=end].iter().fold(0u32, |mask, &m| mask | 1 << voter(m));
        (mask, (seconds(ago(meetings[start])), seconds(ago(meetings[end]))))
    })
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
