//! What a net cannot say and a log shows: which branch a counter takes, and how long a timer runs.

use serde::{Deserialize, Serialize};

use super::tree::Tree;

/// Everything learned beside a net; transitions and places by identifier.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Guards {
    /// Version of this layout.
    #[serde(default)]
    pub format: u32,
    /// One for every marking the log rested in.
    pub points: Vec<Point>,
}

/// What is known of one marking.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Identifiers of the marked places.
    pub marked: Vec<String>,
    /// The last activity before it, for people.
    pub after: String,
    /// What to do here; none where the net alone says it (rules 1 and 2, at once).
    pub choice: Option<Tree>,
    /// Times the log rested here.
    pub seen: u32,
    /// Of these, how often the log did something else than `choice` says.
    pub contradicted: u32,
    /// The longest that the log rested here, in seconds.
    pub longest_s: f64,
}

/// The layout this version writes.
pub const FORMAT: u32 = 1;
