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

    /// The mass that the next instance of a rule seen so often finds, times the number of rules.
    fn unseen(&self, instances: u64) -> f64 {
        let mass = |&(percent, clusters): &(u8, u32)| {
            let share = f64::from(percent) / 100.0;
            f64::from(clusters) * share * (1.0 - share).powf(instances as f64)
        };
        self.clusters.iter().map(mass).sum()
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
        if rule.evidence() >= BODY_INSTANCES {
            self.families.entry(family).or_default().add(rule);
            self.all.add(rule);
        }
    }

    /// Probability that the next instance of a rule takes a usual time of its own that has not been
    /// seen yet.
    pub fn unseen(&self, rule: &Rule, family: Family) -> f64 {
        let instances = rule.evidence();
        let prior = self.all.unseen(instances) / f64::from(self.all.rules.max(1));
        let (mass, rules) = self
            .families
            .get(&family)
            .map_or((0.0, 0), |shares| (shares.unseen(instances), shares.rules));
        (mass + prior) / (f64::from(rules) + 1.0)
    }
}
