//! What a user may set: `[modes]`, `[regions]` and `[cycle]` of `runglight.toml`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::learn::CycleError;

/// How words are compared.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Comparison {
    /// The whole word, as the paper does.
    Word,
    /// The element that changed.
    #[default]
    Element,
}

/// Bits of a region as the user writes them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum RegionSpec {
    /// `I0.0-I7.7`, `I8-I20 by byte`, `I21`.
    Text(String),
    /// Bits by address or name; the first is the highest of the word.
    List(Vec<String>),
}

/// All regions as the user writes them; none means: propose some.
pub type RegionSpecs = BTreeMap<String, RegionSpec>;

/// `[modes]`: which bits say what the machine is about. `M10.3=0` is a bit that says it when OFF.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ModeSpec {
    /// ON while the machine does its work; OFF while it is set up.
    pub work_complete: String,
    /// ON while an operator moves the machine by hand.
    pub manual: Vec<String>,
    /// ON while the machine has stopped with an alarm.
    pub alarm: Vec<String>,
    /// ON during set-up, where that is not simply the rest of the time.
    pub setup: Option<String>,
}

/// `[cycle]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CycleParameters {
    /// `word` or `element`.
    pub mode: Comparison,
    /// An alarm within this time makes a finding of class 3 one of class 1.
    pub alarm_within_s: f64,
    /// A sequence that takes this many times the longest learned never ends.
    pub never_ends_factor: f64,
    /// Sequences looked back on for a rising rate of class 3 and 4.
    pub rate_window: u32,
    /// Chance that a rate called rising is not, for all addresses and all time together.
    pub rate_significance: f64,
    /// A stop with the alarm bit ON that learning saw so often is no failure; 0: every one is.
    pub known_stops: u32,
    /// Most bits of a proposed region.
    pub auto_bits: usize,
    /// Bits that change within this time switch together.
    pub together_s: f64,
}

impl Default for CycleParameters {
    fn default() -> Self {
        Self {
            mode: Comparison::Element,
            alarm_within_s: 60.0,
            never_ends_factor: 2.0,
            rate_window: 100,
            rate_significance: 0.01,
            known_stops: 3,
            auto_bits: 8,
            together_s: 1.0,
        }
    }
}

impl CycleParameters {
    /// Checks ranges.
    ///
    /// # Errors
    /// The first parameter out of range.
    pub fn validate(&self) -> Result<(), CycleError> {
        let checks = [
            ("alarm_within_s", self.alarm_within_s, 0.0, f64::MAX, "a number above 0"),
            ("never_ends_factor", self.never_ends_factor, 1.0, f64::MAX, "a number above 1"),
            ("rate_window", f64::from(self.rate_window), 0.0, f64::MAX, "a whole number above 0"),
            ("rate_significance", self.rate_significance, 0.0, 1.0, "a chance between 0 and 1"),
            ("auto_bits", self.auto_bits as f64, 0.0, 129.0, "a whole number from 1 to 128"),
            ("together_s", self.together_s, 0.0, f64::MAX, "a number above 0"),
        ];
        for (name, value, above, below, expected) in checks {
            if !(value > above && value < below) {
                return Err(CycleError::Parameter { name, value, expected });
            }
        }
        Ok(())
    }
}
