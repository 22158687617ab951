//! What the events of a plant, or of a part of it, teach: each group by itself, so that what is
//! worked with is small and stays near.

use crate::log::{Nanoseconds, SECOND};
use crate::plant::{Plant, SignalClass};
use crate::signal_state::chains::Chains;
use crate::signal_state::enabling::{Happenings, Timed, Together};
use crate::signal_state::parameters::{Parameters, Timing};
use crate::signal_state::rules::Rule;
use crate::signal_state::states::{StateId, States};

use super::branches;
use super::instances::{Instances, OfRule};
use super::partners;
use super::reading::{Events, GroupEvents};
use super::share_out::{share_out, threads_for};
use super::timing::{Bench, Study, Times};
use super::walk::{Found, Walk, Walker};

/// Transitions a thread takes at once.
const AT_ONCE: usize = 256;

/// What events teach.
pub(super) struct Taught {
    /// By group, in the order of first appearance.
    pub(super) rules: Vec<Rule>,
    /// By rule: the event it first ended with.
    pub(super) first: Vec<u32>,
    /// By group.
    pub(super) longest_pause: Vec<Nanoseconds>,
    pub(super) group_start: Vec<StateId>,
}

/// Learns from the events of a plant whose starting signals are known.
pub(super) fn teach(
    events: &Events,
    plant: &Plant,
    states: &States,
    parameters: &Parameters,
    resolution: Nanoseconds,
) -> Taught {
    let is_output = |state| {
        let (signal, _) = states.signal_value(state);
        plant.signals[signal as usize].class == SignalClass::Output
    };
    let teacher = Teacher {
        events,
        plant,
        chains: &Chains::of(plant),
        states,
        is_output: &(0..states.len() as StateId).map(is_output).collect::<Vec<_>>(),
        study: Study { parameters, resolution },
    };
    assembled(teacher.all(), teacher.chains.len())
}

/// What one group teaches.
struct OfGroup {
    /// In the order of first appearance.
    rules: Vec<Rule>,
    first: Vec<u32>,
    longest_pause: Nanoseconds,
    start: StateId,
}

struct Teacher<'a> {
    events: &'a Events,
    plant: &'a Plant,
    chains: &'a Chains,
    states: &'a States,
    is_output: &'a [bool],
    study: Study<'a>,
}

/// What a thread works with, kept from one group to the next.
struct Desk<'a> {
    walker: Walker<'a>,
    instances: Instances,
    bench: Bench,
}

impl<'a> Teacher<'a> {
    /// All groups: large ones one after the other on all threads, small ones beside one another.
    fn all(&self) -> Vec<OfGroup> {
        let groups = &self.events.groups;
        let size = |group: usize| groups[group].happenings.len();
        let (large, small): (Vec<usize>, Vec<usize>) =
            (0..groups.len()).partition(|&group| threads_for(size(group)) > 1);
        let mut desk = self.desk();
        let mut taught: Vec<(usize, OfGroup)> = Vec::with_capacity(groups.len());
        for group in large {
            taught.push((group, self.group(&mut desk, &groups[group], threads_for(size(group)))));
        }
        let threads = threads_for(small.iter().copied().map(size).sum()).min(small.len());
        let one = |desk: &mut Desk<'a>, task: usize| self.group(desk, &groups[small[task]], 1);
        let of_small = share_out(small.len(), threads, &mut desk, || self.desk(), one);
        taught.extend(small.iter().copied().zip(of_small));
        taught.sort_unstable_by_key(|(group, _)| *group);
        taught.into_iter().map(|(_, of_group)| of_group).collect()
    }

    fn desk(&self) -> Desk<'a> {
        Desk {
            walker: Walker::new(self.chains, self.states, &self.events.entries),
            instances: Instances::default(),
            bench: self.bench(),
        }
    }

    fn bench(&self) -> Bench {
        Bench::new(self.states.len())
    }

    fn group(&self, desk: &mut Desk<'_>, events: &GroupEvents, threads: usize) -> OfGroup {
        let Desk { walker, instances, bench } = desk;
        let walk = walker.walk(&events.happenings);
        instances.sort(walk, self.chains);
        let instances = &*instances;
        let happenings = Happenings {
            happenings: &events.happenings,
            entries: &walk.entries,
            run_starts: &walk.run_starts,
            is_output: self.is_output,
            resolution_s: self.study.resolution as f64 / SECOND as f64,
        };
        // What happens at one time of a cycle looks back over the same events.
        let in_order = walk.in_order(self.chains);
        let times_of = |bench: &mut Bench, chunk: usize| -> Vec<Times> {
            let rules = in_order.iter().skip(chunk * AT_ONCE).take(AT_ONCE);
            let times = rules.map(|&rule| {
                let instances = instances.of(walk, rule);
                self.study.times(
                    &walk.rules[rule],
                    instances,
                    (happenings, &walk.first_steps),
                    bench,
                )
            });
            times.collect()
        };
        let chunks = in_order.len().div_ceil(AT_ONCE);
        let times = share_out(chunks, threads, bench, || self.bench(), times_of);
        let mut times: Vec<Times> = times.into_iter().flatten().collect();
        let (plant, states) = (self.plant, self.states);
        let group = partners::Group { walk, instances, happenings, plant, states };
        partners::take_over(&group, &in_order, &mut times);
        self.look_again(&mut times, &in_order, (walk, instances, happenings));
        let ways = branches::ways(walk);
        let found = in_order.iter().map(|&rule| (&walk.rules[rule], ways[rule]));
        let rules = found.clone().zip(times).map(|((found, way), times)| Rule {
            chain: found.chain,
            current: found.current,
            next: found.next,
            count: found.count,
            uncounted: found.uncounted,
            odd_at_start: times.odd_at_start,
            probability: way.probability,
            sequence: 0,
            position: 0,
            dispersion: way.dispersion as f32,
            clusters: times.clusters.into(),
            trigger: times.explanation.trigger.map(Box::new),
        });
        OfGroup {
            rules: rules.collect(),
            first: found.map(|(found, _)| events.order[found.first as usize]).collect(),
            longest_pause: walk.longest_pause,
            start: walk.start,
        }
    }
}

/// What a group's events come to.
type OfEvents<'a> = (&'a Walk, &'a Instances, Happenings<'a>);

impl Teacher<'_> {
    /// Once what all transitions wait for has been looked for, some are known to wait for what bears
    /// their own time.
    fn look_again(&self, times: &mut [Times], in_order: &[usize], of: OfEvents<'_>) {
        // PLAT looks for nothing.
        if self.study.parameters.timing != Timing::Adaptive {
            return;
        }
        let (walk, instances, happenings) = of;
        let mut places = Vec::new();
        let mut timed: Vec<Timed<'_>> = Vec::new();
        for (place, (&rule, times)) in in_order.iter().zip(times.iter_mut()).enumerate() {
            if let OfRule::Device(instances) = instances.of(walk, rule) {
                let Found { current, next, .. } = walk.rules[rule];
                let explanation = &mut times.explanation;
                places.push(place);
                timed.push(Timed { current, next, instances, explanation });
            }
        }
        let together = Together { index: happenings, plant: self.plant, states: self.states };
        for changed in together.explain(&mut timed) {
            let rule = in_order[places[changed]];
            let of_rule = (&walk.rules[rule], instances.of(walk, rule));
            times[places[changed]].count_odd_starts(of_rule, (happenings, &walk.first_steps));
        }
    }
}

/// All groups together, their rules numbered by first appearance in the plant and in their chains.
fn assembled(groups: Vec<OfGroup>, chains: usize) -> Taught {
    let number = groups.iter().map(|of_group| of_group.rules.len()).sum();
    let mut taught = Taught {
        rules: Vec::with_capacity(number),
        first: Vec::with_capacity(number),
        longest_pause: groups.iter().map(|of_group| of_group.longest_pause).collect(),
        group_start: groups.iter().map(|of_group| of_group.start).collect(),
    };
    for of_group in groups {
        taught.rules.extend(of_group.rules);
        taught.first.extend(of_group.first);
    }
    // Those of one event are of one group, and in order already.
    let mut in_order: Vec<(u32, u32)> = taught.first.iter().copied().zip(0..).collect();
    in_order.sort_unstable();
    for ((_, rule), sequence) in in_order.into_iter().zip(0..) {
        taught.rules[rule as usize].sequence = sequence;
    }
    let mut positions = vec![0u32; chains];
    for rule in &mut taught.rules {
        rule.position = positions[rule.chain];
        positions[rule.chain] += 1;
    }
    taught
}
