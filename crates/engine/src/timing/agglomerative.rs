//! Single-linkage agglomerative merging of time clusters, Ghosh 2016, Algorithm 3.

use super::TimeCluster;

/// Merges neighbouring clusters while the nearest two means lie closer than `merge_distance_s`,
/// then drops those whose support is not above `minimum_support`. Where none is left, one cluster
/// of all instances stays (`sorted` is all of them).
pub fn merge(
    mut clusters: Vec<TimeCluster>,
    sorted: &[f64],
    merge_distance_s: f64,
    minimum_support: f64,
) -> Vec<TimeCluster> {
    while let Some(left) = nearest_pair(&clusters) {
        if distance(&clusters, left) >= merge_distance_s {
            break;
        }
        let right = clusters.remove(left + 1);
        let kept = &mut clusters[left];
        let instances = kept.instances + right.instances;
        // Lines 24-27: the mean weighted by instances.
        kept.average_s = (kept.average_s * f64::from(kept.instances)
            + right.average_s * f64::from(right.instances))
            / f64::from(instances);
        kept.instances = instances;
        kept.maximum_s = right.maximum_s;
        kept.probability = f64::from(instances) / sorted.len() as f64;
    }
    clusters.retain(|cluster| cluster.probability > minimum_support);
    if clusters.is_empty() {
        clusters.push(TimeCluster::of(sorted, sorted.len()));
    }
    clusters
}

/// Lines 18-22: the first of the closest neighbours.
fn nearest_pair(clusters: &[TimeCluster]) -> Option<usize> {
    (0..clusters.len().saturating_sub(1))
        .reduce(|best, i| if distance(clusters, i) < distance(clusters, best) { i } else { best })
}

fn distance(clusters: &[TimeCluster], left: usize) -> f64 {
    clusters[left + 1].average_s - clusters[left].average_s
}
