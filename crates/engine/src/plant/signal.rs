//! One PLC variable, kept in little memory: a plant has tens of thousands, a monitor hardly ever
//! asks for more of them than their number.

use serde::{Deserialize, Serialize};

use super::SignalClass;

/// One PLC variable.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Written", into = "Written")]
pub struct Signal {
    symbol: Box<str>,
    name: Name,
    /// What most signals have nothing of.
    notes: Option<Box<Notes>>,
    device: u32,
    /// Input, output or memory.
    pub class: SignalClass,
    /// True for words; booleans have the states `_ON` and `_OFF`.
    pub word: bool,
}

/// The name of a signal inside its device: nearly always what its symbol ends with.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Name {
    EndOfSymbol { start: u32 },
    Own(Box<str>),
}

/// What a symbol table says besides.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Notes {
    address: Option<Box<str>>,
    description: Box<str>,
}

/// A signal as it is written down, and as it is made.
#[derive(Serialize, Deserialize)]
pub(super) struct Written {
    pub(super) symbol: String,
    pub(super) address: Option<String>,
    pub(super) name: String,
    pub(super) device: usize,
    pub(super) class: SignalClass,
    pub(super) word: bool,
    #[serde(default)]
    pub(super) description: String,
}

impl From<Written> for Signal {
    fn from(written: Written) -> Self {
        let name = match written.symbol.strip_suffix(&written.name) {
            Some(before) => Name::EndOfSymbol { start: before.len() as u32 },
            None => Name::Own(written.name.into()),
        };
        let notes = Notes {
            address: written.address.map(Into::into),
            description: written.description.into(),
        };
        Self {
            symbol: written.symbol.into(),
            name,
            notes: (notes != Notes::default()).then(|| Box::new(notes)),
            // A device that is not there either way.
            device: u32::try_from(written.device).unwrap_or(u32::MAX),
            class: written.class,
            word: written.word,
        }
    }
}

impl From<Signal> for Written {
    fn from(signal: Signal) -> Self {
        Self {
            symbol: signal.symbol.to_string(),
            address: signal.address().map(str::to_owned),
            name: signal.name().to_owned(),
            device: signal.device(),
            class: signal.class,
            word: signal.word,
            description: signal.description().to_owned(),
        }
    }
}

impl Signal {
    /// What the log calls it: an address or a full name.
    pub fn symbol(&self) -> &str {
        &self.symbol
    }

    /// Name inside its device.
    pub fn name(&self) -> &str {
        match &self.name {
            Name::EndOfSymbol { start } => &self.symbol[*start as usize..],
            Name::Own(name) => name,
        }
    }

    /// Index into [`super::Plant::devices`].
    pub fn device(&self) -> usize {
        self.device as usize
    }

    /// The same signal where its device has another number.
    pub(crate) fn moved_to(&self, device: usize) -> Self {
        Self { device: device as u32, ..self.clone() }
    }

    /// PLC address, where known.
    pub fn address(&self) -> Option<&str> {
        self.notes.as_ref()?.address.as_deref()
    }

    /// Free text from the symbol table.
    pub fn description(&self) -> &str {
        self.notes.as_ref().map_or("", |notes| &notes.description)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(symbol: &str, name: &str, address: Option<&str>) -> Written {
        Written {
            symbol: symbol.to_owned(),
            address: address.map(str::to_owned),
            name: name.to_owned(),
            device: 3,
            class: SignalClass::Input,
            word: true,
            description: String::new(),
        }
    }

    #[test]
    fn what_is_written_comes_back() {
        for (symbol, name, address) in [
            ("Group1-Gripper-Open", "Open", None),
            ("Öffner-Ä", "Ä", Some("I0.1")),
            ("%IX0.1", "Open", Some("%IX0.1")),
            ("Open", "", None),
        ] {
            let signal = Signal::from(written(symbol, name, address));
            assert_eq!((signal.symbol(), signal.name(), signal.address()), (symbol, name, address));
            assert_eq!((signal.device(), signal.description()), (3, ""));
            assert_eq!(Signal::from(Written::from(signal.clone())), signal);
        }
    }

    #[test]
    fn a_signal_is_less_than_a_cache_line() {
        assert!(size_of::<Signal>() <= 48);
    }
}
