//! One monitor of a plant: its signal-state models and, where there is one, its cycle machine.
//!
//! Both see every row; what they find of one event shares an incident. Rows are handed on one
//! reading at a time, so that the order of findings does not depend on how a log is cut.

pub mod aside;
pub mod learn;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::cycle::model::CycleModel;
use crate::cycle::monitor::Monitor as CycleMonitor;
use crate::cycle::witnesses::Witnesses;
use crate::finding::{Finding, Kind};
use crate::log::{Nanoseconds, SECOND, SignalIndex};
use crate::saved_state;
use crate::signal_state::events::Row;
use crate::signal_state::found::Found;
use crate::signal_state::model::NominalModel;
use crate::signal_state::monitor::{Columns, Keys, Monitor, MonitorError};
use crate::signal_state::snapshot::Snapshot;

use self::aside::{Aside, Meaning};

/// Watches one plant with all its models.
#[derive(Debug, Clone)]
pub struct JointMonitor {
    /// None where only the cycle machine is watched.
    signal_state: Option<Monitor>,
    cycle: Option<CycleMonitor>,
    /// Where there are both.
    aside: Option<Aside>,
    witnesses: Witnesses,
    fresh_for: Nanoseconds,
    now: Nanoseconds,
    /// Findings of rows taken, until they are asked for.
    found: Vec<Finding>,
}

/// What [`JointMonitor::save`] writes where there is a cycle machine.
#[derive(Serialize, Deserialize)]
struct Saved {
    version: u32,
    signal_state: Vec<u8>,
    cycle: Vec<u8>,
    aside: Option<Aside>,
    witnesses: Witnesses,
    now: Nanoseconds,
}

const STATE_VERSION: u32 = 2;

impl JointMonitor {
    /// A monitor that has seen nothing yet.
    pub fn new(model: Arc<NominalModel>, cycle: Option<Arc<CycleModel>>) -> Self {
        let fresh_for = (model.parameters.return_within_s * SECOND as f64) as Nanoseconds;
        let signals = model.plant.signals.len();
        Self {
            signal_state: Some(Monitor::new(model)),
            aside: cycle.as_ref().map(|cycle| Aside::new(&cycle.modes, signals)),
            cycle: cycle.map(CycleMonitor::new),
            witnesses: Witnesses::default(),
            fresh_for,
            now: Nanoseconds::MIN,
            found: Vec::new(),
        }
    }

    /// The cycle machine alone; its saved state is the cycle monitor's own.
    ///
    /// # Errors
    /// A saved state that is damaged, or another model's.
    pub fn of_cycle(cycle: Arc<CycleModel>, state: Option<&[u8]>) -> Result<Self, MonitorError> {
        let cycle = match state {
            Some(bytes) => CycleMonitor::restore(cycle, bytes)?,
            None => CycleMonitor::new(cycle),
        };
        Ok(Self {
            signal_state: None,
            cycle: Some(cycle),
            aside: None,
            witnesses: Witnesses::default(),
            fresh_for: 0,
            now: Nanoseconds::MIN,
            found: Vec::new(),
        })
    }

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// Damaged bytes, another version, or the state of another model.
    pub fn restore(
        model: Arc<NominalModel>,
        cycle: Option<Arc<CycleModel>>,
        bytes: &[u8],
    ) -> Result<Self, MonitorError> {
        let mut joint = Self::new(Arc::clone(&model), None);
        let Some(cycle) = cycle else {
            joint.signal_state = Some(Monitor::restore(model, bytes)?);
            return Ok(joint);
        };
        let body = saved_state::unsealed(bytes).ok_or(MonitorError::Damaged)?;
        // Without a cycle machine the same bytes are the signal-state monitor's own.
        let saved: Saved = postcard::from_bytes(body).map_err(|_| MonitorError::OtherModel)?;
        if saved.version != STATE_VERSION {
            return Err(MonitorError::Damaged);
        }
        joint.signal_state = Some(Monitor::restore(model, &saved.signal_state)?);
        joint.cycle = Some(CycleMonitor::restore(cycle, &saved.cycle)?);
        joint.aside = saved.aside;
        joint.witnesses = saved.witnesses;
        joint.now = saved.now;
        Ok(joint)
    }

    /// Everything needed to go on later, compactly.
    pub fn save(&self) -> Vec<u8> {
        let (signal_state, cycle) = match (&self.signal_state, &self.cycle) {
            (Some(signal_state), None) => return signal_state.save(),
            (None, Some(cycle)) => return cycle.save(),
            (None, None) => return Vec::new(),
            (Some(signal_state), Some(cycle)) => (signal_state, cycle),
        };
        let saved = Saved {
            version: STATE_VERSION,
            signal_state: signal_state.save(),
            cycle: cycle.save(),
            aside: self.aside.clone(),
            witnesses: self.witnesses.clone(),
            now: self.now,
        };
        saved_state::sealed(&saved)
    }

    /// The number of a signal by its symbol, known or not.
    pub fn signal_index(&mut self, symbol: &str, known: Option<SignalIndex>) -> SignalIndex {
        match &mut self.signal_state {
            Some(signal_state) => signal_state.signal_index(symbol, known),
            None => known.unwrap_or(SignalIndex::MAX),
        }
    }

    /// Takes rows in time order.
    ///
    /// # Errors
    /// A row older than what has been seen.
    pub fn observe(&mut self, rows: &[Row]) -> Result<Vec<Finding>, MonitorError> {
        let (signal_state, cycle) = match (&mut self.signal_state, &mut self.cycle) {
            (Some(signal_state), None) => return signal_state.observe(rows),
            (None, Some(cycle)) => {
                let findings = cycle.observe(rows)?;
                self.now = rows.last().map_or(self.now, |row| self.now.max(row.time));
                return Ok(findings);
            }
            (None, None) => return Ok(Vec::new()),
            (Some(signal_state), Some(cycle)) => (signal_state, cycle),
        };
        let mut newest = self.now;
        for (index, row) in rows.iter().enumerate() {
            if row.time < newest {
                let late_s = newest.saturating_sub(row.time) as f64 / SECOND as f64;
                return Err(MonitorError::Order { row: index + 1, late_s: format!("{late_s:.3}") });
            }
            newest = row.time;
        }
        self.now = newest;
        let mut findings = Vec::new();
        for reading in rows.chunk_by(|a, b| a.time == b.time) {
            findings.extend(cycle.observe(reading)?);
            match &mut self.aside {
                Some(aside) => findings.extend(hand_on(aside, signal_state, reading)?),
                None => findings.extend(signal_state.observe(reading)?),
            }
        }
        Ok(self.placed(findings))
    }

    /// What [`Self::observe`] does, but for the findings: they wait for [`Self::take_findings`].
    ///
    /// # Errors
    /// A row older than what has been seen.
    pub fn take_rows(&mut self, rows: &[Row]) -> Result<(), MonitorError> {
        match (&mut self.signal_state, &self.cycle) {
            (Some(signal_state), None) => signal_state.take_rows(rows),
            _ => {
                let findings = self.observe(rows)?;
                self.found.extend(findings);
                Ok(())
            }
        }
    }

    /// What the keys of columns stand for that stand for signals by their numbers.
    pub fn keys(&self, numbers: Vec<SignalIndex>) -> Keys {
        match &self.signal_state {
            Some(signal_state) => signal_state.keys(numbers),
            None => Keys::unmarked(numbers),
        }
    }

    /// What [`Self::take_rows`] does, of rows in columns.
    ///
    /// # Errors
    /// A row older than what has been seen.
    pub fn take_columns(&mut self, columns: Columns<'_>) -> Result<(), MonitorError> {
        match (&mut self.signal_state, &self.cycle) {
            (Some(signal_state), None) => signal_state.take_columns(columns),
            _ => self.take_rows(&columns.to_rows()),
        }
    }

    /// All findings of rows taken and not asked for yet.
    pub fn take_findings(&mut self) -> Vec<Finding> {
        let mut findings = std::mem::take(&mut self.found);
        if let Some(signal_state) = &mut self.signal_state {
            findings.extend(signal_state.take_findings());
        }
        findings
    }

    /// The same, told when somebody asks.
    pub fn take_found(&mut self) -> Found {
        let mut found = Found::from(std::mem::take(&mut self.found));
        if let Some(signal_state) = &mut self.signal_state {
            found.append(signal_state.take_found());
        }
        found
    }

    /// Takes rows that say how signals stand, not that they changed.
    ///
    /// # Errors
    /// A row older than what has been seen.
    pub fn image(&mut self, rows: &[Row]) -> Result<Vec<Finding>, MonitorError> {
        // A cycle machine reads its words from the first complete image, changed or not.
        let mut findings = match &mut self.cycle {
            Some(cycle) => cycle.observe(rows)?,
            None => Vec::new(),
        };
        match (&mut self.signal_state, &mut self.aside) {
            (Some(signal_state), Some(aside)) => {
                let (time, was_paused) = (rows.last().map(|row| row.time), aside.is_paused());
                for row in rows {
                    aside.take(row.signal, row.value);
                }
                if let (Some(time), false) = (time, aside.is_paused()) {
                    let unknown = rows.iter().filter(|row| !aside.knows(row.signal)).copied();
                    let mut image: Vec<Row> = unknown.collect();
                    image.extend(aside.image(time));
                    findings.extend(signal_state.image(&image)?);
                } else if let (Some(time), false) = (time, was_paused) {
                    findings.extend(lose_sight(signal_state, time));
                }
            }
            (Some(signal_state), None) => findings.extend(signal_state.image(rows)?),
            (None, _) => {}
        }
        self.now = rows.last().map_or(self.now, |row| self.now.max(row.time));
        Ok(self.placed(findings))
    }

    /// The plant's rows begin, or go on after a gap, see [`Monitor::begin`].
    pub fn begin(&mut self, time: Nanoseconds, image: bool) {
        if let Some(signal_state) = &mut self.signal_state {
            signal_state.begin(time, image);
        }
    }

    /// The newest time that was observed or advanced to; None before the first.
    pub fn now(&self) -> Option<Nanoseconds> {
        match (&self.signal_state, &self.cycle) {
            (Some(signal_state), None) => signal_state.now(),
            _ => (self.now != Nanoseconds::MIN).then_some(self.now),
        }
    }

    /// Time went on to `now` without a change.
    pub fn advance(&mut self, now: Nanoseconds) -> Vec<Finding> {
        self.now = self.now.max(now);
        let mut findings = self.cycle.as_mut().map_or_else(Vec::new, |cycle| cycle.advance(now));
        let paused = self.aside.as_ref().is_some_and(Aside::is_paused);
        if let Some(signal_state) = self.signal_state.as_mut().filter(|_| !paused) {
            findings.extend(signal_state.advance(now));
        }
        self.placed(findings)
    }

    /// Nothing was recorded from `start` to `end`.
    pub fn gap(&mut self, start: Nanoseconds, end: Nanoseconds) -> Vec<Finding> {
        self.now = self.now.max(end);
        let mut findings = self.cycle.as_mut().map_or_else(Vec::new, |cycle| cycle.gap(start, end));
        if let Some(signal_state) = &mut self.signal_state {
            findings.extend(signal_state.gap(start, end));
        }
        self.placed(findings)
    }

    /// The log has ended.
    pub fn finish(&mut self) -> Vec<Finding> {
        let mut findings = self.cycle.as_mut().map_or_else(Vec::new, CycleMonitor::finish);
        if let Some(signal_state) = &mut self.signal_state {
            findings.extend(signal_state.finish());
        }
        self.placed(findings)
    }

    /// Snapshots of the whole plant made since the last call.
    pub fn take_snapshots(&mut self) -> Vec<Snapshot> {
        self.signal_state.as_mut().map_or_else(Vec::new, Monitor::take_snapshots)
    }

    fn placed(&mut self, mut findings: Vec<Finding>) -> Vec<Finding> {
        if self.cycle.is_some() && self.signal_state.is_some() {
            for finding in &mut findings {
                self.witnesses.place(finding, self.fresh_for);
            }
        }
        findings
    }
}

/// Gives the signal-state models the rows of a machine that goes by itself.
fn hand_on(
    aside: &mut Aside,
    signal_state: &mut Monitor,
    reading: &[Row],
) -> Result<Vec<Finding>, MonitorError> {
    let mut findings = Vec::new();
    let mut own: Vec<Row> = Vec::with_capacity(reading.len());
    for row in reading {
        match aside.take(row.signal, row.value) {
            Meaning::Own => own.push(*row),
            Meaning::Nothing => {}
            Meaning::PauseBegins => {
                findings.extend(signal_state.observe(&own)?);
                own.clear();
                findings.extend(lose_sight(signal_state, row.time));
            }
            Meaning::PauseEnds => {
                findings.extend(lose_sight(signal_state, row.time));
                let image: Vec<Row> = aside.image(row.time).collect();
                findings.extend(signal_state.image(&image)?);
            }
        }
    }
    findings.extend(signal_state.observe(&own)?);
    Ok(findings)
}

/// What follows has no predecessor; but nothing was missed, so no gap is told.
fn lose_sight(signal_state: &mut Monitor, time: Nanoseconds) -> Vec<Finding> {
    let mut findings = signal_state.gap(time, time);
    findings.retain(|finding| {
        finding.kind != Kind::Gap
            || finding.time != time
            || finding.observed_s.is_some_and(|s| s > 0.0)
    });
    findings
}
