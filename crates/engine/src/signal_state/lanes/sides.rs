//! What only some lanes need.

use super::NONE;

/// What only some lanes need. Half a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
pub(super) struct Side {
    /// The next lane of the same chain into the same state.
    pub(super) further: u32,
    /// From the first lane of a state: the first lane of the group's chain.
    pub(super) group: u32,
    /// Places of the sides of the enabling states.
    pub(super) due: [u32; 2],
    /// Place of its further bands, and how many those are.
    pub(super) more: u32,
    pub(super) bands: u32,
}

/// A side with nothing on it.
pub(super) const PLAIN: Side =
    Side { further: NONE, group: NONE, due: [NONE; 2], more: 0, bands: 0 };

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
