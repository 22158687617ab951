//! The reset activity: the change that opens a new run of the machine (Theis 2019, section V-B).

use thiserror::Error;

use crate::log::SignalIndex;
use crate::plant::{Plant, SignalClass};

/// Why a text is no reset activity of a log.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ResetError {
    /// It is not written as one.
    #[error("reset '{found}' must be SIGNAL=VALUE, like %IX0.1=0 (several joined by &)")]
    Form {
        /// The text given.
        found: String,
    },
    /// No signal has this name.
    #[error("reset: the log has no signal '{name}'; it has {known}")]
    Signal {
        /// The name given.
        name: String,
        /// Names there are, the first of them.
        known: String,
    },
    /// Two parts that never become one activity.
    #[error(
        "reset: {first} and {second} are of different classes, which are never one activity; give one of them"
    )]
    Classes {
        /// One signal.
        first: String,
        /// The other one.
        second: String,
    },
    /// The change never happens.
    #[error("reset: the log has no change to {reset}, so there is no run in it{taken}")]
    Never {
        /// The reset asked for.
        reset: String,
        /// What the signal does instead.
        taken: String,
    },
}

/// The change, or changes at one time, that open a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reset {
    /// Signal and the value it changes to.
    pub changes: Vec<(SignalIndex, i64)>,
}

impl Reset {
    /// Reads `%IX0.1=0`, or several joined by `&`; signals by the log's name or by address.
    ///
    /// # Errors
    /// Another form, a signal that is not there, or signals of two classes.
    pub fn parse(text: &str, plant: &Plant) -> Result<Self, ResetError> {
        let written =
            parse_changes(text).ok_or_else(|| ResetError::Form { found: text.to_owned() })?;
        let mut changes = Vec::with_capacity(written.len());
        for (name, value) in &written {
            changes.push((find(name, plant)?, *value));
        }
        let class = |change: &(SignalIndex, i64)| plant.signals[change.0 as usize].class;
        if let Some(other) = changes.iter().position(|change| class(change) != class(&changes[0])) {
            let (first, second) = (written[0].0.clone(), written[other].0.clone());
            return Err(ResetError::Classes { first, second });
        }
        Ok(Self { changes })
    }
}

/// The changes an activity's name tells: `%IX0.1=0 & %IX0.2=1`. None for names of another form.
pub fn parse_changes(name: &str) -> Option<Vec<(String, i64)>> {
    name.split('&')
        .map(|part| {
            let (signal, value) = part.rsplit_once('=')?;
            let signal = signal.trim();
            let value = match value.trim().to_ascii_lowercase().as_str() {
                "true" | "on" => 1,
                "false" | "off" => 0,
                number => number.parse().ok()?,
            };
            (!signal.is_empty()).then(|| (signal.to_owned(), value))
        })
        .collect()
}

/// γ of an activity, from the signals its name tells; ⊥ where they tell nothing.
pub fn class_of_name(name: &str) -> Option<SignalClass> {
    let changes = parse_changes(name)?;
    let class = SignalClass::guess(&changes.first()?.0);
    (class != SignalClass::Memory
        && changes.iter().all(|(signal, _)| SignalClass::guess(signal) == class))
    .then_some(class)
}

fn find(name: &str, plant: &Plant) -> Result<SignalIndex, ResetError> {
    let by_symbol = plant.signals.iter().position(|signal| signal.symbol() == name);
    let by_address = || plant.signals.iter().position(|s| s.address() == Some(name));
    let by_full_name =
        || (0..plant.signals.len()).find(|&s| plant.full_name(s as SignalIndex) == name);
    let found = by_symbol.or_else(by_address).or_else(by_full_name);
    found.map(|index| index as SignalIndex).ok_or_else(|| {
        const SHOWN: usize = 8;
        let mut known: Vec<&str> =
            plant.signals.iter().take(SHOWN).map(|signal| signal.symbol()).collect();
        if plant.signals.len() > SHOWN {
            known.push("…");
        }
        ResetError::Signal { name: name.to_owned(), known: known.join(", ") }
    })
}

#[cfg(test)]
mod tests {
    use super::{Reset, ResetError, class_of_name, parse_changes};
    use crate::naming::NamingRule;
    use crate::plant::{Plant, SignalClass};
    use crate::symbols::SymbolTable;

    fn plant() -> Plant {
        let symbols = ["%IX0.0", "%IX0.1", "%QX0.0"].map(str::to_owned);
        Plant::arrange(&symbols, &SymbolTable::default(), &NamingRule::default())
    }

    #[test]
    fn one_change_or_several() {
        assert_eq!(Reset::parse("%IX0.1=0", &plant()).map(|r| r.changes), Ok(vec![(1, 0)]));
        let both = Reset::parse(" %IX0.0 = TRUE & %IX0.1=off", &plant());
        assert_eq!(both.map(|r| r.changes), Ok(vec![(0, 1), (1, 0)]));
    }

    #[test]
    fn what_is_no_reset_is_said() {
        for text in ["", "%IX0.1", "%IX0.1=x", "=1"] {
            assert!(matches!(Reset::parse(text, &plant()), Err(ResetError::Form { .. })), "{text}");
        }
        let unknown = Reset::parse("%IX9.9=0", &plant()).map_err(|e| e.to_string());
        assert!(unknown.is_err_and(|text| text.contains("it has %IX0.0, %IX0.1, %QX0.0")));
        let mixed = Reset::parse("%IX0.1=0&%QX0.0=1", &plant());
        assert!(matches!(mixed, Err(ResetError::Classes { .. })));
    }

    #[test]
    fn names_tell_changes_and_class() {
        let changes = parse_changes("%QX0.0=0 & %QX0.1=1");
        assert_eq!(changes, Some(vec![("%QX0.0".to_owned(), 0), ("%QX0.1".to_owned(), 1)]));
        assert_eq!(class_of_name("%QX0.0=0 & %QX0.1=1"), Some(SignalClass::Output));
        assert_eq!(class_of_name("%QX0.0=0 & %IX0.1=1"), None);
        assert_eq!(class_of_name("register claim"), None);
    }
}
