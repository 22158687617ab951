//! A stretch of times, asked in two steps and without a branch.

use crate::log::Nanoseconds;

/// The times from one to another, both included.
#[derive(Debug, Clone, Copy)]
pub(super) struct Within {
    first: Nanoseconds,
    /// How far the last lies after the first.
    width: u64,
}

impl Within {
    /// Every time that something can take.
    pub(super) const ALL: Self = Self { first: 0, width: u64::MAX };
    /// None of them: nothing takes less than no time.
    pub(super) const NONE: Self = Self { first: -1, width: 0 };

    /// The times from one to another; none where the other comes first.
    pub(super) fn new(first: Nanoseconds, last: Nanoseconds) -> Self {
        if first > last {
            return Self::NONE;
        }
        Self { first, width: (last as u64).wrapping_sub(first as u64) }
    }

    /// True where a time, not below zero, is one of them.
    #[inline(always)]
    pub(super) fn holds(self, took: Nanoseconds) -> bool {
        // Times before the first wrap round to more than any width.
        (took as u64).wrapping_sub(self.first as u64) <= self.width
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn edge() -> impl Strategy<Value = Nanoseconds> {
        prop_oneof![Just(Nanoseconds::MIN), Just(Nanoseconds::MAX), -3..4i64, any::<Nanoseconds>()]
    }

    proptest! {
        #[test]
        fn a_time_is_within_what_encloses_it(
            first in edge(),
            last in edge(),
            took in prop_oneof![Just(0), Just(Nanoseconds::MAX), 0..4i64, 0..Nanoseconds::MAX],
        ) {
            prop_assert_eq!(Within::new(first, last).holds(took), first <= took && took <= last);
            prop_assert!(Within::ALL.holds(took));
            prop_assert!(!Within::NONE.holds(took));
        }
    }
}
