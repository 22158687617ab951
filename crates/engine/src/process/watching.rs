//! Watching a machine with the network that foretells its next activity, with the verbs of every
//! monitor. An activity the network thought very unlikely becomes a notice, never an alarm.
//!
//! Rows of one time are one scan; a scan is judged when a later time comes, so any split of a log
//! into batches gives the same findings. Nothing is judged before the first reset, nor between a
//! gap and the next one: where the machine is in its run is not known there.

use std::collections::{BTreeMap, HashMap};

use serde::{Deserialize, Serialize};

use super::decay::DecayState;
use super::next_activity::{NextActivity, Predictor};
use super::petri::PetriNet;
use super::replay::TokenReplay;
use super::reset::parse_changes;
use super::slicing::activity_name;
use crate::finding::{Expected, Finding, Kind, Model, stable_id};
use crate::log::{Nanoseconds, SECOND, SignalIndex};
use crate::plant::SignalClass;
use crate::saved_state;
use crate::signal_state::events::{Meaning, Row, Values, is_image};
use crate::signal_state::monitor::MonitorError;

/// Probability below which an activity is told, where the user does not say.
pub const UNLIKELY: f32 = 0.01;

/// Alternatives named in a finding.
const ALTERNATIVES: usize = 3;

/// Activities of the present run named in a finding.
const PATH: usize = 8;

const STATE_VERSION: u32 = 1;

/// Everything that changes while watching.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Watch {
    values: Values,
    /// The scan that is not judged yet.
    scan: Vec<Row>,
    now: Nanoseconds,
    /// Something was seen before.
    started: bool,
    /// After a gap: what changed did so unseen.
    unseen: bool,
    /// A run is followed from its reset.
    following: bool,
    state: DecayState,
    /// Activities of the run, the last ones.
    path: Vec<String>,
    /// First finding of the run.
    incident: Option<String>,
}

#[derive(Serialize, Deserialize)]
struct Saved {
    version: u32,
    fingerprint: u64,
    watch: Watch,
}

/// Watches one machine.
#[derive(Debug, Clone)]
pub struct NextMonitor {
    next: NextActivity,
    replay: TokenReplay,
    numbers: HashMap<String, u32>,
    /// Signals that take part, by name: sorted, so that numbers are in the order of names.
    signals: BTreeMap<String, SignalIndex>,
    symbols: Vec<String>,
    classes: Vec<SignalClass>,
    reset: Vec<(SignalIndex, i64)>,
    unlikely: f32,
    fingerprint: u64,
    watch: Watch,
    findings: Vec<Finding>,
}

impl NextMonitor {
    /// A monitor that has seen nothing yet. `reset` is written as `%IX0.1=0`; signals that are in
    /// no activity of the network are not looked at. `None` where the reset is not written so, or
    /// is of signals the network does not know.
    pub fn new(next: NextActivity, net: &PetriNet, reset: &str, unlikely: f32) -> Option<Self> {
        let mut class_of: BTreeMap<String, SignalClass> = BTreeMap::new();
        let labelled = net.transitions.iter().filter_map(|t| Some((t.label.as_ref()?, t.class)));
        let others = next.activities().iter().map(|name| (name, None));
        for (name, class) in labelled.chain(others) {
            for (signal, _) in parse_changes(name).unwrap_or_default() {
                let class = class.unwrap_or_else(|| SignalClass::guess(&signal));
                class_of.entry(signal).or_insert(class);
            }
        }
        let symbols: Vec<String> = class_of.keys().cloned().collect();
        let signals: BTreeMap<String, SignalIndex> = symbols.iter().cloned().zip(0..).collect();
        let changes = parse_changes(reset)?.into_iter();
        let reset = changes.map(|(name, value)| Some((*signals.get(&name)?, value)));
        let reset: Vec<(SignalIndex, i64)> = reset.collect::<Option<_>>()?;
        let replay = TokenReplay::new(net, next.activities().iter().map(String::as_str));
        let text = format!("{:?}|{reset:?}|{unlikely}", next.activities());
        Some(Self {
            numbers: next.activities().iter().cloned().zip(0..).collect(),
            watch: Watch {
                values: Values::new(symbols.len()),
                scan: Vec::new(),
                now: Nanoseconds::MIN,
                started: false,
                unseen: false,
                following: false,
                state: DecayState::new(net),
                path: Vec::new(),
                incident: None,
            },
            classes: class_of.into_values().collect(),
            fingerprint: xxhash_rust::xxh3::xxh3_64(text.as_bytes()),
            next,
            replay,
            signals,
            symbols,
            reset,
            unlikely,
            findings: Vec::new(),
        })
    }

    /// The number of a signal here; none where it takes no part.
    pub fn signal(&self, symbol: &str) -> Option<SignalIndex> {
        self.signals.get(symbol).copied()
    }

    /// Takes rows in time order, signals by their number here.
    ///
    /// # Errors
    /// A row older than what has been seen; nothing of the batch is taken then.
    pub fn observe(&mut self, rows: &[Row]) -> Result<Vec<Finding>, MonitorError> {
        let mut newest = self.watch.now;
        for (index, row) in rows.iter().enumerate() {
            if row.time < newest {
                let late_s = (newest - row.time) as f64 / SECOND as f64;
                return Err(MonitorError::Order { row: index + 1, late_s: late_s.to_string() });
            }
            newest = row.time;
        }
        for &row in rows {
            self.go_on_to(row.time);
            self.watch.scan.push(row);
        }
        Ok(std::mem::take(&mut self.findings))
    }

    /// Time went on without a change.
    pub fn advance(&mut self, now: Nanoseconds) -> Vec<Finding> {
        if now > self.watch.now {
            self.go_on_to(now);
        }
        std::mem::take(&mut self.findings)
    }

    /// Nothing was recorded for a while: the run is followed again from the next reset.
    pub fn gap(&mut self, end: Nanoseconds) -> Vec<Finding> {
        self.judge();
        self.watch.now = self.watch.now.max(end);
        self.watch.values.doubt();
        self.watch.following = false;
        self.watch.unseen = self.watch.started;
        std::mem::take(&mut self.findings)
    }

    /// The log has ended: judges the running scan.
    pub fn finish(&mut self) -> Vec<Finding> {
        self.judge();
        std::mem::take(&mut self.findings)
    }

    /// Everything needed to go on later.
    pub fn save(&self) -> Vec<u8> {
        saved_state::sealed(&Saved {
            version: STATE_VERSION,
            fingerprint: self.fingerprint,
            watch: self.watch.clone(),
        })
    }

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// Damaged bytes, another version, or the state of another monitor.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), MonitorError> {
        let body = saved_state::unsealed(bytes).ok_or(MonitorError::Damaged)?;
        let saved: Saved = postcard::from_bytes(body).map_err(|_| MonitorError::Damaged)?;
        if saved.version != STATE_VERSION {
            return Err(MonitorError::Damaged);
        }
        if saved.fingerprint != self.fingerprint {
            return Err(MonitorError::OtherModel);
        }
        self.watch = saved.watch;
        self.replay.place(&self.watch.state.marking);
        Ok(())
    }

    fn go_on_to(&mut self, time: Nanoseconds) {
        if time > self.watch.now {
            self.judge();
        }
        self.watch.now = time;
    }

    /// The running scan is complete.
    fn judge(&mut self) {
        let scan = std::mem::take(&mut self.watch.scan);
        let Some(first) = scan.first() else { return };
        let time = first.time;
        let image = !self.watch.started && is_image(scan.iter().map(|row| row.value));
        let unseen = std::mem::take(&mut self.watch.unseen) || image;
        self.watch.started = true;
        let mut changes: Vec<(SignalClass, SignalIndex, i64)> = Vec::with_capacity(scan.len());
        for row in &scan {
            if self.watch.values.take(row.signal, row.value) == Meaning::Event && !unseen {
                changes.push((self.classes[row.signal as usize], row.signal, row.value));
            }
        }
        // As runs are cut (Theis 2019, Algorithm 1): inputs, then memory, then outputs; a signal
        // that changes twice begins a new activity.
        changes.sort_by_key(|change| change.0);
        let mut merged: Vec<(SignalIndex, i64)> = Vec::new();
        let mut class = None;
        for (of, signal, value) in changes {
            if class != Some(of) || merged.iter().any(|&(known, _)| known == signal) {
                self.take_activity(time, &mut merged);
            }
            class = Some(of);
            merged.push((signal, value));
        }
        self.take_activity(time, &mut merged);
    }

    fn take_activity(&mut self, time: Nanoseconds, changes: &mut Vec<(SignalIndex, i64)>) {
        if changes.is_empty() {
            return;
        }
        changes.sort_unstable();
        let opens = self.reset.iter().all(|part| changes.contains(part));
        let named: Vec<(String, i64)> =
            changes.drain(..).map(|(s, v)| (self.symbols[s as usize].clone(), v)).collect();
        let name = activity_name(&named);
        if self.watch.following {
            self.foretell(time, &name, &named[0].0);
        }
        if opens {
            let net = self.replay.net();
            self.watch.state.restart(net, time);
            self.replay.restart();
            self.watch.following = true;
            self.watch.path.clear();
            self.watch.incident = None;
        }
        if !self.watch.following {
            return;
        }
        match self.numbers.get(&name) {
            Some(&number) => {
                let moved = self.replay.step(number);
                let touched = self.replay.touched(&moved);
                self.watch.state.follow(touched, self.replay.marking(), time);
            }
            None => self.watch.state.follow(&[], self.replay.marking(), time),
        }
        self.watch.path.push(name);
        if self.watch.path.len() > PATH {
            self.watch.path.remove(0);
        }
    }

    fn foretell(&mut self, time: Nanoseconds, name: &str, signal: &str) {
        let at = self.watch.state.time();
        let came = self.numbers.get(name).copied();
        let probabilities = self.next.probabilities(&self.watch.state, at);
        let probability = came.map_or(0.0, |came| probabilities[came as usize]);
        if probability >= self.unlikely {
            return;
        }
        let mut likely: Vec<(usize, f32)> = probabilities.iter().copied().enumerate().collect();
        likely.sort_by(|a, b| b.1.total_cmp(&a.1));
        likely.truncate(ALTERNATIVES);
        let activities = self.next.activities();
        let expected: Vec<Expected> = likely
            .iter()
            .map(|&(index, probability)| Expected {
                state: activities[index].clone(),
                probability: f64::from(probability),
                limit_s: None,
            })
            .collect();
        let from = self.watch.path.last().cloned().unwrap_or_default();
        let mut finding = Finding::new(Kind::Transition, Model::Process, time);
        finding.id = stable_id(Kind::Transition, "process", &from, name, time);
        finding.incident = self.watch.incident.get_or_insert_with(|| finding.id.clone()).clone();
        finding.message = message(name, came.is_some(), probability, &expected);
        finding.signal = Some(signal.to_owned());
        finding.to = Some(name.to_owned());
        finding.from = Some(from);
        finding.expected = expected;
        finding.path = self.watch.path.clone();
        finding.path.push(name.to_owned());
        self.findings.push(finding);
    }
}

fn message(name: &str, known: bool, probability: f32, expected: &[Expected]) -> String {
    let percent = |probability: f64| {
        if probability < 0.001 {
            "under 0.1 %".to_owned()
        } else {
            format!("{:.1} %", probability * 100.0)
        }
    };
    let instead = expected.first().map_or(String::new(), |most| {
        format!(", where {} was likely ({})", most.state, percent(most.probability))
    });
    let odds = if known {
        format!("had a probability of {}", percent(f64::from(probability)))
    } else {
        "was never seen in training".to_owned()
    };
    format!("{name} came{instead}; at this point of the run it {odds}.")
}
