//! Finds a plant's signals by symbol: numbers only, the symbols stay in the plant.

use std::hash::BuildHasher;

use hashbrown::{DefaultHashBuilder, HashTable};

use crate::log::SignalIndex;
use crate::plant::Plant;

/// Signals by the hash of their symbol.
#[derive(Debug, Clone, Default)]
pub struct SymbolIndex {
    table: HashTable<SignalIndex>,
    hasher: DefaultHashBuilder,
}

impl SymbolIndex {
    /// Indexes a plant.
    pub fn of(plant: &Plant) -> Self {
        let hasher = DefaultHashBuilder::default();
        let hash = |&index: &SignalIndex| hasher.hash_one(plant.signals[index as usize].symbol());
        let mut table = HashTable::with_capacity(plant.signals.len());
        for index in 0..plant.signals.len() as SignalIndex {
            table.insert_unique(hash(&index), index, hash);
        }
        Self { table, hasher }
    }

    /// The signal of a symbol, in the plant that was indexed.
    pub fn find(&self, plant: &Plant, symbol: &str) -> Option<SignalIndex> {
        let is_it = |&index: &SignalIndex| plant.signals[index as usize].symbol() == symbol;
        self.table.find(self.hasher.hash_one(symbol), is_it).copied()
    }

    /// The signals of many symbols. Logs mostly name signals in the plant's own order: what
    /// follows a signal there is tried first.
    pub fn find_all<'s>(
        &self,
        plant: &Plant,
        symbols: impl IntoIterator<Item = &'s str>,
    ) -> Vec<Option<SignalIndex>> {
        let mut next = 0;
        let mut find = |symbol: &str| {
            let found = match plant.signals.get(next as usize) {
                Some(signal) if signal.symbol() == symbol => Some(next),
                _ => self.find(plant, symbol),
            };
            next = found.map_or(next, |found| found + 1);
            found
        };
        symbols.into_iter().map(&mut find).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::SymbolIndex;
    use crate::naming::NamingRule;
    use crate::plant::Plant;
    use crate::symbols::SymbolTable;

    #[test]
    fn signals_are_found_in_any_order() {
        let symbols = ["G-D-A", "G-D-B", "G-E-C"].map(str::to_owned);
        let plant = Plant::arrange(&symbols, &SymbolTable::default(), &NamingRule::default());
        let index = SymbolIndex::of(&plant);
        let asked = ["G-E-C", "G-D-A", "G-D-B", "G-D-X", "G-E-C"];
        let found = index.find_all(&plant, asked);
        assert_eq!(found, [Some(2), Some(0), Some(1), None, Some(2)]);
        assert_eq!(asked.map(|symbol| index.find(&plant, symbol)).to_vec(), found);
    }
}
