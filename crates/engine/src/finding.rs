//! A finding: one departure from the nominal model, in the published schema.

pub mod line;

use std::fmt::Write as _;

use serde::{Deserialize, Serialize, Serializer};

use crate::log::Nanoseconds;

/// What departed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A transition the model does not have.
    Transition,
    /// A known transition took too long.
    Late,
    /// A known transition came too soon.
    Early,
    /// A group has stopped.
    Stall,
    /// Branches are taken in other shares than learned.
    TransitionProbability,
    /// A transition takes its several times in other shares than learned.
    TimeProbability,
    /// A transition takes longer or shorter on average.
    AverageTime,
    /// A device left its known path and came back: offered for confirmation.
    AlarmPath,
    /// A signal the model does not know.
    UnknownSignal,
    /// Nothing was recorded for a while.
    Gap,
    /// A region left the sequences its cycle machine knows.
    Sequence,
    /// A region began a sequence in a word it never began with.
    StartState,
}

/// How much it matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The control process did what it never does.
    Fault,
    /// It did it at a wrong time or rate.
    Anomaly,
    /// Remarkable, but not worth an alarm within the user's budget; never counts as one.
    Notice,
}

/// Where a finding stands (after ISA-18.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// Just found; may still return to normal.
    Suspected,
    /// Did not return in time, or needs no waiting.
    Confirmed,
    /// Back to normal by itself.
    Returned,
    /// Seen by an operator.
    Acknowledged,
    /// Silenced by an operator.
    Shelved,
}

/// Which model found it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Model {
    /// A device's chain.
    Device,
    /// A group's chain.
    Group,
    /// The plant as a whole.
    Plant,
    /// A region's cycle machine.
    Cycle,
    /// The net its runs follow, and what comes next in it.
    Process,
}

/// What should have happened instead.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Expected {
    /// Signal-state in full.
    pub state: String,
    /// Its learned probability from the present state.
    pub probability: f64,
    /// Until when it was due, in seconds; `None` where no limit is known.
    pub limit_s: Option<f64>,
}

/// A place to look at, best first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Suspect {
    /// PLC address, where known.
    pub address: Option<String>,
    /// Full signal name.
    pub signal: String,
    /// Between 0 and 1.
    pub score: f64,
}

/// One departure from the nominal model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Stable: the same log gives the same ids.
    pub id: String,
    /// Findings that one cause explains share it: the id of the first.
    pub incident: String,
    /// When, nanoseconds since the Unix epoch; ISO 8601 in JSON.
    #[serde(serialize_with = "iso_8601", deserialize_with = "from_iso_8601")]
    pub time: Nanoseconds,
    /// What departed.
    pub kind: Kind,
    /// How much it matters.
    pub severity: Severity,
    /// Where it stands.
    pub state: State,
    /// Which model found it.
    pub model: Model,
    /// Group, where there is one.
    pub group: Option<String>,
    /// Device, where there is one.
    pub device: Option<String>,
    /// Signal inside the device.
    pub signal: Option<String>,
    /// Its PLC address.
    pub address: Option<String>,
    /// Signal-state before, in full.
    pub from: Option<String>,
    /// Signal-state after, in full.
    pub to: Option<String>,
    /// What should have happened instead, most probable first.
    pub expected: Vec<Expected>,
    /// Measured: seconds, or a share between 0 and 1 for probabilities.
    pub observed_s: Option<f64>,
    /// What it was held against: the limit in seconds, or the learned share.
    pub limit_s: Option<f64>,
    /// Class 1 to 4 of Guim & Dias 2023, where it applies.
    pub rank: Option<u8>,
    /// Where to look first.
    pub suspects: Vec<Suspect>,
    /// Signal-states in full, from the last known one on.
    pub path: Vec<String>,
    /// Snapshot of the whole plant made with it.
    pub snapshot_id: Option<String>,
    /// One plain sentence.
    pub message: String,
}

impl Finding {
    /// A notice of a kind, nothing else filled in.
    pub(crate) fn new(kind: Kind, model: Model, time: Nanoseconds) -> Self {
        Self {
            id: String::new(),
            incident: String::new(),
            time,
            kind,
            severity: Severity::Notice,
            state: State::Confirmed,
            model,
            group: None,
            device: None,
            signal: None,
            address: None,
            from: None,
            to: None,
            expected: Vec::new(),
            observed_s: None,
            limit_s: None,
            rank: None,
            suspects: Vec::new(),
            path: Vec::new(),
            snapshot_id: None,
            message: String::new(),
        }
    }

    /// The finding as one line of JSON.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Appends what [`to_json`](Self::to_json) gives to text in UTF-8.
    pub fn append_json(&self, text: &mut Vec<u8>) {
        let before = text.len();
        if serde_json::to_writer(&mut *text, self).is_err() {
            text.truncate(before);
        }
    }
}

/// Stable id of a finding: what, where and when, not which batch it came in.
pub fn stable_id(kind: Kind, place: &str, from: &str, to: &str, time: Nanoseconds) -> String {
    StableId::of(kind, place, from, to).at(time)
}

/// Stable ids of findings that differ in their times only.
#[derive(Debug)]
pub struct StableId {
    /// What is hashed; the time stands at its end.
    text: String,
    /// Length without the time.
    timeless: usize,
}

impl StableId {
    /// What and where.
    pub fn of(kind: Kind, place: &str, from: &str, to: &str) -> Self {
        let text = format!("{kind:?}|{place}|{from}|{to}|");
        Self { timeless: text.len(), text }
    }

    /// The id of that at a time.
    pub fn at(&mut self, time: Nanoseconds) -> String {
        self.text.truncate(self.timeless);
        // A string takes everything.
        let _ = write!(self.text, "{time}");
        format!("{:012x}", xxhash_rust::xxh3::xxh3_64(self.text.as_bytes()) & 0xffff_ffff_ffff)
    }
}

/// `2026-01-05T06:00:00.12Z`.
pub fn time_text(time: Nanoseconds) -> String {
    jiff::Timestamp::from_nanosecond(i128::from(time))
        .map_or_else(|_| time.to_string(), |t| t.to_string())
}

fn iso_8601<S: Serializer>(time: &Nanoseconds, serializer: S) -> Result<S::Ok, S::Error> {
    if serializer.is_human_readable() {
        serializer.serialize_str(&time_text(*time))
    } else {
        serializer.serialize_i64(*time)
    }
}

fn from_iso_8601<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> Result<Nanoseconds, D::Error> {
    use serde::de::Error;
    if !deserializer.is_human_readable() {
        return i64::deserialize(deserializer);
    }
    let text = String::deserialize(deserializer)?;
    let time: jiff::Timestamp = text.parse().map_err(D::Error::custom)?;
    i64::try_from(time.as_nanosecond()).map_err(D::Error::custom)
}
