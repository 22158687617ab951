//! The nominal model: what was learned, indexed for watching.

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use crate::log::{Nanoseconds, SECOND, SignalIndex};
use crate::plant::Plant;
use crate::symbol_index::SymbolIndex;
use crate::timing::TimeCluster;
use crate::timing::limits::{self, Accepted, Tail, plat_allowance_s};

use super::budget::Budget;
use super::chains::{ChainIndex, ChainKind, Chains};
use super::evidence::Evidence;
use super::lanes::Lanes;
use super::parameters::{Parameters, Timing};
use super::rules::{Rule, RuleTable};
use super::sisters::{Names, stem};
use super::states::{StateId, States, full_state_name, short_state_name};

/// Facts of the learning logs that are no rules.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Learned {
    /// Number of events.
    pub events: u64,
    /// Time the logs span together.
    pub duration: Nanoseconds,
    /// Smallest time difference that means something.
    pub resolution: Nanoseconds,
    /// Events closer than this have no order; zero where only equal times are of one scan.
    pub scan_window: Nanoseconds,
    /// Longest time without an event, by group.
    pub longest_pause: Vec<Nanoseconds>,
    /// First state of the chain, by group; `NO_STATE` where it has none.
    pub group_start: Vec<StateId>,
}

/// The nominal behaviour of one plant.
#[derive(Debug, Clone)]
pub struct NominalModel {
    /// Signals, devices, groups.
    pub plant: Plant,
    /// Signal-states.
    pub states: States,
    /// Rules, in the order of [`RuleTable`].
    pub rules: Vec<Rule>,
    /// Facts of the learning logs.
    pub learned: Learned,
    /// Parameters it was learned with and is watched with.
    pub parameters: Parameters,
    pub(super) table: RuleTable,
    pub(super) chains: Chains,
    /// What `adaptive` judges by; `plat` never asks.
    judgement: OnceLock<Judgement>,
    symbols: OnceLock<SymbolIndex>,
    /// Made for the second monitor; from then on every one begins with a copy.
    lanes: OnceLock<Lanes>,
    watched: OnceLock<()>,
    fingerprint: OnceLock<u64>,
    is_part: bool,
}

/// What an alarm rests on.
#[derive(Debug, Clone)]
pub(super) struct Judgement {
    pub(super) evidence: Evidence,
    pub(super) budget: Budget,
    tail: Tail,
}

impl Judgement {
    /// For the chains of a part, which are these of the whole.
    pub(super) fn of_part(&self, whole_chain: &[usize]) -> Self {
        Self { evidence: self.evidence.of_part(whole_chain), ..self.clone() }
    }
}

/// "Learned from the longest nominal pause": this many times it.
const PAUSE_FACTOR: f64 = 1.5;

impl NominalModel {
    /// Indexes rules; also the way back from a model directory.
    pub fn assemble(
        plant: Plant,
        states: States,
        mut rules: Vec<Rule>,
        learned: Learned,
        parameters: Parameters,
    ) -> Self {
        rules.shrink_to_fit();
        let chains = Chains::of(&plant);
        let table = RuleTable::build(&mut rules, &chains, states.len());
        Self {
            plant,
            states,
            rules,
            learned,
            parameters,
            table,
            chains,
            judgement: OnceLock::new(),
            symbols: OnceLock::new(),
            lanes: OnceLock::new(),
            watched: OnceLock::new(),
            fingerprint: OnceLock::new(),
            is_part: false,
        }
    }

    /// A model of some of the rules, judged as in this one.
    pub(super) fn cut(
        &self,
        plant: Plant,
        states: States,
        rules: Vec<Rule>,
        learned: Learned,
        (table, chains, judgement): (RuleTable, Chains, Judgement),
    ) -> Self {
        Self {
            plant,
            states,
            rules,
            learned,
            parameters: self.parameters.clone(),
            table,
            chains,
            judgement: OnceLock::from(judgement),
            symbols: OnceLock::new(),
            lanes: OnceLock::new(),
            watched: OnceLock::new(),
            fingerprint: OnceLock::new(),
            is_part: true,
        }
    }

    /// True where this is a part of a model: what it rests on is the whole one's, so it is neither
    /// saved nor changed by itself.
    pub fn is_part(&self) -> bool {
        self.is_part
    }

    /// How probable what was not seen is, and what of it the budget pays for.
    pub(super) fn judgement(&self) -> &Judgement {
        self.judgement.get_or_init(|| {
            let resolution_s = self.learned.resolution as f64 / SECOND as f64;
            let signals = 0..self.plant.signals.len() as SignalIndex;
            let stems: Vec<u64> = signals.map(|signal| stem(&self.plant, signal)).collect();
            let names = Names { stems: &stems, ..self.names() };
            let evidence = Evidence::of(&self.rules, names, resolution_s);
            let (learned, table) = (&self.learned, &self.table);
            let budget =
                Budget::of(&self.parameters, learned, &self.rules, table, names, &evidence);
            Judgement { tail: Tail::new(budget.per_tail), evidence, budget }
        })
    }

    /// What tells sisters.
    pub(super) fn names(&self) -> Names<'_> {
        Names { plant: &self.plant, states: &self.states, chains: &self.chains, stems: &[] }
    }

    /// Device or group chain of a rule.
    pub fn kind(&self, chain: ChainIndex) -> ChainKind {
        self.chains.kind(chain)
    }

    /// Name of the group of a chain.
    pub fn group_name(&self, chain: ChainIndex) -> &str {
        &self.plant.groups[self.chains.group_of(chain)].name
    }

    /// Name of the device of a chain; `None` for a group's.
    pub fn device_name(&self, chain: ChainIndex) -> Option<&str> {
        self.chains.device(chain).map(|device| self.plant.devices[device].name.as_str())
    }

    /// The chain of a group, or of a device in it.
    pub fn find_chain(&self, group: &str, device: Option<&str>) -> Option<ChainIndex> {
        match device {
            Some(device) => self.plant.find_device(group, device),
            None => self.plant.find_group(group).map(|g| self.chains.chain_of_group(g)),
        }
    }

    /// `Group1-Device2-Signal2_ON`.
    pub fn state_name(&self, state: StateId) -> String {
        let (signal, value) = self.states.signal_value(state);
        full_state_name(&self.plant, signal, value)
    }

    /// `Signal2_ON` in a device's model, `Device2-Signal2_ON` in a group's.
    pub fn short_state_name(&self, state: StateId, kind: ChainKind) -> String {
        let (signal, value) = self.states.signal_value(state);
        let short = short_state_name(&self.plant, signal, value);
        match kind {
            ChainKind::Device => short,
            ChainKind::Group => format!("{}-{short}", self.plant.device_of(signal).name),
        }
    }

    /// Rules of one chain in the order of first appearance.
    pub fn rules_of(&self, chain: ChainIndex) -> Vec<&Rule> {
        let mut rules: Vec<&Rule> = self.rules.iter().filter(|rule| rule.chain == chain).collect();
        rules.sort_by_key(|rule| rule.position);
        rules
    }

    /// All rules: devices, then groups, each in the order of first appearance.
    pub fn rules_in_order(&self) -> Vec<&Rule> {
        let mut rules: Vec<&Rule> = self.rules.iter().collect();
        rules.sort_by_key(|rule| (rule.chain, rule.position));
        rules
    }

    /// Early and late limit in seconds of each time cluster of a rule of this model; empty where
    /// no time is remarkable.
    pub fn limits_of(&self, rule: &Rule) -> Vec<(f64, f64)> {
        let row = super::rules::row_of(rule.current, self.kind(rule.chain));
        self.table.find(&self.rules, row, rule.next).map_or_else(Vec::new, |index| {
            self.accepted(index).iter().map(|a| (a.early_s, a.late_s)).collect()
        })
    }

    /// Accepted times of a rule, by time cluster; empty where no time is remarkable. Worked out
    /// when something departs: the hot loop has them as bands.
    pub(super) fn accepted(&self, rule: usize) -> Vec<Accepted> {
        let rule = &self.rules[rule];
        match self.parameters.timing {
            Timing::Plat => limits::plat(&rule.clusters, self.parameters.allowance_s),
            Timing::Adaptive if !self.times(self.kind(rule.chain)) => Vec::new(),
            Timing::Adaptive => {
                let resolution_s = self.learned.resolution as f64 / SECOND as f64;
                let judgement = self.judgement();
                let shapes = judgement.evidence.shapes(rule, self.names());
                limits::adaptive(rule.judged(), judgement.tail, &shapes, resolution_s)
            }
        }
    }

    /// Accepted times of a rule since the device's own last event: for a transition that happens
    /// without its enabling one.
    pub(super) fn accepted_without_trigger(&self, rule: usize) -> Vec<Accepted> {
        let resolution_s = self.learned.resolution as f64 / SECOND as f64;
        let judgement = self.judgement();
        let shapes = judgement.evidence.shapes_without_trigger();
        limits::adaptive(&self.rules[rule].clusters, judgement.tail, shapes, resolution_s)
    }

    /// Seconds after which a time is late, for the cluster that takes longest; `None` where no
    /// time is.
    pub(super) fn latest_s(&self, rule: usize) -> Option<f64> {
        self.accepted(rule).iter().map(|a| a.late_s).reduce(f64::max)
    }

    /// Finds signals by symbol.
    pub fn symbols(&self) -> &SymbolIndex {
        self.symbols.get_or_init(|| SymbolIndex::of(&self.plant))
    }

    /// Lanes on which nothing has been counted.
    pub(super) fn fresh_lanes(&self) -> Lanes {
        // Most processes watch with one monitor: it need not pay for another's lanes.
        if self.watched.set(()).is_ok() {
            return Lanes::of(self);
        }
        self.lanes.get_or_init(|| Lanes::of(self)).clone()
    }

    /// True where times mean something in chains of a kind: for `adaptive`, a group's repeats what
    /// its devices' say more sharply.
    pub fn times(&self, kind: ChainKind) -> bool {
        self.parameters.timing == Timing::Plat || kind == ChainKind::Device
    }

    /// By how much more, in seconds, the average of a cluster must change to mean anything.
    pub fn significant_change_s(&self, cluster: &TimeCluster) -> f64 {
        match self.parameters.timing {
            Timing::Plat => plat_allowance_s(cluster.average_s),
            Timing::Adaptive => {
                let resolution = self.learned.resolution as f64 / SECOND as f64;
                (self.parameters.significant_change * cluster.average_s).max(3.0 * resolution)
            }
        }
    }

    /// How long a group may pause before it has stopped.
    pub fn stall_after(&self, group: usize) -> Nanoseconds {
        let pause = self.learned.longest_pause.get(group).copied().unwrap_or_default() as f64;
        let given = self.parameters.stall_after_s * SECOND as f64;
        let learned = pause * PAUSE_FACTOR;
        let after = match (self.parameters.timing, self.parameters.stall_learned) {
            (_, true) if pause > 0.0 => learned,
            (Timing::Plat, _) => given,
            (Timing::Adaptive, _) => given.max(learned),
        };
        after.max(1.0) as Nanoseconds
    }

    /// Changes whenever the model does; a monitor's saved state names the model it belongs to.
    pub fn fingerprint(&self) -> u64 {
        *self.fingerprint.get_or_init(|| self.hash())
    }

    fn hash(&self) -> u64 {
        let mut hash = xxhash_rust::xxh3::Xxh3::new();
        for signal in &self.plant.signals {
            hash.update(signal.symbol().as_bytes());
            hash.update(&[0]);
        }
        for rule in &self.rules {
            hash.update(&rule.current.to_le_bytes());
            hash.update(&rule.next.to_le_bytes());
            hash.update(&u64::from(rule.count).to_le_bytes());
            hash.update(&(rule.judged().len() as u64).to_le_bytes());
        }
        hash.digest()
    }
}
