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

/// Signs of all stops of the learned logs, and how often each was seen.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Stops(BTreeMap<Sign, u64>);

impl Stops {
    /// A stop whose cause showed so.
    pub fn count(&mut self, signs: &[Sign]) {
        for sign in signs {
            *self.0.entry(*sign).or_default() += 1;
        }
    }

    /// Adds a sign with its count.
    pub fn add(&mut self, sign: Sign, count: u64) {
        *self.0.entry(sign).or_default() += count;
    }

    /// All signs with their counts, in order.
    pub fn iter(&self) -> impl Iterator<Item = (Sign, u64)> + '_ {
        self.0.iter().map(|(sign, count)| (*sign, *count))
    }

    /// How often a stop showed so: the rarest of its signs. `None` where one was not seen
    /// `known_from` times.
    pub fn known(&self, signs: &[Sign], known_from: u64) -> Option<u64> {
        if known_from == 0 {
            return None;
        }
        let seen = signs.iter().map(|sign| self.0.get(sign).copied().unwrap_or(0)).min()?;
        (seen >= known_from).then_some(seen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURTAIN: Sign = Sign { showed: Showed::Came, bit: 13, value: false };
    const CLAMP: Sign = Sign { showed: Showed::Awaited, bit: 98, value: true };

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
    fn every_sign_has_to_be_known() {
        let mut stops = Stops::default();
        stops.add(CURTAIN, 40);
        stops.count(&[CLAMP]);
        assert_eq!(stops.known(&[CURTAIN, CLAMP], 3), None);
        assert_eq!(stops.known(&[Sign { value: true, ..CURTAIN }], 3), None);
        assert_eq!(stops.known(&[Sign { showed: Showed::Awaited, ..CURTAIN }], 3), None);
    }

    #[test]
    fn nothing_shown_and_nothing_wanted_is_never_known() {
        let mut stops = Stops::default();
        stops.add(CURTAIN, 40);
        assert_eq!(stops.known(&[], 3), None);
        assert_eq!(stops.known(&[CURTAIN], 0), None);
    }
}
