//! Watching a machine against its cycle machine (section 3.5), with the verbs of every monitor.
//!
//! Rows of one time are one reading of the PLC; a reading is judged when a later time comes, so
//! any split of a log into batches gives the same findings. All state is plain data.

mod alarm;
mod follow;
mod report;

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::finding::Finding;
use crate::log::{Nanoseconds, SECOND};
use crate::saved_state;
use crate::signal_state::events::Row;
use crate::signal_state::monitor::MonitorError;

use super::image::{Image, Phase};
use super::lanes::{LOST, Lanes};
use super::machine::{Came, State};
use super::model::CycleModel;
use super::parameters::Comparison;
use super::rate::Rate;
use super::regions::Word;
use super::stops::Sign;

/// Where a region stands: what changes with every step, in the numbers of [`Lanes`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Stand {
    state: u32,
    came: u32,
    since: Nanoseconds,
    /// Where it was before.
    before_state: u32,
    before_came: u32,
    before_since: Nanoseconds,
    /// The word is not the state's: some changes came before their turn.
    ahead: bool,
}

const NOWHERE: Stand = Stand {
    state: LOST,
    came: u32::MAX,
    since: 0,
    before_state: LOST,
    before_came: u32::MAX,
    before_since: 0,
    ahead: false,
};

/// Where a region stands, in the numbers of its machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Here {
    state: State,
    came: Came,
    ahead: bool,
    since: Nanoseconds,
    /// Where it was before, how it had come there, and since when.
    before: (State, Came, Nanoseconds),
}

/// A finding whose end is not known yet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Open {
    finding: Finding,
    region: Option<u32>,
    /// Until when an alarm makes it a class 1.
    deadline: Nanoseconds,
    /// Known transitions since.
    known: u8,
    /// The sequence that never ends: it is over when the phase is.
    never_ends: bool,
    /// What showed of it, to be compared with stops that are known.
    signs: Vec<Sign>,
}

/// Everything that changes while watching.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Watch {
    image: Image,
    /// Time of the reading that is not judged yet.
    reading: Option<Nanoseconds>,
    now: Nanoseconds,
    started: bool,
    /// What the machine was about at the last reading.
    phase: Option<Phase>,
    alarm: bool,
    /// The alarm has been explained, or belongs to a manual phase.
    alarm_handled: bool,
    paused: bool,
    /// Manual was ON during this pause.
    by_hand: bool,
    /// Mode `word` after a start or a gap: a sequence is followed from its beginning.
    await_edge: bool,
    here: Vec<Stand>,
    /// Changes of the machine since the sequence began, where it was followed from there.
    position: Option<u32>,
    /// When any region last changed.
    last_change: Nanoseconds,
    /// Since when the sequence runs, and whether it has been said that it never ends.
    sequence_since: Option<Nanoseconds>,
    never_ends_told: bool,
    /// Sequences watched.
    sequences: u64,
    open: Vec<Open>,
    /// Findings held back for a moment, and when they were made.
    held: Vec<(Nanoseconds, Open)>,
    /// Incident that further findings join while something is open.
    incident: Option<String>,
    next_deadline: Nanoseconds,
    /// By bit.
    rates: BTreeMap<u32, Rate>,
}

/// What [`Monitor::save`] writes.
#[derive(Serialize, Deserialize)]
struct Saved {
    version: u32,
    fingerprint: u64,
    watch: Watch,
}

const STATE_VERSION: u32 = 2;

/// Watches one machine.
#[derive(Debug, Clone)]
pub struct Monitor {
    model: Arc<CycleModel>,
    lanes: Lanes,
    fingerprint: u64,
    element: bool,
    alarm_within: Nanoseconds,
    watch: Watch,
    findings: Vec<Finding>,
    /// Findings of the reading being judged, and the words they were made of.
    fresh: Vec<Open>,
    /// While learning: what the first cause of each alarm showed.
    stops_seen: Option<Vec<Vec<Sign>>>,
}

impl Monitor {
    /// A monitor that has seen nothing yet.
    pub fn new(model: Arc<CycleModel>) -> Self {
        let regions = model.regions.len();
        let watch = Watch {
            image: Image::new(model.bits.len(), regions),
            reading: None,
            now: Nanoseconds::MIN,
            started: false,
            phase: None,
            alarm: false,
            alarm_handled: false,
            paused: false,
            by_hand: false,
            await_edge: true,
            here: vec![NOWHERE; regions],
            position: None,
            last_change: 0,
            sequence_since: None,
            never_ends_told: false,
            sequences: 0,
            open: Vec::new(),
            held: Vec::new(),
            incident: None,
            next_deadline: Nanoseconds::MAX,
            rates: BTreeMap::new(),
        };
        Self {
            lanes: Lanes::of(&model.machines),
            fingerprint: model.fingerprint(),
            element: model.parameters.mode == Comparison::Element,
            alarm_within: (model.parameters.alarm_within_s * SECOND as f64) as i64,
            model,
            watch,
            findings: Vec::new(),
            fresh: Vec::new(),
            stops_seen: None,
        }
    }

    /// A monitor that notes what the alarms of learned logs showed.
    pub(super) fn of_learning(model: Arc<CycleModel>) -> Self {
        Self { stops_seen: Some(Vec::new()), ..Self::new(model) }
    }

    /// What the first cause of each alarm showed.
    pub(super) fn stops_seen(&self) -> &[Vec<Sign>] {
        self.stops_seen.as_deref().unwrap_or_default()
    }

    /// Takes rows in time order; signals are the bits of the model, others are passed over.
    ///
    /// # Errors
    /// A row older than what has been seen.
    pub fn observe(&mut self, rows: &[Row]) -> Result<Vec<Finding>, MonitorError> {
        let mut newest = self.watch.now;
        for (index, row) in rows.iter().enumerate() {
            if row.time < newest {
                let late_s = newest.saturating_sub(row.time) as f64 / SECOND as f64;
                return Err(MonitorError::Order { row: index + 1, late_s: format!("{late_s:.3}") });
            }
            newest = row.time;
        }
        let model = Arc::clone(&self.model);
        let bits = model.bits.len() as u32;
        for row in rows {
            if row.time > self.watch.now {
                self.go_on_to(row.time);
            }
            self.watch.reading = Some(row.time);
            if row.signal < bits {
                self.watch.image.set(&model.wiring, row.signal, row.value != 0);
            }
        }
        Ok(std::mem::take(&mut self.findings))
    }

    /// Time went on to `now` without a change.
    pub fn advance(&mut self, now: Nanoseconds) -> Vec<Finding> {
        if now > self.watch.now {
            self.go_on_to(now);
        }
        std::mem::take(&mut self.findings)
    }

    /// Nothing was recorded from `start` to `end`: what follows has no predecessor.
    pub fn gap(&mut self, _start: Nanoseconds, end: Nanoseconds) -> Vec<Finding> {
        self.judge();
        self.tell_held(Nanoseconds::MAX);
        let watch = &mut self.watch;
        watch.now = watch.now.max(end);
        watch.here.fill(NOWHERE);
        watch.await_edge = true;
        watch.sequence_since = None;
        watch.started = false;
        watch.open.clear();
        watch.incident = None;
        watch.next_deadline = Nanoseconds::MAX;
        std::mem::take(&mut self.findings)
    }

    /// The log has ended: judges the running reading. Open findings stay suspected.
    pub fn finish(&mut self) -> Vec<Finding> {
        self.judge();
        self.tell_held(Nanoseconds::MAX);
        std::mem::take(&mut self.findings)
    }

    /// Everything needed to go on later, compactly.
    pub fn save(&self) -> Vec<u8> {
        let saved = Saved {
            version: STATE_VERSION,
            fingerprint: self.fingerprint,
            watch: self.watch.clone(),
        };
        saved_state::sealed(&saved)
    }

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// Damaged bytes, another version, or the state of another model.
    pub fn restore(model: Arc<CycleModel>, bytes: &[u8]) -> Result<Self, MonitorError> {
        let body = saved_state::unsealed(bytes).ok_or(MonitorError::Damaged)?;
        let saved: Saved = postcard::from_bytes(body).map_err(|_| MonitorError::Damaged)?;
        if saved.version != STATE_VERSION {
            return Err(MonitorError::Damaged);
        }
        let mut monitor = Self::new(model);
        if saved.fingerprint != monitor.fingerprint {
            return Err(MonitorError::OtherModel);
        }
        monitor.watch = saved.watch;
        Ok(monitor)
    }

    /// The running reading is complete; time goes on to a later one.
    #[inline]
    fn go_on_to(&mut self, time: Nanoseconds) {
        self.judge();
        if time >= self.watch.next_deadline {
            self.pass_deadlines(time);
        }
        self.watch.now = time;
    }

    /// Where a region stands, as its machine numbers it.
    fn here(&self, region: usize, phase: Phase) -> Here {
        let stand = self.watch.here[region];
        let own = |state, came| self.lanes.own(region, phase.index(), state, came);
        let (state, came) = own(stand.state, stand.came);
        let (before_state, before_came) = own(stand.before_state, stand.before_came);
        Here {
            state,
            came,
            ahead: stand.ahead,
            since: stand.since,
            before: (before_state, before_came, stand.before_since),
        }
    }

    /// Places a region without a past.
    fn stand(&mut self, region: usize, phase: Phase, state: State, came: Came, since: Nanoseconds) {
        let (state, came) = self.lanes.flat(region, phase.index(), state, came);
        self.watch.here[region] = Stand { state, came, since, ..NOWHERE };
    }

    fn word(&self, region: usize) -> Word {
        self.watch.image.words[region]
    }
}
