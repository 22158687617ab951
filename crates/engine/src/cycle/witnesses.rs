//! Two models, one event: findings of the cycle machine and of the signal-state models that tell
//! of the same trouble share an incident, so that it is one alarm with two witnesses.
//!
//! Like the incidents of the signal-state models, this goes by group and by time: a finding joins
//! what happened in its group shortly before it began, or a class 1 in any group: its alarm has
//! stopped the whole machine.

use std::collections::{BTreeMap, VecDeque};

use serde::{Deserialize, Serialize};

use crate::finding::{Finding, Kind, Model};
use crate::log::{Nanoseconds, SECOND};

/// Incidents remembered under another name.
const RENAMED_AT_MOST: usize = 1_000;

/// Brings findings of both models together, in the order they are made.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Witnesses {
    /// By group: the incident that is fresh, and its latest finding.
    fresh: BTreeMap<String, (String, Nanoseconds)>,
    /// The latest class 1: with its alarm the whole machine has stopped, whatever the group.
    stopped: Option<(String, Nanoseconds)>,
    /// Incidents that turned out to be part of another.
    renamed: VecDeque<(String, String)>,
}

impl Witnesses {
    /// Places a finding; `fresh_for` is how long after its last finding an incident is fresh.
    pub fn place(&mut self, finding: &mut Finding, fresh_for: Nanoseconds) {
        if let Some((_, incident)) = self.renamed.iter().find(|(own, _)| *own == finding.incident) {
            finding.incident.clone_from(incident);
        }
        // A rate is no event, and a lost connection no trouble of the machine.
        let Some(group) = finding.group.as_ref().filter(|_| is_event(finding)) else {
            return;
        };
        let waited = finding.observed_s.filter(|_| is_delay(finding)).unwrap_or(0.0);
        let began = finding.time.saturating_sub((waited * SECOND as f64) as i64);
        let is_fresh = |last: Nanoseconds| began.saturating_sub(last) <= fresh_for;
        let own = self.fresh.get(group).is_some_and(|(_, last)| is_fresh(*last));
        if let Some(stopped) = self.stopped.clone().filter(|(_, time)| !own && is_fresh(*time)) {
            self.fresh.insert(group.clone(), stopped);
        }
        match self.fresh.get_mut(group) {
            Some((incident, last)) if is_fresh(*last) => {
                *last = finding.time.max(*last);
                if *incident != finding.incident {
                    let incident = incident.clone();
                    let own = std::mem::replace(&mut finding.incident, incident.clone());
                    self.renamed.push_back((own, incident));
                    if self.renamed.len() > RENAMED_AT_MOST {
                        self.renamed.pop_front();
                    }
                }
            }
            _ => {
                self.fresh.insert(group.clone(), (finding.incident.clone(), finding.time));
            }
        }
        if finding.rank == Some(1) {
            self.stopped = Some((finding.incident.clone(), finding.time));
        }
    }
}

fn is_event(finding: &Finding) -> bool {
    let rate = finding.model == Model::Cycle && finding.rank.is_none();
    !(rate || matches!(finding.kind, Kind::Gap | Kind::UnknownSignal))
}

fn is_delay(finding: &Finding) -> bool {
    matches!(finding.kind, Kind::Late | Kind::Early | Kind::Stall)
        || finding.kind == Kind::Sequence && finding.to.is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(model: Model, id: &str, group: &str, time_s: i64) -> Finding {
        let mut finding = Finding::new(Kind::Sequence, model, time_s * SECOND);
        finding.id = id.to_owned();
        finding.incident = id.to_owned();
        finding.group = Some(group.to_owned());
        finding.to = Some("x".to_owned());
        finding.rank = Some(3);
        finding
    }

    fn placed(findings: &mut [Finding]) -> Vec<&str> {
        let mut witnesses = Witnesses::default();
        for finding in findings.iter_mut() {
            witnesses.place(finding, 60 * SECOND);
        }
        findings.iter().map(|f| f.incident.as_str()).collect()
    }

    #[test]
    fn two_witnesses_one_incident() {
        let mut both =
            [finding(Model::Cycle, "c", "Press", 100), finding(Model::Device, "d", "Press", 101)];
        assert_eq!(placed(&mut both), ["c", "c"]);
    }

    #[test]
    fn a_later_line_keeps_its_incident() {
        let mut lines = [
            finding(Model::Cycle, "c", "Press", 100),
            finding(Model::Device, "d", "Press", 101),
            finding(Model::Device, "d", "Press", 1000),
        ];
        assert_eq!(placed(&mut lines)[2], "c");
    }

    #[test]
    fn an_alarm_stops_every_group() {
        let mut both =
            [finding(Model::Cycle, "c", "Press", 100), finding(Model::Device, "d", "Checks", 101)];
        both[0].rank = Some(1);
        assert_eq!(placed(&mut both), ["c", "c"]);
    }

    #[test]
    fn other_groups_and_other_times_are_other_incidents() {
        let mut others = [
            finding(Model::Cycle, "a", "Press", 100),
            finding(Model::Device, "b", "Robot", 101),
            finding(Model::Device, "d", "Press", 500),
        ];
        assert_eq!(placed(&mut others), ["a", "b", "d"]);
    }
}
