//! Do findings of class 3 and 4 at one address come more often? The paper saw such growth before
//! a class 1 at the same address (section 4).
//!
//! The test: counts in the last `window` sequences and in all before them are Poisson; given their
//! sum, the recent count is binomial with the window's share of all sequences (Przyborowski and
//! Wilenski 1940). It is made at every finding, so the chance of error is spread (Bonferroni):
//! over the addresses, and over the tests of one address as 1 / (n (n + 1)), which sums to 1.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

/// Findings of one address.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    /// Sequence numbers of the recent findings.
    recent: VecDeque<u64>,
    /// Findings before those.
    before: u64,
    tests: u64,
    /// Sequence in which it was last told.
    told: Option<u64>,
}

/// A rate that has risen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rise {
    /// Findings in the window.
    pub recent: u64,
    /// Findings before it.
    pub before: u64,
    /// Sequences before it.
    pub sequences_before: u64,
    /// Chance of so many by chance.
    pub chance: f64,
}

impl Rate {
    /// A finding in sequence number `sequence` (counted from 0 since watching began).
    pub fn found(
        &mut self,
        sequence: u64,
        window: u64,
        significance: f64,
        addresses: usize,
    ) -> Option<Rise> {
        self.recent.push_back(sequence);
        while self.recent.front().is_some_and(|&first| sequence - first >= window) {
            self.recent.pop_front();
            self.before += 1;
        }
        // A rate needs something to have risen from.
        if sequence < 2 * window {
            return None;
        }
        self.tests += 1;
        let share = window as f64 / (sequence + 1) as f64;
        let recent = self.recent.len() as u64;
        let chance = at_least(recent, recent + self.before, share);
        let tests = self.tests as f64;
        let allowed = significance / (addresses.max(1) as f64 * tests * (tests + 1.0));
        let fresh = self.told.is_none_or(|told| sequence - told >= window);
        (chance < allowed && fresh).then(|| {
            self.told = Some(sequence);
            Rise { recent, before: self.before, sequences_before: sequence + 1 - window, chance }
        })
    }
}

/// P(X ≥ k) of a binomial.
fn at_least(k: u64, n: u64, p: f64) -> f64 {
    let ln_choose = |k: u64| {
        libm::lgamma(n as f64 + 1.0)
            - libm::lgamma(k as f64 + 1.0)
            - libm::lgamma((n - k) as f64 + 1.0)
    };
    let (ln_p, ln_q) = (p.ln(), (1.0 - p).ln());
    let sum: f64 =
        (k..=n).map(|k| (ln_choose(k) + k as f64 * ln_p + (n - k) as f64 * ln_q).exp()).sum();
    sum.min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tail_of_a_binomial() {
        assert!((at_least(0, 10, 0.5) - 1.0).abs() < 1e-12);
        assert!((at_least(10, 10, 0.5) - 1.0 / 1024.0).abs() < 1e-12);
        assert!((at_least(1, 2, 0.1) - 0.19).abs() < 1e-12);
    }

    #[test]
    fn a_steady_rate_never_tells() {
        let mut rate = Rate::default();
        for sequence in (0..20_000).step_by(50) {
            assert_eq!(rate.found(sequence, 100, 0.01, 216), None, "{sequence}");
        }
    }

    #[test]
    fn growth_tells_once_a_window() {
        let mut rate = Rate::default();
        assert_eq!(rate.found(500, 100, 0.01, 216), None);
        let told: Vec<Rise> = (2000..2060).filter_map(|s| rate.found(s, 100, 0.01, 216)).collect();
        assert_eq!(told.len(), 1);
        assert!(told[0].recent < 10 && told[0].before == 1, "{told:?}");
    }

    #[test]
    fn the_first_sequences_have_nothing_to_rise_from() {
        let mut rate = Rate::default();
        assert!((0..199).all(|s| rate.found(s, 100, 0.01, 216).is_none()));
    }
}
