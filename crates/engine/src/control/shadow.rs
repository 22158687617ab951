//! The learned controller beside the real one: it writes nothing and reports every disagreement.

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
use crate::log::{Nanoseconds, SECOND};

/// Follows a plant and its controller.
///
/// A change that does not fit is held for `patience`: inputs and outputs are read one after the
/// other, so an act can be seen before the input that caused it.
pub struct Shadow {
    follower: Follower,
    situations: Vec<Situation>,
    patience: Nanoseconds,
    following: bool,
    started: bool,
    before: Vec<Option<i64>>,
    stuck_since: Option<Nanoseconds>,
    told_late: bool,
}

impl Shadow {
    /// Ready for its first scan; `patience_s` is how long the real controller may take to act.
    ///
    /// # Errors
    /// A net that cannot control, or guards of another net.
    pub fn new(
        program: Arc<Program>,
        guards: Guards,
        decide: Option<Box<dyn Decide>>,
        patience_s: f64,
    ) -> Result<Self, ControlError> {
        let before = vec![None; program.terminals.len()];
        let mut follower = Follower::new(program, guards, decide)?;
        let situations = follower.situations()?;
        let patience = (patience_s * SECOND as f64) as Nanoseconds;
        Ok(Self {
            follower,
            situations,
            patience,
            following: false,
            started: false,
            before,
            stuck_since: None,
            told_late: false,
        })
    }

    /// Whether it knows where the plant stands.
    pub fn following(&self) -> bool {
        self.following
    }

    /// The last activity of the net.
    pub fn last(&self) -> &str {
        self.follower.last()
    }

    /// Nothing was seen for a while: it waits for the next run to open.
    pub fn gap(&mut self) {
        self.lose();
    }

    /// One scan: all terminals as they were read at `now`.
    pub fn scan(&mut self, now: Nanoseconds, image: &Image) -> Vec<Finding> {
        let mut findings = Vec::new();
        if !self.started {
            self.started = true;
            self.stand(now, image, &mut findings);
        } else if !self.following {
            self.wait_for_opening(now, image);
        }
        if self.following {
            self.follow(now, image, &mut findings);
        }
        self.before = image.to_vec();
        findings
    }

    fn stand(&mut self, now: Nanoseconds, image: &Image, findings: &mut Vec<Finding>) {
        match self.follower.standing(&self.situations, image) {
            Some(situation) => {
                self.follower.stand(situation, now);
                // Outputs may lag behind at power-on; what they are is where they start from.
                for (terminal, value) in image.iter().enumerate() {
                    if self.follower.program.terminals[terminal].output {
                        self.follower.told[terminal] = *value;
                    }
                }
                // Only where a run opens is it known that nothing has been counted in it.
                self.follower.counters.forget();
                if let Some(opened) = situation.after.filter(|_| situation.opens) {
                    self.follower.counters.fired(opened, true);
                }
                self.following = true;
            }
            None => {
                findings.push(message::unknown_start(&self.follower.program, image, now));
            }
        }
    }

    fn lose(&mut self) {
        self.following = false;
        self.stuck_since = None;
        self.told_late = false;
        // After a gap the next scan is no change.
        self.before.fill(None);
    }

    fn wait_for_opening(&mut self, now: Nanoseconds, image: &Image) {
        if self.before.iter().all(Option::is_none) {
            return;
        }
        self.follower.told.clone_from(&self.before);
        self.following = self.follower.open(image, now).is_some();
    }

    fn follow(&mut self, now: Nanoseconds, image: &Image, findings: &mut Vec<Finding>) {
        loop {
            if let Some(way) = self.follower.input_move(image) {
                self.follower.fire(&way, now);
            } else if !self.act(now, image, findings) {
                break;
            }
            self.stuck_since = None;
            self.told_late = false;
        }
        self.judge(now, image, findings);
    }

    /// Follows an act of the real controller; false where there is none to follow now.
    fn act(&mut self, now: Nanoseconds, image: &Image, findings: &mut Vec<Finding>) -> bool {
        let Some(way) = self.follower.output_move(image) else { return false };
        let pending = self.follower.pending(image, true);
        match self.follower.intention() {
            Choice::Output(transition, after_s) if transition == way.transition => {
                let patience_s = self.patience as f64 / SECOND as f64;
                if self.follower.rested_s(now) < after_s - patience_s {
                    findings.push(message::early(
                        &mut self.follower,
                        image,
                        &pending,
                        after_s,
                        now,
                    ));
                }
            }
            Choice::Unknown => {}
            Choice::Output(..) | Choice::Wait => {
                if !self.impatient(now) {
                    return false;
                }
                findings.push(message::disagreed(&mut self.follower, image, &pending, now));
            }
        }
        self.follower.fire(&way, now);
        true
    }

    /// What is left over once all that fits has been followed.
    fn judge(&mut self, now: Nanoseconds, image: &Image, findings: &mut Vec<Finding>) {
        let inputs = self.follower.pending(image, false);
        let outputs = self.follower.pending(image, true);
        if inputs.is_empty() && outputs.is_empty() {
            self.stuck_since = None;
            self.judge_time(now, findings);
        } else if self.impatient(now) {
            findings.push(self.departure(now, image, &inputs, &outputs));
            self.lose();
        }
    }

    fn departure(
        &mut self,
        now: Nanoseconds,
        image: &Image,
        inputs: &[TerminalIndex],
        outputs: &[TerminalIndex],
    ) -> Finding {
        if outputs.is_empty() {
            message::departed(&mut self.follower, image, inputs, now)
        } else {
            message::disagreed(&mut self.follower, image, outputs, now)
        }
    }

    fn judge_time(&mut self, now: Nanoseconds, findings: &mut Vec<Finding>) {
        let limit_s = match self.follower.intention() {
            Choice::Output(_, after_s) => Some(after_s + self.patience as f64 / SECOND as f64),
            Choice::Wait | Choice::Unknown => self.follower.limit_s(),
        };
        if let Some(limit_s) = limit_s.filter(|&limit_s| self.follower.rested_s(now) > limit_s)
            && !self.told_late
        {
            self.told_late = true;
            findings.push(message::late(&mut self.follower, limit_s, now, Kind::Late));
        }
    }

    fn impatient(&mut self, now: Nanoseconds) -> bool {
        now - *self.stuck_since.get_or_insert(now) >= self.patience
    }
}
