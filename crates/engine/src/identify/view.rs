//! Which changes of a signal count.

/// A wrap-around of a 16-bit counter is no larger step than this; a larger one is a reset.
const WRAP_STEP_MOST: i64 = 255;

/// Which changes of a signal count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum View {
    /// Every change of value.
    #[default]
    All,
    /// A bit that comes on, a word that grows. The slot of a sensor is two changes, and one event.
    Rising,
    /// A bit that goes off, a word that shrinks.
    Falling,
    /// A counter that goes up, by how much ever, also from its highest value to its lowest. Bits
    /// of words do not count, because they are no counters.
    Increments,
}

impl View {
    /// The view of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "all" => Self::All,
            "rising" => Self::Rising,
            "falling" => Self::Falling,
            "increments" => Self::Increments,
            _ => return None,
        })
    }

    /// True where a change from one value to another counts.
    #[inline]
    pub fn counts(self, from: i64, to: i64) -> bool {
        match self {
            Self::All => from != to,
            Self::Rising => from < to,
            Self::Falling => to < from,
            Self::Increments => from < to || wraps(from, to),
        }
    }

    /// The bits of a word whose change counts.
    #[inline]
    pub fn bits(self, from: i64, to: i64) -> u64 {
        match self {
            Self::All => (from ^ to) as u64,
            Self::Rising => (!from & to) as u64,
            Self::Falling => (from & !to) as u64,
            Self::Increments => 0,
        }
    }
}

/// A 16-bit counter, with sign or without, that goes on behind its highest value.
fn wraps(from: i64, to: i64) -> bool {
    let sixteen_bits = -0x8000..=0xFFFF;
    let step = (to - from).rem_euclid(0x1_0000);
    // Without sign a counter comes from above 0x8000, with sign from just below.
    let from_the_end = from > 0x7FFF - WRAP_STEP_MOST;
    to < from
        && sixteen_bits.contains(&from)
        && sixteen_bits.contains(&to)
        && from_the_end
        && (1..=WRAP_STEP_MOST).contains(&step)
}

#[cfg(test)]
mod tests {
    use super::View::{All, Falling, Increments, Rising};

    #[test]
    fn a_slot_is_two_changes_or_one_edge() {
        let slot = [(0, 1), (1, 0)];
        let counted = |view: super::View| slot.map(|(from, to)| view.counts(from, to));
        assert_eq!(counted(All), [true, true]);
        assert_eq!(counted(Rising), [true, false]);
        assert_eq!(counted(Falling), [false, true]);
        assert_eq!(counted(Increments), [true, false]);
    }

    #[test]
    fn counters_count_through_their_end() {
        for (from, to) in [(1, 2), (1, 4000), (65_535, 0), (65_530, 3), (32_767, -32_768)] {
            assert!(Increments.counts(from, to), "{from} to {to}");
        }
        // A shift ends and the counter is set back.
        for (from, to) in [(57, 0), (60_000, 0), (65_535, 1000), (7, 7), (70_000, 4464), (-1, -2)] {
            assert!(!Increments.counts(from, to), "{from} to {to}");
        }
    }

    #[test]
    fn bits_of_words() {
        let (from, to) = (0b0011, 0b0110);
        assert_eq!(All.bits(from, to), 0b0101);
        assert_eq!(Rising.bits(from, to), 0b0100);
        assert_eq!(Falling.bits(from, to), 0b0001);
        assert_eq!(Increments.bits(from, to), 0);
    }
}
