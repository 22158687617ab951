//! Findings as they are made: filled in, placed in an incident, told.

use std::sync::Arc;

use crate::finding::{Finding, Kind, Model, Severity, State, stable_id};
use crate::log::{Nanoseconds, SECOND};
use crate::signal_state::chains::{ChainIndex, ChainKind};
use crate::signal_state::events::Row;
use crate::signal_state::found::{self, Record, Timed, What};
use crate::signal_state::identity::{FindingId, Identity};
use crate::signal_state::incident::{Incident, Occurrence, Placement};
use crate::signal_state::model::Judgement;
use crate::signal_state::parameters::Timing;
use crate::signal_state::snapshot::Snapshot;
use crate::signal_state::states::NO_STATE;
use crate::signal_state::{check, message};

use super::step::{Entry, Waiting, Way};
use super::watch::{Clock, Here, OpenPath};
use super::{Monitor, SNAPSHOTS_AT_MOST};

impl Monitor {
    /// A time of a rule out of its limits; `way` is the rule's.
    #[cold]
    pub(super) fn report_time(&mut self, rule: usize, way: Way, time: Nanoseconds, timed: Timed) {
        let model = Arc::clone(&self.model);
        let plat = model.parameters.timing == Timing::Plat;
        let (kind, severity) = if plat {
            (Kind::Late, Severity::Anomaly)
        } else {
            let seconds = timed.seconds();
            let accepted = found::accepted(&model, rule, timed.as_learned);
            let kind = found::broken_limit(&model, rule, &accepted, seconds).0;
            let Judgement { evidence, budget, .. } = model.judgement();
            let odd = evidence.odd_time(&model.rules[rule], model.names(), seconds);
            let affordable = odd <= budget.per_time;
            (kind, if affordable { Severity::Anomaly } else { Severity::Notice })
        };
        // `plat` knows no consequences.
        let open = || model.judgement().evidence.is_open_wait(&model.rules[rule]);
        let inherits = !plat && (!timed.as_learned || open());
        let waiting = Waiting { since: timed.since, inherits };
        let what = What::Time { rule: rule as u32, timed };
        let record = Record { what, kind, severity, time, incident: None };
        self.place_record(record, way, waiting);
    }

    pub(super) fn report_unknown(
        &mut self,
        chain: ChainIndex,
        kind: ChainKind,
        Here { state: from, since, .. }: Here,
        Entry { state: to, time, .. }: Entry,
    ) {
        let model = Arc::clone(&self.model);
        let affordable = model.parameters.timing == Timing::Plat || {
            let Judgement { evidence, budget, .. } = model.judgement();
            let names = model.names();
            let way = (chain, from, self.teller().signal_value(to));
            evidence.unknown_transition(&model.rules, &model.table, names, way)
                <= budget.per_transition
        };
        let mut finding = self.teller().at(Kind::Transition, chain, to, time);
        finding.severity = if affordable { Severity::Fault } else { Severity::Notice };
        finding.state = State::Suspected;
        finding.from = Some(self.teller().state_name(from));
        finding.expected = self.teller().expected_from(from, kind);
        finding.observed_s = Some(time.saturating_sub(since).max(0) as f64 / SECOND as f64);
        finding.path = vec![self.teller().state_name(from), self.teller().state_name(to)];
        finding.suspects =
            message::transition_suspects(&model, from, self.teller().signal_value(to), kind);
        finding.message = message::transition(&model, from, &finding, kind);
        finding.id = stable_id(
            finding.kind,
            &self.teller().place_name(chain),
            finding.from.as_deref().unwrap_or_default(),
            finding.to.as_deref().unwrap_or_default(),
            time,
        );
        let deadline = time.saturating_add(self.fresh_for);
        let placed = self.place(finding, chain, Waiting { since, inherits: false });
        self.watch.here[chain].leave_path();
        self.watch.next_deadline = self.watch.next_deadline.min(deadline);
        self.watch.open.push(OpenPath {
            chain,
            finding: placed,
            path: vec![from, to],
            deadline,
            known: 0,
        });
    }

    #[cold]
    pub(super) fn stall_returned(&mut self, group: usize, time: Nanoseconds) {
        if let Some(mut stall) = self.watch.group_stalled[group].take() {
            stall.state = State::Returned;
            stall.time = time;
            stall.message = message::stall_returned(&stall);
            self.records.push(stall.into());
        }
    }

    pub(super) fn report_stall(&mut self, group: usize, due: Nanoseconds) {
        let model = Arc::clone(&self.model);
        let Clock { last: since, state: last, .. } = self.watch.clocks[group];
        let signal = self.teller().signal_value(last).0;
        let device = model.chains.device_chain(signal);
        let mut finding = self.teller().at(Kind::Stall, device, last, due);
        finding.model = Model::Group;
        finding.severity = Severity::Fault;
        finding.from = Some(self.teller().state_name(last));
        finding.to = None;
        finding.expected = self.teller().expected_from(last, ChainKind::Device);
        let waited = self.stall_after[group] as f64 / SECOND as f64;
        finding.observed_s = Some(waited);
        finding.limit_s = Some(waited);
        finding.path = vec![self.teller().state_name(last)];
        finding.suspects = message::stall_suspects(&model, last, signal);
        finding.message = message::stall(&finding);
        let waiting = Waiting { since, inherits: false };
        let placed = self.place(finding, device, waiting);
        self.watch.clocks[group].runs = false;
        self.watch.group_stalled[group] = Some(placed);
    }

    pub(super) fn report_unknown_signal(&mut self, row: Row) {
        let beyond = row.signal as usize - self.model.plant.signals.len();
        if let Some((name, named)) = self.watch.unknown_signals.get_mut(beyond)
            && !std::mem::replace(named, true)
        {
            let id = stable_id(Kind::UnknownSignal, name, "", "", row.time);
            self.records.push(message::unknown_signal(name, id, row.time).into());
        }
    }

    pub(super) fn check(&mut self, group: usize, time: Nanoseconds) {
        let model = Arc::clone(&self.model);
        let departures = check::departures(&model, group, &self.lanes);
        for departure in departures {
            let rule = &model.rules[departure.rule];
            let way = Way { chain: rule.chain, states: [rule.current, rule.next] };
            let kind = departure.kind;
            let what = What::Departure(Box::new(departure));
            let record = Record { what, kind, severity: Severity::Anomaly, time, incident: None };
            self.place_record(record, way, Waiting { since: time, inherits: false });
        }
        self.lanes.reset(group);
    }

    /// Gives a finding its id and incident, makes the snapshot, and reports it.
    pub(super) fn place(
        &mut self,
        mut finding: Finding,
        chain: ChainIndex,
        waiting: Waiting,
    ) -> Finding {
        if finding.id.is_empty() {
            finding.id = stable_id(
                finding.kind,
                &self.teller().place_name(chain),
                finding.from.as_deref().unwrap_or_default(),
                finding.to.as_deref().unwrap_or_default(),
                finding.time,
            );
        }
        let id = FindingId::Told(finding.id.as_str().into());
        let worth = finding.severity != Severity::Notice;
        let placement = self.placement(id, (finding.kind, worth), chain, finding.time, waiting);
        if placement.consequence && self.order.is_some() {
            finding.severity = Severity::Notice;
        }
        finding.incident = placement.incident.text(self.teller()).to_string();
        let first = finding.incident == finding.id;
        if first && worth && matches!(finding.kind, Kind::Transition | Kind::Stall) {
            let snapshot = Snapshot::of(&self.model, &finding, |chain| {
                let here = self.watch.here[chain];
                (here.state != NO_STATE).then(|| (self.teller().state_name(here.state), here.since))
            });
            finding.snapshot_id = Some(snapshot.id.clone());
            if self.watch.snapshots.len() < SNAPSHOTS_AT_MOST {
                self.watch.snapshots.push(snapshot);
            }
        }
        self.records.push(finding.clone().into());
        finding
    }

    /// Places a finding that is told later, and keeps it. Its rule is not looked up: it lies far
    /// from all else that a step needs.
    fn place_record(&mut self, mut record: Record, way: Way, waiting: Waiting) {
        let Way { chain, states } = way;
        let id = FindingId::Untold(Identity::new(record.kind, chain, states, record.time));
        let worth = record.severity != Severity::Notice;
        let placement = self.placement(id, (record.kind, worth), chain, record.time, waiting);
        if placement.consequence && self.order.is_some() {
            record.severity = Severity::Notice;
        }
        record.incident = Some(placement.incident);
        self.records.push(record);
    }

    /// The incident of a finding.
    fn placement(
        &mut self,
        id: FindingId,
        (kind, worth): (Kind, bool),
        chain: ChainIndex,
        time: Nanoseconds,
        waiting: Waiting,
    ) -> Placement {
        let group = self.model.chains.group_of(chain);
        let open = &mut self.watch.incidents[group];
        // What is no alarm itself explains none.
        if !worth && open.is_none() {
            return Placement { incident: id, consequence: false };
        }
        let occurrence = Occurrence {
            id,
            kind,
            chain,
            chain_kind: self.model.kind(chain),
            inherits: waiting.inherits,
            waiting_since: waiting.since,
            time,
        };
        Incident::place(open, occurrence, self.fresh_for)
    }
}
