//! Graphviz text of a device's or group's model, labelled `TP [ATT, TTP; ATT, TTP]` as in
//! Ghosh 2016, Figures 13 and 14: transitions with several times in green.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::chains::{ChainIndex, ChainKind};
use super::model::NominalModel;
use super::rules::Rule;
use super::states::StateId;

const SEVERAL_TIMES: &str = "#1a7f37";
const START_UP: &str = "#b42318";

impl NominalModel {
    /// The graph of one chain. Dashed arrows lead from the events that enable a transition.
    pub fn dot(&self, chain: ChainIndex) -> String {
        let kind = self.kind(chain);
        let title = match self.device_name(chain) {
            Some(device) => format!("{}-{device}", self.group_name(chain)),
            None => self.group_name(chain).to_owned(),
        };
        let rules = self.rules_of(chain);
        let mut text = format!("digraph {} {{\n", quoted(&title));
        text.push_str(
            "  rankdir=TB;\n  node [shape=ellipse, fontname=\"Helvetica\", fontsize=12];\n",
        );
        text.push_str("  edge [fontname=\"Helvetica\", fontsize=10];\n");
        let _ = writeln!(text, "  label={}; labelloc=t;", quoted(&title));
        let mut named = BTreeSet::new();
        for state in rules.iter().flat_map(|rule| [rule.current, rule.next]) {
            if named.insert(state) {
                let label = self.short_state_name(state, kind);
                let _ = writeln!(text, "  {} [label={}];", node(state), quoted(&label));
            }
        }
        for rule in &rules {
            let colour = if rule.clusters.len() > 1 {
                format!(", color=\"{SEVERAL_TIMES}\", fontcolor=\"{SEVERAL_TIMES}\"")
            } else if rule.evidence() == 0 {
                format!(", color=\"{START_UP}\", style=dashed")
            } else {
                String::new()
            };
            let label = quoted(&label(rule));
            let _ = writeln!(
                text,
                "  {} -> {} [label={label}{colour}];",
                node(rule.current),
                node(rule.next)
            );
        }
        for rule in &rules {
            for trigger in rule.trigger.iter().flat_map(|trigger| trigger.states()) {
                if named.insert(trigger) {
                    let label = quoted(&self.short_state_name(trigger, ChainKind::Group));
                    let _ = writeln!(
                        text,
                        "  {} [label={label}, shape=box, style=dashed];",
                        node(trigger)
                    );
                }
                let delay = rule.judged().iter().map(|c| c.average_s).fold(0.0, f64::max);
                let _ = writeln!(
                    text,
                    "  {} -> {} [style=dashed, arrowhead=open, constraint=false, label=\"{delay:.2}\"];",
                    node(trigger),
                    node(rule.next)
                );
            }
        }
        text.push_str("}\n");
        text
    }
}

fn node(state: StateId) -> String {
    format!("s{state}")
}

/// `1 [3.01, 0.47; 33.2, 0.53]`.
fn label(rule: &Rule) -> String {
    let times: Vec<String> = rule
        .clusters
        .iter()
        .map(|c| format!("{:.2}, {}", c.average_s, share(c.probability)))
        .collect();
    format!("{} [{}]", share(rule.probability), times.join("; "))
}

/// Two decimals, without trailing zeros: `1`, `0.5`, `0.47`.
fn share(share: f64) -> String {
    let text = format!("{share:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', " "))
}
