//! Signal names, interned by their bytes.

use std::hash::BuildHasher;

use hashbrown::{DefaultHashBuilder, HashTable};
use runglight_engine::log::SignalIndex;

/// Gives each name a dense number, without making a `String` for a name it knows.
#[derive(Debug, Default)]
pub(crate) struct SignalNames {
    names: Vec<String>,
    /// What each was found as: in Latin-1 files that differs from the name.
    raw: Raw,
    table: HashTable<SignalIndex>,
    hasher: DefaultHashBuilder,
    /// True once a name was no UTF-8 and was read as Latin-1.
    pub(crate) latin_1: bool,
}

/// Bytes of names, side by side.
#[derive(Debug, Default)]
struct Raw {
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

impl Raw {
    fn push(&mut self, name: &[u8]) {
        self.bytes.extend_from_slice(name);
        self.ends.push(self.bytes.len());
    }

    #[inline]
    fn get(&self, index: usize) -> &[u8] {
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.bytes[start..self.ends[index]]
    }

    fn iter(&self) -> impl Iterator<Item = &[u8]> {
        (0..self.ends.len()).map(|index| self.get(index))
    }

    fn clear(&mut self) {
        self.bytes.clear();
        self.ends.clear();
    }
}

/// Names that wait to be numbered together.
#[derive(Debug, Default)]
pub(crate) struct NameQueue {
    names: Raw,
    hashes: Vec<u64>,
}

impl NameQueue {
    const LENGTH: usize = 64;

    /// Takes a name; true where enough of them wait.
    #[inline]
    pub(crate) fn push(&mut self, name: &[u8]) -> bool {
        self.names.push(name);
        self.names.ends.len() >= Self::LENGTH
    }
}

impl SignalNames {
    /// The number of a name, new or known.
    #[inline]
    pub(crate) fn intern(&mut self, name: &[u8]) -> SignalIndex {
        let hash = self.hasher.hash_one(name);
        self.intern_hashed(name, hash)
    }

    /// Numbers many names at once. Nothing of one waits for another, so the processor fetches what
    /// it needs for the next while it compares the last: a plant's names fill more than its cache.
    pub(crate) fn intern_all(&mut self, queue: &mut NameQueue, numbers: &mut Vec<SignalIndex>) {
        let NameQueue { names, hashes } = queue;
        hashes.clear();
        hashes.extend(names.iter().map(|name| self.hasher.hash_one(name)));
        numbers
            .extend(names.iter().zip(hashes).map(|(name, hash)| self.intern_hashed(name, *hash)));
        names.clear();
    }

    #[inline]
    fn intern_hashed(&mut self, name: &[u8], hash: u64) -> SignalIndex {
        if let Some(&known) = self.table.find(hash, |&index| self.raw.get(index as usize) == name) {
            return known;
        }
        self.add(name, hash)
    }

    #[cold]
    fn add(&mut self, name: &[u8], hash: u64) -> SignalIndex {
        let index = self.names.len() as SignalIndex;
        self.names.push(match std::str::from_utf8(name) {
            Ok(text) => text.to_owned(),
            Err(_) => {
                self.latin_1 = true;
                decode_latin_1(name)
            }
        });
        self.raw.push(name);
        let (raw, hasher) = (&self.raw, &self.hasher);
        self.table.insert_unique(hash, index, |&index| hasher.hash_one(raw.get(index as usize)));
        index
    }

    pub(crate) fn into_names(self) -> Vec<String> {
        self.names
    }
}

/// Text in UTF-8, or else in the Latin-1 that Windows writes.
pub(crate) fn decode(bytes: &[u8]) -> String {
    std::str::from_utf8(bytes).map_or_else(|_| decode_latin_1(bytes), str::to_owned)
}

fn decode_latin_1(bytes: &[u8]) -> String {
    encoding_rs::WINDOWS_1252.decode_without_bom_handling(bytes).0.into_owned()
}
