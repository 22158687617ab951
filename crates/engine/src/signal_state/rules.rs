//! Transition rules (Ghosh 2016, Table 2), and the flat table they are looked up in.

use crate::timing::{Clusters, TimeCluster};

use super::chains::{ChainIndex, ChainKind, Chains};
use super::enabling::Trigger;
use super::states::StateId;

/// One transition of one chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Chain it belongs to.
    pub chain: ChainIndex,
    /// Signal-state before.
    pub current: StateId,
    /// Signal-state after.
    pub next: StateId,
    /// How often it was learned.
    pub count: u32,
    /// Of those, how often as a start-up artefact (from the first state after a start or gap) or
    /// by an operator's confirmation: known to be allowed, but no evidence of what is usual.
    pub uncounted: u32,
    /// Of those, how many took a time that is not usual.
    pub odd_at_start: u32,
    /// Share of the transitions out of `current`.
    pub probability: f64,
    /// Place in the order of first appearance over the whole plant: causes before effects.
    pub sequence: u32,
    /// Place in the order of first appearance inside its chain.
    pub position: u32,
    /// Long-run variance of the branch, see [`super::dispersion`].
    pub dispersion: f32,
    /// Its times; empty where none was ever measured (a confirmed path).
    pub clusters: Clusters,
    /// What it really waits for, where that is not the device's own last event.
    pub trigger: Option<Box<Trigger>>,
}

impl Rule {
    /// The times it is judged by: delays from the enabling event where there is one.
    pub fn judged(&self) -> &[TimeCluster] {
        self.trigger.as_ref().map_or(&self.clusters, |trigger| &trigger.clusters)
    }

    /// Instances that count as evidence.
    pub fn evidence(&self) -> u64 {
        u64::from(self.count.saturating_sub(self.uncounted))
    }
}

/// Rules by current state: row `2·state` for the device's chain, `2·state + 1` for the group's.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RuleTable {
    row_start: Vec<u32>,
}

/// Row of a state in the chain of a kind.
#[inline]
pub fn row_of(state: StateId, kind: ChainKind) -> usize {
    2 * state as usize + usize::from(kind == ChainKind::Group)
}

impl RuleTable {
    /// Sorts `rules` by row and indexes them. Within a row the most frequent stands first.
    pub fn build(rules: &mut [Rule], chains: &Chains, states: usize) -> Self {
        let row = |rule: &Rule| row_of(rule.current, chains.kind(rule.chain));
        // Keys are sorted, and each rule moved once.
        rules.sort_by_cached_key(|rule| (row(rule), std::cmp::Reverse(rule.count), rule.sequence));
        let mut row_start = vec![0u32; 2 * states + 1];
        for rule in rules.iter() {
            row_start[row(rule) + 1] += 1;
        }
        for row in 1..row_start.len() {
            row_start[row] += row_start[row - 1];
        }
        Self { row_start }
    }

    /// Indices of the rules of a row.
    #[inline]
    pub fn row(&self, row: usize) -> std::ops::Range<usize> {
        match (self.row_start.get(row), self.row_start.get(row + 1)) {
            (Some(&start), Some(&end)) => start as usize..end as usize,
            _ => 0..0,
        }
    }

    /// Indices of the rules of every row.
    pub fn rows(&self) -> impl Iterator<Item = std::ops::Range<usize>> + Clone + '_ {
        self.row_start.windows(2).map(|ends| ends[0] as usize..ends[1] as usize)
    }

    /// The rule from a row to a state.
    #[inline]
    pub fn find(&self, rules: &[Rule], row: usize, next: StateId) -> Option<usize> {
        self.row(row).find(|&rule| rules[rule].next == next)
    }
}
