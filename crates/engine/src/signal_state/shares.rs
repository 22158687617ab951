//! What a transition seen only a few times may still hold back: usual times of its own.
//!
//! Of a cluster with share `q` nothing is seen in `n` instances with probability `(1-q)^n`, and the
//! next instance is its first with probability `q·(1-q)^n`. How many clusters of which share there
//! are is told by a transition's sisters, among whom the plant as a whole counts as one more.

use std::collections::HashMap;

use crate::timing::limits::BODY_INSTANCES;

use super::rules::Rule;
use super::sisters::Family;

/// Shares of the time clusters of some rules that have several.
#[derive(Debug, Clone, Default)]
struct Shares {
    /// Share in hundredths, and clusters that have it.
    clusters: Vec<(u8, u32)>,
    rules: u32,
}

impl Shares {
    fn add(&mut self, rule: &Rule) {
        self.rules += 1;
        let clusters = rule.judged();
        let usual = clusters.iter().filter(|c| c.instances >= BODY_INSTANCES);
        for cluster in usual.filter(|_| clusters.len() > 1) {
            let percent = (cluster.probability * 100.0).round().clamp(0.0, 100.0) as u8;
            match self.clusters.iter_mut().find(|(share, _)| *share == percent) {
                Some((_, count)) => *count += 1,
                None => self.clusters.push((percent, 1)),
            }
        }
    }

    /// The mass that the next instance finds of a rule whose clusters are found so, times the
    /// number of rules.
    fn unseen(&self, first: &FirstSeen) -> f64 {
        let mass = |&(percent, clusters): &(u8, u32)| f64::from(clusters) * first[percent as usize];
        self.clusters.iter().map(mass).sum()
    }
}

/// By share in hundredths: probability that the next instance of a rule is its first of a cluster.
type FirstSeen = [f64; 101];

/// What [`FirstSeen`] is after so many instances.
fn first_seen(instances: u64) -> FirstSeen {
    std::array::from_fn(|percent| {
        let share = percent as f64 / 100.0;
        share * (1.0 - share).powf(instances as f64)
    })
}

/// [`first_seen`] of the counts that were asked for: most transitions of a plant are seen about
/// equally often.
#[derive(Debug, Default)]
pub struct FirstSeenByCount {
    known: HashMap<u64, FirstSeen>,
}

impl FirstSeenByCount {
    fn of(&mut self, instances: u64) -> &FirstSeen {
        self.known.entry(instances).or_insert_with(|| first_seen(instances))
    }
}

/// Shares of all rules of one character.
#[derive(Debug, Clone, Default)]
pub struct SharesBySisters {
    families: HashMap<Family, Shares>,
    all: Shares,
}

impl SharesBySisters {
    /// Counts the clusters of a rule.
    pub fn add(&mut self, rule: &Rule, family: Family) {
        if rule.evidence() >= u64::from(BODY_INSTANCES) {
            self.families.entry(family).or_default().add(rule);
            self.all.add(rule);
        }
    }

    /// Probability that the next instance of a rule takes a usual time of its own that has not been
    /// seen yet.
    pub fn unseen(&self, rule: &Rule, family: Family, first: &mut FirstSeenByCount) -> f64 {
        let first = first.of(rule.evidence());
        let prior = self.all.unseen(first) / f64::from(self.all.rules.max(1));
        let (mass, rules) = self
            .families
            .get(&family)
            .map_or((0.0, 0), |shares| (shares.unseen(first), shares.rules));
        (mass + prior) / (f64::from(rules) + 1.0)
    }
}
