//! Which shape the tails of a plant's times have: exponential, or bounded by mechanics.
//!
//! One transition seen some dozen times hardly tells; thousands of them do. The Gini coefficient of
//! the distances from the median is ½ for exponential tails (variance `1/(12 n)` over `n` draws),
//! 0.41 for a normal law, ⅓ for an even spread. Over a plant, the coefficients are a mixture of
//! ½ and of what its bounded times show, whose weight is found by expectation and maximisation
//! (Dempster, Laird & Rubin 1977). Each cluster then has its own probability of being exponential.

use super::TimeCluster;
use super::extremes::{Extremes, Side};
use super::pooled::Pooled;

/// Instances from which a cluster says something of its shape.
pub const SHAPE_INSTANCES: u32 = 20;
/// Gini coefficient of exponential tails.
const EXPONENTIAL: f64 = 0.5;
/// Bounded times show no more than this: that of a normal law, and a little.
const BOUNDED_AT_MOST: f64 = 0.42;
/// Scales below so many resolutions show the clock's ticks, not a shape.
const TICKS: f64 = 2.0;
/// Scales below so many would let the ticks reach far.
const TICKS_OF_EXTREMES: f64 = 4.0;
/// Instances from which a cluster's own spread is well known.
const MANY_INSTANCES: u32 = 40;
/// Clusters that are taken to be exponential before any has been seen.
const PRIOR_CLUSTERS: f64 = 1.0;
const ROUNDS: usize = 25;

/// The mixture of shapes in one kind of times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shapes {
    exponential: f64,
    bounded_gini: f64,
    /// How far bounded times reach, early and late: in clusters of few, and of many instances.
    extremes: [[Option<Extremes>; 2]; 2],
    /// What like motions show together.
    pooled: Option<Pooled>,
    resolution_s: f64,
}

impl Shapes {
    /// Learns the mixture from clusters of one kind.
    pub fn of<'a>(clusters: impl Iterator<Item = &'a TimeCluster>, resolution_s: f64) -> Self {
        let telling: Vec<&TimeCluster> =
            clusters.filter(|cluster| is_telling(cluster, resolution_s)).collect();
        let mut shapes = Self {
            exponential: 1.0,
            bounded_gini: BOUNDED_AT_MOST,
            extremes: [[None; 2]; 2],
            pooled: None,
            resolution_s,
        };
        if telling.is_empty() {
            return shapes;
        }
        let mut ginis: Vec<f64> =
            telling.iter().map(|cluster| f64::from(cluster.tail_gini)).collect();
        ginis.sort_unstable_by(f64::total_cmp);
        shapes.bounded_gini = ginis[ginis.len() / 2].min(BOUNDED_AT_MOST);
        shapes.exponential = 0.5;
        for _ in 0..ROUNDS {
            let sum: f64 = telling.iter().map(|cluster| shapes.probability(cluster)).sum();
            shapes.exponential = (sum + PRIOR_CLUSTERS) / (telling.len() as f64 + PRIOR_CLUSTERS);
        }
        let bounded = telling.into_iter().filter(|cluster| {
            shapes.probability(cluster) < 0.5 && spreads(cluster, TICKS_OF_EXTREMES * resolution_s)
        });
        let (many, few): (Vec<&TimeCluster>, Vec<&TimeCluster>) =
            bounded.partition(|cluster| cluster.instances >= MANY_INSTANCES);
        shapes.extremes = [few, many].map(|clusters| {
            [Side::Early, Side::Late].map(|side| Extremes::of(&clusters, side, resolution_s))
        });
        shapes
    }

    /// Weight of exponential tails among clusters that are times of the same motion of like
    /// devices, of which the plant's weighs one; `None` where they tell nothing.
    pub fn of_family<'a>(&self, clusters: impl Iterator<Item = &'a TimeCluster>) -> Option<f64> {
        let telling: Vec<&TimeCluster> =
            clusters.filter(|cluster| is_telling(cluster, self.resolution_s)).collect();
        if telling.is_empty() {
            return None;
        }
        let mut family = *self;
        for _ in 0..ROUNDS {
            let sum: f64 = telling.iter().map(|cluster| family.probability(cluster)).sum();
            family.exponential = (sum + self.exponential) / (telling.len() as f64 + 1.0);
        }
        Some(family.exponential)
    }

    /// The same shapes, exponential ones of this weight.
    pub fn weighted(&self, exponential: f64) -> Self {
        Self { exponential, ..*self }
    }

    /// The same shapes, of motions that are like others.
    pub fn like(&self, pooled: Option<Pooled>) -> Self {
        Self { pooled, ..*self }
    }

    /// What like motions show for a cluster too small to tell its own shape.
    pub fn pooled(&self, cluster: &TimeCluster) -> Option<&Pooled> {
        self.pooled.as_ref().filter(|_| cluster.instances < SHAPE_INSTANCES)
    }

    /// How far bounded times of a cluster of so many instances reach on a side, where the plant
    /// tells.
    pub fn extremes(&self, side: Side, instances: u32) -> Option<&Extremes> {
        let of_size = &self.extremes[usize::from(instances >= MANY_INSTANCES)];
        of_size[usize::from(side == Side::Late)].as_ref()
    }

    /// Probability that a cluster's tails are exponential; 1 where it is too small to tell.
    pub fn exponential(&self, cluster: &TimeCluster) -> f64 {
        if is_telling(cluster, self.resolution_s) { self.probability(cluster) } else { 1.0 }
    }

    fn probability(&self, cluster: &TimeCluster) -> f64 {
        let density = |gini: f64| {
            let away = f64::from(cluster.tail_gini).min(EXPONENTIAL) - gini;
            (-6.0 * f64::from(cluster.instances) * away * away).exp()
        };
        let exponential = self.exponential * density(EXPONENTIAL);
        let bounded = (1.0 - self.exponential) * density(self.bounded_gini);
        if exponential + bounded > 0.0 { exponential / (exponential + bounded) } else { 1.0 }
    }
}

fn is_telling(cluster: &TimeCluster, resolution_s: f64) -> bool {
    cluster.instances >= SHAPE_INSTANCES && spreads(cluster, TICKS * resolution_s)
}

/// True where a tail is at least so long. In single precision, as scales are kept: that of a log
/// of whole ticks is often the very number.
fn spreads(cluster: &TimeCluster, scale_s: f64) -> bool {
    cluster.late_scale_s.max(cluster.early_scale_s) >= scale_s as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cluster(instances: u32, tail_gini: f32) -> TimeCluster {
        TimeCluster {
            instances,
            average_s: 1.0,
            minimum_s: 0.5,
            maximum_s: 1.5,
            deviation_s: 0.2,
            probability: 1.0,
            late_scale_s: 0.2,
            early_scale_s: 0.2,
            tail_gini,
            dispersion: 1.0,
        }
    }

    #[test]
    fn a_plant_of_bounded_times_tells_what_one_cluster_cannot() {
        let plant = vec![cluster(30, 0.35); 500];
        let few = Shapes::of(plant[..1].iter(), 0.01);
        let many = Shapes::of(plant.iter(), 0.01);
        assert!(few.exponential(&plant[0]) > 0.01);
        assert!(many.exponential(&plant[0]) < 1e-3);
    }

    #[test]
    fn like_motions_vouch_for_one_another() {
        let mut plant = vec![cluster(30, 0.35); 500];
        plant.extend(vec![cluster(30, 0.5); 500]);
        let shapes = Shapes::of(plant.iter(), 0.01);
        let doubtful = cluster(30, 0.41);
        let [bounded, exponential] = [&plant[..50], &plant[950..]]
            .map(|family| shapes.of_family(family.iter()).unwrap_or_default())
            .map(|weight| shapes.weighted(weight).exponential(&doubtful));
        let alone = shapes.exponential(&doubtful);
        assert!(bounded < 0.1 * alone && exponential > alone, "{bounded} {alone} {exponential}");
        assert_eq!(shapes.of_family([].iter()), None);
    }

    #[test]
    fn an_exponential_cluster_among_bounded_ones_is_seen() {
        let mut plant = vec![cluster(100, 0.35); 500];
        plant.push(cluster(100, 0.52));
        let shapes = Shapes::of(plant.iter(), 0.01);
        assert!(shapes.exponential(&plant[500]) > 0.9);
    }

    #[test]
    fn the_clock_s_ticks_have_no_shape() {
        let ticking = TimeCluster { late_scale_s: 0.01, early_scale_s: 0.01, ..cluster(100, 0.2) };
        assert_eq!(Shapes::of([ticking].iter(), 0.01).exponential(&ticking), 1.0);
    }
}
