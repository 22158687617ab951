//! The enabling event of a transition: what it really waits for.
//!
//! Many transitions wait for a neighbour. Measured from the device's own last event their times
//! look random; measured from the event that enables them they are tight. For every transition
//! whose own times are broad we look for the signal-state in its group, or the later of two (a
//! join), whose occurrences best explain when it happens.
//!
//! Near-linear: a sample of the instances looks back over the last few events of the group and
//! votes for the states it meets at a steady distance; only the finalists are measured on all
//! instances. What lies further back in time than those few events is not found.

use crate::log::{Nanoseconds, SECOND, SignalIndex};
use crate::plant::{Plant, SignalClass};
use crate::timing::TimeCluster;
use crate::timing::optimal;

use super::states::{NO_STATE, StateId, States};

/// What enables a transition, and how long it then takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Trigger {
    /// The enabling state, and the other one of a join: the delay runs from the later of the two.
    pub states: [StateId; 2],
    /// Delays from the enabling event.
    pub clusters: Box<[TimeCluster]>,
}

impl Trigger {
    /// The states there are: one, or the two of a join.
    pub fn states(&self) -> impl Iterator<Item = StateId> + '_ {
        self.states.iter().copied().filter(|&state| state != NO_STATE)
    }

    /// Since when the transition was due, its enabling states (of one, twice) having been entered
    /// at two times: the later. `None` where the device was not waiting for it: one of them has not
    /// been entered afresh since the device last did the same (`before`), or the device's own last
    /// event (`own`) is the later.
    #[inline]
    pub fn due(
        one: Nanoseconds,
        other: Nanoseconds,
        before: Nanoseconds,
        own: Nanoseconds,
    ) -> Option<Nanoseconds> {
        let (older, later) = (one.min(other), one.max(other));
        (older >= before && older != Nanoseconds::MIN && later >= own).then_some(later)
    }
}

/// Fewer instances say nothing about what enables a transition.
const INSTANCES_AT_LEAST: usize = 8;
/// Instances that vote; one bit each.
const VOTERS: usize = 32;
/// A first screening by so few voters spares most transitions the full vote: some state must be
/// met by so many of them at a steady distance.
const SCREENERS: usize = 8;
const SCREENED: u32 = 3;
/// Events of the group a voter looks back over.
const LOOK_BACK: usize = 48;
/// A trigger must explain this share of the voters.
const EXPLAINED: f64 = 0.9;
/// Each partner of a join must explain at least this share alone.
const PARTNER: f64 = 0.08;
/// Candidates that may lead a join.
const LEADING: usize = 24;
/// Finalists measured on all instances, of single triggers and of joins.
const FINALISTS: usize = 6;
/// A trigger must leave no more than this share of the own spread.
const GAIN: f64 = 0.5;
/// Steps (of the natural logarithm of the spread) by which several distances must beat one.
const SEVERAL: f64 = 2.0;
/// Own times spreading less than this many resolutions, or this share of the time, are tight.
const TIGHT_RESOLUTIONS: f64 = 5.0;
const TIGHT_SHARE: f64 = 0.0001;
/// Delays that agree within this are steady, at the most.
const STEADY_AT_MOST_S: f64 = 1.0;
/// Instances whose happenings are fetched ahead of their turn.
const TOUCHED: usize = 16;
/// So many instances a trigger must leave unexplained before a partner is looked for, and the
/// partner must explain this share of them.
const LEFT_AT_LEAST: usize = 3;
const LEFT_EXPLAINED: f64 = 0.6;
/// Share of each tail of delays that may be outliers.
const OUTLIERS: f64 = 0.01;

/// One event of the learning logs.
#[derive(Debug, Clone, Copy)]
pub struct Happening {
    /// When.
    pub time: Nanoseconds,
    /// The signal that changed.
    pub signal: SignalIndex,
    /// The state entered.
    pub state: StateId,
    /// Run it belongs to: logs, and the stretches between gaps, each begin a new one.
    pub run: u32,
    /// True where this is no event, but its device's state is in doubt after a gap.
    pub doubtful: bool,
}

/// No voter has met a state in this search.
const NOBODY: u32 = u32::MAX;

/// One event of a group, as a voter passes it on the way back.
#[derive(Clone, Copy)]
struct Passed {
    time: Nanoseconds,
    state: StateId,
    run: u32,
}

/// What a voter met: a state, and how long ago.
#[derive(Clone, Copy)]
struct Meeting {
    state: StateId,
    voter: u8,
    ago: Nanoseconds,
}

/// Bits of a packed meeting: the voter, and how long ago (137 s); the state has the rest.
const VOTER_BITS: u32 = VOTERS.ilog2();
const AGO_BITS: u32 = 37;

impl Meeting {
    /// By state, then by distance, in one number; `None` for a wait that takes minutes.
    fn pack(&self) -> Option<u64> {
        let ago = u64::try_from(self.ago).ok().filter(|ago| ago >> AGO_BITS == 0)?;
        let state = u64::from(self.state);
        let key = (state << AGO_BITS | ago) << VOTER_BITS | u64::from(self.voter);
        (state >> (64 - AGO_BITS - VOTER_BITS) == 0).then_some(key)
    }

    fn unpack(key: u64) -> Self {
        let bits = |shift: u32, bits: u32| key >> shift & ((1 << bits) - 1);
        Self {
            state: (key >> (AGO_BITS + VOTER_BITS)) as StateId,
            voter: bits(0, VOTER_BITS) as u8,
            ago: bits(VOTER_BITS, AGO_BITS) as Nanoseconds,
        }
    }

    /// Sorts by state, then by distance. Numbers sort several times faster than structures.
    fn sort(meetings: &mut [Self], keys: &mut Vec<u64>) {
        keys.clear();
        keys.extend(meetings.iter().map_while(Self::pack));
        if keys.len() < meetings.len() {
            meetings.sort_unstable_by_key(|meeting| (meeting.state, meeting.ago));
            return;
        }
        keys.sort_unstable();
        for (meeting, &key) in meetings.iter_mut().zip(keys.iter()) {
            *meeting = Self::unpack(key);
        }
    }
}

/// Looks for enabling events in learned happenings.
pub struct Search<'a> {
    happenings: &'a [Happening],
    plant: &'a Plant,
    states: &'a States,
    resolution_s: f64,
    /// Per signal.
    group_of: Vec<u32>,
    /// Events of each group, and the place of each happening among its group's.
    by_group: Vec<Vec<Passed>>,
    place: Vec<u32>,
    /// Happenings by state, and where those of each state begin.
    of_state: Vec<u32>,
    first_of: Vec<u32>,
    /// Per state: the voter that met it last, and how many have.
    seen_by: Vec<u32>,
    votes: Vec<u8>,
    meetings: Vec<Meeting>,
    keys: Vec<u64>,
}

/// A candidate after the vote.
struct Candidate {
    state: StateId,
    /// How many voters met it.
    met: u32,
    /// Those that met it at one steady distance.
    mask: u32,
    /// Least and greatest of those distances, in seconds.
    window: (f64, f64),
    /// The same within the width that the scans alone explain: what partners of a join share.
    close: Window,
}

impl<'a> Search<'a> {
    /// Indexes the happenings of a plant.
    pub fn new(
        happenings: &'a [Happening],
        plant: &'a Plant,
        states: &'a States,
        resolution: Nanoseconds,
    ) -> Self {
        let group_of: Vec<u32> =
            plant.signals.iter().map(|s| plant.devices[s.device].group as u32).collect();
        let mut sizes = vec![0usize; plant.groups.len()];
        for happening in happenings {
            sizes[group_of[happening.signal as usize] as usize] += 1;
        }
        let mut by_group: Vec<Vec<Passed>> = sizes.into_iter().map(Vec::with_capacity).collect();
        let mut place = Vec::with_capacity(happenings.len());
        let mut last_of = vec![0u32; states.len() + 1];
        for happening in happenings {
            let Happening { time, signal, state, run, .. } = *happening;
            let group = &mut by_group[group_of[signal as usize] as usize];
            place.push(group.len() as u32);
            group.push(Passed { time, state, run });
            last_of[state as usize + 1] += 1;
        }
        for state in 1..last_of.len() {
            last_of[state] += last_of[state - 1];
        }
        let first_of = last_of.clone();
        let mut of_state = vec![0u32; happenings.len()];
        for (index, happening) in (0..).zip(happenings) {
            let at = &mut last_of[happening.state as usize];
            of_state[*at as usize] = index;
            *at += 1;
        }
        Self {
            happenings,
            plant,
            states,
            resolution_s: resolution as f64 / SECOND as f64,
            group_of,
            by_group,
            place,
            first_of,
            of_state,
            seen_by: vec![NOBODY; states.len()],
            votes: vec![0; states.len()],
            meetings: Vec::new(),
            keys: Vec::new(),
        }
    }

    /// The enabling event of a transition into `next`, whose instances are the happenings
    /// `instances` (ascending) and took `own_s` since the device's own last event (`sorted`: by
    /// size); `current` is that event's state. `None` where nothing explains it better than the own event.
    pub fn trigger(
        &mut self,
        instances: &[u32],
        own_s: &[f64],
        sorted: &[f64],
        (current, next): (StateId, StateId),
    ) -> Option<Trigger> {
        if instances.len() < INSTANCES_AT_LEAST {
            return None;
        }
        let own_spread = residual_spread(sorted);
        let tight = TIGHT_RESOLUTIONS * self.resolution_s;
        if own_spread <= tight.max(TIGHT_SHARE * sorted[sorted.len() / 2]) {
            return None;
        }
        let steady = (own_spread / 8.0).clamp(tight, STEADY_AT_MOST_S.max(tight));
        let first = self.vote(instances, own_s, (current, next), steady, SCREENERS);
        let promising = |c: &Candidate| c.state != current && c.mask.count_ones() >= SCREENED;
        if !first.iter().any(promising) {
            return None;
        }
        let voters = instances.len().min(VOTERS);
        let candidates = self.vote(instances, own_s, (current, next), steady, voters);
        let finalists = finalists(&candidates, voters, (self.close_s(), steady));
        let best = finalists
            .into_iter()
            .filter_map(|states| {
                let delays = self.delays(instances, own_s, states, next)?;
                let spread = residual_spread(&delays);
                (spread <= GAIN * own_spread).then_some((spread, delays, states))
            })
            // Several distances must explain far better than one; and the shorter delay stands
            // nearer to the cause where two explain equally well.
            .min_by(|a, b| {
                let rank = |(spread, delays, _): &(f64, Vec<f64>, _)| {
                    let n = delays.len();
                    let several = delays[n - 1 - n / 20] - delays[n / 20] > steady;
                    let left = (spread.max(self.resolution_s) / self.resolution_s).ln().round();
                    (left + if several { SEVERAL } else { 0.0 }) * 1e6 + delays[n / 2]
                };
                rank(a).total_cmp(&rank(b))
            })?;
        let (_, delays, states) = best;
        let joined = self.with_partner(instances, own_s, (current, next), states);
        let (delays, states) = joined.unwrap_or((delays, states));
        Some(Trigger { states, clusters: optimal::cluster(&delays, self.resolution_s).into() })
    }

    /// Delays that agree within this differ by no more than scans do.
    fn close_s(&self) -> f64 {
        2.0 * TIGHT_RESOLUTIONS * self.resolution_s
    }

    /// The partner of a single trigger that explains most instances and leaves some far off: the
    /// instances left vote for what they really waited for, at the same distance.
    fn with_partner(
        &mut self,
        instances: &[u32],
        own_s: &[f64],
        (current, next): (StateId, StateId),
        [one, other]: [StateId; 2],
    ) -> Option<(Vec<f64>, [StateId; 2])> {
        if other != NO_STATE {
            return None;
        }
        let close = self.close_s();
        let delays = self.delay_of_each(instances, own_s, [one, NO_STATE], next);
        let mut sorted: Vec<f64> = delays.iter().copied().filter(|d| d.is_finite()).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let (low, high) = most_within(&sorted, close)?;
        let explained = |delay: &f64| (low..=high).contains(delay);
        let left: Vec<usize> = (0..delays.len()).filter(|&at| !explained(&delays[at])).collect();
        if left.len() < LEFT_AT_LEAST || left.len() * 3 > instances.len() * 2 {
            return None;
        }
        let theirs: Vec<u32> = left.iter().map(|&at| instances[at]).collect();
        let own: Vec<f64> = left.iter().map(|&at| own_s[at]).collect();
        let voters = theirs.len().min(VOTERS);
        let mut candidates = self.vote(&theirs, &own, (current, next), close, voters);
        candidates.retain(|c| {
            let (mask, (least, most)) = c.close;
            c.state != one
                && f64::from(mask.count_ones()) >= LEFT_EXPLAINED * voters as f64
                && most.max(high) - least.min(low) <= 1.5 * close
        });
        candidates.sort_by_key(|c| std::cmp::Reverse(c.close.0.count_ones()));
        let joined = candidates.iter().take(FINALISTS).filter_map(|c| {
            let states = [one, c.state];
            let delays = self.delays(instances, own_s, states, next)?;
            let (low, high) = most_within(&delays, close)?;
            let within = delays.iter().filter(|d| (low..=high).contains(*d)).count();
            let still_left = instances.len() - within;
            let fewer = still_left as f64 <= GAIN * left.len() as f64;
            fewer.then_some((still_left, delays, states))
        });
        let best = joined.min_by_key(|(still_left, ..)| *still_left);
        best.map(|(_, delays, states)| (delays, states))
    }

    /// Lets a sample of the instances look back; the own last event always stands for election.
    fn vote(
        &mut self,
        instances: &[u32],
        own_s: &[f64],
        (current, next): (StateId, StateId),
        steady: f64,
        voters: usize,
    ) -> Vec<Candidate> {
        self.meetings.clear();
        let instance = |voter: usize| voter * instances.len() / voters;
        self.touch((0..voters).map(|voter| instances[instance(voter)]));
        for voter in 0..voters {
            let instance = instance(voter);
            self.look_back(voter as u8, instances[instance], own_s[instance], (current, next));
        }
        let least = (PARTNER * voters as f64).ceil() as u8;
        let mut meetings = std::mem::take(&mut self.meetings);
        for meeting in &meetings {
            self.seen_by[meeting.state as usize] = NOBODY;
        }
        meetings.retain(|m| self.votes[m.state as usize] >= least || m.state == current);
        Meeting::sort(&mut meetings, &mut self.keys);
        let mut candidates = Vec::new();
        for run in meetings.chunk_by(|a, b| a.state == b.state) {
            if self.may_enable(run[0].state, next, run)
                && let Some((mask, window)) = densest(run, steady)
                && let Some(close) = densest(run, steady.min(self.close_s()))
                && (mask.count_ones() >= u32::from(least) || run[0].state == current)
            {
                let met = run.len() as u32;
                candidates.push(Candidate { state: run[0].state, met, mask, window, close });
            }
        }
        self.meetings = meetings;
        candidates
    }

    /// Reads what the voters will need. Each looks at another place of a long log; loads that do
    /// not wait for one another share their latency.
    fn touch(&self, voters: impl Iterator<Item = u32>) {
        let mut places = [(0usize, 0usize); VOTERS];
        for (place, index) in places.iter_mut().zip(voters) {
            let group = self.group_of[self.happenings[index as usize].signal as usize];
            *place = (group as usize, self.place[index as usize] as usize);
        }
        let mut touched = 0;
        for (group, place) in places {
            // Four events a cache line.
            for back in [0, 4, 8] {
                let passed =
                    self.by_group.get(group).and_then(|g| g.get(place.saturating_sub(back)));
                touched ^= passed.map_or(0, |passed| passed.state);
            }
        }
        std::hint::black_box(touched);
    }

    /// One voter: what happened while its device waited, latest first, each state once.
    fn look_back(
        &mut self,
        voter: u8,
        index: u32,
        own_s: f64,
        (current, next): (StateId, StateId),
    ) {
        let here = self.happenings[index as usize];
        let group = &self.by_group[self.group_of[here.signal as usize] as usize];
        let place = self.place[index as usize] as usize;
        let since = here.time - (own_s * SECOND as f64).round() as Nanoseconds;
        let (seen_by, votes, meetings) = (&mut self.seen_by, &mut self.votes, &mut self.meetings);
        // A happening belongs to one transition of one device, so it stamps uniquely.
        let mut meet = |state: StateId, time: Nanoseconds| {
            if state != next && seen_by[state as usize] != index {
                let first = seen_by[state as usize] == NOBODY;
                votes[state as usize] = if first { 1 } else { votes[state as usize] + 1 };
                seen_by[state as usize] = index;
                meetings.push(Meeting { state, voter, ago: here.time - time });
            }
        };
        meet(current, since);
        // Of the same time, but later in the file: the order inside a scan means nothing.
        for later in group[place + 1..].iter().take_while(|other| other.time == here.time) {
            meet(later.state, later.time);
        }
        let waited = |other: &&Passed| other.run == here.run && other.time >= since;
        for earlier in group[..place].iter().rev().take(LOOK_BACK).take_while(waited) {
            meet(earlier.state, earlier.time);
        }
    }

    /// An event of the same instant may be the cause of ours only where an input enables an
    /// output; otherwise it may as well be its effect.
    fn may_enable(&self, state: StateId, next: StateId, delays: &[Meeting]) -> bool {
        let class = |state| {
            let (signal, _) = self.states.signal_value(state);
            self.plant.signals[signal as usize].class
        };
        let together = delays.iter().filter(|meeting| meeting.ago <= 0).count();
        together * 5 <= delays.len()
            || (class(state) != SignalClass::Output && class(next) == SignalClass::Output)
    }

    /// Happenings that entered a state, ascending.
    fn entries(&self, state: StateId) -> &[u32] {
        let state = state as usize;
        &self.of_state[self.first_of[state] as usize..self.first_of[state + 1] as usize]
    }

    /// Sorted delays of all instances from the later of the states; `None` where more than a few
    /// instances came without a fresh one: each occurrence enables a transition once, and only
    /// what happens while the device waits enables it.
    fn delays(
        &self,
        instances: &[u32],
        own_s: &[f64],
        states: [StateId; 2],
        next: StateId,
    ) -> Option<Vec<f64>> {
        let mut delays = self.delay_of_each(instances, own_s, states, next);
        delays.retain(|delay| delay.is_finite());
        delays.sort_unstable_by(f64::total_cmp);
        (delays.len() as f64 >= EXPLAINED * instances.len() as f64).then_some(delays)
    }

    /// The same in the order of the instances; infinite where there was no fresh one.
    fn delay_of_each(
        &self,
        instances: &[u32],
        own_s: &[f64],
        states: [StateId; 2],
        next: StateId,
    ) -> Vec<f64> {
        let mut delays: Vec<f64> = Vec::with_capacity(instances.len());
        let mut cursors = [0usize; 2];
        let entries = self.entries(next);
        let mut entry = 0;
        for (at, (&index, &own)) in instances.iter().zip(own_s).enumerate() {
            if at % TOUCHED == 0 {
                let ahead = &instances[at..instances.len().min(at + TOUCHED)];
                let times = ahead.iter().map(|&index| self.happenings[index as usize].time);
                std::hint::black_box(times.fold(0, |touched, time| touched ^ time));
            }
            let here = self.happenings[index as usize];
            // Happenings are in order: all of the same time, and none that are later.
            let together = self.happenings[index as usize + 1..]
                .iter()
                .take_while(|other| other.time == here.time && other.run == here.run)
                .count();
            let reached = index + together as u32;
            entry += entries[entry..].partition_point(|&other| other < index);
            let before = entry.checked_sub(1).map(|at| self.happenings[entries[at] as usize]);
            let before = before.filter(|b| b.run == here.run).map(|b| b.time);
            let mut latest: Option<Nanoseconds> = None;
            let mut fresh = true;
            for (state, cursor) in states.iter().zip(&mut cursors) {
                if *state == NO_STATE {
                    continue;
                }
                let occurrences = self.entries(*state);
                *cursor += occurrences[*cursor..].iter().take_while(|&&o| o <= reached).count();
                let last =
                    cursor.checked_sub(1).map(|at| self.happenings[occurrences[at] as usize]);
                let time = last.filter(|l| l.run == here.run).map(|l| l.time);
                fresh &= time.is_some() && time >= before;
                latest = latest.max(time);
            }
            let delay = latest.filter(|_| fresh).map(|time| seconds(here.time - time));
            delays.push(delay.filter(|&delay| delay <= own).unwrap_or(f64::INFINITY));
        }
        delays
    }
}

fn seconds(time: Nanoseconds) -> f64 {
    time as f64 / SECOND as f64
}

/// The window of width `steady` that holds most of the meetings, sorted by distance: its voters
/// and ends.
fn densest(meetings: &[Meeting], steady: f64) -> Option<(u32, (f64, f64))> {
    let steady = (steady * SECOND as f64) as Nanoseconds;
    let mut best: Option<(usize, usize)> = None;
    let mut start = 0;
    for end in 0..meetings.len() {
        while meetings[end].ago - meetings[start].ago > steady {
            start += 1;
        }
        if best.is_none_or(|(s, e)| end - start > e - s) {
            best = Some((start, end));
        }
    }
    best.map(|(start, end)| {
        let mask = meetings[start..=end].iter().fold(0u32, |mask, m| mask | 1 << m.voter);
        (mask, (seconds(meetings[start].ago), seconds(meetings[end].ago)))
    })
}

/// The most promising single triggers and joins.
fn finalists(
    candidates: &[Candidate],
    voters: usize,
    (close, steady): (f64, f64),
) -> Vec<[StateId; 2]> {
    let needed = (EXPLAINED * voters as f64).ceil() as u32;
    let spread = |c: &Candidate| c.window.1 - c.window.0;
    let best = |mut singles: Vec<&Candidate>| {
        singles.sort_by(|a, b| spread(a).total_cmp(&spread(b)));
        singles.into_iter().take(FINALISTS).map(|c| [c.state, NO_STATE]).collect::<Vec<_>>()
    };
    let (steady_ones, others): (Vec<&Candidate>, Vec<&Candidate>) =
        candidates.iter().partition(|c| c.mask.count_ones() >= needed);
    let mut finalists = best(steady_ones);
    // A program may act after one time or another: met by all, at a few steady distances.
    finalists.extend(best(
        others
            .into_iter()
            .filter(|c| c.met >= needed && 3 * c.mask.count_ones() >= needed)
            .collect(),
    ));
    // Where scans alone do not explain the scatter of the delays, wider windows may.
    let mut pairs = joins(candidates, needed, close, |c| c.close);
    if pairs.is_empty() {
        pairs = joins(candidates, needed, steady, |c| (c.mask, c.window));
    }
    finalists.extend(pairs.into_iter().take(FINALISTS));
    finalists
}

/// A candidate's voters, and the least and greatest of their distances in seconds.
type Window = (u32, (f64, f64));

/// Pairs that together explain what neither does alone, those that explain most first.
fn joins(
    candidates: &[Candidate],
    needed: u32,
    width: f64,
    window: impl Fn(&Candidate) -> Window,
) -> Vec<[StateId; 2]> {
    let mut partners: Vec<(StateId, Window)> =
        candidates.iter().map(|c| (c.state, window(c))).collect();
    partners.sort_by_key(|(_, (mask, _))| std::cmp::Reverse(mask.count_ones()));
    let mut pairs: Vec<(u32, f64, [StateId; 2])> = Vec::new();
    for (at, (one, (a, first))) in partners.iter().enumerate().take(LEADING) {
        let alone = a.count_ones();
        // The leading one of two explains at least half of what both do.
        if 2 * alone < needed {
            break;
        }
        for (other, (b, second)) in &partners[at + 1..] {
            let together = (a | b).count_ones();
            // The program waits for both and then acts: whichever is the later, at one distance.
            let (low, high) = (first.0.min(second.0), first.1.max(second.1));
            if together >= needed && together > alone && high - low <= width {
                pairs.push((together, high - low, [*one, *other]));
            }
        }
    }
    pairs.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
    pairs.into_iter().map(|(.., states)| states).collect()
}

/// Ends of the window of this width that holds most of the sorted times.
fn most_within(sorted: &[f64], width: f64) -> Option<(f64, f64)> {
    let mut best: Option<(usize, usize)> = None;
    let mut start = 0;
    for end in 0..sorted.len() {
        while sorted[end] - sorted[start] > width {
            start += 1;
        }
        if best.is_none_or(|(s, e)| end - start > e - s) {
            best = Some((start, end));
        }
    }
    best.map(|(start, end)| (sorted[start], sorted[end]))
}

/// Range of sorted times without a few outliers and without the two widest gaps: what up to three
/// steady times leave unexplained.
fn residual_spread(sorted: &[f64]) -> f64 {
    let cut = (OUTLIERS * sorted.len() as f64).round() as usize;
    let kept = &sorted[cut..sorted.len() - cut];
    let (Some(first), Some(last)) = (kept.first(), kept.last()) else {
        return 0.0;
    };
    let (mut widest, mut second) = (0.0, 0.0);
    for pair in kept.windows(2) {
        let gap = pair[1] - pair[0];
        if gap > widest {
            (widest, second) = (gap, widest);
        } else if gap > second {
            second = gap;
        }
    }
    last - first - widest - second
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_steady_times_leave_little() {
        let times = [1.0, 1.01, 1.02, 5.0, 5.01, 9.0, 9.02];
        assert!((residual_spread(&times) - 0.05).abs() < 1e-9);
    }

    #[test]
    fn meetings_are_sorted_alike_packed_or_not() {
        let met = |state, voter, ago| Meeting { state, voter, ago };
        for far in [0, 1 << AGO_BITS] {
            let mut meetings = [met(9, 1, 5 + far), met(2, 31, 7), met(9, 0, 0), met(2, 3, 6)];
            Meeting::sort(&mut meetings, &mut Vec::new());
            let sorted = meetings.map(|m| (m.state, m.voter, m.ago));
            assert_eq!(sorted, [(2, 3, 6), (2, 31, 7), (9, 0, 0), (9, 1, 5 + far)]);
        }
    }

    #[test]
    fn the_densest_window_names_its_voters() {
        let met = |voter, ms: i64| Meeting { state: 0, voter, ago: ms * SECOND / 1000 };
        let meetings = [met(3, 100), met(0, 110), met(2, 120), met(1, 7000)];
        let (mask, (low, high)) = densest(&meetings, 0.05).unwrap_or_default();
        assert_eq!(mask, 0b1101);
        assert!((high - low - 0.02).abs() < 1e-9);
    }
}
