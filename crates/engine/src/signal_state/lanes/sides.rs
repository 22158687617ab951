//! What only some lanes need.

use crate::log::Nanoseconds;
use crate::signal_state::chains::ChainKind;
use crate::signal_state::enabling::Trigger;

use super::NONE;

/// What only some lanes need. Half a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
pub(super) struct Side {
    /// From the first lane of a state: its device's further lanes lie from here to `group`, its
    /// group's lanes to `end`, among those that are no first ones.
    pub(super) further: u32,
    pub(super) group: u32,
    pub(super) end: u32,
    /// Places of the sides of the enabling states.
    pub(super) due: [u32; 2],
    /// Place of its further bands, and how many those are.
    pub(super) more: u32,
    pub(super) bands: u32,
}

impl Side {
    /// Adds the next lane of a state that is no first one: the device's come before the group's.
    pub(super) fn add_further(&mut self, kind: ChainKind, place: u32) {
        if self.end == 0 {
            (self.further, self.group) = (place, place);
        }
        self.end = place + 1;
        if kind == ChainKind::Device {
            self.group = self.end;
        }
    }

    /// Since when its lane was due, see [`Trigger::due`]; `entered` is by the places of sides.
    #[inline(always)]
    pub(super) fn due(
        &self,
        entered: &[Nanoseconds],
        before: Nanoseconds,
        own: Nanoseconds,
    ) -> Option<Nanoseconds> {
        let [one, other] = self.due.map(|place| entered.get(place as usize));
        let first = *one?;
        Trigger::due(first, other.copied().unwrap_or(first), before, own)
    }
}

/// A side with nothing on it.
pub(super) const PLAIN: Side =
    Side { further: 0, group: 0, end: 0, due: [NONE; 2], more: 0, bands: 0 };

/// Sides while lanes are laid out: the first is the plain one, which most lanes share.
pub(super) struct Sides(pub(super) Vec<Side>);

impl Sides {
    pub(super) fn new() -> Self {
        Self(vec![PLAIN])
    }

    /// A new side; returns its place.
    pub(super) fn add(&mut self) -> u32 {
        self.0.push(PLAIN);
        self.0.len() as u32 - 1
    }
}
