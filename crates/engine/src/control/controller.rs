//! Algorithm 2 of Theis 2019 at every scan, and a safe state where the plant leaves the net.

use std::sync::Arc;

use super::counters::Choice;
use super::decide::Decide;
use super::error::ControlError;
use super::follower::{Follower, Image};
use super::guards::Guards;
use super::message;
use super::program::{Program, TerminalIndex};
use super::situations::Situation;
use crate::finding::{Finding, Kind};
use crate::log::Nanoseconds;

/// Events of one scan; a net that makes more turns in circles without waiting.
const MOST_EVENTS: usize = 1_000;
/// Scans in a row in which an output is not what was written.
const DISOBEYED_SCANS: u32 = 2;

/// What the controller is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// No scan yet.
    Starting,
    /// In control.
    Running,
    /// It has given up, and holds the safe state.
    Safe,
}

/// What one scan comes to.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scan {
    /// Outputs to write, in this order.
    pub writes: Vec<(TerminalIndex, i64)>,
    /// What departed.
    pub findings: Vec<Finding>,
}

/// A learned controller in the place of the PLC's program.
pub struct Controller {
    follower: Follower,
    situations: Vec<Situation>,
    safe: Vec<(TerminalIndex, i64)>,
    mode: Mode,
    disobeyed: u32,
}

impl Controller {
    /// Ready for its first scan. `safe` names the outputs of the safe state; others are 0 in it.
    ///
    /// # Errors
    /// A net that cannot control, guards of another net, or a safe value for no output.
    pub fn new(
        program: Arc<Program>,
        guards: Guards,
        decide: Option<Box<dyn Decide>>,
        safe: &[(String, i64)],
    ) -> Result<Self, ControlError> {
        let safe = safe_state(&program, safe)?;
        let mut follower = Follower::new(program, guards, decide)?;
        let situations = follower.situations()?;
        Ok(Self { follower, situations, safe, mode: Mode::Starting, disobeyed: 0 })
    }

    /// What it is doing.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// The outputs of the safe state.
    pub fn safe(&self) -> &[(TerminalIndex, i64)] {
        &self.safe
    }

    /// The last activity of the net.
    pub fn last(&self) -> &str {
        self.follower.last()
    }

    /// One scan: all terminals as they were read at `now`.
    pub fn scan(&mut self, now: Nanoseconds, image: &Image) -> Scan {
        let mut scan = Scan::default();
        let before = match self.mode {
            Mode::Safe => {
                scan.writes = differing(&self.safe, image);
                return scan;
            }
            Mode::Starting => self.start(now, image),
            Mode::Running => self.obeyed(now, image),
        };
        match before.or_else(|| self.control(now, image)) {
            Some(mut finding) => {
                self.mode = Mode::Safe;
                message::made_safe(&mut finding, &self.follower.program, &self.safe);
                scan.findings.push(finding);
                scan.writes = differing(&self.safe, image);
            }
            None => {
                let told = &self.follower.told;
                let wanted: Vec<_> = self
                    .outputs()
                    .filter_map(|terminal| Some((terminal, told[terminal]?)))
                    .collect();
                scan.writes = differing(&wanted, image);
            }
        }
        scan
    }

    fn outputs(&self) -> impl Iterator<Item = TerminalIndex> {
        let terminals = &self.follower.program.terminals;
        (0..terminals.len()).filter(|&terminal| terminals[terminal].output)
    }

    /// Looks itself up in what the plant shows.
    fn start(&mut self, now: Nanoseconds, image: &Image) -> Option<Finding> {
        let Some(situation) = self.follower.standing(&self.situations, image) else {
            return Some(message::unknown_start(&self.follower.program, image, now));
        };
        self.follower.stand(situation, now);
        self.follower.counters.clear();
        if let Some(opened) = situation.after {
            self.follower.counters.fired(opened, false);
        }
        self.mode = Mode::Running;
        None
    }

    /// Whether the outputs are still what was written.
    fn obeyed(&mut self, now: Nanoseconds, image: &Image) -> Option<Finding> {
        let foreign = self.follower.pending(image, true);
        self.disobeyed = if foreign.is_empty() { 0 } else { self.disobeyed + 1 };
        (self.disobeyed >= DISOBEYED_SCANS)
            .then(|| message::disobeyed(&self.follower, image, &foreign, now))
    }

    fn control(&mut self, now: Nanoseconds, image: &Image) -> Option<Finding> {
        let follower = &mut self.follower;
        for _ in 0..MOST_EVENTS {
            // What has happened already comes before what may be done.
            if let Some(way) = follower.input_move(image) {
                follower.fire(&way, now);
                continue;
            }
            if let Choice::Output(transition, after_s) = follower.intention()
                && follower.rested_s(now) >= after_s
                && let Some(way) = follower.ways().iter().find(|way| way.transition == transition)
            {
                follower.fire(way, now);
                continue;
            }
            let pending = follower.pending(image, false);
            if !pending.is_empty() {
                return Some(message::departed(follower, image, &pending, now));
            }
            let late = follower.limit_s().filter(|&limit_s| follower.rested_s(now) > limit_s);
            return late.map(|limit_s| message::late(follower, limit_s, now, Kind::Late));
        }
        Some(message::circles(follower, now))
    }
}

/// The safe state: every output 0 but those named.
///
/// # Errors
/// A name that is no output of the net.
pub fn safe_state(
    program: &Program,
    named: &[(String, i64)],
) -> Result<Vec<(TerminalIndex, i64)>, ControlError> {
    let outputs = || (0..program.terminals.len()).filter(|&t| program.terminals[t].output);
    for (address, _) in named {
        if outputs().all(|terminal| program.terminals[terminal].address != *address) {
            let known: Vec<_> = outputs().map(|t| program.terminals[t].address.as_str()).collect();
            return Err(ControlError::NoSuchOutput {
                address: address.clone(),
                outputs: known.join(", "),
            });
        }
    }
    let value = |terminal: TerminalIndex| {
        let address = &program.terminals[terminal].address;
        named.iter().find(|(name, _)| name == address).map_or(0, |(_, value)| *value)
    };
    Ok(outputs().map(|terminal| (terminal, value(terminal))).collect())
}

/// What has to be written: outputs that go off first, so that nothing is on together that never was.
fn differing(wanted: &[(TerminalIndex, i64)], image: &Image) -> Vec<(TerminalIndex, i64)> {
    let mut writes: Vec<_> = wanted
        .iter()
        .copied()
        .filter(|&(terminal, value)| image[terminal] != Some(value))
        .collect();
    writes.sort_by_key(|&(terminal, value)| (value != 0, terminal));
    writes
}
