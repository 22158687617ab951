//! Findings as they are made: a few numbers each, told in words when somebody asks.
//!
//! Everything a record refers to belongs to the model, which does not change; what may change
//! while watching (an incident, counted shares) is kept in the record.

use std::sync::Arc;

use crate::finding::{Finding, Kind, Severity};
use crate::log::{Nanoseconds, SECOND};
use crate::timing::limits::Accepted;

use super::check::Departure;
use super::identity::{FindingId, Identity};
use super::model::NominalModel;
use super::parameters::Timing;
use super::telling::Telling;

/// A transition and how long it took.
#[derive(Debug, Clone, Copy)]
pub struct Timed {
    /// Since when it was due.
    pub since: Nanoseconds,
    /// How long it took since then.
    pub took: Nanoseconds,
    /// Measured as the rule's times were learned.
    pub as_learned: bool,
}

impl Timed {
    /// From one time to another.
    #[inline]
    pub fn new(since: Nanoseconds, time: Nanoseconds, as_learned: bool) -> Self {
        // In a scan whose order was mended, time may seem to run backwards.
        Self { since, took: time.saturating_sub(since).max(0), as_learned }
    }

    /// The time it took.
    pub fn seconds(self) -> f64 {
        self.took as f64 / SECOND as f64
    }
}

/// What a record tells of.
#[derive(Debug, Clone)]
pub enum What {
    /// A time out of its limits.
    Time {
        /// The rule whose time it was.
        rule: u32,
        /// The time.
        timed: Timed,
    },
    /// A share or an average that has changed.
    Departure(Box<Departure>),
    /// Told already.
    Told(Box<Finding>),
}

/// One finding.
#[derive(Debug, Clone)]
pub struct Record {
    /// What was found.
    pub what: What,
    /// Its kind.
    pub kind: Kind,
    /// How much it matters.
    pub severity: Severity,
    /// When.
    pub time: Nanoseconds,
    /// Its incident; none for what is told already, and for an incident of its own.
    pub incident: Option<FindingId>,
}

impl From<Finding> for Record {
    fn from(finding: Finding) -> Self {
        Self {
            kind: finding.kind,
            severity: finding.severity,
            time: finding.time,
            incident: None,
            what: What::Told(Box::new(finding)),
        }
    }
}

impl Record {
    /// What a time or a departure is known by.
    pub fn identity(&self, model: &NominalModel) -> Option<Identity> {
        let rule = match &self.what {
            What::Time { rule, .. } => *rule as usize,
            What::Departure(departure) => departure.rule,
            What::Told(_) => return None,
        };
        let rule = &model.rules[rule];
        Some(Identity::new(self.kind, rule.chain, [rule.current, rule.next], self.time))
    }
}

/// Findings in the order they were made.
#[derive(Debug, Clone, Default)]
pub struct Found {
    /// Whose numbers the records use; none where all are told already.
    model: Option<Arc<NominalModel>>,
    records: Vec<Record>,
}

impl From<Vec<Finding>> for Found {
    fn from(findings: Vec<Finding>) -> Self {
        Self { model: None, records: findings.into_iter().map(Record::from).collect() }
    }
}

impl Found {
    /// Records of a model's monitor.
    pub fn new(model: Arc<NominalModel>, records: Vec<Record>) -> Self {
        Self { model: Some(model), records }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// True where there is none.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Adds those found later by the same monitor.
    pub fn append(&mut self, later: Self) {
        self.model = later.model.or(self.model.take());
        if self.records.is_empty() {
            self.records = later.records;
        } else {
            self.records.extend(later.records);
        }
    }

    /// Tells them one by one.
    pub fn telling(&self) -> Telling<'_> {
        Telling::of(self.model.as_deref(), &self.records)
    }

    /// Tells all.
    pub fn into_findings(self) -> Vec<Finding> {
        let told = |record: &Record| matches!(record.what, What::Told(_));
        if self.records.iter().all(told) {
            let whole = |record: Record| match record.what {
                What::Told(finding) => Some(*finding),
                _ => None,
            };
            return self.records.into_iter().filter_map(whole).collect();
        }
        self.findings()
    }

    /// Tells all, and keeps what they are told from.
    pub fn findings(&self) -> Vec<Finding> {
        let mut findings = Vec::with_capacity(self.len());
        let mut telling = self.telling();
        while telling.tell_next(|said| findings.push(said.finding.clone())) {}
        findings
    }
}

/// Accepted times of a rule: since its enabling event, or without one.
pub fn accepted(model: &NominalModel, rule: usize, as_learned: bool) -> Vec<Accepted> {
    if as_learned { model.accepted(rule) } else { model.accepted_without_trigger(rule) }
}

/// Which limit a time broke, and where that limit lies.
pub fn broken_limit(
    model: &NominalModel,
    rule: usize,
    accepted: &[Accepted],
    seconds: f64,
) -> (Kind, f64) {
    if model.parameters.timing == Timing::Plat {
        let cluster = nearest_maximum(model, rule, seconds);
        return (Kind::Late, cluster.map_or(f64::INFINITY, |cluster| accepted[cluster].late_s));
    }
    let late = accepted.iter().map(|a| a.late_s).filter(|&limit| limit < seconds).reduce(f64::max);
    let early =
        accepted.iter().map(|a| a.early_s).filter(|&limit| limit > seconds).reduce(f64::min);
    match (late, early) {
        (Some(late), Some(early)) if early - seconds < seconds - late => (Kind::Early, early),
        (Some(late), _) => (Kind::Late, late),
        (None, early) => (Kind::Early, early.unwrap_or(0.0)),
    }
}

/// The cluster whose maximum is most similar to a time (section 2.6).
fn nearest_maximum(model: &NominalModel, rule: usize, seconds: f64) -> Option<usize> {
    let clusters = &model.rules[rule].clusters;
    (0..clusters.len()).min_by(|&a, &b| {
        let distance = |c: usize| (clusters[c].maximum_s - seconds).abs();
        distance(a).total_cmp(&distance(b))
    })
}
