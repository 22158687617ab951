//! What like motions show together, for the one of them that was seen a few times only.
//!
//! A robot puts a part aside a dozen times in the log: alone that says little of how far its time
//! ever spreads, but two hundred robots of its make do the same. Their spreads, each as a share of
//! its own average, are drawn from a common law: scaled inverse χ², whose scale and degrees of
//! freedom are found by maximum likelihood. A motion's own variance is then moderated, weighed
//! against the common one by their degrees of freedom (Smyth 2004, section 3). How far times reach,
//! in moderated deviations, the farthest instance of every motion says, measured without it as
//! the next one would be: peaks over threshold, with the predictive tail of [`super::limits`].

use super::TimeCluster;
use super::extremes::{Side, without_extreme};

/// Fewer motions say nothing of their make.
const MOTIONS_AT_LEAST: usize = 10;
/// Instances from which one's spread is worth a look.
const INSTANCES_AT_LEAST: u32 = 3;
/// Farthest instances that the tail is taken from, at most, and as a part of all motions.
const FARTHEST: usize = 10;
const FARTHEST_PART: usize = 2;
/// Degrees of freedom of the common law that are tried.
const DEGREES: [f64; 4] = [2.0, 8.0, 32.0, 128.0];
/// Spreads that differ more have no common law that reaches as far as a limit.
const DEGREES_AT_LEAST: f64 = 8.0;
const ROUNDS: usize = 30;
const CONVERGED: f64 = 1e-3;

/// The spread that like motions have in common, and how far beyond it their times reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pooled {
    common: Common,
    /// Early and late.
    beyond: [Beyond; 2],
    resolution_s: f64,
}

/// The law of variances, in shares of the squared average.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Common {
    variance: f64,
    degrees: f64,
}

/// The tail of distances from the average, in moderated deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Beyond {
    draws: f64,
    farthest: f64,
    threshold: f64,
    mean_excess: f64,
}

/// A variance in shares of the squared average, from so many degrees of freedom.
#[derive(Debug, Clone, Copy)]
struct Spread {
    variance: f64,
    degrees: f64,
}

impl Pooled {
    /// From the times of like motions; `None` where they are too few. Times that are no longer
    /// than the resolution, in seconds, say nothing.
    pub fn of<'a>(
        clusters: impl Iterator<Item = &'a TimeCluster>,
        resolution_s: f64,
    ) -> Option<Self> {
        let telling: Vec<&TimeCluster> =
            clusters.filter(|cluster| is_telling(cluster, resolution_s)).collect();
        if telling.len() < MOTIONS_AT_LEAST {
            return None;
        }
        let spreads: Vec<Spread> =
            telling.iter().map(|cluster| spread(cluster, resolution_s)).collect();
        let common = Common::of(&spreads);
        if common.degrees < DEGREES_AT_LEAST {
            return None;
        }
        let beyond = [Side::Early, Side::Late].map(|side| {
            let reaches = telling.iter().map(|c| common.reach(c, side, resolution_s));
            Beyond::of(reaches.collect(), telling.iter().map(|c| f64::from(c.instances)).sum())
        });
        Some(Self { common, beyond, resolution_s })
    }

    /// Distance from the average, in seconds, that a time of one of the motions passes on a side
    /// with probability `alpha`; `None` where it is too short, or was seen too seldom, to tell.
    pub fn reach(&self, cluster: &TimeCluster, side: Side, alpha: f64) -> Option<f64> {
        if !is_telling(cluster, self.resolution_s) {
            return None;
        }
        let deviation = self.common.moderated(spread(cluster, self.resolution_s));
        let of_average = (1.0 + 1.0 / f64::from(cluster.instances)).sqrt();
        let beyond = &self.beyond[usize::from(side == Side::Late)];
        Some(beyond.distance(alpha) * deviation * of_average * cluster.average_s)
    }
}

impl Common {
    /// Maximum likelihood: for given degrees of freedom the scale by expectation and maximisation.
    fn of(spreads: &[Spread]) -> Self {
        let mut law = Self { variance: geometric_mean(spreads), degrees: 0.0 };
        let tried = DEGREES.map(|degrees| {
            law.degrees = degrees;
            for _ in 0..ROUNDS {
                let precision = |s: &Spread| 1.0 / law.moderated_variance(*s);
                let sum: f64 = spreads.iter().map(precision).sum();
                let before = std::mem::replace(&mut law.variance, spreads.len() as f64 / sum);
                if (law.variance / before - 1.0).abs() < CONVERGED {
                    break;
                }
            }
            (law, law.likelihood(spreads))
        });
        let likelier = |a: (Self, f64), b: (Self, f64)| if b.1 > a.1 { b } else { a };
        tried.into_iter().reduce(likelier).unwrap_or(tried[0]).0
    }

    /// Logarithm of the density of variances, which over the common one are F-distributed; what
    /// does not depend on the law is left out.
    fn likelihood(self, spreads: &[Spread]) -> f64 {
        let Self { variance, degrees } = self;
        let gamma = |of: f64| libm::lgamma(0.5 * of);
        let of_law = gamma(degrees);
        let of_one = |s: &Spread| {
            let ratio = s.degrees * s.variance / (degrees * variance);
            gamma(degrees + s.degrees) - of_law + 0.5 * s.degrees * ratio.ln()
                - 0.5 * (degrees + s.degrees) * ratio.ln_1p()
        };
        spreads.iter().map(of_one).sum()
    }

    fn moderated_variance(self, own: Spread) -> f64 {
        let Self { variance, degrees } = self;
        (degrees * variance + own.degrees * own.variance) / (degrees + own.degrees)
    }

    fn moderated(self, own: Spread) -> f64 {
        self.moderated_variance(own).sqrt()
    }

    /// Distance of the extreme instance from the average, in moderated deviations, both as they are
    /// without it.
    fn reach(self, cluster: &TimeCluster, side: Side, resolution_s: f64) -> f64 {
        let n = f64::from(cluster.instances);
        let (distance, squares) = without_extreme(cluster, side);
        let variance = (squares / (n - 2.0)).max(least_variance(resolution_s));
        let others = Spread { variance: variance / cluster.average_s.powi(2), degrees: n - 2.0 };
        let of_average = (1.0 + 1.0 / (n - 1.0)).sqrt();
        distance / (self.moderated(others) * of_average * cluster.average_s)
    }
}

impl Beyond {
    fn of(mut reaches: Vec<f64>, draws: f64) -> Self {
        let farthest = FARTHEST.min(reaches.len() / FARTHEST_PART);
        reaches.sort_unstable_by(|a, b| b.total_cmp(a));
        let threshold = reaches[farthest - 1];
        let excess: f64 = reaches[..farthest].iter().map(|reach| reach - threshold).sum();
        let farthest = farthest as f64;
        Self { draws, farthest, threshold, mean_excess: excess / farthest }
    }

    fn distance(&self, alpha: f64) -> f64 {
        let ratio = (self.farthest / (alpha * self.draws)).max(1.0);
        self.threshold + self.farthest * self.mean_excess * (ratio.powf(1.0 / self.farthest) - 1.0)
    }
}

fn is_telling(cluster: &TimeCluster, resolution_s: f64) -> bool {
    cluster.instances >= INSTANCES_AT_LEAST && cluster.average_s > resolution_s
}

/// Of times that are whole ticks of the clock.
fn least_variance(resolution_s: f64) -> f64 {
    (resolution_s.powi(2) / 12.0).max(1e-12)
}

fn spread(cluster: &TimeCluster, resolution_s: f64) -> Spread {
    let n = f64::from(cluster.instances);
    let variance = f64::from(cluster.deviation_s).powi(2) * n / (n - 1.0);
    let variance = variance.max(least_variance(resolution_s)) / cluster.average_s.powi(2);
    Spread { variance, degrees: n - 1.0 }
}

fn geometric_mean(spreads: &[Spread]) -> f64 {
    let logarithms: f64 = spreads.iter().map(|s| s.variance.ln()).sum();
    (logarithms / spreads.len() as f64).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timing::optimal;

    const RESOLUTION_S: f64 = 0.001;

    fn even(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (*seed >> 11) as f64 / (1u64 << 53) as f64
    }

    /// One seen five times, around an average, evenly within this share of it.
    fn motion(seed: &mut u64, average_s: f64, spread: f64) -> TimeCluster {
        loop {
            let mut times: Vec<f64> =
                (0..5).map(|_| average_s * (1.0 + spread * (2.0 * even(seed) - 1.0))).collect();
            times.sort_unstable_by(f64::total_cmp);
            // Now and then five times look like two usual ones.
            if let [motion] = optimal::cluster(&times, RESOLUTION_S)[..] {
                return motion;
            }
        }
    }

    #[test]
    fn like_motions_say_how_far_a_rare_one_reaches() {
        let mut seed = 7;
        let motions: Vec<TimeCluster> =
            (0..200).map(|i| motion(&mut seed, 15.0 + 0.1 * f64::from(i), 0.02)).collect();
        let pooled = Pooled::of(motions.iter(), RESOLUTION_S);
        let reach = |cluster, side| pooled.and_then(|pooled| pooled.reach(cluster, side, 1e-6));
        for cluster in &motions {
            // None is farther than 2 % from what is in truth the middle; three deviations more pay
            // for what is known of that middle, and of the law.
            for side in [Side::Early, Side::Late] {
                let share = reach(cluster, side).map(|reach| reach / cluster.average_s);
                assert!(share.is_some_and(|share| (0.03..0.12).contains(&share)), "{share:?}");
            }
        }
        // What takes no time has no share of it.
        let at_once = optimal::cluster(&[0.0; 5], RESOLUTION_S)[0];
        assert_eq!(reach(&at_once, Side::Late), None);
    }

    #[test]
    fn motions_that_spread_as_they_like_say_nothing() {
        let mut seed = 7;
        let motions: Vec<TimeCluster> = (0..200)
            .map(|i| {
                let spread = 0.2 * even(&mut seed).powi(4);
                motion(&mut seed, 15.0 + 0.1 * f64::from(i), spread)
            })
            .collect();
        assert_eq!(Pooled::of(motions.iter(), RESOLUTION_S), None);
    }

    #[test]
    fn a_few_motions_are_no_make() {
        let mut seed = 7;
        let motions: Vec<TimeCluster> = (0..9).map(|_| motion(&mut seed, 15.0, 0.02)).collect();
        assert_eq!(Pooled::of(motions.iter(), RESOLUTION_S), None);
    }
}
