//! What is too long, or too short, for a transition.
//!
//! `plat`: the published rule, a fixed allowance over the nearest maximum. `adaptive`: a
//! predictive tail. After `n` instances the next one lies beyond the largest with probability
//! `1/(n+1)` whatever the distribution; how far beyond is taken as exponential with the scale of
//! the cluster's own tail, and since that scale is itself learned from `n` instances, the
//! predictive tail is the Lomax (Pareto II) distribution with shape `n`:
//! `P(X > maximum + m) = (1 + m / (n·scale))^-n / (n + 1)`.
//! Few instances make a heavy tail and so a wide limit; no fixed allowance is needed. Motions
//! bounded by mechanics have no exponential tail: how far theirs reach the whole plant tells
//! ([`super::extremes`]), or, where it is small, Student's t. Which of the two a cluster has is a
//! matter of probability ([`super::shape`]), and half the tail probability `α` pays for each: the
//! limit is where bounded times are passed with `α/2`, or the Lomax law with `α/2` over the
//! probability that it holds, whichever is farther. What was seen too seldom to tell its own shape
//! is limited by the nearer of its own Lomax law and what like motions show together
//! ([`super::pooled`]).

use super::TimeCluster;
use super::extremes::Side;
use super::shape::Shapes;

/// Clusters with fewer instances are *rare but seen*: accepted, but no basis for a limit.
pub const BODY_INSTANCES: u32 = 3;

/// The published allowance Δ over a maximum, in seconds (Ghosh 2016, below Table 4).
pub fn plat_allowance_s(maximum_s: f64) -> f64 {
    if maximum_s <= 15.0 {
        1.5
    } else if maximum_s <= 30.0 {
        3.0
    } else {
        4.0
    }
}

/// The times accepted around one cluster, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accepted {
    /// Anything below is early; zero where nothing is.
    pub early_s: f64,
    /// Anything above is late; infinite where nothing is.
    pub late_s: f64,
}

/// A tail probability per transition, and the normal deviate that half of it goes with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tail {
    alpha: f64,
    z_of_half: f64,
}

impl Tail {
    /// The tail passed with probability `alpha`.
    pub fn new(alpha: f64) -> Self {
        Self { alpha, z_of_half: normal_quantile(alpha / 2.0) }
    }
}

/// Accepted times per cluster for a tail probability per transition. An empty answer means that
/// no time is remarkable, since too few were seen.
pub fn adaptive(
    clusters: &[TimeCluster],
    tail: Tail,
    shapes: &Shapes,
    resolution_s: f64,
) -> Vec<Accepted> {
    if !clusters.iter().any(|c| c.instances >= BODY_INSTANCES) {
        return Vec::new();
    }
    clusters
        .iter()
        .map(|cluster| {
            let instances = f64::from(cluster.instances);
            let exponential = shapes.exponential(cluster);
            let reach = |side: Side, scale: f32, extreme: f64| {
                let scale = f64::from(scale).max(resolution_s);
                if cluster.instances < BODY_INSTANCES {
                    return extreme + scale;
                }
                if exponential >= 1.0 {
                    let alone = extreme + lomax_margin(instances, scale, tail.alpha);
                    let pooled = shapes.pooled(cluster);
                    let alike = pooled.and_then(|pooled| pooled.reach(cluster, side, tail.alpha));
                    return alike.map_or(alone, |alike| alone.min(alike.max(extreme + scale)));
                }
                let alpha = (tail.alpha / (2.0 * exponential)).min(1.0);
                // The nearer of the two: a few clusters that are two times in one would otherwise
                // widen the limits of all.
                let deviation = f64::from(cluster.deviation_s).max(resolution_s);
                let of_plant = shapes.extremes(side, cluster.instances);
                let bounded = of_plant
                    .map_or(f64::INFINITY, |law| deviation * law.distance(tail.alpha / 2.0))
                    .min(normal_reach(instances, scale, tail.z_of_half));
                (extreme + lomax_margin(instances, scale, alpha)).max(bounded).max(extreme + scale)
            };
            // Distances from the average outwards, to either side.
            let (below, above) =
                (cluster.average_s - cluster.minimum_s, cluster.maximum_s - cluster.average_s);
            Accepted {
                early_s: (cluster.average_s - reach(Side::Early, cluster.early_scale_s, below))
                    .max(0.0),
                late_s: cluster.average_s + reach(Side::Late, cluster.late_scale_s, above),
            }
        })
        .collect()
}

/// The published rule as accepted times: nothing is early.
/// `allowance_s` is one Δ for all times, as in the paper's section 3.2, instead of the steps.
pub fn plat(clusters: &[TimeCluster], allowance_s: Option<f64>) -> Vec<Accepted> {
    let allowance = |maximum| allowance_s.unwrap_or_else(|| plat_allowance_s(maximum));
    clusters
        .iter()
        .map(|c| Accepted { early_s: 0.0, late_s: c.maximum_s + allowance(c.maximum_s) })
        .collect()
}

/// Distance from the centre that Student's t passes with the probability of `z`; `scale` is the
/// mean distance of a half, √(2/π) of a normal law's deviation.
fn normal_reach(instances: f64, scale: f64, z: f64) -> f64 {
    let degrees = instances - 1.0;
    // The quantile of Student's t by its expansion (Peizer & Pratt; Abramowitz & Stegun 26.7.5).
    let t = z
        + (z.powi(3) + z) / (4.0 * degrees)
        + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * degrees.powi(2));
    t * scale * (std::f64::consts::PI / 2.0).sqrt() * (1.0 + 1.0 / instances).sqrt()
}

/// The standard normal deviate passed with probability `alpha`, by bisection.
fn normal_quantile(alpha: f64) -> f64 {
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if 0.5 * libm::erfc(middle / std::f64::consts::SQRT_2) > alpha {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The margin beyond an extreme that is passed with probability `alpha`.
fn lomax_margin(instances: f64, scale: f64, alpha: f64) -> f64 {
    let ratio = (1.0 / (alpha * (instances + 1.0))).max(1.0);
    instances * scale * (ratio.powf(1.0 / instances) - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_allowance_has_three_steps() {
        assert_eq!(plat_allowance_s(15.0), 1.5);
        assert_eq!(plat_allowance_s(15.1), 3.0);
        assert_eq!(plat_allowance_s(30.1), 4.0);
    }

    #[test]
    fn few_instances_make_wide_limits() {
        let margin = |n| lomax_margin(n, 0.01, 1e-6);
        assert!(margin(3.0) > 2.0 * margin(5.0));
        assert!(margin(5.0) > margin(20.0));
        assert!(margin(20.0) > margin(1000.0));
        assert!((normal_quantile(0.025) - 1.959_964).abs() < 1e-5);
        // 20 instances: 20 · 0.01 · ((1e6/21)^(1/20) − 1) = 0.1427…
        assert!((margin(20.0) - 0.1427).abs() < 1e-3);
    }
}
