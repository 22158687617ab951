//! Some groups of a nominal model as a model of their own, watched somewhere else.
//!
//! Groups have nothing to do with one another while they are watched, but for two things: what an
//! alarm rests on is told by the whole plant ([`super::evidence`], [`super::budget`]), so a part
//! keeps it as the whole plant has it; and a transition may wait for another group's event, where
//! a model says so: those groups stay together ([`NominalModel::independent_groups`]).
//!
//! Where events closer than a scan window have no order, a scan is a scan of the plant: it begins
//! with its first row, whichever group that is of. Rows that bear the time of their scan, as our
//! taps write them, are cut alike by every part; where each row has a time of its own, a part may
//! cut other scans than the whole.

use crate::plant_part::PlantPart;

use super::chains::Chains;
use super::enabling::Trigger;
use super::model::{Learned, NominalModel};
use super::rules::{Rule, RuleTable};
use super::states::{NO_STATE, StateId, States};

impl NominalModel {
    /// The groups of these numbers, with the whole plant's evidence and budget; and what the part's
    /// numbers of signals mean in the whole plant.
    pub fn part(&self, groups: &[usize]) -> (Self, PlantPart) {
        let part = PlantPart::of(&self.plant, groups);
        let numbers = Numbers::of(self, &part);
        let whole_chain: Vec<usize> = part
            .devices
            .iter()
            .copied()
            .chain(part.groups.iter().map(|&group| self.chains.chain_of_group(group)))
            .collect();
        let chains = Chains::of(&part.plant);
        let mut rules: Vec<Rule> =
            self.rules.iter().filter_map(|rule| numbers.rule(rule, &whole_chain)).collect();
        rules.shrink_to_fit();
        let table = RuleTable::build(&mut rules, &chains, numbers.states.len());
        let of_groups = |group: &usize| self.learned.group_start.get(*group).copied();
        let learned = Learned {
            longest_pause: part
                .groups
                .iter()
                .map(|&group| self.learned.longest_pause.get(group).copied().unwrap_or_default())
                .collect(),
            group_start: part
                .groups
                .iter()
                .map(|group| of_groups(group).and_then(|s| numbers.state(s)).unwrap_or(NO_STATE))
                .collect(),
            ..self.learned.clone()
        };
        let evidence = self.evidence.of_part(&whole_chain);
        let states = numbers.states;
        let plant = part.plant.clone();
        (self.cut(plant, states, rules, learned, (table, chains, evidence)), part)
    }

    /// Lists of groups, each of which needs no other: one each, but for those whose transitions
    /// wait for one another's events.
    pub fn independent_groups(&self) -> Vec<Vec<usize>> {
        let mut leader: Vec<usize> = (0..self.plant.groups.len()).collect();
        for rule in &self.rules {
            let own = self.chains.group_of(rule.chain);
            for state in rule.trigger.iter().flat_map(|trigger| trigger.states()) {
                let signal = self.states.signal_value(state).0;
                let other = self.chains.group_of(self.chains.device_chain(signal));
                let (one, two) = (leader[own], leader[other]);
                if one != two {
                    let (first, second) = (one.min(two), one.max(two));
                    leader.iter_mut().filter(|l| **l == second).for_each(|l| *l = first);
                }
            }
        }
        let mut parts: Vec<Vec<usize>> = vec![Vec::new(); leader.len()];
        for (group, leader) in leader.into_iter().enumerate() {
            parts[leader].push(group);
        }
        parts.retain(|part| !part.is_empty());
        parts
    }
}

/// The whole plant's numbers, as the part has them.
struct Numbers<'a> {
    whole: &'a NominalModel,
    part: &'a PlantPart,
    states: States,
}

impl<'a> Numbers<'a> {
    fn of(whole: &'a NominalModel, part: &'a PlantPart) -> Self {
        let mut states = States::new(part.signals.len());
        for &(signal, value) in whole.states.further() {
            if let Some(own) = part.own(signal) {
                states.intern(own, value);
            }
        }
        Self { whole, part, states }
    }

    fn state(&self, state: StateId) -> Option<StateId> {
        if state == NO_STATE {
            return Some(NO_STATE);
        }
        let (signal, value) = self.whole.states.signal_value(state);
        self.states.find(self.part.own(signal)?, value)
    }

    /// `None` for a rule of another part.
    fn rule(&self, rule: &Rule, whole_chain: &[usize]) -> Option<Rule> {
        // Devices, then groups: ascending in both.
        let chain = whole_chain.binary_search(&rule.chain).ok()?;
        let (current, next) = (self.state(rule.current)?, self.state(rule.next)?);
        let trigger = match &rule.trigger {
            Some(trigger) => {
                let [one, other] = trigger.states;
                let states = [self.state(one)?, self.state(other)?];
                Some(Box::new(Trigger { states, clusters: trigger.clusters.clone() }))
            }
            None => None,
        };
        Some(Rule { chain, current, next, trigger, ..rule.clone() })
    }
}
