//! The sentences of findings, and where to look first. One place for all wording.

use std::fmt::Write as _;

use crate::finding::{Finding, Kind, Model, Suspect, stable_id};
use crate::log::{Nanoseconds, SECOND, SignalIndex};
use crate::plant::SignalClass;

use super::chains::ChainKind;
use super::check::Departure;
use super::model::NominalModel;
use super::rules::{Rule, row_of};
use super::states::StateId;

/// "RET_ON", "RET_ON or BACKWARD_OFF", at most three.
fn alternatives(model: &NominalModel, from: StateId, kind: ChainKind) -> Option<String> {
    let row = model.table.row(row_of(from, kind));
    let names: Vec<String> =
        row.clone().take(3).map(|r| model.short_state_name(model.rules[r].next, kind)).collect();
    let more = if row.len() > 3 { " or another known one" } else { "" };
    (!names.is_empty()).then(|| names.join(" or ") + more)
}

fn place_text(finding: &Finding) -> String {
    match (finding.model, &finding.group, &finding.device) {
        (Model::Group, Some(group), _) => group_text(group),
        (_, _, Some(device)) => device.clone(),
        _ => "The plant".to_owned(),
    }
}

/// "Group 7", but "Group1" as it is.
fn group_text(group: &str) -> String {
    if group.to_lowercase().starts_with("group") {
        group.to_owned()
    } else {
        format!("Group {group}")
    }
}

fn first_suspect(finding: &Finding) -> String {
    finding.suspects.first().map_or_else(String::new, |suspect| {
        let short = suspect.signal.splitn(3, '-').nth(2).unwrap_or(&suspect.signal);
        match &suspect.address {
            Some(address) if address != short => format!("; look at {short} ({address}) first"),
            _ => format!("; look at {short} first"),
        }
    })
}

/// An unknown transition.
pub fn transition(
    model: &NominalModel,
    from: StateId,
    finding: &Finding,
    kind: ChainKind,
) -> String {
    let learned: u64 = model.rules[model.table.row(row_of(from, kind))]
        .iter()
        .map(|rule| u64::from(rule.count))
        .sum();
    let to = finding.to.as_deref().unwrap_or_default();
    let event = finding.signal.as_deref().map_or_else(String::new, |signal| {
        let value = to.rsplit_once(signal).map_or("", |(_, suffix)| suffix);
        let happened = match value {
            "_ON" => "switched ON".to_owned(),
            "_OFF" => "switched OFF".to_owned(),
            other => format!("became {}", other.trim_start_matches('=')),
        };
        let address = finding.address.as_deref().filter(|a| *a != signal);
        let address = address.map_or_else(String::new, |a| format!(" ({a})"));
        let device = match kind {
            ChainKind::Device => String::new(),
            ChainKind::Group => format!("{} ", finding.device.as_deref().unwrap_or_default()),
        };
        format!("{device}{signal}{address} {happened}")
    });
    let expected = alternatives(model, from, kind).map_or_else(
        || "nothing was ever seen to follow".to_owned(),
        |names| format!("expected {names} (learned from {learned} passes)"),
    );
    format!(
        "{}: {event} right after {}; {expected}{}",
        place_text(finding),
        state_text_of(model, from, kind),
        first_suspect(finding)
    )
}

fn state_text_of(model: &NominalModel, state: StateId, kind: ChainKind) -> String {
    if (state as usize) < model.states.len() {
        model.short_state_name(state, kind)
    } else {
        "a value never seen before".to_owned()
    }
}

/// What is said of transitions that took too long or too short, but for the two times.
#[derive(Debug)]
pub struct TimeSentence {
    before: String,
    between: String,
    after: String,
}

impl TimeSentence {
    /// The sentence for one rule, whose finding is filled in but for its times.
    pub fn of(model: &NominalModel, rule: usize, from_trigger: bool, finding: &Finding) -> Self {
        let rule = &model.rules[rule];
        let kind = model.kind(rule.chain);
        let (verb, bound) = match finding.kind {
            Kind::Early => ("came too soon", "was not expected before"),
            _ => ("came late", "was due within"),
        };
        let after = rule.trigger.as_ref().filter(|_| from_trigger).map_or_else(
            || model.short_state_name(rule.current, kind),
            |trigger| {
                let states: Vec<String> =
                    trigger.states().map(|s| model.short_state_name(s, ChainKind::Group)).collect();
                format!("{}, which it waits for", states.join(" and "))
            },
        );
        let next = model.short_state_name(rule.next, kind);
        Self {
            before: format!("{}: {next} {verb}, ", place_text(finding)),
            between: format!(" s after {after}; it {bound} "),
            after: format!(" s{}", first_suspect(finding)),
        }
    }

    /// Says it of a time, in the place of what `message` says.
    pub fn say(&self, observed_s: f64, limit_s: f64, message: &mut String) {
        let Self { before, between, after } = self;
        message.clear();
        // A string takes everything.
        let _ = write!(message, "{before}{observed_s:.2}{between}{limit_s:.2}{after}");
    }
}

/// A group that has stopped.
pub fn stall(finding: &Finding) -> String {
    let awaited: Vec<String> = finding
        .expected
        .iter()
        .take(3)
        .map(|e| e.state.splitn(3, '-').nth(2).unwrap_or(&e.state).to_owned())
        .collect();
    let waiting = if awaited.is_empty() {
        String::new()
    } else {
        format!(", which should have been followed by {}", awaited.join(" or "))
    };
    let from = finding.from.as_deref().unwrap_or_default();
    let short = from.split_once('-').map_or(from, |(_, rest)| rest);
    format!(
        "{} has stopped: nothing has changed for {:.0} s; the last event was {short}{waiting}{}",
        group_text(finding.group.as_deref().unwrap_or_default()),
        finding.observed_s.unwrap_or_default(),
        first_suspect(finding)
    )
}

/// The group moves again.
pub fn stall_returned(finding: &Finding) -> String {
    format!("{} is moving again", group_text(finding.group.as_deref().unwrap_or_default()))
}

/// The device is back on known transitions.
pub fn returned(finding: &Finding) -> String {
    let first = finding.message.split("; expected").next().unwrap_or_default();
    format!("{first}; it is back on its known path")
}

/// The device did not come back in time.
pub fn not_returned(finding: &Finding, within_s: f64) -> String {
    format!("{}; not back on its known path within {within_s:.0} s", finding.message)
}

/// A path offered for confirmation.
pub fn alarm_path(finding: &Finding) -> String {
    let short: Vec<&str> =
        finding.path.iter().map(|s| s.splitn(3, '-').nth(2).unwrap_or(s.as_str())).collect();
    format!(
        "{} left its known path and came back: {}; confirm {} if this is normal",
        place_text(finding),
        short.join(" → "),
        finding.id
    )
}

/// A share or average that has changed.
pub fn departure(model: &NominalModel, departure: &Departure, finding: &Finding) -> String {
    let rule = &model.rules[departure.rule];
    let kind = model.kind(rule.chain);
    let (from, to) =
        (model.short_state_name(rule.current, kind), model.short_state_name(rule.next, kind));
    let place = place_text(finding);
    let shares = |shares: &[f64]| {
        shares.iter().fold(String::new(), |mut text, share| {
            let _ = write!(text, "{}{share:.2}", if text.is_empty() { "" } else { " and " });
            text
        })
    };
    match departure.kind {
        Kind::TransitionProbability => format!(
            "{place}: after {from}, {to} now follows in {:.0} % of cases instead of {:.0} %",
            100.0 * departure.observed,
            100.0 * departure.learned
        ),
        Kind::TimeProbability => format!(
            "{place}: {from} to {to} takes its usual times in other shares: {} instead of {}",
            shares(&departure.observed_shares),
            shares(&departure.learned_shares)
        ),
        _ => format!(
            "{place}: {from} to {to} now takes {:.2} s on average instead of {:.2} s",
            departure.observed, departure.learned
        ),
    }
}

/// Nothing was recorded.
pub fn gap(start: Nanoseconds, end: Nanoseconds) -> Finding {
    let seconds = end.saturating_sub(start) as f64 / SECOND as f64;
    let id = stable_id(Kind::Gap, "", "", "", start);
    let mut finding = plant_notice(Kind::Gap, id, end);
    finding.observed_s = Some(seconds);
    finding.message =
        format!("Nothing was recorded for {seconds:.1} s; watching starts afresh after it");
    finding
}

/// A signal the model does not know.
pub fn unknown_signal(name: &str, id: String, time: Nanoseconds) -> Finding {
    let mut finding = plant_notice(Kind::UnknownSignal, id, time);
    finding.signal = Some(name.to_owned());
    finding.message =
        format!("Signal {name} is not in the model; it is ignored until it is learned");
    finding
}

fn plant_notice(kind: Kind, id: String, time: Nanoseconds) -> Finding {
    Finding { incident: id.clone(), id, ..Finding::new(kind, Model::Plant, time) }
}

fn suspect(model: &NominalModel, signal: SignalIndex, score: f64) -> Suspect {
    Suspect {
        address: model.plant.signals[signal as usize].address().map(str::to_owned),
        signal: model.plant.full_name(signal),
        score,
    }
}

/// Score of a signal whose edge was skipped: what came instead is the known next but one.
const SKIPPED: f64 = 0.9;
/// Score of the signal that came unexpectedly, and of one that was awaited.
const UNEXPECTED: f64 = 0.6;
const AWAITED: f64 = 0.3;

/// After an unknown transition: an awaited signal that was skipped, the one that came, those
/// awaited.
pub fn transition_suspects(
    model: &NominalModel,
    from: StateId,
    (came, value): (SignalIndex, i64),
    kind: ChainKind,
) -> Vec<Suspect> {
    let mut suspects = vec![suspect(model, came, UNEXPECTED)];
    for rule in model.table.row(row_of(from, kind)) {
        let rule = &model.rules[rule];
        let awaited = model.states.signal_value(rule.next).0;
        if awaited == came {
            continue;
        }
        let skipped = model.states.find(came, value).is_some_and(|to| {
            model
                .table
                .find(&model.rules, row_of(rule.next, kind), to)
                .is_some_and(|next| model.rules[next].evidence() > 0)
        });
        let score = if skipped { SKIPPED } else { AWAITED };
        suspects.push(suspect(model, awaited, score * rule.probability));
    }
    ranked(suspects)
}

/// After a late transition: the signal that came late, and the output that should have caused it.
pub fn time_suspects(model: &NominalModel, rule: usize) -> Vec<Suspect> {
    let rule: &Rule = &model.rules[rule];
    let came = model.states.signal_value(rule.next).0;
    let awaited = rule.trigger.as_ref().map_or(rule.current, |trigger| trigger.states[0]);
    let before = model.states.signal_value(awaited).0;
    let actuator = model.plant.signals[before as usize].class == SignalClass::Output;
    let mut suspects = vec![suspect(model, came, UNEXPECTED)];
    if before != came {
        suspects.push(suspect(model, before, if actuator { SKIPPED } else { AWAITED }));
    }
    ranked(suspects)
}

/// After a stop: the last output given, whose effect never came, and the signals awaited.
pub fn stall_suspects(model: &NominalModel, last: StateId, signal: SignalIndex) -> Vec<Suspect> {
    let actuator = model.plant.signals[signal as usize].class == SignalClass::Output;
    let mut suspects = vec![suspect(model, signal, if actuator { SKIPPED } else { AWAITED })];
    for rule in model.table.row(row_of(last, ChainKind::Device)) {
        let awaited = model.states.signal_value(model.rules[rule].next).0;
        if awaited != signal {
            suspects.push(suspect(model, awaited, UNEXPECTED * model.rules[rule].probability));
        }
    }
    ranked(suspects)
}

fn ranked(mut suspects: Vec<Suspect>) -> Vec<Suspect> {
    suspects.sort_by(|a, b| b.score.total_cmp(&a.score));
    suspects.truncate(5);
    for suspect in &mut suspects {
        suspect.score = (suspect.score * 1e4).round() / 1e4;
    }
    suspects
}
