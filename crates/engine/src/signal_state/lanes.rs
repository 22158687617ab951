//! The rules as the hot loop wants them: filed by the state they lead to, one cache line each,
//! with their limits and counters in it.
//!
//! The state a row leads to says where its [`Lane`] lies, whatever its device did before. So the
//! lanes of coming rows can be fetched ahead of their turn, and an event that takes the most
//! frequent transition into its state touches one line. What only some rules need lies beside
//! ([`sides`]); everything else a rule knows stays in the model until something departs from it.

mod checked;
mod counted;
mod layout;
mod sides;
mod within;

pub use checked::{Checked, Checks};
pub use counted::{Counters, Seen};

use std::ops::Range;
use std::sync::Arc;

use prefetch_index::prefetch_index;

use crate::log::Nanoseconds;

use super::chains::{ChainIndex, ChainKind};
use super::found::Timed;
use super::states::{NO_STATE, StateId};

use layout::Layout;
use sides::Side;
use within::Within;

/// A state not entered since the start or a gap.
pub const NEVER: Nanoseconds = Nanoseconds::MIN;
/// No lane, no slot.
const NONE: u32 = u32::MAX;
/// No rule leads here; unlike [`NO_STATE`], no chain stands there.
const NOWHERE: StateId = NO_STATE - 1;

/// In place of a band: the time means nothing.
const UNTIMED: u32 = u32::MAX;

/// Bands in the lane itself; a rule has seldom more.
const INLINE: usize = 2;

/// One rule; the first lane of a state also says what is known of the state. 64 bytes.
///
/// A *band* is the accepted times of one cluster of the rule, and what was seen of it. The bands
/// of a rule do not overlap: the band is the cluster.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Lane {
    /// The state it leads from.
    current: StateId,
    /// The place of its side, and [`Traits`].
    side: u32,
    within: [Within; INLINE],
    sum: [Nanoseconds; INLINE],
    seen: [u32; INLINE],
}

/// What is particular about a lane: the low bits of [`Lane::side`].
struct Traits;

impl Traits {
    const BITS: u32 = 3;
    /// The state is one of its device's starting signal.
    const STARTING: u32 = 1;
    /// Its time runs from another event.
    const WAITS: u32 = 2;
    /// It has further bands.
    const MORE: u32 = 4;
}

/// No rule leads here. A time nobody learned is never remarkable.
const UNUSED: Lane = Lane {
    current: NOWHERE,
    side: 0,
    within: [Within::ALL, Within::NONE],
    sum: [0; INLINE],
    seen: [0; INLINE],
};

impl Lane {
    #[inline(always)]
    fn has(&self, what: u32) -> bool {
        self.side & what != 0
    }

    #[inline(always)]
    fn place_of_side(&self) -> usize {
        (self.side >> Traits::BITS) as usize
    }

    /// The band in the lane that a time belongs to.
    #[inline(always)]
    fn band(&self, took: Nanoseconds) -> Option<usize> {
        // Both are asked, whichever it is: a branch here would be guessed wrong every other time.
        let [first, second] = self.within.map(|within| within.holds(took));
        (first | second).then_some(usize::from(!first))
    }
}

/// A band that is not in a lane.
#[derive(Debug, Clone, Copy)]
struct Band {
    within: Within,
    seen: Seen,
}

/// Where the lanes of a group's chain into one state lie, among those that are no first ones.
#[derive(Debug, Clone, Copy)]
struct Starting {
    /// The state that the first of them leads from.
    first: StateId,
    start: u32,
    end: u32,
}

/// Lanes of a model: the first of every state, in their order, then the others.
#[derive(Debug, Clone)]
pub struct Lanes {
    lanes: Vec<Lane>,
    states: usize,
    /// The states that the others lead from, in their order.
    from: Arc<[StateId]>,
    /// By their places.
    sides: Arc<[Side]>,
    /// By device chain, as its starting signal goes off and as it goes on.
    starting: Arc<[Starting]>,
    /// Bands that are in no lane.
    more: Vec<Band>,
    /// When states were entered, by the places of their sides. Those of which something must know
    /// come first; all that have no side share the very first, which nothing reads. Others have a
    /// place, too, so that no row asks whether its state has one.
    entered: Vec<Nanoseconds>,
    /// By lane: how often it was taken at a time that means nothing, since the last check.
    untimed: Vec<u32>,
    /// Whether times mean something in a group's chain, too.
    times_groups: bool,
    layout: Arc<Layout>,
}

/// A transition as it usually is: its lane, its band, the time it took.
#[derive(Debug, Clone, Copy, Default)]
pub struct Usual {
    lane: u32,
    band: u32,
    took: Nanoseconds,
}

impl Lanes {
    /// Fetches the first lane of a state, so that it is at hand when its turn comes.
    #[inline(always)]
    pub fn fetch(&self, state: StateId) {
        // Beyond the last there are only signals nobody learned: to fetch what is there is no harm.
        prefetch_index(&self.lanes, state as usize);
    }

    /// Fetches what stands beside a state's lane, which is at hand; most have nothing there and
    /// fetch the same.
    #[inline(always)]
    pub fn fetch_side(&self, state: StateId) {
        if let Some(lane) = self.lanes.get(state as usize) {
            prefetch_index(&self.sides, lane.place_of_side());
        }
    }

    /// Counts a transition from `current` at `time` as a usual one, and the state as entered;
    /// false, and nothing counted, where it is not one of the state's first lane, or what it
    /// `took`, not below zero, is not accepted in one of the lane's own bands.
    #[inline(always)]
    pub fn take_first(
        &mut self,
        state: StateId,
        current: StateId,
        time: Nanoseconds,
        took: Nanoseconds,
    ) -> bool {
        let Some(lane) = self.lanes.get_mut(state as usize) else { return false };
        // As in [`Lane::band`], and no branch for which of the two it is either.
        let [first, second] = lane.within.map(|within| within.holds(took));
        if !(first | second) | (lane.current != current) {
            return false;
        }
        let band = usize::from(!first);
        lane.seen[band] += 1;
        lane.sum[band] = lane.sum[band].wrapping_add(took);
        if let Some(entered) = self.entered.get_mut(lane.place_of_side()) {
            *entered = time;
        }
        true
    }

    #[inline(always)]
    fn side(&self, lane: usize) -> Option<&Side> {
        self.sides.get(self.lanes.get(lane)?.place_of_side())
    }

    /// Keeps when a state was entered, and returns when it was before; [`NEVER`] where nothing must
    /// know.
    #[inline(always)]
    pub fn enter(&mut self, state: StateId, time: Nanoseconds) -> Nanoseconds {
        let Some(lane) = self.lanes[..self.states].get(state as usize) else { return NEVER };
        let entered = self.entered.get_mut(lane.place_of_side());
        entered.map_or(NEVER, |entered| std::mem::replace(entered, time))
    }

    /// When a state was entered before, where something must know.
    #[inline(always)]
    pub fn last_entry(&self, state: StateId) -> Nanoseconds {
        let lane = self.lanes[..self.states].get(state as usize);
        let entered = lane.and_then(|lane| self.entered.get(lane.place_of_side()));
        entered.copied().unwrap_or(NEVER)
    }

    /// Sight was lost: as if no state had ever been entered.
    pub fn forget_entries(&mut self) {
        self.entered.fill(NEVER);
    }

    /// The lane of a chain's rule between two states.
    #[inline(always)]
    pub fn find(&self, kind: ChainKind, current: StateId, next: StateId) -> Option<usize> {
        if next as usize >= self.states {
            return None;
        }
        if kind == ChainKind::Device && self.lanes[next as usize].current == current {
            return Some(next as usize);
        }
        let found = self.find_further(kind, current, next as usize);
        (found != NONE).then_some(found as usize)
    }

    /// The lane where it is not the first of its state, or [`NONE`].
    #[inline(always)]
    fn find_further(&self, kind: ChainKind, current: StateId, first: usize) -> u32 {
        let Some(side) = self.side(first) else { return NONE };
        let (start, end) = match kind {
            ChainKind::Device => (side.further, side.group),
            ChainKind::Group => (side.group, side.end),
        };
        self.find_among(start..end, current).map_or(NONE, |lane| lane as u32)
    }

    /// The lane that leads from a state, among some of those that are no first ones.
    #[inline(always)]
    fn find_among(&self, range: Range<u32>, current: StateId) -> Option<usize> {
        let (start, end) = (range.start as usize, range.end as usize);
        let place = self.from.get(start..end)?.iter().position(|&from| from == current)?;
        Some(self.states + start + place)
    }

    /// The lane of a group's rule from one state to that of a device's starting signal, which is
    /// boolean: [`Self::find`] without a look at the lane of that state.
    #[inline(always)]
    pub fn find_starting(
        &self,
        device: ChainIndex,
        current: StateId,
        next: StateId,
    ) -> Option<usize> {
        let &Starting { first, start, end } = self.starting.get(2 * device + next as usize % 2)?;
        if first == current {
            return Some(self.states + start as usize);
        }
        self.find_among(start..end, current)
    }

    /// True for a learned state of a starting signal: a step of its group's chain.
    #[inline(always)]
    pub fn starts(&self, state: StateId) -> bool {
        self.lanes[state as usize].has(Traits::STARTING)
    }

    /// True where the lane's time runs from another event.
    #[inline(always)]
    pub fn waits(&self, lane: usize) -> bool {
        self.lanes[lane].has(Traits::WAITS)
    }

    /// True where a state's first lane waits for another state, alone or among others.
    pub fn waits_for(&self, state: StateId, other: StateId) -> bool {
        let place = self.lanes[other as usize].place_of_side() as u32;
        self.side(state as usize).is_some_and(|side| side.due.contains(&place))
    }

    /// Since when a lane that waits was due, of a device that stands where it stands since `own` and
    /// whose next state was entered before at `before`; `None` where it waits for what has not
    /// happened afresh.
    #[inline(always)]
    pub fn due(&self, lane: usize, before: Nanoseconds, own: Nanoseconds) -> Option<Nanoseconds> {
        self.side(lane)?.due(&self.entered, before, own)
    }

    /// A transition of a device that stands in `current` since `own`, whose next state was entered
    /// before at `before`; `None` where it is none or not in time.
    #[inline(always)]
    pub fn usual_of_device(
        &self,
        current: StateId,
        next: StateId,
        [before, own, time]: [Nanoseconds; 3],
    ) -> Option<Usual> {
        let lane = self.find(ChainKind::Device, current, next)?;
        let since = if self.waits(lane) { self.due(lane, before, own)? } else { own };
        self.usual(lane, Timed::new(since, time, true).took)
    }

    /// Takes such a transition, and counts the state as entered; false, and nothing counted, where
    /// there is none.
    #[inline(never)]
    pub fn take_any(
        &mut self,
        current: StateId,
        next: StateId,
        own: Nanoseconds,
        time: Nanoseconds,
    ) -> bool {
        let times = [self.last_entry(next), own, time];
        let Some(usual) = self.usual_of_device(current, next, times) else { return false };
        self.take(usual);
        self.enter(next, time);
        true
    }

    /// The lane as it is usually taken; `None` where the time, not below zero, is not accepted.
    #[inline(always)]
    pub fn usual(&self, lane: usize, took: Nanoseconds) -> Option<Usual> {
        let at = &self.lanes[lane];
        if let Some(band) = at.band(took) {
            return Some(Usual { lane: lane as u32, band: band as u32, took });
        }
        let band = if at.has(Traits::MORE) { self.further_band(lane, took) } else { NONE };
        (band != NONE).then_some(Usual { lane: lane as u32, band, took })
    }

    /// The lane of a group's chain as it is usually taken.
    #[inline(always)]
    pub fn usual_of_group(&self, lane: usize, took: Nanoseconds) -> Option<Usual> {
        if self.times_groups {
            return self.usual(lane, took);
        }
        Some(Usual { lane: lane as u32, band: UNTIMED, took })
    }

    /// Numbers go in and out: what went through memory would keep all of a step there.
    #[inline(never)]
    fn further_band(&self, lane: usize, took: Nanoseconds) -> u32 {
        let within = self.further(lane).iter().position(|band| band.within.holds(took));
        within.map_or(NONE, |within| (INLINE + within) as u32)
    }

    /// Counts a usual transition.
    #[inline(always)]
    pub fn take(&mut self, usual: Usual) {
        let Usual { lane, band, took } = usual;
        if band == UNTIMED {
            return self.take_untimed(lane as usize);
        }
        let at = &mut self.lanes[lane as usize];
        if let Some(seen) = at.seen.get_mut(band as usize) {
            *seen += 1;
            let sum = &mut at.sum[band as usize];
            *sum = sum.wrapping_add(took);
        } else {
            self.take_further_band(lane as usize, band as usize, took);
        }
    }

    #[inline(never)]
    fn take_further_band(&mut self, lane: usize, band: usize, took: Nanoseconds) {
        let first = self.others(lane).start;
        let seen = &mut self.more[first + band - INLINE].seen;
        seen.count += 1;
        seen.sum = seen.sum.wrapping_add(took);
    }

    /// Counts a transition whose time means nothing.
    #[inline(always)]
    pub fn take_untimed(&mut self, lane: usize) {
        self.untimed[lane] += 1;
    }

    /// The rule of a lane.
    pub fn rule(&self, lane: usize) -> usize {
        self.layout.rule_of[lane] as usize
    }

    /// Where the bands of a lane lie that are not in it.
    fn others(&self, lane: usize) -> Range<usize> {
        self.side(lane).map_or(0..0, |side| side.more as usize..(side.more + side.bands) as usize)
    }

    /// The bands of a lane that are not in it.
    #[inline]
    fn further(&self, lane: usize) -> &[Band] {
        let has = self.lanes[lane].has(Traits::MORE);
        if has { &self.more[self.others(lane)] } else { &[] }
    }
}
