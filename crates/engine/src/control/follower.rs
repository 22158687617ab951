//! A net at the place where a plant stands: what the controller, its shadow and the learner share.

use std::sync::Arc;

use super::counters::{Choice, Counters};
use super::decide::{Decide, Fired};
use super::error::ControlError;
use super::guards::Guards;
use super::moves::{Move, Moves};
use super::program::{Program, TerminalIndex};
use super::situations::{Situation, explore};
use crate::log::{Nanoseconds, SECOND};
use crate::process::petri::Marking;

/// The values of all terminals in one scan; `None` where one is not read.
pub type Image = [Option<i64>];

/// A rest longer than this many times the longest learned one, and a second more, is too long.
const LATE_FACTOR: f64 = 1.5;
const LATE_ALLOWANCE_S: f64 = 1.0;

/// A net, its guards, and where the two stand.
pub struct Follower {
    /// The net.
    pub program: Arc<Program>,
    /// What has been counted.
    pub counters: Counters,
    /// The events of the present run.
    pub run: Vec<Fired>,
    /// Where the tokens are.
    pub marking: Marking,
    /// Time of the last event.
    pub since: Nanoseconds,
    /// The values that events have told, by terminal.
    pub told: Vec<Option<i64>>,
    moves: Moves,
    decide: Option<Box<dyn Decide>>,
    decided: Option<(Choice, Vec<f64>)>,
}

impl Follower {
    /// Before the first event.
    ///
    /// # Errors
    /// Guards of another net.
    pub fn new(
        program: Arc<Program>,
        guards: Guards,
        decide: Option<Box<dyn Decide>>,
    ) -> Result<Self, ControlError> {
        Ok(Self {
            counters: Counters::new(&program, guards)?,
            run: Vec::new(),
            marking: program.net.initial.clone(),
            since: 0,
            told: vec![None; program.terminals.len()],
            moves: Moves::new(Arc::clone(&program)),
            decide,
            decided: None,
            program,
        })
    }

    /// Every situation the net can be in, checked: none is stuck, and each can be decided.
    ///
    /// # Errors
    /// A net that cannot control.
    pub fn situations(&mut self) -> Result<Vec<Situation>, ControlError> {
        let program = Arc::clone(&self.program);
        let found = explore(&program, &mut self.moves)?;
        if self.decide.is_none() {
            for situation in &found {
                let moves = self.moves.from(&situation.marking)?;
                if needs_decision(&program, &moves) && !self.counters.decides(&situation.marking) {
                    let after = situation.after.map_or("the beginning", |t| program.label(t));
                    let labels: Vec<_> =
                        moves.iter().map(|way| program.label(way.transition)).collect();
                    return Err(ControlError::Undecided {
                        after: after.to_owned(),
                        alternatives: labels.join(" or "),
                    });
                }
            }
        }
        Ok(found)
    }

    /// The situation that looks like `image`: one of equal outputs, else one whose outputs can be
    /// brought about; the opening of a run before any other, then the nearest to it.
    pub fn standing<'s>(
        &self,
        situations: &'s [Situation],
        image: &Image,
    ) -> Option<&'s Situation> {
        let terminals = &self.program.terminals;
        let alike = |situation: &Situation, output: bool| {
            terminals.iter().zip(&situation.values).zip(image).all(|((terminal, value), seen)| {
                terminal.output != output || (value.is_some() && value == seen)
            })
        };
        let known = |situation: &Situation| situation.values.iter().all(Option::is_some);
        let fits: Vec<_> = situations.iter().filter(|s| known(s) && alike(s, false)).collect();
        let rank = |s: &&&Situation| (!alike(s, true), !s.opens);
        fits.iter().min_by_key(rank).copied()
    }

    /// Takes up the net at a situation.
    pub fn stand(&mut self, situation: &Situation, now: Nanoseconds) {
        self.marking.clone_from(&situation.marking);
        self.told.clone_from(&situation.values);
        self.run =
            situation.after.map(|t| Fired { transition: t, time: now }).into_iter().collect();
        self.since = now;
        self.decided = None;
    }

    /// Takes up the net at the opening of a run, where `image` has just begun one.
    pub fn open(&mut self, image: &Image, now: Nanoseconds) -> Option<Move> {
        self.marking.clone_from(&self.program.net.initial);
        let mut way = self.input_move(image).or_else(|| self.output_move(image))?;
        way.restarts = true;
        self.told = image.to_vec();
        self.counters.forget();
        self.fire(&way, now);
        Some(way)
    }

    /// Whether an event that has just come can open a run. A signal never seen before does not
    /// tell: its first row may be its image.
    pub fn input_opening(&self, image: &Image) -> bool {
        self.told.iter().zip(image).any(|(told, value)| told.is_some() && told != value)
    }

    /// What can come next.
    pub fn ways(&mut self) -> Arc<[Move]> {
        // Every marking within reach has been looked at when the follower was made.
        self.moves.from(&self.marking).unwrap_or_else(|_| Arc::new([]))
    }

    /// Terminals of a class that differ from what events have told.
    pub fn pending(&self, image: &Image, output: bool) -> Vec<TerminalIndex> {
        (0..self.told.len())
            .filter(|&t| {
                self.program.terminals[t].output == output
                    && image[t].is_some()
                    && image[t] != self.told[t]
            })
            .collect()
    }

    /// The input that has come and is expected; the one of the most changes if there are several.
    pub fn input_move(&mut self, image: &Image) -> Option<Move> {
        self.best(image, false, |follower, changes| {
            changes
                .iter()
                .all(|&(t, value)| image[t] == Some(value) && follower.told[t] != Some(value))
        })
    }

    /// The output that has been set, by whoever controls, and is possible here. A part of it that
    /// stood so before is no reason against it.
    pub fn output_move(&mut self, image: &Image) -> Option<Move> {
        self.best(image, true, |follower, changes| {
            changes.iter().all(|&(t, value)| image[t] == Some(value))
                && changes.iter().any(|&(t, value)| follower.told[t] != Some(value))
        })
    }

    /// An event has happened.
    pub fn fire(&mut self, way: &Move, now: Nanoseconds) {
        if way.restarts {
            self.run.clear();
        }
        if let Some(activity) = self.program.changes_of(way.transition) {
            for &(terminal, value) in &activity.changes {
                self.told[terminal] = Some(value);
            }
        }
        self.counters.fired(way.transition, way.restarts);
        self.run.push(Fired { transition: way.transition, time: now });
        self.marking.clone_from(&way.after);
        self.since = now;
        self.decided = None;
    }

    /// What the learned controller does here (Theis 2019, rules 1 to 3), decided once per event.
    pub fn intention(&mut self) -> Choice {
        self.consider().0
    }

    /// Label, chance and limit of everything possible here, most probable first.
    pub fn expected(&mut self) -> Vec<(String, f64, Option<f64>)> {
        let (choice, chances) = self.consider();
        let limit_s = self.limit_s();
        let ways = self.ways();
        let mut expected: Vec<_> = ways
            .iter()
            .zip(chances)
            .map(|(way, chance)| {
                let chosen = choice == Choice::Wait && !self.program.is_output(way.transition);
                (self.program.label(way.transition).to_owned(), chance, limit_s.filter(|_| chosen))
            })
            .collect();
        expected.sort_by(|a, b| b.1.total_cmp(&a.1));
        expected
    }

    /// How long this may last, in seconds, where a log has shown it.
    pub fn limit_s(&self) -> Option<f64> {
        let longest_s = self.counters.longest_s(&self.marking)?;
        Some(longest_s * LATE_FACTOR + LATE_ALLOWANCE_S)
    }

    /// How long the net has rested here, in seconds.
    pub fn rested_s(&self, now: Nanoseconds) -> f64 {
        (now - self.since) as f64 / SECOND as f64
    }

    /// The last activity, for people.
    pub fn last(&self) -> &str {
        self.run.last().map_or("the beginning", |fired| self.program.label(fired.transition))
    }

    fn best(
        &mut self,
        _image: &Image,
        output: bool,
        fits: impl Fn(&Self, &[(TerminalIndex, i64)]) -> bool,
    ) -> Option<Move> {
        let ways = self.ways();
        let mut best: Option<(&Move, usize)> = None;
        for way in ways.iter() {
            let Some(activity) = self.program.changes_of(way.transition) else { continue };
            if activity.output == output
                && best.is_none_or(|(_, most)| activity.changes.len() > most)
                && fits(self, &activity.changes)
            {
                best = Some((way, activity.changes.len()));
            }
        }
        best.map(|(way, _)| way.clone())
    }

    fn consider(&mut self) -> (Choice, Vec<f64>) {
        if let Some(decided) = &self.decided {
            return decided.clone();
        }
        let decided = self.judge();
        self.decided = Some(decided.clone());
        decided
    }

    fn judge(&mut self) -> (Choice, Vec<f64>) {
        let ways = self.ways();
        let is_output = |way: &Move| self.program.is_output(way.transition);
        if let Some(choice) = self.counters.choice(&self.marking) {
            let fits = |way: &Move| match choice {
                Choice::Output(transition, _) => way.transition == transition,
                Choice::Wait => !is_output(way),
                Choice::Unknown => true,
            };
            return (choice, even(&ways, fits));
        }
        if !needs_decision(&self.program, &ways) {
            let choice = match ways.first() {
                Some(way) if is_output(way) => Choice::Output(way.transition, 0.0),
                _ => Choice::Wait,
            };
            return (choice, even(&ways, |_| true));
        }
        let Some(decide) = &mut self.decide else {
            return (Choice::Unknown, even(&ways, |_| true));
        };
        let predicted = decide.next(&self.run);
        let chance = |of: Option<_>| {
            predicted.iter().filter(|(what, _)| *what == of).map(|(_, chance)| chance).sum::<f64>()
        };
        let chances: Vec<f64> = ways
            .iter()
            .map(|way| {
                let own = chance(Some(way.transition));
                if way.restarts { own.max(chance(None)) } else { own }
            })
            .collect();
        let best =
            (0..ways.len()).max_by(|&a, &b| chances[a].total_cmp(&chances[b]).then(b.cmp(&a)));
        let choice = match best {
            Some(best) if chances[best] > 0.0 && is_output(&ways[best]) => {
                Choice::Output(ways[best].transition, 0.0)
            }
            _ => Choice::Wait,
        };
        (choice, chances)
    }
}

/// Rule 3: several outputs, or an output and an input.
pub fn needs_decision(program: &Program, ways: &[Move]) -> bool {
    let outputs = ways.iter().filter(|way| program.is_output(way.transition)).count();
    outputs > 0 && ways.len() > 1
}

fn even(ways: &[Move], fits: impl Fn(&Move) -> bool) -> Vec<f64> {
    let count = ways.iter().filter(|way| fits(way)).count().max(1) as f64;
    ways.iter().map(|way| if fits(way) { 1.0 / count } else { 0.0 }).collect()
}
