//! The variables of the program.

use std::fmt::Write as _;

use super::{START, Text};

impl Text {
    pub(super) fn declare(&self, text: &mut String) {
        text.push_str("  VAR\n");
        for terminal in self.terminals(false).chain(self.terminals(true)) {
            let (name, kind) = (self.names.get(terminal), self.names.kind(terminal));
            let place = self.names.place(terminal).map_or(String::new(), |at| format!(" AT {at}"));
            let _ = writeln!(text, "    {name}{place} : {kind};");
        }
        text.push_str("  END_VAR\n  VAR\n");
        let _ = writeln!(text, "    state : INT := {START};");
        for terminal in self.terminals(false) {
            let (name, kind) = (self.names.get(terminal), self.names.kind(terminal));
            let _ = writeln!(text, "    {name}_told : {kind};");
        }
        for (number, (counter, preset)) in self.counters.iter().enumerate() {
            let counted = self.label(&counter.counts);
            let since = counter.reset_by.as_deref().map_or_else(
                || "since the run began".to_owned(),
                |id| format!("since {}", self.label(id)),
            );
            let _ = writeln!(
                text,
                "    count_{number} : CTU; (* {counted} {since}, preset {preset} *)"
            );
        }
        for (number, (state, after_s)) in self.timers.iter().enumerate() {
            let _ = writeln!(
                text,
                "    timer_{number} : TON; (* state {state} acts after {after_s:.3} s *)"
            );
        }
        text.push_str(
            "    watch : TON;\n    limit : TIME;\n    moved : BOOL;\n    step : INT;\n    \
             alarm : BOOL; (* the plant left the net: the outputs are in their safe state *)\n  \
             END_VAR\n\n",
        );
    }

    /// The activity of a transition, fit for a comment.
    pub(super) fn label(&self, id: &str) -> String {
        let label = self.program.transition(id).map_or(id, |t| self.program.label(t));
        label.replace("(*", "").replace("*)", "")
    }
}
