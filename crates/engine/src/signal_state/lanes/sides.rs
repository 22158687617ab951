//! What only some lanes need, side by side.

use prefetch_index::prefetch_index;

use super::NONE;

/// What only some lanes need. Half a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
pub(super) struct Side {
    /// The next lane of the same chain into the same state.
    pub(super) further: u32,
    /// From the first lane of a state: the first lane of the group's chain.
    pub(super) group: u32,
    /// Where it is kept when the state was entered.
    pub(super) slot: u32,
    /// Where that of the enabling states is kept.
    pub(super) due: [u32; 2],
    /// Place of its further bands, and how many those are.
    pub(super) more: u32,
    pub(super) bands: u32,
}

/// A side with nothing on it.
pub(super) const PLAIN: Side =
    Side { further: NONE, group: NONE, slot: NONE, due: [NONE; 2], more: 0, bands: 0 };

/// The sides of all lanes that have one.
#[derive(Debug, Default)]
pub(super) struct Sides {
    /// By lane: the place of its side, or [`NONE`]. Counting bits would spare it, but takes longer
    /// than all else that an event needs: not every processor we are built for counts them itself.
    places: Vec<u32>,
    sides: Vec<Side>,
}

impl Sides {
    /// By lane; there are no sides from the last given on.
    pub(super) fn of(by_lane: &[Option<Side>]) -> Self {
        let sides: Vec<Side> = by_lane.iter().flatten().copied().collect();
        let mut places = 0..;
        let place = |side: &Option<Side>| side.and_then(|_| places.next()).unwrap_or(NONE);
        Self { places: by_lane.iter().map(place).collect(), sides }
    }

    /// The side of a lane.
    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> Option<&Side> {
        self.sides.get(*self.places.get(lane)? as usize)
    }

    /// Fetches the side of a lane; the last, where it has none: that is at hand anyway, and who
    /// has one cannot be guessed.
    #[inline(always)]
    pub(super) fn fetch(&self, lane: usize) {
        if let Some(&place) = self.places.get(lane) {
            prefetch_index(&self.sides, (place as usize).min(self.sides.len()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_side_is_found_by_its_lane() {
        let by_lane: Vec<Option<Side>> = (0..200u32)
            .map(|lane| (lane % 63 == 0).then_some(Side { slot: lane, ..PLAIN }))
            .collect();
        let sides = Sides::of(&by_lane);
        for (lane, side) in by_lane.iter().enumerate() {
            assert_eq!(sides.get(lane).map(|s| s.slot), side.map(|s| s.slot));
        }
        assert!(sides.get(200).is_none());
    }
}
