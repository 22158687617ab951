//! Guards from a log: at every marking, what was done there, after how many of what, and how soon.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::error::ControlError;
use super::follower::{Follower, needs_decision};
use super::guards::{FORMAT, Guards, Point};
use super::program::Program;
use super::tree::{Counter, Tree};
use crate::log::{ChangeLog, Nanoseconds, SECOND};
use crate::process::petri::{Marking, TransitionIndex};

/// Splits behind one another; a program of more counters in one place is no program.
const DEEPEST: usize = 6;
/// A timer's delays differ by no more than this share of themselves, or one reaction.
const TIMER_SPREAD: f64 = 0.2;

/// What guards are learned with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearnParameters {
    /// The PLC acts at once if it acts within this time, in seconds; longer is a timer.
    pub reaction_s: f64,
}

/// What was learned, and how well the log follows the net.
#[derive(Debug, Clone, PartialEq)]
pub struct Learned {
    /// The guards.
    pub guards: Guards,
    /// Events that followed the net.
    pub events: usize,
    /// Runs that began.
    pub runs: usize,
    /// How often the log left the net.
    pub departures: usize,
}

type Counts = HashMap<(TransitionIndex, Option<TransitionIndex>), u32>;

/// What the log did at one rest.
#[derive(Debug, Clone)]
struct Sample {
    chosen: TransitionIndex,
    output: bool,
    after: Option<TransitionIndex>,
    rested_s: f64,
    counts: Counts,
}

/// Learns guards from change logs of the machine.
///
/// # Errors
/// Logs that never follow the net.
pub fn learn(
    program: &Arc<Program>,
    logs: &[&ChangeLog],
    parameters: LearnParameters,
) -> Result<Learned, ControlError> {
    let mut watcher = Watcher {
        follower: Follower::new(Arc::clone(program), Guards::default(), None)?,
        reset_by: resetting(program),
        counts: Counts::new(),
        samples: HashMap::new(),
        deciding: HashSet::new(),
        learned: Learned { guards: Guards::default(), events: 0, runs: 0, departures: 0 },
        following: false,
        patience: (parameters.reaction_s * SECOND as f64) as Nanoseconds,
    };
    for log in logs {
        watcher.watch(log);
    }
    if watcher.learned.events == 0 {
        return Err(ControlError::NeverFollowed);
    }
    let mut points: Vec<Point> = Vec::new();
    for (marking, samples) in &watcher.samples {
        let decides = watcher.deciding.contains(marking);
        points.push(point(program, marking, samples, decides, parameters));
    }
    points.sort_by(|a, b| a.marked.cmp(&b.marked));
    watcher.learned.guards = Guards { format: FORMAT, points };
    Ok(watcher.learned)
}

/// What can reset a counter beside the beginning of a run: the outputs.
fn resetting(program: &Program) -> Vec<TransitionIndex> {
    (0..program.activities.len() as TransitionIndex).filter(|&t| program.is_output(t)).collect()
}

struct Watcher {
    follower: Follower,
    reset_by: Vec<TransitionIndex>,
    /// Of each transition since the run began (`None`), and since each output; missing while that
    /// output has not come.
    counts: Counts,
    samples: HashMap<Marking, Vec<Sample>>,
    deciding: HashSet<Marking>,
    learned: Learned,
    following: bool,
    patience: Nanoseconds,
}

impl Watcher {
    fn watch(&mut self, log: &ChangeLog) {
        let program = Arc::clone(&self.follower.program);
        let terminals: Vec<_> = log.signals.iter().map(|name| program.terminal(name)).collect();
        let mut image: Vec<Option<i64>> = vec![None; program.terminals.len()];
        let mut stuck_since = None;
        self.following = false;
        let mut row = 0;
        while row < log.time.len() {
            let now = log.time[row];
            let before = image.clone();
            let lost = log.gaps.iter().any(|gap| gap.start < now && now <= gap.end);
            self.following &= !lost;
            while row < log.time.len() && log.time[row] == now {
                if let Some(terminal) = terminals[log.signal[row] as usize] {
                    image[terminal] = Some(log.value[row]);
                }
                row += 1;
            }
            // A signal that has not been seen yet was the other thing before its first change.
            if !self.following {
                self.follower.told = before;
                if self.follower.input_opening(&image) && self.follower.open(&image, now).is_some()
                {
                    self.following = true;
                    self.opened();
                }
                if !self.following {
                    continue;
                }
            }
            while self.step(&image, now) {
                stuck_since = None;
            }
            let pending = |output| !self.follower.pending(&image, output).is_empty();
            if !pending(false) && !pending(true) {
                stuck_since = None;
            } else if now - *stuck_since.get_or_insert(now) >= self.patience {
                self.learned.departures += 1;
                self.following = false;
                stuck_since = None;
            }
        }
    }

    fn opened(&mut self) {
        self.counts.clear();
        self.learned.runs += 1;
        self.learned.events += 1;
        let Some(opening) = self.follower.run.first().copied() else { return };
        self.count(opening.transition, true);
    }

    fn step(&mut self, image: &[Option<i64>], now: Nanoseconds) -> bool {
        let way = self.follower.input_move(image).or_else(|| self.follower.output_move(image));
        let Some(way) = way else { return false };
        let ways = self.follower.ways();
        let marking = self.follower.marking.clone();
        if needs_decision(&self.follower.program, &ways) {
            self.deciding.insert(marking.clone());
        }
        self.samples.entry(marking).or_default().push(Sample {
            chosen: way.transition,
            output: self.follower.program.is_output(way.transition),
            after: self.follower.run.last().map(|fired| fired.transition),
            rested_s: self.follower.rested_s(now),
            counts: self.counts.clone(),
        });
        self.follower.fire(&way, now);
        self.learned.events += 1;
        self.learned.runs += usize::from(way.restarts);
        self.count(way.transition, way.restarts);
        true
    }

    fn count(&mut self, fired: TransitionIndex, restarts: bool) {
        let all: Vec<_> = (0..self.follower.program.activities.len() as TransitionIndex)
            .filter(|&t| self.follower.program.changes_of(t).is_some())
            .collect();
        for &counted in &all {
            if restarts {
                self.counts.insert((counted, None), 0);
            }
            if self.reset_by.contains(&fired) {
                self.counts.insert((counted, Some(fired)), 0);
            }
        }
        let resets = std::iter::once(None).chain(self.reset_by.iter().copied().map(Some));
        for reset in resets {
            if let Some(count) = self.counts.get_mut(&(fired, reset)) {
                *count += 1;
            }
        }
    }
}

fn point(
    program: &Program,
    marking: &Marking,
    samples: &[Sample],
    decides: bool,
    parameters: LearnParameters,
) -> Point {
    let mut contradicted = 0;
    let all: Vec<&Sample> = samples.iter().collect();
    let tree = grow(program, &all, 0, parameters, &mut contradicted);
    let says_more = decides
        || matches!(&tree, Tree::Output { after_s, .. } if *after_s > 0.0)
        || matches!(&tree, Tree::Count { .. });
    let after = samples.last().and_then(|sample| sample.after);
    Point {
        marked: program.marked(marking),
        after: after.map_or_else(String::new, |t| program.label(t).to_owned()),
        choice: says_more.then_some(tree),
        seen: samples.len() as u32,
        contradicted: if says_more { contradicted } else { 0 },
        longest_s: samples.iter().map(|sample| sample.rested_s).fold(0.0, f64::max),
    }
}

/// The outputs chosen; all inputs are one choice, to wait.
fn choices(samples: &[&Sample]) -> HashMap<Option<TransitionIndex>, usize> {
    let mut counted = HashMap::new();
    for sample in samples {
        *counted.entry(sample.output.then_some(sample.chosen)).or_insert(0) += 1;
    }
    counted
}

fn impurity(samples: &[&Sample]) -> f64 {
    let total = samples.len() as f64;
    let squares: f64 = choices(samples).values().map(|&n| (n as f64 / total).powi(2)).sum();
    total * (1.0 - squares)
}

fn grow(
    program: &Program,
    samples: &[&Sample],
    depth: usize,
    parameters: LearnParameters,
    contradicted: &mut u32,
) -> Tree {
    if choices(samples).len() > 1
        && depth < DEEPEST
        && let Some(split) = best_split(samples)
    {
        let value = |sample: &&&Sample| sample.counts.get(&split.feature).copied();
        let part = |reached: bool| -> Vec<&Sample> {
            samples
                .iter()
                .filter(|s| value(s).is_some_and(|v| (v >= split.preset) == reached))
                .copied()
                .collect()
        };
        let id = |t: TransitionIndex| program.net.transitions[t as usize].id.clone();
        let mut branch =
            |reached| Box::new(grow(program, &part(reached), depth + 1, parameters, contradicted));
        let (reached, below) = (branch(true), branch(false));
        return Tree::Count {
            counter: Counter { counts: id(split.feature.0), reset_by: split.feature.1.map(id) },
            preset: split.preset,
            reached,
            below,
        };
    }
    leaf(program, samples, parameters, contradicted)
}

fn leaf(
    program: &Program,
    samples: &[&Sample],
    parameters: LearnParameters,
    contradicted: &mut u32,
) -> Tree {
    let mut outputs: Vec<_> =
        choices(samples).into_iter().filter_map(|(what, n)| Some((n, what?))).collect();
    outputs.sort_unstable();
    let waits: Vec<f64> = samples.iter().filter(|s| !s.output).map(|s| s.rested_s).collect();
    let Some(&(_, output)) = outputs.last() else { return Tree::Wait };
    let acts: Vec<f64> =
        samples.iter().filter(|s| s.output && s.chosen == output).map(|s| s.rested_s).collect();
    let soonest = acts.iter().copied().fold(f64::INFINITY, f64::min);
    let latest = acts.iter().copied().fold(0.0, f64::max);
    let steady = latest - soonest <= parameters.reaction_s.max(TIMER_SPREAD * soonest);
    let timer = soonest > parameters.reaction_s && steady;
    // An input that came before the timer ran out says nothing against the timer.
    let against = waits.iter().filter(|&&rested_s| !timer || rested_s > latest).count();
    let others = samples.len() - waits.len() - acts.len();
    if against + others > acts.len() && waits.len() > acts.len() {
        *contradicted += (samples.len() - waits.len()) as u32;
        return Tree::Wait;
    }
    *contradicted += (against + others) as u32;
    Tree::Output {
        transition: program.net.transitions[output as usize].id.clone(),
        after_s: if timer { soonest } else { 0.0 },
    }
}

type Feature = (TransitionIndex, Option<TransitionIndex>);

struct Split {
    feature: Feature,
    preset: u32,
}

/// The count that tells the choices apart best. Among equals, the one of the event just before,
/// then one that each run begins anew: what a programmer would have counted.
fn best_split(samples: &[&Sample]) -> Option<Split> {
    let mut features: Vec<Feature> =
        samples.iter().flat_map(|sample| sample.counts.keys().copied()).collect();
    features.sort_unstable();
    features.dedup();
    let after: HashSet<_> = samples.iter().filter_map(|sample| sample.after).collect();
    let mut best: Option<(f64, bool, bool, Split)> = None;
    for feature in features {
        let known: Vec<(&Sample, u32)> =
            samples.iter().filter_map(|s| Some((*s, *s.counts.get(&feature)?))).collect();
        // A counter that has not begun for a fifth of the samples is none to build on.
        if known.len() * 5 < samples.len() * 4 {
            continue;
        }
        let whole: Vec<&Sample> = known.iter().map(|(sample, _)| *sample).collect();
        let before = impurity(&whole);
        let mut values: Vec<u32> = known.iter().map(|(_, value)| *value).collect();
        values.sort_unstable();
        values.dedup();
        for &preset in values.iter().skip(1) {
            let part = |reached: bool| -> Vec<&Sample> {
                known.iter().filter(|(_, v)| (*v >= preset) == reached).map(|(s, _)| *s).collect()
            };
            let gain = before - impurity(&part(true)) - impurity(&part(false));
            // Chance alone gives small gains.
            if gain < 0.5 {
                continue;
            }
            let rank = (gain, after.contains(&feature.0), feature.1.is_none());
            let better = best.as_ref().is_none_or(|(gain, near, own, _)| {
                let by_gain = rank.0 - gain;
                by_gain > 1e-9 || (by_gain > -1e-9 && (rank.1, rank.2) > (*near, *own))
            });
            if better {
                best = Some((rank.0, rank.1, rank.2, Split { feature, preset }));
            }
        }
    }
    best.map(|(_, _, _, split)| split)
}
