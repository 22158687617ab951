//! Signal names, interned by their bytes.

use std::hash::BuildHasher;

use hashbrown::{DefaultHashBuilder, HashTable};
use runglight_engine::log::SignalIndex;

/// Gives each name a dense number, without making a `String` for a name it knows.
#[derive(Debug, Default)]
pub(crate) struct SignalNames {
    names: Vec<String>,
    raw: Raw,
    table: HashTable<SignalIndex>,
    hasher: DefaultHashBuilder,
    /// True once a name was no UTF-8 and was read as Latin-1.
    pub(crate) latin_1: bool,
}

/// The bytes each name was found as, side by side; they differ from the name in Latin-1 files.
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
    fn get(&self, index: SignalIndex) -> &[u8] {
        let index = index as usize;
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.bytes[start..self.ends[index]]
    }
}

impl SignalNames {
    /// The number of a name, new or known.
    #[inline]
    pub(crate) fn intern(&mut self, name: &[u8]) -> SignalIndex {
        let hash = self.hasher.hash_one(name);
        if let Some(&known) = self.table.find(hash, |&index| self.raw.get(index) == name) {
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
        self.table.insert_unique(hash, index, |&index| hasher.hash_one(raw.get(index)));
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
