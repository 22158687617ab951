//! Carefully seeded k-means (CSk-means), Ghosh 2016, Algorithms 1 and 2.
//!
//! Decisions where the paper leaves a gap (`docs/decisions/0002-plat-to-the-letter.md`):
//! `k` shrinks to the number of instances; split positions the assignment loop does not reach
//! leave the partitions after them empty; an empty partition keeps its mean while iterating, and is
//! dropped before merging.

use super::TimeCluster;
use super::agglomerative;

/// Parameters of the published clustering.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CskMeans {
    /// Initial number of clusters, at least 2.
    pub k: usize,
    /// Keeps the relative gap of small times finite ("parameter ε").
    pub epsilon: f64,
    /// Instances that span less are one cluster (Algorithm 1, line 5).
    pub single_cluster_span_s: f64,
    /// Clusters whose means lie closer are merged (Algorithm 3, line 23).
    pub merge_distance_s: f64,
    /// Clusters with no more than this share are dropped (Algorithm 3, line 38).
    pub minimum_support: f64,
}

/// "(very small) threshold value" of Algorithm 2, line 27.
const MEANS_EQUAL_S: f64 = 1e-9;
/// Algorithm 2 has no bound; k-means in one dimension settles long before this.
const ITERATIONS_AT_MOST: usize = 1000;

impl CskMeans {
    /// Clusters instances sorted in ascending order; empty input gives no cluster.
    pub fn cluster(&self, sorted: &[f64]) -> Vec<TimeCluster> {
        let (Some(first), Some(last)) = (sorted.first(), sorted.last()) else {
            return Vec::new();
        };
        if last - first < self.single_cluster_span_s {
            return vec![TimeCluster::of(sorted, sorted.len())];
        }
        let ends = k_means(sorted, seeds(sorted, self.k.min(sorted.len()), self.epsilon));
        let partitions = partitions(sorted, &ends).filter(|p| !p.is_empty());
        agglomerative::merge(
            partitions.map(|p| TimeCluster::of(p, sorted.len())).collect(),
            sorted,
            self.merge_distance_s,
            self.minimum_support,
        )
    }
}

/// The `k - 1` break positions with the largest relative gaps (Algorithm 1, lines 12-21): each is
/// the index of the last instance before a break, ascending.
fn seeds(sorted: &[f64], k: usize, epsilon: f64) -> Vec<usize> {
    let mut gap_value = vec![-1.0; k.saturating_sub(1)];
    let mut position = vec![0; k.saturating_sub(1)];
    for i in 0..sorted.len() - 1 {
        let gap = (sorted[i + 1] - sorted[i]) / (sorted[i] + epsilon);
        let mut smallest = 0;
        for j in 1..gap_value.len() {
            if gap_value[j] < gap_value[smallest] {
                smallest = j;
            }
        }
        if gap_value.get(smallest).is_some_and(|&value| gap > value) {
            gap_value[smallest] = gap;
            position[smallest] = i;
        }
    }
    position.sort_unstable();
    position
}

/// Algorithm 2. Takes and returns the last index of every partition but the last one.
fn k_means(sorted: &[f64], mut ends: Vec<usize>) -> Vec<usize> {
    let mut means: Vec<f64> = partitions(sorted, &ends).map(super::mean).collect();
    for _ in 0..ITERATIONS_AT_MOST {
        ends = assign(sorted, &means);
        let moved: Vec<f64> = partitions(sorted, &ends)
            .zip(&means)
            .map(
                |(partition, &before)| {
                    if partition.is_empty() { before } else { super::mean(partition) }
                },
            )
            .collect();
        let settled = means.iter().zip(&moved).all(|(a, b)| (a - b).abs() <= MEANS_EQUAL_S);
        means = moved;
        if settled {
            break;
        }
    }
    ends
}

/// Lines 3-9: walks the sorted instances and moves to the next mean where it is nearer.
fn assign(sorted: &[f64], means: &[f64]) -> Vec<usize> {
    let mut ends = vec![sorted.len() - 1; means.len() - 1];
    let mut current = 0;
    for (i, time) in sorted.iter().enumerate().skip(1) {
        if current == means.len() - 1 {
            break;
        }
        if (time - means[current]).abs() > (time - means[current + 1]).abs() {
            ends[current] = i - 1;
            current += 1;
        }
    }
    ends
}

fn partitions<'a>(sorted: &'a [f64], ends: &'a [usize]) -> impl Iterator<Item = &'a [f64]> {
    (0..=ends.len()).map(move |i| {
        let start = if i == 0 { 0 } else { ends[i - 1] + 1 };
        let end = ends.get(i).map_or(sorted.len(), |&last| last + 1);
        sorted.get(start..end).unwrap_or_default()
    })
}
