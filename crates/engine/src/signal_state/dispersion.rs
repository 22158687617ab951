//! How far a share wanders: the long-run variance of a sequence against that of independent draws.
//!
//! A periodic check compares a share seen in thirty cycles with the learned one. Independent draws
//! wander by the binomial law; products that alternate strictly wander far less, and products that
//! come in batches far more. The factor is estimated from the learning log by Bartlett-weighted
//! autocovariances (Newey & West 1987). A factor below 1 makes the check sharper, so it is only
//! believed where the runs test (Wald & Wolfowitz 1940) rejects independence.

/// `|z|` of the runs test from which alternation is believed (two-sided, about 0.1 %).
const ALTERNATION_BELIEVED: f64 = 3.3;
/// Longest lag looked at.
const LAG_AT_MOST: usize = 30;

/// Dispersion factor of "the instance belongs to `kind`" in a sequence of kinds.
pub fn of_share(sequence: &[u32], kind: u32) -> f64 {
    let n = sequence.len();
    if n < 8 {
        return 1.0;
    }
    let share = sequence.iter().filter(|&&k| k == kind).count() as f64 / n as f64;
    if share <= 0.0 || share >= 1.0 {
        return 1.0;
    }
    let deviation = |i: usize| if sequence[i] == kind { 1.0 - share } else { -share };
    let ratio = long_run_ratio(n, deviation, share * (1.0 - share));
    let runs = 1 + (1..n).filter(|&i| (sequence[i] == kind) != (sequence[i - 1] == kind)).count();
    if ratio >= 1.0 || runs_z(n, share, runs) >= ALTERNATION_BELIEVED {
        ratio.max(1.0 / n as f64)
    } else {
        1.0
    }
}

/// Dispersion factor of the mean of a series of times; never below 1.
pub fn of_mean(series: &[f64]) -> f64 {
    let n = series.len();
    if n < 8 {
        return 1.0;
    }
    let mean = series.iter().sum::<f64>() / n as f64;
    let variance = series.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n as f64;
    if variance <= 0.0 {
        return 1.0;
    }
    long_run_ratio(n, |i| series[i] - mean, variance).max(1.0)
}

fn long_run_ratio(n: usize, deviation: impl Fn(usize) -> f64, variance: f64) -> f64 {
    let lags = ((n as f64).sqrt().ceil() as usize).clamp(1, LAG_AT_MOST);
    let deviations: Vec<f64> = (0..n).map(deviation).collect();
    let mut ratio = 1.0;
    for first in (1..=lags).step_by(LAGS_AT_ONCE) {
        let sums = lagged_sums(&deviations, first);
        for (lag, sum) in (first..=lags).zip(sums) {
            let covariance = sum / n as f64;
            let weight = 1.0 - lag as f64 / (lags + 1) as f64;
            ratio += 2.0 * weight * covariance / variance;
        }
    }
    ratio
}

/// Sums that do not wait for one another share their latency.
const LAGS_AT_ONCE: usize = 6;

/// For the lags from `first` on: the sum over all pairs that far apart, each from the left.
fn lagged_sums(deviations: &[f64], first: usize) -> [f64; LAGS_AT_ONCE] {
    let mut sums = [0.0; LAGS_AT_ONCE];
    let longest = first + LAGS_AT_ONCE - 1;
    for (lag, sum) in (first..).zip(&mut sums) {
        for i in lag..deviations.len().min(longest) {
            *sum += deviations[i] * deviations[i - lag];
        }
    }
    for window in deviations.windows(longest + 1) {
        let deviation = window[longest];
        for (before, sum) in (0..LAGS_AT_ONCE).zip(&mut sums) {
            *sum += deviation * window[LAGS_AT_ONCE - 1 - before];
        }
    }
    sums
}

/// Standardised number of runs: large where kinds alternate.
fn runs_z(n: usize, share: f64, runs: usize) -> f64 {
    let (ones, zeros) = (share * n as f64, (1.0 - share) * n as f64);
    let expected = 2.0 * ones * zeros / n as f64 + 1.0;
    let variance = (expected - 1.0) * (expected - 2.0) / (n as f64 - 1.0);
    if variance > 0.0 { (runs as f64 - expected) / variance.sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alternation_is_nearly_certain() {
        let sequence: Vec<u32> = (0..19).map(|i| i % 2).collect();
        assert!(of_share(&sequence, 0) < 0.25);
    }

    #[test]
    fn batches_wander_more() {
        let sequence: Vec<u32> = (0..200).map(|i| (i / 20) % 2).collect();
        assert!(of_share(&sequence, 0) > 4.0);
    }

    #[test]
    fn a_short_sequence_proves_nothing() {
        assert_eq!(of_share(&[0, 1, 0, 1], 0), 1.0);
    }
}
