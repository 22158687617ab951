//! How the program finds its place when it is switched on in the middle of the work.

use std::collections::HashSet;
use std::fmt::Write as _;

use super::{SAFE, START, Text};
use crate::control::program::TerminalIndex;
use crate::control::situations::Situation;

impl Text {
    pub(super) fn look_up(&self, text: &mut String) {
        let inputs: Vec<_> = self.terminals(false).collect();
        let all: Vec<_> = (0..self.program.terminals.len()).collect();
        let _ = writeln!(text, "  IF state = {START} THEN");
        let mut word = "IF";
        // As the controller does: first where the outputs are alike too, then by inputs alone, and
        // the opening of a run before any other.
        for asked in [&all, &inputs] {
            let mut known: HashSet<Vec<Option<i64>>> = HashSet::new();
            let opening = self.situations.iter().filter(|situation| situation.opens);
            for situation in opening.chain(self.situations.iter().filter(|s| !s.opens)) {
                let values: Vec<_> = asked.iter().map(|&t| situation.values[t]).collect();
                if situation.values.iter().any(Option::is_none) || !known.insert(values) {
                    continue;
                }
                let Some(state) = self.state_of(&situation.marking) else { continue };
                let _ = writeln!(text, "    {word} {} THEN", self.looks_like(situation, asked));
                for terminal in self.terminals(true) {
                    let value = situation.values[terminal].unwrap_or_default();
                    let name = self.names.get(terminal);
                    let _ = writeln!(text, "      {name} := {};", self.literal(terminal, value));
                }
                for (number, (counter, preset)) in self.counters.iter().enumerate() {
                    let opened = situation.after.map(|t| &self.program.net.transitions[t as usize]);
                    if opened.is_some_and(|transition| transition.id == counter.counts) {
                        let _ = writeln!(
                            text,
                            "      count_{number}(CU := TRUE, R := FALSE, PV := {preset});\n      \
                             count_{number}(CU := FALSE, R := FALSE, PV := {preset});"
                        );
                    }
                }
                let _ = writeln!(text, "      state := {state};");
                word = "ELSIF";
            }
        }
        let _ = writeln!(text, "    ELSE\n      state := {SAFE};\n    END_IF;");
        for terminal in inputs {
            let name = self.names.get(terminal);
            let _ = writeln!(text, "    {name}_told := {name};");
        }
        text.push_str("  END_IF;\n\n");
    }

    fn looks_like(&self, situation: &Situation, asked: &[TerminalIndex]) -> String {
        let conditions: Vec<_> = asked
            .iter()
            .map(|&terminal| {
                let value = situation.values[terminal].unwrap_or_default();
                self.is(self.names.get(terminal), terminal, value)
            })
            .collect();
        conditions.join(" AND ")
    }
}
