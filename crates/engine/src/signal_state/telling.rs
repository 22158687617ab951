//! Puts the records of one batch into words. What those of one rule have in common is said once.

use std::cell::OnceCell;
use std::slice;
use std::sync::Arc;

use hashbrown::HashMap;

use crate::finding::line::Line;
use crate::finding::{Expected, Finding, Kind, Severity, StableId};
use crate::timing::limits::Accepted;

use super::check::Departure;
use super::found::{Record, Timed, What, accepted, broken_limit};
use super::identity::{FindingId, Identity};
use super::message::{self, TimeSentence};
use super::model::NominalModel;
use super::teller::Teller;

/// Tells the records of one batch, one by one.
pub struct Telling<'a> {
    records: slice::Iter<'a, Record>,
    /// Whose numbers the records use; none where all are told already.
    words: Option<Words<'a>>,
}

impl<'a> Telling<'a> {
    pub(super) fn of(model: Option<&'a NominalModel>, records: &'a [Record]) -> Self {
        Self { records: records.iter(), words: model.map(Words::of) }
    }

    /// Tells the next one; false where there is none.
    pub fn tell_next(&mut self, hear: impl FnOnce(Said<'_>)) -> bool {
        let Some(record) = self.records.next() else { return false };
        match (&mut self.words, &record.what) {
            (Some(words), _) => words.tell(record, hear),
            (None, What::Told(finding)) => hear(Said::once(finding)),
            (None, _) => {}
        }
        true
    }
}

/// A finding that is told.
pub struct Said<'a> {
    /// The finding.
    pub finding: &'a Finding,
    /// Its JSON with that of others, where one like it was told before.
    line: Option<&'a OnceCell<Option<Line>>>,
}

impl<'a> Said<'a> {
    fn once(finding: &'a Finding) -> Self {
        Self { finding, line: None }
    }

    /// Appends the finding's JSON to text in UTF-8.
    pub fn append_json(&self, text: &mut Vec<u8>) {
        let line = self.line.and_then(|line| line.get_or_init(|| Line::of(self.finding)).as_ref());
        match line {
            Some(line) => line.append(self.finding, text),
            None => self.finding.append_json(text),
        }
    }
}

/// What was said so far, and may be said again.
struct Words<'a> {
    model: &'a NominalModel,
    /// Ids of incidents: many findings share one.
    incidents: HashMap<Identity, Arc<str>>,
    times: HashMap<Alike, TimeFinding>,
}

/// What findings of times have in common that differ in their times only.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Alike {
    rule: u32,
    as_learned: bool,
    kind: Kind,
    severity: Severity,
}

/// The finding told last of those that are alike.
struct TimeFinding {
    finding: Finding,
    accepted: Vec<Accepted>,
    id: StableId,
    sentence: TimeSentence,
    line: OnceCell<Option<Line>>,
}

impl<'a> Words<'a> {
    fn of(model: &'a NominalModel) -> Self {
        Self { model, incidents: HashMap::new(), times: HashMap::new() }
    }

    fn tell(&mut self, record: &Record, hear: impl FnOnce(Said<'_>)) {
        match &record.what {
            What::Time { rule, timed } => self.tell_time(record, *rule, *timed, hear),
            What::Departure(departure) => hear(Said::once(&self.departure(record, departure))),
            What::Told(finding) if finding.incident.is_empty() => {
                let incident = finding.id.clone();
                hear(Said::once(&Finding { incident, ..Finding::clone(finding) }));
            }
            What::Told(finding) => hear(Said::once(finding)),
        }
    }

    fn tell_time(&mut self, record: &Record, rule: u32, timed: Timed, hear: impl FnOnce(Said<'_>)) {
        let model = self.model;
        let incident = self.incident(record);
        let Record { kind, severity, .. } = *record;
        let alike = Alike { rule, as_learned: timed.as_learned, kind, severity };
        let mut again = true;
        let TimeFinding { finding, accepted, id, sentence, line } =
            self.times.entry(alike).or_insert_with(|| {
                again = false;
                TimeFinding::of(model, alike, record)
            });
        let observed_s = timed.seconds();
        let limit_s = broken_limit(model, rule as usize, accepted, observed_s).1;
        finding.time = record.time;
        finding.observed_s = Some(observed_s);
        finding.limit_s = Some(limit_s);
        sentence.say(observed_s, limit_s, &mut finding.message);
        finding.id = id.at(record.time);
        finding.incident.clear();
        finding.incident.push_str(incident.as_deref().unwrap_or(&finding.id));
        // What is told once is not taken apart.
        hear(Said { finding, line: again.then_some(line) });
    }

    fn departure(&mut self, record: &Record, departure: &Departure) -> Finding {
        let teller = Teller::of(self.model);
        let rule = &self.model.rules[departure.rule];
        let mut finding = teller.at(record.kind, rule.chain, rule.next, record.time);
        finding.severity = record.severity;
        finding.from = Some(teller.state_name(rule.current));
        finding.expected = teller.expected_from(rule.current, self.model.kind(rule.chain));
        finding.observed_s = Some(departure.observed);
        finding.limit_s = Some(departure.learned);
        finding.message = message::departure(self.model, departure, &finding);
        if let Some(identity) = record.identity(self.model) {
            finding.id = identity.id(teller);
        }
        finding.incident = match self.incident(record) {
            Some(incident) => incident.to_string(),
            None => finding.id.clone(),
        };
        finding
    }

    /// The incident of a record; `None` for one of its own.
    fn incident(&mut self, record: &Record) -> Option<Arc<str>> {
        match record.incident.as_ref()? {
            FindingId::Untold(identity) => {
                let id = || identity.id(Teller::of(self.model)).into();
                Some(Arc::clone(self.incidents.entry(*identity).or_insert_with(id)))
            }
            FindingId::Told(id) => Some(Arc::clone(id)),
        }
    }
}

impl TimeFinding {
    fn of(model: &NominalModel, alike: Alike, record: &Record) -> Self {
        let index = alike.rule as usize;
        let rule = &model.rules[index];
        let teller = Teller::of(model);
        let accepted = accepted(model, index, alike.as_learned);
        let mut finding = teller.at(alike.kind, rule.chain, rule.next, record.time);
        finding.severity = alike.severity;
        finding.from = Some(teller.state_name(rule.current));
        finding.expected = vec![Expected {
            state: finding.to.clone().unwrap_or_default(),
            probability: rule.probability,
            limit_s: accepted.iter().map(|a| a.late_s).reduce(f64::max),
        }];
        finding.suspects = message::time_suspects(model, index);
        let sentence = TimeSentence::of(model, index, alike.as_learned, &finding);
        let name = |state: &Option<String>| state.clone().unwrap_or_default();
        let id = Identity::new(alike.kind, rule.chain, [rule.current, rule.next], record.time)
            .what_and_where(teller, &name(&finding.from), &name(&finding.to));
        Self { finding, accepted, id, sentence, line: OnceCell::new() }
    }
}
