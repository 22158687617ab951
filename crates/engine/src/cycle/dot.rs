//! Graphviz text of a machine in the colours of Guim & Dias 2023, Figure 4: initial states blue,
//! final ones red, both green, weights on the arrows.

use std::fmt::Write as _;

use super::image::Phase;
use super::model::CycleModel;

const INITIAL: &str = "#2f6fdb";
const FINAL: &str = "#c0392b";
const BOTH: &str = "#1a7f37";

impl CycleModel {
    /// The graph of one region in one phase.
    pub fn dot(&self, region: usize, phase: Phase) -> String {
        let (shown, machine) = (&self.regions[region], self.machine(region, phase));
        let title = quoted(&format!("{}, {}", shown.name, phase.name()));
        let mut text = format!("digraph {title} {{\n  rankdir=TB;\n");
        text.push_str("  node [shape=ellipse, fontname=\"Helvetica\", fontsize=12];\n");
        text.push_str("  edge [fontname=\"Helvetica\", fontsize=10];\n");
        let _ = writeln!(text, "  label={title}; labelloc=t;");
        for (state, node) in machine.nodes.iter().enumerate() {
            let colour = match (node.initial > 0, node.last > 0) {
                (true, true) => Some(BOTH),
                (true, false) => Some(INITIAL),
                (false, true) => Some(FINAL),
                (false, false) => None,
            };
            let style = colour.map_or_else(String::new, |colour| {
                format!(", style=filled, fillcolor=\"{colour}\", fontcolor=white")
            });
            let _ = writeln!(text, "  s{state} [label=\"{}\"{style}];", shown.hex(node.word));
        }
        for t in &machine.transitions {
            let _ = writeln!(text, "  s{} -> s{} [label=\"{}\"];", t.from, t.to, t.weight);
        }
        text.push_str("}\n");
        text
    }
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', " "))
}
