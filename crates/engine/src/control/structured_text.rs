//! A learned controller as IEC 61131-3 Structured Text: a CASE over the markings the net can rest
//! in, counters as CTU, timers as TON.

mod declarations;
mod names;
mod start;
mod states;

use std::fmt::Write as _;
use std::sync::Arc;

use super::controller::safe_state;
use super::counters::Counters;
use super::error::ControlError;
use super::follower::Follower;
use super::guards::Guards;
use super::program::{Program, TerminalIndex};
use super::situations::Situation;
use super::tree::Counter;
use crate::process::petri::Marking;
use names::Names;

/// States of one program; PLCs have little memory, and people less.
const MOST_STATES: usize = 1_000;
/// Events of one scan; see `Controller`.
const MOST_EVENTS: usize = 100;
/// Looks itself up in the inputs.
const START: i64 = -1;
/// Has given up.
const SAFE: i64 = -2;

/// Everything the parts of the text are written from.
struct Text {
    program: Arc<Program>,
    names: Names,
    /// Markings, by state.
    states: Vec<Marking>,
    situations: Vec<Situation>,
    counters: Vec<(Counter, u32)>,
    /// States whose outputs wait for a timer, and how long in seconds.
    timers: Vec<(usize, f64)>,
    safe: Vec<(TerminalIndex, i64)>,
    follower: Follower,
}

/// Writes a net and its guards as a program called `name`.
///
/// # Errors
/// A net that cannot control by guards alone, or is too large.
pub fn write(
    program: &Arc<Program>,
    guards: &Guards,
    safe: &[(String, i64)],
    name: &str,
) -> Result<String, ControlError> {
    let safe = safe_state(program, safe)?;
    let mut follower = Follower::new(Arc::clone(program), guards.clone(), None)?;
    let situations = follower.situations()?;
    let mut states: Vec<Marking> = Vec::new();
    for situation in &situations {
        if !states.contains(&situation.marking) {
            states.push(situation.marking.clone());
        }
        if states.len() > MOST_STATES {
            return Err(ControlError::TooLarge { most: MOST_STATES });
        }
    }
    let text = Text {
        program: Arc::clone(program),
        names: Names::of(program),
        counters: presets(&follower.counters),
        timers: states::timers(&follower.counters, &states),
        states,
        situations,
        safe,
        follower,
    };
    Ok(text.whole(name))
}

/// Every counter with each preset it is asked for: one CTU each.
fn presets(counters: &Counters) -> Vec<(Counter, u32)> {
    let mut all = Vec::new();
    for tree in counters.guards().points.iter().filter_map(|point| point.choice.as_ref()) {
        tree.each_count(&mut |counter, preset| {
            let asked = (counter.clone(), preset);
            if !all.contains(&asked) {
                all.push(asked);
            }
        });
    }
    all
}

impl Text {
    fn whole(mut self, name: &str) -> String {
        let mut text = String::new();
        let title = if self.program.net.name.is_empty() { "a net" } else { &self.program.net.name };
        let title = title.replace("(*", "").replace("*)", "");
        let _ = writeln!(
            text,
            "(* Learned by runglight from {title}. Test it against a simulation, and beside the \
             real program, before it moves anything. *)"
        );
        let _ = writeln!(text, "PROGRAM {}", Names::identifier(name));
        self.declare(&mut text);
        self.look_up(&mut text);
        self.run(&mut text);
        text.push_str("END_PROGRAM\n");
        text
    }

    /// `IX0_1` or `NOT IX0_1`, or a comparison for words.
    fn is(&self, name: &str, terminal: TerminalIndex, value: i64) -> String {
        match (self.names.is_bit(terminal), value) {
            (true, 0) => format!("NOT {name}"),
            (true, _) => name.to_owned(),
            (false, value) => format!("{name} = {value}"),
        }
    }

    fn literal(&self, terminal: TerminalIndex, value: i64) -> String {
        match (self.names.is_bit(terminal), value) {
            (true, 0) => "FALSE".to_owned(),
            (true, _) => "TRUE".to_owned(),
            (false, value) => value.to_string(),
        }
    }

    fn terminals(&self, output: bool) -> impl Iterator<Item = TerminalIndex> {
        let terminals = &self.program.terminals;
        (0..terminals.len()).filter(move |&terminal| terminals[terminal].output == output)
    }

    fn state_of(&self, marking: &[u32]) -> Option<usize> {
        self.states.iter().position(|state| state == marking)
    }
}

/// `T#1500ms`.
fn time(seconds: f64) -> String {
    format!("T#{}ms", (seconds * 1e3).round() as i64)
}
