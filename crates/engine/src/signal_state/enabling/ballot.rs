//! A sample of a transition's instances votes for what it may have waited for: each looks back over
//! the last few events of its group, and a state stands where several have met it.

use prefetch_index::prefetch_index;

use crate::log::Nanoseconds;
use crate::signal_state::states::StateId;

use super::election::{Election, LOOK_BACK};
use super::happenings::Happenings;
use super::meetings::{VOTERS, Window, ago, are_steady, densest, may_be_steady, meeting};

/// Room for the meetings of a state: an odd number lets the first of many states share the cache.
const ROOM: usize = VOTERS + 1;
/// Each partner of a join must explain at least this share alone.
const PARTNER: f64 = 0.08;

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

/// A candidate that may lead a join, as states that few have met are held against it.
pub(super) struct Leader {
    pub(super) voters: u32,
    /// So many of the others another state must explain.
    pub(super) lacks: usize,
    /// The distances at which it can, in nanoseconds.
    pub(super) reach: std::ops::RangeInclusive<u64>,
}

/// Who met a state last in a vote.
#[derive(Clone, Copy, Default)]
struct Tally {
    /// Voters are numbered through all votes, from 1.
    by: u32,
    /// The state's place among those that were met.
    at: u32,
}

/// Counts votes; its tables are kept from one vote to the next.
pub(super) struct Ballot {
    /// By state.
    tallies: Vec<Tally>,
    /// The last voter, and the first one of this vote.
    voter: u32,
    first: u32,
    /// The states that were met, how many there are, and how many met each.
    met: Vec<StateId>,
    number: usize,
    votes: Vec<u8>,
    /// Their meetings, with room for one with each voter.
    meetings: Vec<u64>,
    near: Vec<StateId>,
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
            votes: Vec::new(),
            meetings: Vec::new(),
            near: Vec::new(),
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
            if usize::from(self.votes[at]) < enough || state == election.current {
                return false;
            }
            let meetings = self.meetings_of(at);
            are_steady(meetings, election.steady, enough)
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

    /// The candidates that so many have met at one steady distance, or at any distance so many as
    /// `anywhere`, by state; the own last event always stands for election.
    pub(super) fn candidates(
        &mut self,
        index: Happenings<'_>,
        election: &Election<'_>,
        steadily: u32,
        anywhere: u32,
    ) -> Vec<Candidate> {
        let mut candidates = Vec::new();
        for at in 0..self.number {
            let votes = u32::from(self.votes[at]);
            let is_worth = votes >= anywhere
                || votes >= steadily
                    && may_be_steady(self.meetings_of(at), election.steady, steadily as usize);
            if is_worth || self.met[at] == election.current {
                candidates.extend(self.candidate(index, election, at));
            }
        }
        candidates.sort_unstable_by_key(|candidate| candidate.state);
        candidates
    }

    /// Further candidates that perhaps enough of those have met that a leader lacks, within its
    /// reach.
    pub(super) fn followers(
        &mut self,
        index: Happenings<'_>,
        election: &Election<'_>,
        leaders: &[Leader],
        candidates: &[Candidate],
    ) -> Vec<Candidate> {
        let mut states = Vec::new();
        for leader in leaders {
            self.near.clear();
            let lacking = (0..election.voters()).filter(|voter| leader.voters >> voter & 1 == 0);
            for voter in lacking {
                self.near.extend(election.look(index, voter).within(&leader.reach));
            }
            self.near.sort_unstable();
            let often = self.near.chunk_by(|a, b| a == b).filter(|of| of.len() >= leader.lacks);
            states.extend(often.map(|of| of[0]));
        }
        states.sort_unstable();
        states.dedup();
        let is_known =
            |state: StateId| candidates.binary_search_by_key(&state, |known| known.state).is_ok();
        states.retain(|state| *state != election.next && !is_known(*state));
        let further = states.into_iter().filter_map(|state| {
            let at = self.tallies[state as usize].at as usize;
            self.candidate(index, election, at)
        });
        further.collect()
    }

    fn candidate(
        &mut self,
        index: Happenings<'_>,
        election: &Election<'_>,
        at: usize,
    ) -> Option<Candidate> {
        let (state, met) = (self.met[at], u32::from(self.votes[at]));
        let least = (PARTNER * election.voters() as f64).ceil() as u32;
        let is_own = state == election.current;
        if met < least && !is_own {
            return None;
        }
        let meetings = self.meetings_of(at);
        meetings.sort_unstable();
        if !may_enable(index, state, election.next, meetings) {
            return None;
        }
        let steady = densest(meetings, election.steady)?;
        let close = densest(meetings, election.close.min(election.steady))?;
        (steady.votes() >= least || is_own).then_some(Candidate { state, met, steady, close })
    }

    fn meetings_of(&mut self, at: usize) -> &mut [u64] {
        &mut self.meetings[at * ROOM..][..usize::from(self.votes[at])]
    }

    fn open(&mut self) {
        if self.voter >= u32::MAX - VOTERS as u32 {
            self.tallies.fill(Tally::default());
            self.voter = 0;
        }
        self.first = self.voter + 1;
        self.votes[..self.number].fill(0);
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
            for back in (0..=LOOK_BACK).step_by(4) {
                prefetch_index(index.happenings, place.saturating_sub(back));
            }
        }
        for voter in voters {
            self.look_back(index, election, voter);
        }
    }

    /// One voter: what happened while its device waited, latest first, each state once.
    fn look_back(&mut self, index: Happenings<'_>, election: &Election<'_>, voter: usize) {
        let look = election.look(index, voter);
        self.make_room(1 + look.together.len() + LOOK_BACK);
        self.voter += 1;
        let mut meet = Meet {
            voter: (voter, self.voter, self.first),
            now: look.now,
            next: election.next,
            number: self.number,
            tallies: &mut self.tallies,
            met: &mut self.met,
            votes: &mut self.votes,
            meetings: &mut self.meetings,
        };
        meet.state(election.current, look.since);
        for other in look.together {
            meet.state(other.state, other.time);
        }
        for other in look.earlier.iter().rev().take_while(|other| other.time >= look.since) {
            meet.state(other.state, other.time);
        }
        self.number = meet.number;
    }

    /// For so many more states.
    fn make_room(&mut self, states: usize) {
        let number = self.number + states;
        if self.met.len() < number {
            self.met.resize(number, 0);
            self.votes.resize(number, 0);
            self.meetings.resize(number * ROOM, 0);
        }
    }
}

/// A voter on its way back.
struct Meet<'a> {
    /// Its number in this vote and in all, and that of the first of this vote.
    voter: (usize, u32, u32),
    now: Nanoseconds,
    next: StateId,
    number: usize,
    tallies: &'a mut [Tally],
    met: &'a mut [StateId],
    votes: &'a mut [u8],
    meetings: &'a mut [u64],
}

impl Meet<'_> {
    #[inline(always)]
    fn state(&mut self, state: StateId, time: Nanoseconds) {
        let (voter, by, first) = self.voter;
        let tally = &mut self.tallies[state as usize];
        if state == self.next || tally.by == by {
            return;
        }
        // Nobody can foretell which states are new: no branch.
        let is_new = tally.by < first;
        self.met[self.number] = state;
        let at = if is_new { self.number } else { tally.at as usize };
        self.number += usize::from(is_new);
        *tally = Tally { by, at: at as u32 };
        let votes = &mut self.votes[at];
        self.meetings[at * ROOM + usize::from(*votes)] =
            meeting((self.now - time).max(0) as u64, voter);
        *votes += 1;
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

/// An event of the same instant may be the cause of ours only where an input enables an
/// output; otherwise it may as well be its effect.
fn may_enable(index: Happenings<'_>, state: StateId, next: StateId, meetings: &[u64]) -> bool {
    let together = meetings.iter().filter(|&&meeting| ago(meeting) == 0).count();
    together * 5 <= meetings.len()
        || (!index.is_output[state as usize] && index.is_output[next as usize])
}
