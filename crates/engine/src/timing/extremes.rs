//! How far bounded times ever reach: the extremes of all clusters of a plant on one scale.
//!
//! One cluster of some dozen instances cannot say how far one time in a million reaches; the
//! clusters of a plant together have seen millions. In each, the extreme instance is measured from
//! the average, in standard deviations, both without that instance, as the next
//! one would be measured. Beyond the tenth farthest of these, the law goes on as an exponential with
//! their mean excess (peaks over threshold, Pickands 1975, with shape 0).

use super::TimeCluster;

/// Farthest extremes that the tail is taken from.
const FARTHEST: usize = 10;
/// Fewer clusters say nothing about a plant.
const CLUSTERS_AT_LEAST: usize = 50;

/// The tail of the distance of a plant's times from their averages, in standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    draws: f64,
    threshold: f64,
    mean_excess: f64,
}

/// One side of a cluster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Shorter than average.
    Early,
    /// Longer than average.
    Late,
}

impl Extremes {
    /// From clusters of one kind; `None` where there are too few.
    pub fn of(clusters: &[&TimeCluster], side: Side, resolution_s: f64) -> Option<Self> {
        if clusters.len() < CLUSTERS_AT_LEAST {
            return None;
        }
        let mut reaches: Vec<f64> =
            clusters.iter().map(|cluster| reach(cluster, side, resolution_s)).collect();
        reaches.sort_unstable_by(|a, b| b.total_cmp(a));
        let threshold = reaches[FARTHEST - 1];
        let excess = |reach: &f64| reach - threshold;
        Some(Self {
            draws: clusters.iter().map(|cluster| f64::from(cluster.instances)).sum(),
            threshold,
            mean_excess: reaches[..FARTHEST].iter().map(excess).sum::<f64>() / FARTHEST as f64,
        })
    }

    /// Distance that a time passes with probability `alpha`, in standard deviations.
    pub fn distance(&self, alpha: f64) -> f64 {
        let expected = alpha * self.draws;
        self.threshold + self.mean_excess * (FARTHEST as f64 / expected).ln().max(0.0)
    }
}

/// The extreme instance of a side, as the others show it: its distance from their average, and
/// the sum of their squared deviations from it.
pub(super) fn without_extreme(cluster: &TimeCluster, side: Side) -> (f64, f64) {
    let n = f64::from(cluster.instances);
    let distance = match side {
        Side::Early => cluster.average_s - cluster.minimum_s,
        Side::Late => cluster.maximum_s - cluster.average_s,
    };
    let squares = n * f64::from(cluster.deviation_s).powi(2) - distance.powi(2) * n / (n - 1.0);
    (distance * n / (n - 1.0), squares.max(0.0))
}

/// Distance of the extreme instance, in standard deviations, both as they are without it.
fn reach(cluster: &TimeCluster, side: Side, resolution_s: f64) -> f64 {
    let (distance, squares) = without_extreme(cluster, side);
    let others = squares / (f64::from(cluster.instances) - 1.0);
    distance / others.sqrt().max(resolution_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timing::optimal;

    /// Sums of three even draws: bounded, steep towards the ends.
    fn bounded(seed: &mut u64) -> f64 {
        let mut even = || {
            *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (*seed >> 11) as f64 / (1u64 << 53) as f64
        };
        10.0 + even() + even() + even()
    }

    #[test]
    fn a_plant_knows_how_far_one_time_in_a_million_reaches() {
        let mut seed = 7;
        let clusters: Vec<TimeCluster> = (0..2000)
            .map(|_| {
                let mut times: Vec<f64> = (0..60).map(|_| bounded(&mut seed)).collect();
                times.sort_unstable_by(f64::total_cmp);
                optimal::cluster(&times, 0.001)[0]
            })
            .collect();
        let all: Vec<&TimeCluster> = clusters.iter().collect();
        let extremes = Extremes::of(&all, Side::Late, 0.001);
        let scale = clusters.iter().map(|c| f64::from(c.deviation_s)).sum::<f64>() / 2000.0;
        // No sum of three is farther than 1.5 from its mean; few come near.
        let seconds = extremes.map(|law| law.distance(1e-6) * scale);
        assert!(seconds.is_some_and(|s| (1.2..2.2).contains(&s)), "{seconds:?}");
        assert!(Extremes::of(&all[..20], Side::Late, 0.001).is_none());
    }
}
