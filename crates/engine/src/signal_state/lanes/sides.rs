//! What only some lanes need, side by side; found by counting, not by a table as long as the lanes.

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

/// 64 lanes: which have a side, and how many sides there are before them.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    has: u64,
    before: u32,
}

/// The sides of all lanes that have one.
#[derive(Debug, Default)]
pub(super) struct Sides {
    blocks: Vec<Block>,
    sides: Vec<Side>,
}

impl Sides {
    /// By lane.
    pub(super) fn of(by_lane: &[Option<Side>]) -> Self {
        let sides: Vec<Side> = by_lane.iter().flatten().copied().collect();
        let mut before = 0;
        let blocks = by_lane.chunks(64).map(|chunk| {
            let has =
                (0..).zip(chunk).fold(0, |has, (bit, side)| has | u64::from(side.is_some()) << bit);
            let block = Block { has, before };
            before += has.count_ones();
            block
        });
        Self { blocks: blocks.collect(), sides }
    }

    /// The side of a lane.
    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> Option<&Side> {
        let block = self.blocks.get(lane / 64)?;
        let bit = 1 << (lane % 64);
        if block.has & bit == 0 {
            return None;
        }
        self.sides.get(block.place(bit))
    }

    /// Fetches the side of a lane, or its neighbour's.
    #[inline(always)]
    pub(super) fn fetch(&self, lane: usize) {
        if let Some(block) = self.blocks.get(lane / 64) {
            prefetch_index(&self.sides, block.place(1 << (lane % 64)));
        }
    }
}

impl Block {
    #[inline(always)]
    fn place(&self, bit: u64) -> usize {
        (self.before + (self.has & (bit - 1)).count_ones()) as usize
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
