//! The plant: signals, the devices they operate, and the groups devices work in.
//!
//! Ghosh 2016, section 2.1: a symbol name is the signal's name extended by its device and group
//! (`Group2-Device1-Signal2`). A symbol table or another [`NamingRule`] says so for plants that
//! name differently; what fits neither is grouped by [name stem](crate::stem).

mod signal;

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use crate::log::SignalIndex;
use crate::naming::NamingRule;
use crate::stem;
use crate::symbols::SymbolTable;

pub use signal::Signal;
use signal::Written;

/// The group of signals whose names tell none.
pub const PLANT_GROUP: &str = "plant";

/// Where a signal lies in the PLC (IEC 61131-3, 6.5.5).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SignalClass {
    /// `%I`: the PLC reads it.
    Input,
    /// `%M`, or not known.
    Memory,
    /// `%Q`: the PLC writes it.
    Output,
}

impl SignalClass {
    /// Reads a class as users write it: `input`, `%I`, `I`, `E`, `output`, `%Q`, `Q`, `A`, …
    pub fn parse(text: &str) -> Option<Self> {
        match text.trim().trim_start_matches('%').to_ascii_lowercase().as_str() {
            "i" | "e" | "in" | "input" | "sensor" | "sensor input" => Some(Self::Input),
            "q" | "a" | "o" | "out" | "output" => Some(Self::Output),
            "m" | "memory" | "mem" | "" => Some(Self::Memory),
            _ => None,
        }
    }

    /// Guesses from an address or a prefixed name: `%IX0.1`, `I5.0`, `E5.0`, `I_Pump_Up`.
    pub fn guess(name: &str) -> Self {
        let bytes = name.as_bytes();
        let (first, second) = (bytes.first().copied(), bytes.get(1).copied());
        let marker = if first == Some(b'%') { second } else { first };
        let after = if first == Some(b'%') { bytes.get(2).copied() } else { second };
        let is_marker =
            first == Some(b'%') || after.is_some_and(|b| b == b'_' || b.is_ascii_digit());
        match (is_marker, marker) {
            (true, Some(b'I' | b'i' | b'E')) => Self::Input,
            (true, Some(b'Q' | b'q' | b'A' | b'O' | b'o')) => Self::Output,
            _ => Self::Memory,
        }
    }
}

/// Signals that operate one piece of equipment.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Device {
    /// Name inside its group.
    pub name: String,
    /// Index into [`Plant::groups`].
    pub group: usize,
    /// The signal that stands for the device in its group's model: the first of it seen while
    /// learning, unless the user chose another. `None` while none has been seen.
    pub starting: Option<SignalIndex>,
}

/// Devices that work together.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Group {
    /// Name in the plant.
    pub name: String,
}

/// All signals, devices and groups.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plant {
    /// By [`SignalIndex`].
    pub signals: Vec<Signal>,
    /// Every signal belongs to one of them.
    pub devices: Vec<Device>,
    /// Every device belongs to one of them.
    pub groups: Vec<Group>,
    /// Symbols that neither the table nor the naming rule placed.
    pub unplaced: Vec<String>,
}

impl Plant {
    /// Places every symbol of a log in a device and a group: by the symbol table, else by the
    /// naming rule, else by name stem in the group [`PLANT_GROUP`].
    pub fn arrange(symbols: &[String], table: &SymbolTable, rule: &NamingRule) -> Self {
        let mut plant = Self::default();
        let mut places = Places::default();
        let stems = stem::devices_by_stem(
            symbols.iter().filter(|s| table.find(s).is_none() && rule.split(s).is_none()),
        );
        for symbol in symbols {
            let entry = table.find(symbol);
            let split = rule
                .split(symbol)
                .or_else(|| entry.and_then(|e| e.full_name()).and_then(|name| rule.split(&name)));
            let guessed = SignalClass::guess(symbol);
            let (group, device, name) = match (entry, split) {
                (Some(entry), split) if entry.device.is_some() || split.is_none() => (
                    entry.group.clone().unwrap_or_else(|| PLANT_GROUP.to_owned()),
                    entry.device.clone().unwrap_or_else(|| PLANT_GROUP.to_owned()),
                    entry.signal.clone().unwrap_or_else(|| symbol.clone()),
                ),
                (_, Some(split)) => (split.group, split.device, split.signal),
                (_, None) => {
                    plant.unplaced.push(symbol.clone());
                    let device = stems.get(symbol).cloned().unwrap_or_else(|| symbol.clone());
                    (PLANT_GROUP.to_owned(), device, symbol.clone())
                }
            };
            let device = places.device(&mut plant, &group, &device);
            let signal = Written {
                symbol: symbol.clone(),
                address: entry.map(|e| e.address.clone()).or_else(|| address_of(symbol)),
                name,
                device,
                class: entry.and_then(|e| e.class).unwrap_or(guessed),
                word: entry.is_some_and(|e| e.word),
                description: entry.map(|e| e.description.clone()).unwrap_or_default(),
            };
            plant.signals.push(signal.into());
        }
        plant
    }

    /// The device of a signal.
    pub fn device_of(&self, signal: SignalIndex) -> &Device {
        &self.devices[self.signals[signal as usize].device()]
    }

    /// The group of a device, by index.
    pub fn group_of(&self, device: usize) -> &Group {
        &self.groups[self.devices[device].group]
    }

    /// `Group1-Device2-Signal2`.
    pub fn full_name(&self, signal: SignalIndex) -> String {
        self.name_parts(signal).concat()
    }

    /// What a full name is made of.
    pub fn name_parts(&self, signal: SignalIndex) -> [&str; 5] {
        let signal = &self.signals[signal as usize];
        let device = &self.devices[signal.device()];
        [&self.groups[device.group].name, "-", &device.name, "-", signal.name()]
    }

    /// `Group1-Device2`.
    pub fn device_name(&self, device: usize) -> String {
        format!("{}-{}", self.group_of(device).name, self.devices[device].name)
    }

    /// Looks a device up by `Group-Device`.
    pub fn find_device(&self, group: &str, device: &str) -> Option<usize> {
        self.devices.iter().position(|d| d.name == device && self.groups[d.group].name == group)
    }

    /// Looks a group up by name.
    pub fn find_group(&self, group: &str) -> Option<usize> {
        self.groups.iter().position(|g| g.name == group)
    }
}

/// Finds or makes devices and groups by name while a plant is arranged.
#[derive(Default)]
struct Places {
    groups: HashMap<String, usize>,
    devices: HashMap<(usize, String), usize>,
}

impl Places {
    fn device(&mut self, plant: &mut Plant, group: &str, device: &str) -> usize {
        let group = *self.groups.entry(group.to_owned()).or_insert_with(|| {
            plant.groups.push(Group { name: group.to_owned() });
            plant.groups.len() - 1
        });
        *self.devices.entry((group, device.to_owned())).or_insert_with(|| {
            plant.devices.push(Device { name: device.to_owned(), group, starting: None });
            plant.devices.len() - 1
        })
    }
}

/// A symbol that is itself an address: `%IX0.1`, `%MW33`, `I5.0`, `DB1.DBX0.0`, `40001`.
fn address_of(symbol: &str) -> Option<String> {
    let bare = symbol.strip_prefix('%').unwrap_or(symbol);
    let has_digit = bare.bytes().any(|b| b.is_ascii_digit());
    let address_shaped = bare.len() <= 16
        && bare.bytes().all(|b| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'.')
        && bare.bytes().take_while(u8::is_ascii_uppercase).count() <= 3;
    (symbol.starts_with('%') || (has_digit && address_shaped)).then(|| symbol.to_owned())
}
