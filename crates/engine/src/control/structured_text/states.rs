//! One branch of the CASE for every marking, and what happens around it in each scan.

use std::fmt::Write as _;

use super::{MOST_EVENTS, SAFE, Text, time};
use crate::control::counters::Counters;
use crate::control::moves::Move;
use crate::control::tree::Tree;
use crate::process::petri::Marking;

/// Outputs of a marking that wait: by state, with the delay in seconds.
pub(super) fn timers(counters: &Counters, states: &[Marking]) -> Vec<(usize, f64)> {
    let mut timers: Vec<(usize, f64)> = Vec::new();
    for (state, marking) in states.iter().enumerate() {
        if let Some(tree) = counters.tree(marking) {
            tree.each_output(&mut |_, after_s| {
                if after_s > 0.0 && !timers.contains(&(state, after_s)) {
                    timers.push((state, after_s));
                }
            });
        }
    }
    timers
}

impl Text {
    pub(super) fn run(&mut self, text: &mut String) {
        for (number, (state, after_s)) in self.timers.iter().enumerate() {
            let _ = writeln!(
                text,
                "  timer_{number}(IN := state = {state}, PT := {});",
                time(*after_s)
            );
        }
        let _ = writeln!(
            text,
            "  FOR step := 1 TO {MOST_EVENTS} DO\n    moved := FALSE;\n    limit := T#0ms;\n    \
             CASE state OF"
        );
        for state in 0..self.states.len() {
            self.state(state, text);
        }
        text.push_str("    END_CASE;\n    IF moved THEN\n      watch(IN := FALSE, PT := limit);\n");
        for (number, (_, after_s)) in self.timers.iter().enumerate() {
            let _ = writeln!(text, "      timer_{number}(IN := FALSE, PT := {});", time(*after_s));
        }
        text.push_str("    ELSE\n      EXIT;\n    END_IF;\n  END_FOR;\n\n");
        for (number, (state, after_s)) in self.timers.iter().enumerate() {
            let _ = writeln!(
                text,
                "  timer_{number}(IN := state = {state}, PT := {});",
                time(*after_s)
            );
        }
        self.end(text);
    }

    /// What the net does not allow leads to the safe state.
    fn end(&self, text: &mut String) {
        let differs: Vec<_> = self
            .terminals(false)
            .map(|terminal| {
                let name = self.names.get(terminal);
                format!("{name} <> {name}_told")
            })
            .collect();
        let differs = if differs.is_empty() {
            String::new()
        } else {
            format!(" OR {}", differs.join(" OR "))
        };
        let _ = writeln!(
            text,
            "  watch(IN := limit > T#0ms, PT := limit);\n  \
             IF moved OR watch.Q{differs} THEN\n    state := {SAFE};\n  END_IF;\n  \
             alarm := state = {SAFE};\n  IF alarm THEN"
        );
        for &(terminal, value) in &self.safe {
            let name = self.names.get(terminal);
            let _ = writeln!(text, "    {name} := {};", self.literal(terminal, value));
        }
        text.push_str("  END_IF;\n");
    }

    fn state(&mut self, state: usize, text: &mut String) {
        let marking = self.states[state].clone();
        self.follower.marking.clone_from(&marking);
        let mut ways: Vec<Move> = self.follower.ways().to_vec();
        // The one of the most changes first, as the controller does.
        ways.sort_by_key(|way| {
            let changes = self.program.changes_of(way.transition).map_or(0, |a| a.changes.len());
            (std::cmp::Reverse(changes), way.transition)
        });
        let after = self.situations.iter().find(|situation| situation.marking == marking);
        let after = after.and_then(|situation| situation.after);
        let after = after.map_or("the beginning", |t| self.program.label(t));
        let _ = writeln!(text, "      {state}: (* after {after} *)");
        if let Some(limit_s) = self.follower.limit_s() {
            let _ = writeln!(text, "        limit := {};", time(limit_s));
        }
        let mut word = "IF";
        for way in ways.iter().filter(|way| !self.program.is_output(way.transition)) {
            let Some(activity) = self.program.changes_of(way.transition) else { continue };
            let conditions: Vec<_> = activity
                .changes
                .iter()
                .map(|&(terminal, value)| {
                    let name = self.names.get(terminal);
                    let told = format!("{name} <> {name}_told");
                    format!("{told} AND {}", self.is(name, terminal, value))
                })
                .collect();
            let _ = writeln!(text, "        {word} {} THEN", conditions.join(" AND "));
            for &(terminal, _) in &activity.changes {
                let name = self.names.get(terminal);
                let _ = writeln!(text, "          {name}_told := {name};");
            }
            self.fired(way, "          ", text);
            word = "ELSIF";
        }
        let tree = self.follower.counters.tree(&marking).cloned().unwrap_or_else(|| {
            match ways.iter().find(|way| self.program.is_output(way.transition)) {
                Some(way) => Tree::Output {
                    transition: self.program.net.transitions[way.transition as usize].id.clone(),
                    after_s: 0.0,
                },
                None => Tree::Wait,
            }
        });
        if word == "IF" {
            self.decide(state, &ways, &tree, "        ", text);
        } else {
            let mut decision = String::new();
            self.decide(state, &ways, &tree, "          ", &mut decision);
            if *"" == *decision {
                text.push_str(&decision);
            } else {
                text.push_str("        ELSE\n");
                text.push_str(&decision);
            }
            text.push_str("        END_IF;\n");
        }
    }

    fn decide(&self, state: usize, ways: &[Move], tree: &Tree, indent: &str, text: &mut String) {
        match tree {
            Tree::Wait => {
                let _ = writeln!(text, "{indent}moved := FALSE; (* waits *)");
            }
            Tree::Output { transition, after_s } => {
                let found = self.program.transition(transition);
                let Some(way) = ways.iter().find(|way| Some(way.transition) == found) else {
                    return;
                };
                let timer = self.timers.iter().position(|timer| timer == &(state, *after_s));
                let inner = match timer {
                    Some(number) => {
                        let _ = writeln!(text, "{indent}IF timer_{number}.Q THEN");
                        format!("{indent}  ")
                    }
                    None => indent.to_owned(),
                };
                if let Some(activity) = self.program.changes_of(way.transition) {
                    for &(terminal, value) in &activity.changes {
                        let name = self.names.get(terminal);
                        let literal = self.literal(terminal, value);
                        let _ = writeln!(text, "{inner}{name} := {literal};");
                    }
                }
                self.fired(way, &inner, text);
                if timer.is_some() {
                    let _ = writeln!(text, "{indent}END_IF;");
                }
            }
            Tree::Count { counter, preset, reached, below } => {
                let asked = (counter.clone(), *preset);
                let number = self.counters.iter().position(|known| *known == asked);
                let _ = writeln!(text, "{indent}IF count_{}.Q THEN", number.unwrap_or_default());
                let inner = format!("{indent}  ");
                self.decide(state, ways, reached, &inner, text);
                let _ = writeln!(text, "{indent}ELSE");
                self.decide(state, ways, below, &inner, text);
                let _ = writeln!(text, "{indent}END_IF;");
            }
        }
    }

    /// Moves on, and counts.
    fn fired(&self, way: &Move, indent: &str, text: &mut String) {
        let id = &self.program.net.transitions[way.transition as usize].id;
        for (number, (counter, preset)) in self.counters.iter().enumerate() {
            let resets = counter.reset_by.as_ref() == Some(id)
                || (way.restarts && counter.reset_by.is_none());
            if resets {
                let _ = writeln!(
                    text,
                    "{indent}count_{number}(CU := FALSE, R := TRUE, PV := {preset});"
                );
            }
            if counter.counts == *id {
                // A rising edge, whatever was before.
                for rising in ["TRUE", "FALSE"] {
                    let _ = writeln!(
                        text,
                        "{indent}count_{number}(CU := {rising}, R := FALSE, PV := {preset});"
                    );
                }
            }
        }
        match self.state_of(&way.after) {
            Some(state) => {
                let _ = writeln!(text, "{indent}state := {state};\n{indent}moved := TRUE;");
            }
            // The net allows it, but no sequence of changes leads there.
            None => {
                let _ = writeln!(text, "{indent}state := {SAFE};\n{indent}moved := TRUE;");
            }
        }
    }
}
