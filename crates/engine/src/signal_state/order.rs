//! Events of one scan have no order: they are sorted canonically, inputs before outputs (the PLC
//! reads, then writes), then by signal; rows of one signal keep theirs.

use crate::log::{Nanoseconds, SignalIndex};
use crate::plant::{Plant, SignalClass};

use super::events::Row;

/// Rank of every signal inside a scan.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ScanOrder {
    rank: Vec<u32>,
}

impl ScanOrder {
    /// Inputs, then memory, then outputs; inside a class in the plant's order.
    pub fn of(plant: &Plant) -> Self {
        let mut by_class: Vec<(SignalClass, u32)> =
            plant.signals.iter().zip(0..).map(|(signal, index)| (signal.class, index)).collect();
        by_class.sort_unstable();
        let mut rank = vec![0; by_class.len()];
        for (position, (_, index)) in (0..).zip(by_class) {
            rank[index as usize] = position;
        }
        Self { rank }
    }

    /// By signal: its rank.
    pub fn into_ranks(self) -> Vec<u32> {
        self.rank
    }

    /// True where of two rows in time order, each a time and a signal, the second comes first.
    #[inline]
    pub fn swaps(
        &self,
        (first, one): (Nanoseconds, SignalIndex),
        (second, other): (Nanoseconds, SignalIndex),
    ) -> bool {
        first == second && self.rank[other as usize] < self.rank[one as usize]
    }

    /// Sorts rows of equal time; `rows` is in time order already.
    pub fn sort(&self, rows: &mut [Row]) {
        if rows.len() > 1 {
            rows.sort_by_key(|row| (row.time, self.rank[row.signal as usize]));
        }
    }
}
