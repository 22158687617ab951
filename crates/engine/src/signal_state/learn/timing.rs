//! The times of every transition: clustered, and measured from what it really waits for.
//!
//! Transitions have nothing to do with one another here, so several are looked at at a time.

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::log::{Nanoseconds, SECOND};
use crate::signal_state::chains::{ChainKind, Chains};
use crate::signal_state::dispersion;
use crate::signal_state::enabling::{Happenings, Search, Trigger};
use crate::signal_state::parameters::{Parameters, Timing};
use crate::timing::csk_means::CskMeans;
use crate::timing::{self, TimeCluster, optimal};

use super::walk::{ByRule, Transitions};

/// Transitions a thread takes at once.
const AT_ONCE: usize = 256;
/// Fewer instances than this are not worth a thread of their own.
const INSTANCES_A_THREAD: usize = 100_000;
/// More threads would wait for memory.
const THREADS_AT_MOST: usize = 8;

/// What is learned of the times of one transition.
pub(super) struct Times {
    pub(super) clusters: Vec<TimeCluster>,
    pub(super) trigger: Option<Trigger>,
}

/// How times are learned.
#[derive(Clone, Copy)]
pub(super) struct Study<'a> {
    pub(super) found: &'a Transitions,
    pub(super) chains: &'a Chains,
    pub(super) parameters: &'a Parameters,
    pub(super) resolution: Nanoseconds,
    /// Where enabling events are looked for; none where they are not.
    pub(super) happenings: Option<&'a Happenings<'a>>,
}

impl Study<'_> {
    /// The times of all transitions, in their order.
    pub(super) fn all(self) -> Vec<Times> {
        let by_rule = ByRule::of(self.found);
        let cores = thread::available_parallelism().map_or(1, NonZero::get);
        let worth = self.found.instances.len() / INSTANCES_A_THREAD;
        let next = AtomicUsize::new(0);
        let work = || self.take_chunks(&by_rule, &next);
        let mut chunks = thread::scope(|scope| {
            let others = 1..cores.min(worth).min(THREADS_AT_MOST);
            let others: Vec<_> = others.map(|_| scope.spawn(work)).collect();
            let mut chunks = work();
            for other in others {
                match other.join() {
                    Ok(more) => chunks.extend(more),
                    Err(panic) => std::panic::resume_unwind(panic),
                }
            }
            chunks
        });
        chunks.sort_unstable_by_key(|(first, _)| *first);
        chunks.into_iter().flat_map(|(_, times)| times).collect()
    }

    /// One thread: takes chunks until there is none left.
    fn take_chunks(self, by_rule: &ByRule, next: &AtomicUsize) -> Vec<(usize, Vec<Times>)> {
        let mut bench = Bench { search: self.happenings.map(Search::new), ..Bench::default() };
        let mut chunks = Vec::new();
        loop {
            let first = next.fetch_add(AT_ONCE, Ordering::Relaxed);
            let end = self.found.rules.len().min(first.saturating_add(AT_ONCE));
            if first >= end {
                return chunks;
            }
            let times = (first..end).map(|rule| self.one(by_rule, rule, &mut bench)).collect();
            chunks.push((first, times));
        }
    }

    fn one(self, by_rule: &ByRule, index: usize, bench: &mut Bench<'_>) -> Times {
        let Bench { search, ordered, times, sorted } = bench;
        let transition = &self.found.rules[index];
        let range = by_rule.range(index);
        let took = &by_rule.took[range.clone()];
        // Whole numbers sort faster than floats.
        ordered.clear();
        ordered.extend_from_slice(took);
        ordered.sort_unstable();
        times.clear();
        times.extend(took.iter().map(|&took| seconds(took)));
        sorted.clear();
        sorted.extend(ordered.iter().map(|&took| seconds(took)));
        let is_device = self.chains.kind(transition.chain) == ChainKind::Device;
        let trigger = search.as_mut().filter(|_| is_device).and_then(|search| {
            let states = (transition.current, transition.next);
            search.trigger(&by_rule.events[range], times, sorted, states)
        });
        Times { clusters: cluster(times, sorted, self.parameters, self.resolution), trigger }
    }
}

/// What a thread works with, kept from one transition to the next.
#[derive(Default)]
struct Bench<'a> {
    search: Option<Search<'a>>,
    ordered: Vec<Nanoseconds>,
    times: Vec<f64>,
    sorted: Vec<f64>,
}

fn seconds(nanoseconds: Nanoseconds) -> f64 {
    nanoseconds as f64 / SECOND as f64
}

/// Clusters the instances of one transition, given in the order they happened and in that of size.
fn cluster(
    times: &[f64],
    sorted: &[f64],
    parameters: &Parameters,
    resolution: Nanoseconds,
) -> Vec<TimeCluster> {
    match parameters.timing {
        Timing::Plat => CskMeans {
            k: parameters.k,
            epsilon: parameters.epsilon,
            single_cluster_span_s: parameters.single_cluster_span_s,
            merge_distance_s: parameters.merge_distance_s,
            minimum_support: parameters.minimum_support,
        }
        .cluster(sorted),
        Timing::Adaptive => {
            let mut clusters = optimal::cluster(sorted, seconds(resolution));
            if clusters.len() > 1 {
                let kinds: Vec<u32> = times
                    .iter()
                    .map(|&time| timing::nearest(&clusters, time).unwrap_or(0) as u32)
                    .collect();
                for (cluster, kind) in clusters.iter_mut().zip(0..) {
                    cluster.dispersion = dispersion::of_share(&kinds, kind) as f32;
                }
            } else if let Some(only) = clusters.first_mut() {
                only.dispersion = dispersion::of_mean(times) as f32;
            }
            clusters
        }
    }
}
