//! Transition times: how long a transition takes when all is well, and what is too long or short.

pub mod agglomerative;
pub mod clusters;
pub mod csk_means;
pub mod extremes;
pub mod limits;
pub mod optimal;
pub mod pooled;
pub mod shape;

use serde::{Deserialize, Serialize};

pub use clusters::Clusters;

/// One of the times a transition takes. All times in seconds.
///
/// What a time is compared with is kept to the last bit, and estimates in single precision: a plant
/// has tens of thousands of these in memory.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TimeCluster {
    /// Mean of the instances (ATT in Ghosh 2016, Figures 13-14).
    pub average_s: f64,
    /// Smallest instance.
    pub minimum_s: f64,
    /// Largest instance.
    pub maximum_s: f64,
    /// Share of the transition's instances (TTP). Not renormalised when clusters are dropped.
    pub probability: f64,
    /// Number of learned instances.
    pub instances: u32,
    /// Standard deviation of the instances. Zero with `plat`.
    pub deviation_s: f32,
    /// Mean excess of the upper half over the median: the scale of the late tail. Zero with `plat`.
    pub late_scale_s: f32,
    /// The same for the lower half: the scale of the early tail. Zero with `plat`.
    pub early_scale_s: f32,
    /// Gini coefficient of the distances from the median: ½ for exponential tails, 0.41 for a
    /// normal law, ⅓ for an even spread.
    pub tail_gini: f32,
    /// Long-run variance of belonging to this cluster, over that of independent draws: below 1
    /// where clusters alternate, above 1 where they come in bunches. See [`crate::signal_state::dispersion`].
    pub dispersion: f32,
}

impl TimeCluster {
    /// Summarises one contiguous run of the sorted instances `times` out of `total`.
    fn of(times: &[f64], total: usize) -> Self {
        let (first, last) = (times.first().copied(), times.last().copied());
        Self {
            instances: times.len() as u32,
            average_s: mean(times),
            minimum_s: first.unwrap_or_default(),
            maximum_s: last.unwrap_or_default(),
            probability: times.len() as f64 / total as f64,
            deviation_s: 0.0,
            late_scale_s: 0.0,
            early_scale_s: 0.0,
            tail_gini: 0.5,
            dispersion: 1.0,
        }
    }
}

/// The cluster whose average is nearest to a time.
pub fn nearest(clusters: &[TimeCluster], time_s: f64) -> Option<usize> {
    (0..clusters.len()).min_by(|&a, &b| {
        let distance = |i: usize| (clusters[i].average_s - time_s).abs();
        distance(a).total_cmp(&distance(b))
    })
}

/// Mean of sorted values, summed from the left; zero where there are none.
fn mean(times: &[f64]) -> f64 {
    if times.is_empty() { 0.0 } else { times.iter().sum::<f64>() / times.len() as f64 }
}
