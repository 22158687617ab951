//! The rules as the hot loop wants them: filed by the state they lead to, one cache line each,
//! with their limits and counters in it.
//!
//! The state a row leads to says where its [`Lane`] lies, whatever its device did before. So the
//! lanes of coming rows can be fetched ahead of their turn, and an event that takes the most
//! frequent transition into its state touches one line. What only some rules need lies beside
//! ([`sides`]); everything else a rule knows stays in the model until something departs from it.

mod counted;
mod layout;
mod sides;

pub use counted::{Counters, Seen};
pub use layout::Checked;

use std::collections::BTreeMap;
use std::sync::Arc;

use prefetch_index::prefetch_index;

use crate::log::Nanoseconds;

use super::chains::{ChainIndex, ChainKind};
use super::enabling::Trigger;
use super::states::{NO_STATE, StateId};

use layout::Layout;

/// A state not entered since the start or a gap.
pub const NEVER: Nanoseconds = Nanoseconds::MIN;
/// No lane, no slot.
const NONE: u32 = u32::MAX;
/// No rule leads here; unlike [`NO_STATE`], no chain stands there.
const NOWHERE: StateId = NO_STATE - 1;

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
    /// The device of the state it leads to, and [`Traits`].
    device: u32,
    early: [Nanoseconds; INLINE],
    late: [Nanoseconds; INLINE],
    sum: [Nanoseconds; INLINE],
    seen: [u32; INLINE],
}

/// What is particular about a lane: the low bits of [`Lane::device`].
struct Traits;

impl Traits {
    const BITS: u32 = 4;
    /// The state is one of its device's starting signal.
    const STARTING: u32 = 1;
    /// Its time runs from another event.
    const WAITS: u32 = 2;
    /// When the state was entered is kept, since something must know.
    const TRACKED: u32 = 4;
    /// It has further bands.
    const MORE: u32 = 8;
}

/// No rule leads here. A time nobody learned is never remarkable.
const UNUSED: Lane = Lane {
    current: NOWHERE,
    device: u32::MAX << Traits::BITS,
    early: [Nanoseconds::MIN, Nanoseconds::MAX],
    late: [Nanoseconds::MAX, Nanoseconds::MIN],
    sum: [0; INLINE],
    seen: [0; INLINE],
};

impl Lane {
    #[inline(always)]
    fn has(&self, what: u32) -> bool {
        self.device & what != 0
    }
}

/// A band that is not in a lane.
#[derive(Debug, Clone, Copy)]
struct Band {
    early: Nanoseconds,
    late: Nanoseconds,
    seen: Seen,
}

/// Lanes of a model: the first of every state, in their order, then the others.
#[derive(Debug, Clone)]
pub struct Lanes {
    lanes: Vec<Lane>,
    states: usize,
    /// Bands that are in no lane.
    more: Vec<Band>,
    /// By slot: when a state was entered.
    entered: Vec<Nanoseconds>,
    /// By lane: how often it was taken at a time that means nothing, since the last check.
    untimed: BTreeMap<u32, u32>,
    layout: Arc<Layout>,
}

/// What is known of a state by its number alone.
#[derive(Debug, Clone, Copy)]
pub struct Entered {
    /// When it was entered before; [`NEVER`] where nothing must know.
    pub before: Nanoseconds,
    /// Its device.
    pub device: ChainIndex,
    /// True where it is one of its device's starting signal.
    pub starting: bool,
}

/// A transition as it usually is: its lane, its band, the time it took.
#[derive(Debug, Clone, Copy)]
pub struct Usual {
    lane: u32,
    band: u32,
    took: Nanoseconds,
}

impl Lanes {
    /// Fetches the lane of a state, so that it is at hand when its turn comes.
    #[inline(always)]
    pub fn fetch(&self, state: usize) {
        prefetch_index(&self.lanes, state);
        self.layout.fetch_side(state);
    }

    /// Fetches what a state's lane leads on to; the lane is at hand.
    #[inline(always)]
    pub fn fetch_further(&self, state: usize) {
        if self.lanes.get(state).is_some_and(|lane| lane.has(Traits::STARTING))
            && let Some(side) = self.layout.side(state)
        {
            prefetch_index(&self.lanes, side.group as usize);
        }
    }

    /// Keeps that a state was entered. `None` for a state nobody learned: nothing waits for it.
    #[inline]
    pub fn enter(&mut self, state: StateId, time: Nanoseconds) -> Option<Entered> {
        let entered = self.place(state)?;
        let before = self.keep_entry(state, time);
        Some(Entered { before, ..entered })
    }

    /// Where a state stands; `None` for a state nobody learned.
    #[inline(always)]
    pub fn place(&self, state: StateId) -> Option<Entered> {
        let lane = self.lanes[..self.states].get(state as usize)?;
        Some(Entered {
            before: NEVER,
            device: (lane.device >> Traits::BITS) as ChainIndex,
            starting: lane.has(Traits::STARTING),
        })
    }

    /// Keeps when a learned state was entered, where something must know; returns when it was
    /// before.
    #[inline(always)]
    pub fn keep_entry(&mut self, state: StateId, time: Nanoseconds) -> Nanoseconds {
        if !self.lanes[state as usize].has(Traits::TRACKED) {
            return NEVER;
        }
        let slot = self.layout.side(state as usize).map_or(NONE, |side| side.slot);
        let entered = self.entered.get_mut(slot as usize);
        entered.map_or(NEVER, |entered| std::mem::replace(entered, time))
    }

    /// When a learned state was entered before, where something must know.
    #[inline(always)]
    pub fn last_entry(&self, state: StateId) -> Nanoseconds {
        if !self.lanes[state as usize].has(Traits::TRACKED) {
            return NEVER;
        }
        let side = self.layout.side(state as usize);
        side.and_then(|side| self.entered.get(side.slot as usize)).copied().unwrap_or(NEVER)
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
    #[inline(never)]
    fn find_further(&self, kind: ChainKind, current: StateId, first: usize) -> u32 {
        let Some(side) = self.layout.side(first) else { return NONE };
        let mut at = if kind == ChainKind::Device { side.further } else { side.group };
        while let Some(lane) = self.lanes.get(at as usize) {
            if lane.current == current {
                return at;
            }
            at = self.layout.side(at as usize).map_or(NONE, |side| side.further);
        }
        NONE
    }

    /// True where the lane's time runs from another event.
    #[inline(always)]
    pub fn waits(&self, lane: usize) -> bool {
        self.lanes[lane].has(Traits::WAITS)
    }

    /// Since when a lane that waits was due, see [`Trigger::due`].
    #[inline(always)]
    pub fn due(&self, lane: usize, before: Nanoseconds, own: Nanoseconds) -> Option<Nanoseconds> {
        let [one, other] = self.layout.side(lane)?.due.map(|slot| self.entered.get(slot as usize));
        let first = *one?;
        Trigger::due(first, other.copied().unwrap_or(first), before, own)
    }

    /// The lane as it is usually taken; `None` where the time is not accepted.
    #[inline(always)]
    pub fn usual(&self, lane: usize, took: Nanoseconds) -> Option<Usual> {
        let at = &self.lanes[lane];
        // Both are looked at, whichever it is: a branch here would be guessed wrong every other time.
        let first = (took >= at.early[0]) & (took <= at.late[0]);
        let second = (took >= at.early[1]) & (took <= at.late[1]);
        if first | second {
            return Some(Usual { lane: lane as u32, band: u32::from(!first), took });
        }
        let band = if at.has(Traits::MORE) { self.further_band(lane, took) } else { NONE };
        (band != NONE).then_some(Usual { lane: lane as u32, band, took })
    }

    /// Numbers go in and out: what went through memory would keep all of a step there.
    #[inline(never)]
    fn further_band(&self, lane: usize, took: Nanoseconds) -> u32 {
        let bands = &self.more[self.layout.others(lane)];
        let within = bands.iter().position(|band| took >= band.early && took <= band.late);
        within.map_or(NONE, |within| (INLINE + within) as u32)
    }

    /// Counts a usual transition.
    #[inline(always)]
    pub fn take(&mut self, usual: Usual) {
        let Usual { lane, band, took } = usual;
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
        let first = self.layout.others(lane).start;
        let seen = &mut self.more[first + band - INLINE].seen;
        seen.count += 1;
        seen.sum = seen.sum.wrapping_add(took);
    }

    /// Counts a transition whose time means nothing.
    pub fn take_untimed(&mut self, lane: usize) {
        *self.untimed.entry(lane as u32).or_default() += 1;
    }

    /// The rule of a lane.
    pub fn rule(&self, lane: usize) -> usize {
        self.layout.rule_of[lane] as usize
    }
}
