//! Watching a plant against its nominal model (Ghosh 2016, section 2.6), as decided in the design.
//!
//! Two verbs: [`Monitor::observe`] takes rows in time order, [`Monitor::advance`] says that time
//! went on. Rows are held until their scan is complete, so any split of a log into batches gives
//! the same findings. All state is plain data and serialises.

mod batch;
mod deadlines;
mod marks;
mod paths;
mod report;
mod saved;
mod scan;
mod step;
mod usual;
mod watch;

use std::sync::Arc;

use thiserror::Error;

use crate::finding::Finding;
use crate::log::{Nanoseconds, SECOND, SignalIndex};

use super::chains::ChainIndex;
use super::events::{Meaning, Row};
use super::found::{Found, Record};
use super::lanes::Lanes;
use super::message;
use super::model::NominalModel;
use super::order::ScanOrder;
use super::parameters::Timing;
use super::snapshot::Snapshot;
use super::states::NO_STATE;
use super::teller::Teller;

pub use batch::Columns;
pub use marks::Keys;

use batch::Batch;
use marks::{Mark, Marks};
use step::Entry;
use watch::Watch;

/// Values of words nobody learned that are kept apart by number; beyond, they share the last.
const FURTHER_STATES_AT_MOST: usize = 10_000;
/// Signals nobody learned that are named once each; beyond, they pass unnamed.
const UNKNOWN_SIGNALS_AT_MOST: usize = 1_000;
/// Other orders of one scan are tried for up to this many events of one chain.
const REORDER_AT_MOST: usize = 6;
/// Consecutive known transitions after which a device is back on its path.
const KNOWN_TO_RETURN: u8 = 2;
/// Distinct alarm paths offered for confirmation.
const OFFERS_AT_MOST: usize = 10_000;
/// Snapshots kept until somebody takes them.
const SNAPSHOTS_AT_MOST: usize = 256;
/// Longest alarm path kept, in states.
const PATH_AT_MOST: usize = 64;

/// Why rows or a saved state were refused.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum MonitorError {
    /// A row older than what has been seen.
    #[error(
        "row {row} of the batch lies {late_s} s before a row already watched; give rows in time order"
    )]
    Order {
        /// Row of the batch, counted from 1.
        row: usize,
        /// How far back, in seconds.
        late_s: String,
    },
    /// The saved state is not one, or of another version.
    #[error("the saved monitor state is damaged or of another version; start without it")]
    Damaged,
    /// The saved state belongs to another model.
    #[error("the saved monitor state belongs to another model; start without it")]
    OtherModel,
}

/// Watches one plant.
#[derive(Debug, Clone)]
pub struct Monitor {
    model: Arc<NominalModel>,
    order: Option<ScanOrder>,
    lanes: Lanes,
    stall_after: Vec<Nanoseconds>,
    fresh_for: Nanoseconds,
    watch: Watch,
    /// Findings not taken yet.
    records: Vec<Record>,
    scratch: Vec<(ChainIndex, Entry)>,
    marks: Marks,
    /// The marks of the rows in hand.
    marked: Vec<Mark>,
}

impl Monitor {
    /// A monitor that has seen nothing yet.
    pub fn new(model: Arc<NominalModel>) -> Self {
        let groups = model.plant.groups.len();
        let lanes = model.fresh_lanes();
        Self {
            order: (model.parameters.timing == Timing::Adaptive)
                .then(|| ScanOrder::of(&model.plant)),
            stall_after: (0..groups).map(|group| model.stall_after(group)).collect(),
            fresh_for: (model.parameters.return_within_s * SECOND as f64) as Nanoseconds,
            marks: Marks::of(&model, &lanes),
            marked: Vec::new(),
            lanes,
            watch: Watch::of(&model),
            records: Vec::new(),
            scratch: Vec::new(),
            model,
        }
    }

    /// The signal's number for rows: the model's, or a number beyond for a signal nobody learned.
    pub fn signal_index(&mut self, symbol: &str, known: Option<SignalIndex>) -> SignalIndex {
        if let Some(known) = known {
            return known;
        }
        let beyond = self.model.plant.signals.len();
        let unknown = &mut self.watch.unknown_signals;
        let place = unknown.iter().position(|(s, _)| s == symbol).unwrap_or_else(|| {
            if unknown.len() < UNKNOWN_SIGNALS_AT_MOST {
                unknown.push((symbol.to_owned(), false));
                unknown.len() - 1
            } else {
                UNKNOWN_SIGNALS_AT_MOST
            }
        });
        (beyond + place) as SignalIndex
    }

    /// Takes rows in time order and returns what they show.
    ///
    /// # Errors
    /// A row older than one already watched; nothing of the batch is taken then.
    pub fn observe(&mut self, rows: &[Row]) -> Result<Vec<Finding>, MonitorError> {
        self.take_rows(rows)?;
        Ok(self.take_findings())
    }

    /// What [`Self::observe`] does, but for the findings: they wait for [`Self::take_findings`].
    ///
    /// # Errors
    /// A row older than one already watched; nothing of the batch is taken then.
    pub fn take_rows(&mut self, rows: &[Row]) -> Result<(), MonitorError> {
        self.check_order(rows)?;
        self.take_batch(rows);
        Ok(())
    }

    /// The same, of rows in columns, which are in time order by themselves.
    ///
    /// # Errors
    /// They begin before a row already watched; none of them is taken then.
    pub fn take_columns(&mut self, columns: Columns<'_>) -> Result<(), MonitorError> {
        if columns.times(0..columns.len().min(1)).any(|first| first < self.watch.now) {
            return Err(self.disorder(columns));
        }
        self.take_batch(columns);
        Ok(())
    }

    /// What the keys of columns stand for that stand for signals by their numbers.
    pub fn keys(&self, numbers: Vec<SignalIndex>) -> Keys {
        self.marks.keys(numbers)
    }

    /// All findings not taken yet.
    pub fn take_findings(&mut self) -> Vec<Finding> {
        self.take_found().into_findings()
    }

    /// The same, in numbers.
    pub fn take_found(&mut self) -> Found {
        Found::new(Arc::clone(&self.model), std::mem::take(&mut self.records))
    }

    /// The plant's rows begin at `time`, or go on after a gap: for a part of it, whose own rows may
    /// come later. `image` says whether the rows of a log's very first time are an image of the
    /// plant ([`is_image`](super::events::is_image)); after a gap they always are.
    ///
    /// Without it, a monitor takes the first rows it sees for the first of the plant.
    pub fn begin(&mut self, time: Nanoseconds, image: bool) {
        if !self.watch.started {
            self.watch.started = true;
            self.watch.resynchronise = image;
        }
        if self.watch.resynchronise {
            self.watch.begins = Some(time);
            self.resume_clocks(time);
        }
    }

    /// Takes rows that say how signals stand, not that they changed: what a live source reads
    /// first after its start or a gap, or when it meets a signal.
    ///
    /// # Errors
    /// A row older than one already watched; nothing of the batch is taken then.
    pub fn image(&mut self, rows: &[Row]) -> Result<Vec<Finding>, MonitorError> {
        self.check_order(rows)?;
        let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
            return Ok(Vec::new());
        };
        self.complete_scan();
        self.pass_deadlines(first.time);
        if std::mem::replace(&mut self.watch.resynchronise, false) {
            self.resume_clocks(last.time);
        }
        self.watch.begins = None;
        self.watch.started = true;
        self.watch.now = last.time;
        for &row in rows {
            if row.signal as usize >= self.model.plant.signals.len() {
                self.report_unknown_signal(row);
            } else if self.watch.values.take(row.signal, row.value) != Meaning::Sample {
                self.lose_sight(row.signal);
            }
        }
        Ok(self.take_findings())
    }

    /// Time went on to `now` without a change: completes the running scan, finds stalls and paths
    /// that did not return.
    pub fn advance(&mut self, now: Nanoseconds) -> Vec<Finding> {
        // What is due is judged when all rows before it are: the running scan may hold the very
        // event a group was waiting for.
        if self.scan_is_over(now) || now >= self.watch.next_deadline {
            self.complete_scan();
        }
        if now > self.watch.now {
            self.watch.now = now;
            self.pass_deadlines(now);
        }
        self.take_findings()
    }

    /// The newest time that was observed or advanced to; None before the first.
    pub fn now(&self) -> Option<Nanoseconds> {
        (self.watch.now != Nanoseconds::MIN).then_some(self.watch.now)
    }

    /// Nothing was recorded from `start` to `end`: what follows has no predecessor.
    pub fn gap(&mut self, start: Nanoseconds, end: Nanoseconds) -> Vec<Finding> {
        self.complete_scan();
        let watch = &mut self.watch;
        watch.now = watch.now.max(end);
        for here in &mut watch.here {
            here.forget();
            here.return_to_path();
        }
        watch.open.clear();
        for (stalled, clock) in watch.group_stalled.iter_mut().zip(&mut watch.clocks) {
            clock.runs = false;
            // A stop that has been told is not told again after the gap.
            if stalled.take().is_some() {
                clock.state = NO_STATE;
            }
        }
        watch.next_deadline = Nanoseconds::MAX;
        watch.resynchronise = true;
        watch.begins = None;
        watch.values.doubt();
        self.lanes.forget_entries();
        let finding = message::gap(start, end);
        self.records.push(finding.into());
        self.take_findings()
    }

    /// The log has ended: completes the running scan. Open paths stay suspected.
    pub fn finish(&mut self) -> Vec<Finding> {
        self.complete_scan();
        self.take_findings()
    }

    /// Snapshots of the whole plant made since the last call.
    pub fn take_snapshots(&mut self) -> Vec<Snapshot> {
        std::mem::take(&mut self.watch.snapshots)
    }

    fn check_order(&self, batch: impl Batch) -> Result<(), MonitorError> {
        let mut newest = self.watch.now;
        let mut ordered = true;
        for time in batch.times(0..batch.len()) {
            ordered &= time >= newest;
            newest = time;
        }
        if ordered { Ok(()) } else { Err(self.disorder(batch)) }
    }

    #[cold]
    fn disorder(&self, batch: impl Batch) -> MonitorError {
        let times = || batch.times(0..batch.len());
        let before = std::iter::once(self.watch.now).chain(times());
        let mut late = times().zip(before).zip(1..).filter(|((time, newest), _)| time < newest);
        let (row, late) = late
            .next()
            .map_or((0, 0), |((time, newest), number)| (number, newest.saturating_sub(time)));
        MonitorError::Order { row, late_s: format!("{:.3}", late as f64 / SECOND as f64) }
    }

    /// Knows the names of states, also of those first met while watching.
    fn teller(&self) -> Teller<'_> {
        Teller { model: &self.model, further: &self.watch.further }
    }
}
