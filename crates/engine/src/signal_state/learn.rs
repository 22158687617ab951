//! Learning the nominal model from fault-free logs (Ghosh 2016, sections 2.4.1 and 2.4.2).

use std::borrow::Borrow;

use thiserror::Error;

use crate::log::{ChangeLog, Nanoseconds, SECOND, SignalIndex};
use crate::naming::{NamingError, NamingRule};
use crate::plant::Plant;
use crate::symbols::SymbolTable;
use crate::timing::csk_means::CskMeans;
use crate::timing::{self, TimeCluster, optimal};

use super::chains::{ChainIndex, ChainKind, Chains};
use super::dispersion;
use super::enabling::{Happening, Search};
use super::events::{Meaning, Row, Values, is_image};
use super::model::{Learned, NominalModel};
use super::order::ScanOrder;
use super::parameters::{ParameterError, Parameters, Timing};
use super::rules::{Rule, row_of};
use super::states::{NO_STATE, StateId, States};

/// Why nothing can be learned.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LearnError {
    /// No event in any log.
    #[error("nothing to learn from: the log holds no change of any signal")]
    NoEvents,
    /// A parameter out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A naming rule that is none.
    #[error(transparent)]
    Naming(#[from] NamingError),
    /// `starting` names a device the logs do not have.
    #[error("starting signal '{device}={signal}': {problem}")]
    Starting {
        /// `Group-Device` as given.
        device: String,
        /// Signal as given.
        signal: String,
        /// What is wrong.
        problem: String,
    },
}

/// Learns from one or more logs of the same plant, each a run of its own.
///
/// # Errors
/// No event at all, a parameter out of range, an unknown starting signal, a naming rule that is
/// none.
pub fn learn<L: Borrow<ChangeLog>>(
    logs: &[L],
    table: &SymbolTable,
    parameters: &Parameters,
) -> Result<NominalModel, LearnError> {
    parameters.validate()?;
    let logs: Vec<&ChangeLog> = logs.iter().map(Borrow::borrow).collect();
    let logs = logs.as_slice();
    let rule = NamingRule::parse(&parameters.naming)?;
    let symbols = all_symbols(logs);
    let mut plant = Plant::arrange(&symbols, table, &rule);
    mark_words(&mut plant, logs);
    let order = (parameters.timing == Timing::Adaptive).then(|| ScanOrder::of(&plant));
    let mut states = States::new(plant.signals.len());
    let events = read_events(logs, &plant, &mut states, order.as_ref());
    if events.is_empty() {
        return Err(LearnError::NoEvents);
    }
    choose_starting_signals(&mut plant, &events, parameters)?;
    let chains = Chains::of(&plant);
    let resolution = resolution(logs, parameters);
    let transitions = walk(&events, &chains, states.len());
    let search = (parameters.timing == Timing::Adaptive)
        .then(|| Search::new(&events, &plant, &states, resolution));
    let rules = rules(&transitions, &chains, states.len(), parameters, resolution, search);
    let learned = Learned {
        events: events.len() as u64,
        duration: logs.iter().copied().filter_map(span).sum(),
        resolution,
        scan_window: scan_window(logs, parameters),
        longest_pause: longest_pauses(&events, &chains, plant.groups.len()),
        group_start: group_starts(&events, &chains, plant.groups.len()),
    };
    Ok(NominalModel::assemble(plant, states, rules, learned, parameters.clone()))
}

fn span(log: &ChangeLog) -> Option<Nanoseconds> {
    Some(log.time.last()?.saturating_sub(*log.time.first()?))
}

/// Symbols of all logs in the order they are first named.
fn all_symbols(logs: &[&ChangeLog]) -> Vec<String> {
    let mut seen = std::collections::HashSet::new();
    logs.iter()
        .flat_map(|log| &log.signals)
        .filter(|symbol| seen.insert(symbol.as_str()))
        .cloned()
        .collect()
}

/// A signal that ever holds a value other than 0 and 1 is a word.
fn mark_words(plant: &mut Plant, logs: &[&ChangeLog]) {
    for log in logs {
        let to_plant = indices(log, plant);
        for (&signal, &value) in log.signal.iter().zip(&log.value) {
            if value & !1 != 0 {
                plant.signals[to_plant[signal as usize] as usize].word = true;
            }
        }
    }
}

/// The plant's index of each of a log's signals.
fn indices(log: &ChangeLog, plant: &Plant) -> Vec<SignalIndex> {
    let by_symbol: std::collections::HashMap<&str, SignalIndex> =
        plant.signals.iter().zip(0..).map(|(s, index)| (s.symbol.as_str(), index)).collect();
    log.signals.iter().map(|symbol| by_symbol.get(symbol.as_str()).copied().unwrap_or(0)).collect()
}

/// All events of all logs, scans in canonical order where `order` is given.
fn read_events(
    logs: &[&ChangeLog],
    plant: &Plant,
    states: &mut States,
    order: Option<&ScanOrder>,
) -> Vec<Happening> {
    let mut events = Vec::with_capacity(logs.iter().map(|log| log.len()).sum());
    let mut run = 0;
    for log in logs {
        let to_plant = indices(log, plant);
        let mut values = Values::new(plant.signals.len());
        let mut gaps = log.gaps.iter().peekable();
        run += 1;
        let mut resynchronise = is_image(first_values(log));
        let mut start = 0;
        let mut scan: Vec<Row> = Vec::new();
        while start < log.len() {
            let time = log.time[start];
            let end = start + log.time[start..].iter().take_while(|&&t| t == time).count();
            scan.clear();
            scan.extend((start..end).map(|row| Row {
                time,
                signal: to_plant[log.signal[row] as usize],
                value: log.value[row],
            }));
            start = end;
            while gaps.next_if(|gap| gap.end <= time).is_some() {
                run += 1;
                resynchronise = true;
                values.doubt();
            }
            if let Some(order) = order {
                order.sort(&mut scan);
            }
            for row in &scan {
                let meaning = values.take(row.signal, row.value);
                if meaning == Meaning::Sample || resynchronise {
                    continue;
                }
                let state = states.intern(row.signal, row.value);
                let doubtful = meaning == Meaning::Doubtful;
                events.push(Happening { time, signal: row.signal, state, run, doubtful });
            }
            resynchronise = false;
        }
    }
    events
}

fn first_values(log: &ChangeLog) -> impl Iterator<Item = i64> + '_ {
    let first = log.time.first().copied();
    log.time
        .iter()
        .zip(&log.value)
        .take_while(move |(time, _)| Some(**time) == first)
        .map(|(_, value)| *value)
}

/// The first signal of each device with an event stands for it, unless the user says otherwise.
fn choose_starting_signals(
    plant: &mut Plant,
    events: &[Happening],
    parameters: &Parameters,
) -> Result<(), LearnError> {
    let device_of: Vec<u32> = plant.signals.iter().map(|signal| signal.device as u32).collect();
    let mut first = vec![SignalIndex::MAX; plant.devices.len()];
    for event in events {
        let first = &mut first[device_of[event.signal as usize] as usize];
        if *first == SignalIndex::MAX {
            *first = event.signal;
        }
    }
    for (device, first) in plant.devices.iter_mut().zip(first) {
        if first != SignalIndex::MAX {
            device.starting.get_or_insert(first);
        }
    }
    for (name, signal) in &parameters.starting {
        let error = |problem: &str| LearnError::Starting {
            device: name.clone(),
            signal: signal.clone(),
            problem: problem.to_owned(),
        };
        let device = (0..plant.devices.len())
            .find(|&d| plant.device_name(d) == *name || plant.devices[d].name == *name)
            .ok_or_else(|| error("the logs hold no such device; give it as Group-Device"))?;
        let index = (0..plant.signals.len() as SignalIndex)
            .find(|&s| {
                let candidate = &plant.signals[s as usize];
                candidate.device == device && candidate.name == *signal
            })
            .ok_or_else(|| error("the device has no such signal"))?;
        plant.devices[device].starting = Some(index);
    }
    Ok(())
}

/// Every transition of every chain, and the instances of each in the order they happened.
struct Transitions {
    rules: Vec<Found>,
    /// In the order of the log.
    instances: Vec<Instance>,
}

/// One time a transition happened.
#[derive(Clone, Copy)]
struct Instance {
    rule: u32,
    /// The event it ended with.
    event: u32,
    took: Nanoseconds,
}

struct Found {
    chain: ChainIndex,
    current: StateId,
    next: StateId,
    count: u32,
    uncounted: u32,
}

#[derive(Clone, Copy)]
struct Here {
    state: StateId,
    time: Nanoseconds,
    /// True while `state` was entered at the first time after a start or gap.
    first: bool,
}

fn walk(events: &[Happening], chains: &Chains, states: usize) -> Transitions {
    let nowhere = Here { state: NO_STATE, time: 0, first: true };
    let mut here = vec![nowhere; chains.len()];
    let mut known = Known::new(states);
    let mut found =
        Transitions { rules: Vec::new(), instances: Vec::with_capacity(events.len() * 5 / 4) };
    let mut run = 0;
    for (index, event) in (0..).zip(events) {
        if std::mem::replace(&mut run, event.run) != event.run {
            here.fill(nowhere);
        }
        let group = chains.group_chain(event.signal).map(|chain| (chain, ChainKind::Group));
        let device = (chains.device_chain(event.signal), ChainKind::Device);
        for (chain, kind) in std::iter::once(device).chain(group) {
            if event.doubtful {
                here[chain] = nowhere;
                continue;
            }
            let before = here[chain];
            // Signals that were ON when the log began were all written at its first time.
            let first = before.state == NO_STATE || (before.first && before.time == event.time);
            here[chain] = Here { state: event.state, time: event.time, first };
            if before.state == NO_STATE {
                continue;
            }
            let new = found.rules.len() as u32;
            let rule = known.rule(before.state, kind, event.state, new);
            if rule == new {
                found.rules.push(Found {
                    chain,
                    current: before.state,
                    next: event.state,
                    count: 0,
                    uncounted: 0,
                });
            }
            if before.first {
                found.rules[rule as usize].uncounted += 1;
            }
            let took = event.time - before.time;
            found.instances.push(Instance { rule, event: index, took });
        }
    }
    let mut counts = vec![0u32; found.rules.len()];
    for instance in &found.instances {
        counts[instance.rule as usize] += 1;
    }
    for (rule, count) in found.rules.iter_mut().zip(counts) {
        rule.count = count;
    }
    found
}

/// The transitions met so far. Nearly all states are entered from one other only, so the last
/// transition into a state is tried first.
struct Known {
    /// By row of the state entered: where from, and the rule.
    last: Vec<(StateId, u32)>,
    by_row: Vec<Vec<(StateId, u32)>>,
}

impl Known {
    fn new(states: usize) -> Self {
        Self { last: vec![(NO_STATE, 0); 2 * states], by_row: vec![Vec::new(); 2 * states] }
    }

    /// The rule of a transition, which is `new` where it is met for the first time.
    #[inline]
    fn rule(&mut self, current: StateId, kind: ChainKind, next: StateId, new: u32) -> u32 {
        let last = &mut self.last[row_of(next, kind)];
        if last.0 != current {
            let row = &mut self.by_row[row_of(current, kind)];
            let known = row.iter().find(|(to, _)| *to == next).map(|&(_, rule)| rule);
            *last = (current, known.unwrap_or(new));
            if known.is_none() {
                row.push((next, new));
            }
        }
        last.1
    }
}

/// The instances of every rule side by side, each in the order they happened.
struct ByRule {
    end: Vec<usize>,
    took: Vec<Nanoseconds>,
    events: Vec<u32>,
}

impl ByRule {
    fn of(found: &Transitions) -> Self {
        let mut end = vec![0usize; found.rules.len() + 1];
        for (rule, transition) in found.rules.iter().enumerate() {
            end[rule + 1] = end[rule] + transition.count as usize;
        }
        let mut place = end.clone();
        let mut took = vec![0; found.instances.len()];
        let mut events = vec![0u32; found.instances.len()];
        for instance in &found.instances {
            let at = &mut place[instance.rule as usize];
            took[*at] = instance.took;
            events[*at] = instance.event;
            *at += 1;
        }
        Self { end, took, events }
    }

    fn range(&self, rule: usize) -> std::ops::Range<usize> {
        self.end[rule]..self.end[rule + 1]
    }
}

/// Clusters times, looks for enabling events and computes probabilities.
fn rules(
    found: &Transitions,
    chains: &Chains,
    states: usize,
    parameters: &Parameters,
    resolution: Nanoseconds,
    mut search: Option<Search<'_>>,
) -> Vec<Rule> {
    let branch_dispersion = branch_dispersion(found, chains, states);
    let by_rule = ByRule::of(found);
    let mut position = vec![0u32; chains.len()];
    let mut rules = Vec::with_capacity(found.rules.len());
    let (mut ordered, mut times, mut sorted) = (Vec::new(), Vec::new(), Vec::new());
    for (index, transition) in found.rules.iter().enumerate() {
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
        let is_device = chains.kind(transition.chain) == ChainKind::Device;
        let trigger = search.as_mut().filter(|_| is_device).and_then(|search| {
            let states = (transition.current, transition.next);
            search.trigger(&by_rule.events[range], &times, &sorted, states)
        });
        rules.push(Rule {
            chain: transition.chain,
            current: transition.current,
            next: transition.next,
            count: transition.count,
            uncounted: transition.uncounted,
            probability: 0.0,
            sequence: index as u32,
            position: position[transition.chain],
            dispersion: branch_dispersion[index],
            clusters: cluster(&times, &sorted, parameters, resolution).into(),
            trigger: trigger.map(Box::new),
        });
        position[transition.chain] += 1;
    }
    set_probabilities(&mut rules, chains);
    rules
}

fn seconds(nanoseconds: Nanoseconds) -> f64 {
    nanoseconds as f64 / SECOND as f64
}

/// Shares of each transition among those out of its state.
pub(super) fn set_probabilities(rules: &mut [Rule], chains: &Chains) {
    let mut out = hashbrown::HashMap::<(ChainKind, StateId), u64>::new();
    for rule in rules.iter() {
        *out.entry((chains.kind(rule.chain), rule.current)).or_default() += u64::from(rule.count);
    }
    for rule in rules.iter_mut() {
        let total = out[&(chains.kind(rule.chain), rule.current)];
        rule.probability = f64::from(rule.count) / total as f64;
    }
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
                    cluster.dispersion = dispersion::of_share(&kinds, kind);
                }
            } else if let Some(only) = clusters.first_mut() {
                only.dispersion = dispersion::of_mean(times);
            }
            clusters
        }
    }
}

/// Dispersion of every branch: of "this transition was taken" among departures from its state.
fn branch_dispersion(found: &Transitions, chains: &Chains, states: usize) -> Vec<f64> {
    let row = |rule: &Found| row_of(rule.current, chains.kind(rule.chain));
    // Most states are left in one way only.
    let mut ways = vec![0u32; 2 * states];
    for rule in &found.rules {
        ways[row(rule)] += 1;
    }
    let rows: Vec<Option<usize>> =
        found.rules.iter().map(row).map(|row| (ways[row] > 1).then_some(row)).collect();
    let mut departures: Vec<Vec<u32>> = vec![Vec::new(); 2 * states];
    for instance in &found.instances {
        if let Some(row) = rows[instance.rule as usize] {
            departures[row].push(instance.rule);
        }
    }
    rows.iter()
        .zip(0..)
        .map(|(row, index)| row.map_or(1.0, |row| dispersion::of_share(&departures[row], index)))
        .collect()
}

/// Smallest time difference that means something: the scan interval where known, else the
/// resolution the logger writes times with.
fn resolution(logs: &[&ChangeLog], parameters: &Parameters) -> Nanoseconds {
    let given = parameters.scan_interval_s.map(|s| (s * SECOND as f64) as Nanoseconds);
    let scan = given.or_else(|| logs.iter().filter_map(|log| log.scan_interval).max());
    scan.unwrap_or_else(|| logger_resolution(logs)).clamp(FINEST, SECOND)
}

/// Finer times are taken as noise.
const FINEST: Nanoseconds = SECOND / 1000;
/// Share of times that may lie off the logger's grid, when a clock was set or a source is finer.
const OFF_GRID: f64 = 0.05;

/// The coarsest of the usual grids (1 s, 500 ms, 200 ms, … 1 ms) nearly all times lie on.
fn logger_resolution(logs: &[&ChangeLog]) -> Nanoseconds {
    let grids = [1000, 500, 200, 100, 50, 20, 10, 5, 2].map(|ms| ms * FINEST);
    let rows: usize = logs.iter().map(|log| log.len()).sum();
    let allowed = (OFF_GRID * rows as f64) as usize;
    let fits = |grid: Nanoseconds| {
        let times = logs.iter().flat_map(|log| &log.time);
        // A grid that does not fit is given up with the first row too many.
        times.filter(|&&time| time % grid != 0).nth(allowed).is_none()
    };
    grids.into_iter().find(|&grid| fits(grid)).unwrap_or(FINEST)
}

/// Scans may come early by one part in this many of their interval.
const SCAN_JITTER: Nanoseconds = 4;

/// Events closer than this have no order; zero where only equal times are of one scan.
///
/// A little less than the interval: scans jitter, and two in a row are not one because the second
/// came early; nor must a live finding wait for a third.
fn scan_window(logs: &[&ChangeLog], parameters: &Parameters) -> Nanoseconds {
    let given = parameters.scan_interval_s.map(|s| (s * SECOND as f64) as Nanoseconds);
    let interval = given.or_else(|| logs.iter().filter_map(|log| log.scan_interval).max());
    interval.map_or(0, |interval| interval - interval / SCAN_JITTER)
}

/// Longest time between two events of each group.
fn longest_pauses(events: &[Happening], chains: &Chains, groups: usize) -> Vec<Nanoseconds> {
    let mut last: Vec<Option<Nanoseconds>> = vec![None; groups];
    let mut longest = vec![0; groups];
    let mut run = 0;
    for event in events {
        if std::mem::replace(&mut run, event.run) != event.run {
            last.fill(None);
        }
        let group = chains.group_of(chains.device_chain(event.signal));
        if let Some(last) = last[group] {
            longest[group] = longest[group].max(event.time - last);
        }
        last[group] = Some(event.time);
    }
    longest
}

/// The first signal-state of each group's chain: its return closes a group cycle.
fn group_starts(events: &[Happening], chains: &Chains, groups: usize) -> Vec<StateId> {
    let mut starts = vec![NO_STATE; groups];
    for event in events {
        if let Some(chain) = chains.group_chain(event.signal) {
            let start = &mut starts[chains.group_of(chain)];
            if *start == NO_STATE {
                *start = event.state;
            }
        }
    }
    starts
}
