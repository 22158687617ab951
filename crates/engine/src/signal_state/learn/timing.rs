//! The times of every transition: clustered, and measured from what it really waits for.

use crate::log::{Nanoseconds, SECOND};
use crate::signal_state::dispersion;
use crate::signal_state::enabling::{
    Delayed, Entry, Explanation, Happenings, Search, Usual, has_odd,
};
use crate::signal_state::parameters::{Parameters, Timing};
use crate::timing::csk_means::CskMeans;
use crate::timing::limits::BODY_INSTANCES;
use crate::timing::{self, TimeCluster, optimal};

use super::instances::OfRule;
use super::walk::Found;

/// What is learned of the times of one transition.
pub(super) struct Times {
    pub(super) clusters: Vec<TimeCluster>,
    pub(super) explanation: Explanation,
    /// First steps after a start or gap that took a time that is not usual.
    pub(super) odd_at_start: u32,
}

impl Times {
    /// The times it is judged by: delays from what it waits for, where that is known.
    pub(super) fn judged(&self) -> &[TimeCluster] {
        self.explanation.trigger.as_ref().map_or(&self.clusters, |trigger| &trigger.clusters)
    }

    /// Lets it wait for something else than was found.
    pub(super) fn wait_for(
        &mut self,
        delayed: Delayed,
        (rule, instances): (&Found, OfRule<'_>),
        (happenings, first_steps): (Happenings<'_>, &[u32]),
    ) {
        let found = std::mem::replace(&mut self.explanation, Explanation::NONE);
        self.explanation = found.or_waits_for(delayed, happenings.resolution_s);
        self.count_odd_starts((rule, instances), (happenings, first_steps));
    }

    /// Counts the first steps that took a time that is not usual, of those they are judged by.
    pub(super) fn count_odd_starts(
        &mut self,
        (rule, instances): (&Found, OfRule<'_>),
        (happenings, first_steps): (Happenings<'_>, &[u32]),
    ) {
        let odd = match instances {
            OfRule::Device(entries) if rule.uncounted > 0 => {
                let is_first = |entry: &Entry| first_steps.binary_search(&entry.place).is_ok();
                let times = match &self.explanation.trigger {
                    Some(trigger) => trigger.delays(happenings, entries, rule.next),
                    None => entries.iter().map(|entry| Some(seconds(entry.took))).collect(),
                };
                let first = entries.iter().zip(times).filter(|(entry, _)| is_first(entry));
                let times = first.filter_map(|(_, time)| time);
                times.filter(|&time| is_odd(self.judged(), time)).count()
            }
            OfRule::Device(_) => 0,
            OfRule::Group(_) => rule.uncounted as usize,
        };
        self.odd_at_start = odd as u32;
    }
}

/// How times are learned.
#[derive(Clone, Copy)]
pub(super) struct Study<'a> {
    pub(super) parameters: &'a Parameters,
    pub(super) resolution: Nanoseconds,
}

impl Study<'_> {
    /// The times of a transition; `happenings` is where enabling events are looked for, and
    /// `first_steps` says which instances were a device's first after a start or gap.
    pub(super) fn times(
        self,
        rule: &Found,
        instances: OfRule<'_>,
        (happenings, first_steps): (Happenings<'_>, &[u32]),
        bench: &mut Bench,
    ) -> Times {
        let Bench { search, took, times, sorted } = bench;
        took.clear();
        match instances {
            OfRule::Device(entries) => took.extend(entries.iter().map(|entry| entry.took)),
            OfRule::Group(steps) => took.extend_from_slice(steps),
        }
        times.clear();
        times.extend(took.iter().map(|&took| seconds(took)));
        // Whole numbers sort faster than floats.
        took.sort_unstable();
        sorted.clear();
        sorted.extend(took.iter().map(|&took| seconds(took)));
        let clusters = cluster(times, sorted, self.parameters, self.resolution);
        let explanation = match instances {
            OfRule::Device(entries) if self.parameters.timing == Timing::Adaptive => {
                let way = (rule.current, rule.next);
                let found = search.explain(happenings, entries, sorted, way);
                let trigger = found.trigger.as_ref();
                let judged = trigger.map_or(clusters.as_slice(), |trigger| &trigger.clusters);
                let usual = has_odd(judged, happenings.resolution_s)
                    .then(|| Usual::of(happenings, entries, way, trigger, judged));
                match usual.flatten().and_then(|usual| usual.partner()) {
                    Some(joined) => found.or_waits_for(joined, happenings.resolution_s),
                    None => found,
                }
            }
            _ => Explanation::NONE,
        };
        let mut times = Times { clusters, explanation, odd_at_start: 0 };
        times.count_odd_starts((rule, instances), (happenings, first_steps));
        times
    }
}

/// True where a time is of a cluster too small to be a usual time.
fn is_odd(clusters: &[TimeCluster], time: f64) -> bool {
    let of = timing::nearest(clusters, time).and_then(|at| clusters.get(at));
    of.is_some_and(|cluster| cluster.instances < BODY_INSTANCES)
}

/// What a thread works with, kept from one transition to the next.
pub(super) struct Bench {
    search: Search,
    took: Vec<Nanoseconds>,
    times: Vec<f64>,
    sorted: Vec<f64>,
}

impl Bench {
    /// For a plant of so many states.
    pub(super) fn new(states: usize) -> Self {
        let (took, times, sorted) = (Vec::new(), Vec::new(), Vec::new());
        Self { search: Search::new(states), took, times, sorted }
    }
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
