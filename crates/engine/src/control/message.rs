//! The findings of a controller and of its shadow. One place for all wording.

use super::controller::Mode;
use super::follower::{Follower, Image};
use super::program::{Program, TerminalIndex};
use crate::finding::{Expected, Finding, Kind, Model, Severity, Suspect, stable_id};
use crate::log::Nanoseconds;

/// Alternatives named in one sentence.
const NAMED_AT_MOST: usize = 3;

/// The plant did what the net does not allow.
pub fn departed(
    follower: &mut Follower,
    image: &Image,
    pending: &[TerminalIndex],
    now: Nanoseconds,
) -> Finding {
    let kind = if known(&follower.program, image, pending) {
        Kind::Transition
    } else {
        Kind::UnknownSignal
    };
    let seen = shown(&follower.program, image, pending);
    let mut finding = at(follower, kind, &seen, pending, now);
    let what = if kind == Kind::Transition { "came out of turn" } else { "has never been seen" };
    finding.message = format!(
        "{seen} {what} after {}; expected {}",
        follower.last(),
        alternatives(&finding.expected)
    );
    finding
}

/// The real controller did what the learned one would not.
pub fn disagreed(
    follower: &mut Follower,
    image: &Image,
    pending: &[TerminalIndex],
    now: Nanoseconds,
) -> Finding {
    let mut finding = departed(follower, image, pending, now);
    let seen = shown(&follower.program, image, pending);
    finding.message = format!(
        "The controller set {seen} after {}; the learned one expected {}",
        follower.last(),
        alternatives(&finding.expected)
    );
    finding
}

/// The real controller set an output sooner than it ever did.
pub fn early(
    follower: &mut Follower,
    image: &Image,
    pending: &[TerminalIndex],
    after_s: f64,
    now: Nanoseconds,
) -> Finding {
    let mut finding = disagreed(follower, image, pending, now);
    let rested_s = follower.rested_s(now);
    finding.kind = Kind::Early;
    finding.severity = Severity::Anomaly;
    finding.observed_s = Some(rested_s);
    finding.limit_s = Some(after_s);
    finding.message = format!(
        "The controller set {} {rested_s:.1} s after {}; learned was a delay of {after_s:.1} s",
        shown(&follower.program, image, pending),
        follower.last()
    );
    finding
}

/// Nothing came, or the real controller did nothing, for too long.
pub fn late(follower: &mut Follower, limit_s: f64, now: Nanoseconds, kind: Kind) -> Finding {
    let rested_s = follower.rested_s(now);
    let mut finding = at(follower, kind, "", &[], now);
    let expected = alternatives(&finding.expected);
    let first = finding.expected.first().map(|expected| expected.state.clone());
    finding.severity = Severity::Anomaly;
    finding.observed_s = Some(rested_s);
    finding.limit_s = Some(limit_s);
    finding.to = None;
    finding.address = first.as_deref().and_then(|label| label.split('=').next()).map(str::to_owned);
    finding.signal.clone_from(&finding.address);
    finding.message = format!(
        "{expected} did not come: due within {limit_s:.1} s after {}, waited {rested_s:.1} s",
        follower.last()
    );
    finding
}

/// Outputs are not what was written.
pub fn disobeyed(
    follower: &Follower,
    image: &Image,
    foreign: &[TerminalIndex],
    now: Nanoseconds,
) -> Finding {
    let seen = shown(&follower.program, image, foreign);
    let mut finding = new(Kind::Transition, follower.last(), &seen, now);
    place(&mut finding, &follower.program, foreign);
    let written: Vec<String> =
        foreign.iter().map(|&t| text(&follower.program, t, follower.told[t])).collect();
    finding.message = format!(
        "{seen} where {} was written: something else writes this output, or the PLC does not obey",
        written.join(" & ")
    );
    finding
}

/// The plant stands as the net never does.
pub fn unknown_start(program: &Program, image: &Image, now: Nanoseconds) -> Finding {
    let inputs: Vec<_> = (0..image.len()).filter(|&t| !program.terminals[t].output).collect();
    let seen = shown(program, image, &inputs);
    let mut finding = new(Kind::StartState, "", &seen, now);
    finding.from = None;
    finding.message = format!(
        "The plant stands at {seen}, where the learned controller never stood; \
         bring it into a state of its normal work first"
    );
    finding
}

/// The net fires without end.
pub fn circles(follower: &Follower, now: Nanoseconds) -> Finding {
    let mut finding = new(Kind::Transition, follower.last(), "", now);
    finding.to = None;
    finding.message =
        format!("The net goes in circles after {} without waiting for anything", follower.last());
    finding
}

/// Says in the finding that the controller has given up.
pub fn made_safe(finding: &mut Finding, program: &Program, safe: &[(TerminalIndex, i64)]) {
    let values: Vec<_> = safe.iter().map(|&(t, value)| text(program, t, Some(value))).collect();
    finding.severity = Severity::Fault;
    finding.message = format!("{}; safe state: {}", finding.message, values.join(", "));
}

/// What a controller is doing, for people.
pub fn mode(mode: Mode) -> &'static str {
    match mode {
        Mode::Starting => "starting",
        Mode::Running => "running",
        Mode::Safe => "safe",
    }
}

fn at(
    follower: &mut Follower,
    kind: Kind,
    seen: &str,
    pending: &[TerminalIndex],
    now: Nanoseconds,
) -> Finding {
    let mut finding = new(kind, follower.last(), seen, now);
    finding.expected = follower
        .expected()
        .into_iter()
        .map(|(state, probability, limit_s)| Expected { state, probability, limit_s })
        .collect();
    finding.path =
        follower.run.iter().map(|f| follower.program.label(f.transition).to_owned()).collect();
    place(&mut finding, &follower.program, pending);
    finding
}

fn new(kind: Kind, from: &str, seen: &str, now: Nanoseconds) -> Finding {
    let mut finding = Finding::new(kind, Model::Process, now);
    finding.id = stable_id(kind, "process", from, seen, now);
    finding.incident.clone_from(&finding.id);
    finding.severity = Severity::Fault;
    finding.from = Some(from.to_owned());
    finding.to = Some(seen.to_owned());
    finding
}

fn place(finding: &mut Finding, program: &Program, pending: &[TerminalIndex]) {
    let address = |&terminal: &TerminalIndex| program.terminals[terminal].address.clone();
    finding.address = pending.first().map(address);
    finding.signal.clone_from(&finding.address);
    finding.suspects = pending
        .iter()
        .map(|terminal| Suspect {
            address: Some(address(terminal)),
            signal: address(terminal),
            score: 1.0 / pending.len() as f64,
        })
        .collect();
}

/// Whether the net knows each of these changes, wherever it is.
fn known(program: &Program, image: &Image, pending: &[TerminalIndex]) -> bool {
    let changes = || program.activities.iter().flatten().flat_map(|activity| &activity.changes);
    pending
        .iter()
        .all(|&t| changes().any(|&(terminal, value)| (terminal, Some(value)) == (t, image[t])))
}

fn shown(program: &Program, image: &Image, terminals: &[TerminalIndex]) -> String {
    let texts: Vec<_> = terminals.iter().map(|&t| text(program, t, image[t])).collect();
    texts.join(" & ")
}

fn text(program: &Program, terminal: TerminalIndex, value: Option<i64>) -> String {
    let address = &program.terminals[terminal].address;
    value.map_or_else(|| format!("{address}=?"), |value| format!("{address}={value}"))
}

fn alternatives(expected: &[Expected]) -> String {
    let likely: Vec<_> = expected.iter().filter(|e| e.probability > 0.0).collect();
    let named: Vec<_> = likely.iter().take(NAMED_AT_MOST).map(|e| e.state.as_str()).collect();
    let more = likely.len().saturating_sub(NAMED_AT_MOST);
    match (named.is_empty(), more) {
        (true, _) => "nothing".to_owned(),
        (false, 0) => named.join(" or "),
        (false, more) => format!("{} or {more} more", named.join(", ")),
    }
}
