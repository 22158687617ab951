//! Stops that are no failure: the alarm bit rises "for any reason", also where somebody reaches
//! through a light curtain, opens a door, presses STOP, or no part comes.
//!
//! What is learned from is taken to be nominal, and so are stops that it holds again and again.
//! Each alarm of the learned logs is explained as watching would explain it; what its cause showed
//! is counted. A stop seen
//! [`known_stops`](super::parameters::CycleParameters::known_stops) times is known from then on. A failure that slipped into the learned logs once or twice is not.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// What showed of the cause of a stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Showed {
    /// The bit took a value out of turn.
    Came,
    /// The bit should have taken a value, and did not.
    Awaited,
}

/// One bit of a cause.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Sign {
    /// How.
    pub showed: Showed,
    /// Index of the bit.
    pub bit: u32,
    /// The value it took, or should have taken.
    pub value: bool,
}

/// Stops of the learned logs by all that their causes showed, and how often each was seen. One clamp
/// that is awaited is another stop than all four.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Stops(BTreeMap<Vec<Sign>, u64>);

impl Stops {
    /// A stop whose cause showed so; one that showed nothing is none.
    pub fn count(&mut self, signs: &[Sign]) {
        self.add(signs.to_vec(), 1);
    }

    /// Adds stops that showed alike.
    pub fn add(&mut self, mut signs: Vec<Sign>, count: u64) {
        if !signs.is_empty() {
            signs.sort_unstable();
            *self.0.entry(signs).or_default() += count;
        }
    }

    /// All stops with their counts, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&[Sign], u64)> {
        self.0.iter().map(|(signs, count)| (signs.as_slice(), *count))
    }

    /// How often a stop showed so; `None` where that is less than `known_from` times.
    pub fn known(&self, signs: &[Sign], known_from: u64) -> Option<u64> {
        let mut signs = signs.to_vec();
        signs.sort_unstable();
        let seen = self.0.get(&signs).copied()?;
        (known_from > 0 && seen >= known_from).then_some(seen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURTAIN: Sign = Sign { showed: Showed::Came, bit: 13, value: false };
    const CLAMP: Sign = Sign { showed: Showed::Awaited, bit: 98, value: true };
    const OTHER_CLAMP: Sign = Sign { showed: Showed::Awaited, bit: 99, value: true };

    #[test]
    fn what_is_seen_again_and_again_is_known() {
        let mut stops = Stops::default();
        stops.count(&[CURTAIN]);
        stops.count(&[CURTAIN]);
        assert_eq!(stops.known(&[CURTAIN], 3), None);
        stops.count(&[CURTAIN]);
        assert_eq!(stops.known(&[CURTAIN], 3), Some(3));
    }

    #[test]
    fn it_has_to_show_the_same() {
        let mut stops = Stops::default();
        stops.add(vec![CURTAIN], 40);
        stops.add(vec![CLAMP, OTHER_CLAMP], 40);
        assert_eq!(stops.known(&[CURTAIN, CLAMP], 3), None);
        assert_eq!(stops.known(&[CLAMP], 3), None);
        assert_eq!(stops.known(&[OTHER_CLAMP, CLAMP], 3), Some(40));
        assert_eq!(stops.known(&[Sign { value: true, ..CURTAIN }], 3), None);
        assert_eq!(stops.known(&[Sign { showed: Showed::Awaited, ..CURTAIN }], 3), None);
    }

    #[test]
    fn nothing_shown_and_nothing_wanted_is_never_known() {
        let mut stops = Stops::default();
        stops.add(vec![CURTAIN], 40);
        stops.count(&[]);
        assert_eq!(stops.known(&[], 1), None);
        assert_eq!(stops.known(&[CURTAIN], 0), None);
    }
}
