//! Decision trees over counters: small, exact, and readable by whoever writes PLC programs.

use serde::{Deserialize, Serialize};

/// Counts firings of one transition; a CTU.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Counter {
    /// Identifier of the transition counted.
    pub counts: String,
    /// Identifier of the transition that resets it; none where each run of the net begins at 0.
    pub reset_by: Option<String>,
}

/// What to do at a marking.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tree {
    /// Wait for an input (rule 1).
    Wait,
    /// Fire an output (rule 2) when the marking has lasted `after_s`; a TON where that is above 0.
    Output {
        /// Identifier of the transition.
        transition: String,
        /// Seconds since the event before.
        after_s: f64,
    },
    /// Depends on how often something has happened.
    Count {
        /// What is counted.
        counter: Counter,
        /// The counter's preset.
        preset: u32,
        /// Where the count has reached the preset.
        reached: Box<Tree>,
        /// Where it has not.
        below: Box<Tree>,
    },
}

impl Tree {
    /// Every counter it asks for, with its preset.
    pub fn each_count(&self, told: &mut impl FnMut(&Counter, u32)) {
        if let Self::Count { counter, preset, reached, below } = self {
            told(counter, *preset);
            reached.each_count(told);
            below.each_count(told);
        }
    }

    /// Every output transition it may fire.
    pub fn outputs(&self) -> Vec<String> {
        let mut all = Vec::new();
        self.each_output(&mut |transition, _| all.push(transition.to_owned()));
        all
    }

    /// Every output transition it may fire, and after how many seconds.
    pub fn each_output(&self, told: &mut impl FnMut(&str, f64)) {
        match self {
            Self::Wait => {}
            Self::Output { transition, after_s } => told(transition, *after_s),
            Self::Count { reached, below, .. } => {
                reached.each_output(told);
                below.each_output(told);
            }
        }
    }
}
