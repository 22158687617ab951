//! Findings as they are made: filled in, placed in an incident, told.

use std::sync::Arc;

use crate::finding::{Expected, Finding, Kind, Model, Severity, State, stable_id};
use crate::log::{Nanoseconds, SECOND};
use crate::signal_state::chains::{ChainIndex, ChainKind};
use crate::signal_state::events::Row;
use crate::signal_state::incident::{Incident, Occurrence, Placement};
use crate::signal_state::parameters::Timing;
use crate::signal_state::rules::row_of;
use crate::signal_state::snapshot::Snapshot;
use crate::signal_state::states::{NO_STATE, StateId};
use crate::signal_state::{check, message};
use crate::timing::limits::Accepted;

use super::{Entry, Here, Monitor, OpenPath, SNAPSHOTS_AT_MOST, Timed, Waiting};

impl Monitor {
    /// The cluster whose maximum is most similar to a time (section 2.6).
    fn nearest_maximum(&self, rule: usize, seconds: f64) -> Option<usize> {
        let clusters = &self.model.rules[rule].clusters;
        (0..clusters.len()).min_by(|&a, &b| {
            let distance = |c: usize| (clusters[c].maximum_s - seconds).abs();
            distance(a).total_cmp(&distance(b))
        })
    }

    pub(super) fn report_time(
        &mut self,
        chain: ChainIndex,
        kind: ChainKind,
        rule: usize,
        time: Nanoseconds,
        timed: Timed,
    ) {
        let model = Arc::clone(&self.model);
        let seconds = timed.seconds();
        let accepted = self.accepted(rule, timed);
        let (found, limit_s) = match model.parameters.timing {
            Timing::Plat => {
                let cluster = self.nearest_maximum(rule, seconds);
                (Kind::Late, cluster.map_or(f64::INFINITY, |cluster| accepted[cluster].late_s))
            }
            Timing::Adaptive => broken_limit(&accepted, seconds),
        };
        let affordable = model.parameters.timing == Timing::Plat
            || model.evidence.odd_time(&model.rules[rule], model.names(), seconds)
                <= model.budget.per_time;
        let mut finding = self.at(found, chain, kind, model.rules[rule].next, time);
        finding.severity = if affordable { Severity::Anomaly } else { Severity::Notice };
        finding.from = Some(self.state_name(model.rules[rule].current));
        finding.expected = vec![Expected {
            state: finding.to.clone().unwrap_or_default(),
            probability: model.rules[rule].probability,
            limit_s: accepted.iter().map(|a| a.late_s).reduce(f64::max),
        }];
        finding.observed_s = Some(seconds);
        finding.limit_s = Some(limit_s);
        finding.suspects = message::time_suspects(&model, rule);
        finding.message = message::time(&model, rule, timed.as_learned, &finding);
        let inherits = !timed.as_learned || model.evidence.is_open_wait(&model.rules[rule]);
        self.place(finding, chain, kind, Waiting { since: timed.since, inherits });
    }

    pub(super) fn report_unknown(
        &mut self,
        chain: ChainIndex,
        kind: ChainKind,
        Here { state: from, since }: Here,
        Entry { state: to, time, .. }: Entry,
    ) {
        let model = Arc::clone(&self.model);
        let unseen = if model.parameters.timing == Timing::Plat {
            0.0
        } else {
            model.evidence.unknown_transition(
                &model.rules,
                &model.table,
                model.names(),
                (chain, from),
            )
        };
        let mut finding = self.at(Kind::Transition, chain, kind, to, time);
        finding.severity =
            if unseen <= model.budget.per_transition { Severity::Fault } else { Severity::Notice };
        finding.state = State::Suspected;
        finding.from = Some(self.state_name(from));
        finding.expected = self.expected_from(from, kind);
        finding.observed_s = Some(time.saturating_sub(since).max(0) as f64 / SECOND as f64);
        finding.path = vec![self.state_name(from), self.state_name(to)];
        finding.suspects = message::transition_suspects(&model, from, self.signal_value(to), kind);
        finding.message = message::transition(&model, from, &finding, kind);
        finding.id = stable_id(
            finding.kind,
            &self.place_name(chain),
            finding.from.as_deref().unwrap_or_default(),
            finding.to.as_deref().unwrap_or_default(),
            time,
        );
        let deadline = time.saturating_add(self.fresh_for);
        let placed = self.place(finding, chain, kind, Waiting { since, inherits: false }).clone();
        self.watch.off_path[chain] = true;
        self.watch.next_deadline = self.watch.next_deadline.min(deadline);
        self.watch.open.push(OpenPath {
            chain,
            finding: placed,
            path: vec![from, to],
            deadline,
            known: 0,
        });
    }

    /// Expected successors of a state, most probable first.
    pub(super) fn expected_from(&self, state: StateId, kind: ChainKind) -> Vec<Expected> {
        self.model
            .table
            .row(row_of(state, kind))
            .map(|rule| Expected {
                state: self.state_name(self.model.rules[rule].next),
                probability: self.model.rules[rule].probability,
                limit_s: self.model.latest_s(rule),
            })
            .collect()
    }

    #[cold]
    pub(super) fn stall_returned(&mut self, group: usize, time: Nanoseconds) {
        if let Some(mut stall) = self.watch.group_stalled[group].take() {
            stall.state = State::Returned;
            stall.time = time;
            stall.message = message::stall_returned(&stall);
            self.findings.push(stall);
        }
    }

    pub(super) fn report_stall(&mut self, group: usize, due: Nanoseconds) {
        let model = Arc::clone(&self.model);
        let last = self.watch.group_last_state[group];
        let signal = self.signal_value(last).0;
        let device = model.chains.device_chain(signal);
        let since = self.watch.group_last[group];
        let mut finding = self.at(Kind::Stall, device, ChainKind::Device, last, due);
        finding.model = Model::Group;
        finding.severity = Severity::Fault;
        finding.from = Some(self.state_name(last));
        finding.to = None;
        finding.expected = self.expected_from(last, ChainKind::Device);
        let waited = self.stall_after[group] as f64 / SECOND as f64;
        finding.observed_s = Some(waited);
        finding.limit_s = Some(waited);
        finding.path = vec![self.state_name(last)];
        finding.suspects = message::stall_suspects(&model, last, signal);
        finding.message = message::stall(&finding);
        let waiting = Waiting { since, inherits: false };
        let placed = self.place(finding, device, ChainKind::Device, waiting).clone();
        self.watch.group_stalled[group] = Some(placed);
    }

    pub(super) fn report_unknown_signal(&mut self, row: Row) {
        let beyond = row.signal as usize - self.model.plant.signals.len();
        if let Some((name, named)) = self.watch.unknown_signals.get_mut(beyond)
            && !std::mem::replace(named, true)
        {
            let id = stable_id(Kind::UnknownSignal, name, "", "", row.time);
            self.findings.push(message::unknown_signal(name, id, row.time));
        }
    }

    pub(super) fn check(&mut self, group: usize, time: Nanoseconds) {
        let model = Arc::clone(&self.model);
        let departures = check::departures(&model, group, &self.lanes);
        for departure in departures {
            let rule = &model.rules[departure.rule];
            let kind = model.chains.kind(rule.chain);
            let mut finding = self.at(departure.kind, rule.chain, kind, rule.next, time);
            finding.severity = Severity::Anomaly;
            finding.from = Some(self.state_name(rule.current));
            finding.expected = self.expected_from(rule.current, kind);
            finding.observed_s = Some(departure.observed);
            finding.limit_s = Some(departure.learned);
            finding.message = message::departure(&model, &departure, &finding);
            self.place(finding, rule.chain, kind, Waiting { since: time, inherits: false });
        }
        self.lanes.reset(group);
    }

    /// A finding of a kind at a chain, its state's signal filled in.
    pub(super) fn at(
        &self,
        kind: Kind,
        chain: ChainIndex,
        chain_kind: ChainKind,
        state: StateId,
        time: Nanoseconds,
    ) -> Finding {
        let plant = &self.model.plant;
        let index = self.signal_value(state).0;
        let signal = &plant.signals[index as usize];
        let model = match chain_kind {
            ChainKind::Device => Model::Device,
            ChainKind::Group => Model::Group,
        };
        Finding {
            group: Some(self.model.group_name(chain).to_owned()),
            device: Some(plant.device_of(index).name.clone()),
            signal: Some(signal.name.clone()),
            address: signal.address.clone(),
            to: Some(self.state_name(state)),
            ..Finding::new(kind, model, time)
        }
    }

    pub(super) fn place_name(&self, chain: ChainIndex) -> String {
        format!("{}/{}", self.model.group_name(chain), self.model.device_name(chain).unwrap_or(""))
    }

    /// Gives a finding its id and incident, makes the snapshot, and reports it.
    pub(super) fn place(
        &mut self,
        mut finding: Finding,
        chain: ChainIndex,
        kind: ChainKind,
        waiting: Waiting,
    ) -> &Finding {
        if finding.id.is_empty() {
            finding.id = stable_id(
                finding.kind,
                &self.place_name(chain),
                finding.from.as_deref().unwrap_or_default(),
                finding.to.as_deref().unwrap_or_default(),
                finding.time,
            );
        }
        let group = self.model.chains.group_of(chain);
        let occurrence = Occurrence {
            id: &finding.id,
            kind: finding.kind,
            chain,
            chain_kind: kind,
            inherits: waiting.inherits,
            waiting_since: waiting.since,
            time: finding.time,
        };
        // What is no alarm itself explains none.
        let worth = finding.severity != Severity::Notice;
        let placement = if worth || self.watch.incidents[group].is_some() {
            Incident::place(&mut self.watch.incidents[group], occurrence, self.fresh_for)
        } else {
            Placement { incident: finding.id.clone(), consequence: false }
        };
        if placement.consequence && self.order.is_some() {
            finding.severity = Severity::Notice;
        }
        let first = placement.incident == finding.id;
        finding.incident = placement.incident;
        if first && worth && matches!(finding.kind, Kind::Transition | Kind::Stall) {
            let snapshot = Snapshot::of(&self.model, &finding, |chain| {
                let here = self.watch.here[chain];
                (here.state != NO_STATE).then(|| (self.state_name(here.state), here.since))
            });
            finding.snapshot_id = Some(snapshot.id.clone());
            if self.watch.snapshots.len() < SNAPSHOTS_AT_MOST {
                self.watch.snapshots.push(snapshot);
            }
        }
        let place = self.findings.len();
        self.findings.push(finding);
        &self.findings[place]
    }
}

/// Which limit a time broke, and where that limit lies.
fn broken_limit(accepted: &[Accepted], seconds: f64) -> (Kind, f64) {
    let late = accepted.iter().map(|a| a.late_s).filter(|&limit| limit < seconds).reduce(f64::max);
    let early =
        accepted.iter().map(|a| a.early_s).filter(|&limit| limit > seconds).reduce(f64::min);
    match (late, early) {
        (Some(late), Some(early)) if early - seconds < seconds - late => (Kind::Early, early),
        (Some(late), _) => (Kind::Late, late),
        (None, early) => (Kind::Early, early.unwrap_or(0.0)),
    }
}
