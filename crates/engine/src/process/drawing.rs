//! Graphviz text of a net: the first place green, the last one red (Theis 2019, Figure 5), inputs
//! and outputs by colour, silent transitions black bars.

use std::fmt::Write as _;

use super::petri::{PetriNet, PlaceIndex};
use crate::plant::SignalClass;
use crate::signal_state::dot::quoted;

const FIRST: &str = "#2da44e";
const LAST: &str = "#cf222e";
const INPUT: &str = "#ddf4ff";
const OUTPUT: &str = "#fff1d6";
const OTHER: &str = "#f2f3f5";

impl PetriNet {
    /// The net as Graphviz draws it, from left to right.
    pub fn dot(&self) -> String {
        let title = if self.name.is_empty() { "net" } else { &self.name };
        let mut text = format!("digraph {} {{\n  rankdir=LR;\n", quoted(title));
        text.push_str("  node [fontname=\"Helvetica\", fontsize=11];\n");
        text.push_str("  edge [color=\"#57606a\", arrowsize=0.7];\n");
        for place in 0..self.places.len() {
            let _ = writeln!(text, "  {} [{}];", place_name(place), self.place_style(place));
        }
        for (number, transition) in self.transitions.iter().enumerate() {
            let style = match &transition.label {
                Some(label) => {
                    let fill = match transition.class {
                        Some(SignalClass::Input) => INPUT,
                        Some(SignalClass::Output) => OUTPUT,
                        Some(SignalClass::Memory) | None => OTHER,
                    };
                    let lines = quoted(label).replace(" & ", "\\n");
                    format!("shape=box, style=filled, fillcolor=\"{fill}\", label={lines}")
                }
                None => {
                    "shape=box, style=filled, fillcolor=black, label=\"\", width=0.12, height=0.4"
                        .to_owned()
                }
            };
            let _ = writeln!(text, "  t{number} [{style}, tooltip={}];", quoted(&transition.id));
            let arcs = |places: &[PlaceIndex]| -> Vec<String> {
                places.iter().map(|&place| place_name(place as usize)).collect()
            };
            for place in arcs(&transition.inputs) {
                let _ = writeln!(text, "  {place} -> t{number};");
            }
            for place in arcs(&transition.outputs) {
                let _ = writeln!(text, "  t{number} -> {place};");
            }
        }
        text.push_str("}\n");
        text
    }

    fn place_style(&self, place: usize) -> String {
        let tokens = self.initial[place];
        let fill = match (tokens > 0, self.last[place] > 0) {
            (true, _) => FIRST,
            (false, true) => LAST,
            (false, false) => "white",
        };
        let label = if tokens > 1 { tokens.to_string() } else { String::new() };
        format!(
            "shape=circle, style=filled, fillcolor=\"{fill}\", label=\"{label}\", width=0.3, \
             fixedsize=true, tooltip={}",
            quoted(&self.places[place])
        )
    }
}

fn place_name(place: usize) -> String {
    format!("p{place}")
}

#[cfg(test)]
mod tests {
    use crate::process::event_log::EventLog;
    use crate::process::split_miner::{MiningParameters, mine};

    #[test]
    fn first_and_last_places_and_classes_have_their_colours() {
        let log = EventLog::from_traces([vec!["%IX0.1=0 & %IX0.2=1", "%QX0.0=1"]]);
        let net = mine(&log, &MiningParameters::default()).map(|m| m.net).unwrap_or_default();
        let dot = net.dot();
        for part in ["#2da44e", "#cf222e", "#ddf4ff", "#fff1d6", "%IX0.1=0\\n%IX0.2=1"] {
            assert_eq!(dot.matches(part).count(), 1, "{part}: {dot}");
        }
    }
}
