//! Regions: bits watched as one word (section 3.3: "parts of the equipment that perform distinct
//! tasks and cycle at different times").

use std::collections::{BTreeMap, HashMap};

use serde::{Deserialize, Serialize};

use crate::plant::Plant;

use super::address::Place;
use super::learn::CycleError;
use super::parameters::{ModeSpec, RegionSpec, RegionSpecs};

/// A word of a region's bits, the first slot highest.
pub type Word = u128;

/// Most bits of a region.
pub const BITS_AT_MOST: usize = 128;

/// One bit that the cycle machine reads.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Bit {
    /// What the log calls it.
    pub symbol: String,
    /// PLC address, where known.
    pub address: Option<String>,
    /// `Group-Device-Signal`.
    pub name: String,
    /// Its group.
    pub group: String,
    /// Its device.
    pub device: String,
    /// Free text from the symbol table.
    #[serde(default)]
    pub description: String,
}

impl Bit {
    /// What the signal is called inside its device.
    pub fn short_name(&self) -> &str {
        let prefix = self.group.len() + self.device.len() + 2;
        self.name.get(prefix..).filter(|short| !short.is_empty()).unwrap_or(&self.name)
    }
}

/// Bits watched as one word.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Region {
    /// As the user calls it.
    pub name: String,
    /// Indices of bits, the highest of the word first; `None` is a bit of the range that no log
    /// has, and counts as equal.
    pub slots: Vec<Option<usize>>,
}

impl Region {
    /// Bits of the word.
    pub fn width(&self) -> usize {
        self.slots.len()
    }

    /// The word's hexadecimal text, as long as its width says.
    pub fn hex(&self, word: Word) -> String {
        let digits = self.width().div_ceil(4).max(1);
        format!("{word:0digits$x}")
    }

    /// Mask of the bit in a slot.
    pub fn mask(&self, slot: usize) -> Word {
        1 << (self.width() - 1 - slot)
    }

    /// The bits set in a mask, highest first.
    pub fn bits_of(&self, mask: Word) -> impl Iterator<Item = usize> + '_ {
        (0..self.width())
            .filter(move |&slot| mask & self.mask(slot) != 0)
            .filter_map(|slot| self.slots[slot])
    }
}

/// A bit that says something, and the value it says it with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModeBit {
    /// Index of the bit.
    pub bit: usize,
    /// The value that means yes.
    pub active: bool,
}

/// Which bits say what the machine is about.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Modes {
    /// The machine does its work.
    pub work_complete: ModeBit,
    /// Moved by hand.
    pub manual: Vec<ModeBit>,
    /// Stopped with an alarm.
    pub alarm: Vec<ModeBit>,
    /// Set up.
    pub setup: Option<ModeBit>,
}

impl Modes {
    /// All mode bits.
    pub fn all(&self) -> impl Iterator<Item = &ModeBit> {
        std::iter::once(&self.work_complete)
            .chain(&self.setup)
            .chain(&self.manual)
            .chain(&self.alarm)
    }
}

/// Bits of a plant, found by address or any of their names.
pub struct Directory {
    bits: Vec<Bit>,
    places: Vec<Option<Place>>,
    by_name: HashMap<String, usize>,
    by_place: BTreeMap<Place, usize>,
}

impl Directory {
    /// All boolean signals of a plant.
    pub fn of(plant: &Plant) -> Self {
        let mut directory = Self {
            bits: Vec::new(),
            places: Vec::new(),
            by_name: HashMap::new(),
            by_place: BTreeMap::new(),
        };
        for (index, signal) in (0..).zip(&plant.signals) {
            let number = directory.bits.len();
            let device = &plant.devices[signal.device()];
            let bit = Bit {
                symbol: signal.symbol().to_owned(),
                address: signal.address().map(str::to_owned),
                name: plant.full_name(index),
                group: plant.groups[device.group].name.clone(),
                device: device.name.clone(),
                description: signal.description().to_owned(),
            };
            let place = signal.address().or(Some(signal.symbol())).and_then(Place::parse);
            for name in [Some(&bit.symbol), bit.address.as_ref(), Some(&bit.name)] {
                directory.by_name.extend(name.map(|name| (name.to_ascii_lowercase(), number)));
            }
            if let Some(place) = &place {
                directory.by_place.entry(place.clone()).or_insert(number);
            }
            directory.places.push(place);
            directory.bits.push(bit);
        }
        directory
    }

    /// The bits, by index.
    pub fn bits(&self) -> &[Bit] {
        &self.bits
    }

    /// Where a bit lies.
    pub fn place(&self, bit: usize) -> Option<&Place> {
        self.places[bit].as_ref()
    }

    fn find(&self, text: &str) -> Option<usize> {
        self.by_name
            .get(&text.trim().to_ascii_lowercase())
            .or_else(|| self.by_place.get(&Place::parse(text)?))
            .copied()
    }

    fn required(&self, text: &str, wanted_by: &str) -> Result<usize, CycleError> {
        self.find(text).ok_or_else(|| CycleError::UnknownBit {
            bit: text.trim().to_owned(),
            wanted_by: wanted_by.to_owned(),
        })
    }

    /// The mode bits a user names.
    ///
    /// # Errors
    /// A bit the log does not have, or no work-complete bit.
    pub fn modes(&self, spec: &ModeSpec) -> Result<Modes, CycleError> {
        if spec.work_complete.trim().is_empty() {
            return Err(CycleError::NoWorkComplete);
        }
        let one = |text: &str, key: &str| {
            let (name, active) = match text.rsplit_once('=') {
                Some((name, "0")) => (name, false),
                Some((name, "1")) => (name, true),
                _ => (text, true),
            };
            Ok(ModeBit { bit: self.required(name, &format!("[modes] {key}"))?, active })
        };
        let all = |texts: &[String], key: &str| -> Result<Vec<ModeBit>, CycleError> {
            texts.iter().map(|text| one(text, key)).collect()
        };
        Ok(Modes {
            work_complete: one(&spec.work_complete, "work_complete")?,
            manual: all(&spec.manual, "manual")?,
            alarm: all(&spec.alarm, "alarm")?,
            setup: spec.setup.as_deref().map(|text| one(text, "setup")).transpose()?,
        })
    }

    /// The regions a user names.
    ///
    /// # Errors
    /// A bit the log does not have, a range without bits, a region too wide for one word.
    pub fn regions(&self, specs: &RegionSpecs) -> Result<Vec<Region>, CycleError> {
        let mut regions = Vec::new();
        for (name, spec) in specs {
            let wanted_by = format!("[regions] {name}");
            match spec {
                RegionSpec::List(bits) => {
                    let slots = bits
                        .iter()
                        .map(|bit| self.required(bit, &wanted_by).map(Some))
                        .collect::<Result<_, _>>()?;
                    regions.push(Region { name: name.clone(), slots });
                }
                RegionSpec::Text(text) => regions.extend(self.range(name, text, &wanted_by)?),
            }
        }
        for region in &regions {
            if region.slots.is_empty() || region.width() > BITS_AT_MOST {
                return Err(CycleError::Width {
                    region: region.name.clone(),
                    bits: region.width(),
                });
            }
        }
        Ok(regions)
    }

    /// `I0.0-I7.7`, `I8-I20 by byte`, `I21`.
    fn range(&self, name: &str, text: &str, wanted_by: &str) -> Result<Vec<Region>, CycleError> {
        let (range, by_byte) = match text.trim().strip_suffix("by byte") {
            Some(range) => (range.trim(), true),
            None => (text.trim(), false),
        };
        if !by_byte && let Some(bit) = self.find(range) {
            return Ok(vec![Region { name: name.to_owned(), slots: vec![Some(bit)] }]);
        }
        let bad = || CycleError::Range { range: text.to_owned(), wanted_by: wanted_by.to_owned() };
        let (from, to) = match range.split_once('-') {
            Some((from, to)) => (Place::parse(from), Place::parse(to)),
            None => (Place::parse(range), Place::parse(range)),
        };
        let (from, to) = from.zip(to).ok_or_else(bad)?;
        if from.area != to.area {
            return Err(bad());
        }
        let places = self.places_between(&from, &to);
        if !places.iter().any(|place| self.by_place.contains_key(place)) {
            return Err(bad());
        }
        let slots = |places: &[Place]| -> Vec<Option<usize>> {
            places.iter().map(|place| self.by_place.get(place).copied()).collect()
        };
        if !by_byte {
            return Ok(vec![Region { name: name.to_owned(), slots: slots(&places) }]);
        }
        Ok(places
            .chunk_by(|a, b| a.number == b.number)
            .filter(|byte| byte.iter().any(|place| self.by_place.contains_key(place)))
            .map(|byte| Region {
                name: format!("{name}-{}{}", from.area, byte[0].number),
                slots: slots(byte),
            })
            .collect())
    }

    /// Every bit from one place to another, in word order.
    fn places_between(&self, from: &Place, to: &Place) -> Vec<Place> {
        let of_bytes = self.by_place.keys().any(|p| p.area == from.area && p.bit.is_some());
        let at = |number, bit| Place { area: from.area.clone(), number, bit };
        // Wider than any region, so that the width is what is complained of.
        let last = to.number.min(from.number.saturating_add(4 * BITS_AT_MOST as u32));
        let mut places = Vec::new();
        for number in from.number..=last {
            if !of_bytes {
                places.push(at(number, None));
                continue;
            }
            let low = if number == from.number { from.bit.unwrap_or(0) } else { 0 };
            let high = if number == to.number { to.bit.unwrap_or(7) } else { 7 };
            places.extend((low..=high).map(|bit| at(number, Some(bit))));
        }
        places.sort_by_key(Place::word_order);
        places
    }
}
