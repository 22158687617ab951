//! Sampled tables to changes: which columns are signals, and when they changed.

use runglight_engine::bits::{BitNames, width_of};
use runglight_engine::log::{Gap, Nanoseconds, SECOND, SignalIndex};

use crate::error::{FormatError, RowFault, shortened};
use crate::intake::Intake;
use crate::options::{OnError, ReadOptions};
use crate::report::{BadRow, SHOWN_BAD_ROWS};
use crate::value::{self, Cell};

/// A column with more different values than this is a measurement.
const WORD_VALUES_MOST: usize = 64;
/// In fewer samples than this, changing often proves nothing.
const SAMPLES_TO_JUDGE: u64 = 10;

/// Takes samples row by row and keeps only what changed.
pub(crate) struct Sampler {
    columns: Vec<Sampled>,
    times: Vec<Nanoseconds>,
    /// Changes in order of sample, then column.
    changes: Vec<Change>,
    stop_at_first: bool,
}

struct Change {
    sample: usize,
    column: u32,
    value: i64,
}

/// One column and what is known of it so far.
struct Sampled {
    name: String,
    /// Thresholds in rising order; empty for a column that is not banded.
    thresholds: Vec<f64>,
    split: bool,
    last: Option<i64>,
    changes: u64,
    distinct: Vec<i64>,
    lowest: i64,
    highest: i64,
    /// All bits that were ever set.
    ever_set: u64,
    left_out: Option<&'static str>,
    bad: Vec<u64>,
    first_bad: Vec<(u64, RowFault)>,
}

impl Sampler {
    pub(crate) fn new(names: impl IntoIterator<Item = String>, options: &ReadOptions) -> Self {
        let columns = names.into_iter().map(|name| Sampled::new(name, options)).collect();
        Self {
            columns,
            times: Vec::new(),
            changes: Vec::new(),
            stop_at_first: options.on_error == OnError::Fail,
        }
    }

    /// Begins the next sample.
    pub(crate) fn sample(&mut self, time: Nanoseconds) {
        self.times.push(time);
    }

    /// True where the column's cells no longer matter.
    #[inline]
    pub(crate) fn is_left_out(&self, column: usize) -> bool {
        self.columns[column].left_out.is_some()
    }

    /// Takes one cell of the running sample.
    #[inline]
    pub(crate) fn cell(&mut self, column: usize, row: u64, cell: Cell, found: &[u8]) {
        let sampled = &mut self.columns[column];
        if sampled.left_out.is_some() {
            return;
        }
        let value = match cell {
            Cell::Integer(number) if sampled.thresholds.is_empty() => number,
            Cell::Integer(number) => sampled.band(number as f64),
            Cell::Real(real) if !sampled.thresholds.is_empty() => sampled.band(real),
            Cell::Real(_) => {
                sampled.left_out = Some(
                    "holds measurements (numbers with a fraction); give analog with a threshold to keep it",
                );
                return;
            }
            Cell::Empty | Cell::Text => {
                sampled.take_bad(row, found, self.stop_at_first);
                return;
            }
        };
        if sampled.last == Some(value) {
            return;
        }
        sampled.take_change(value);
        let sample = self.times.len().saturating_sub(1);
        self.changes.push(Change { sample, column: column as u32, value });
    }

    /// The first bad cell so far in a column that will be kept as things stand.
    pub(crate) fn first_bad(&self) -> Option<(u64, RowFault)> {
        self.kept()
            .filter_map(|column| column.first_bad.first())
            .min_by_key(|(row, _)| *row)
            .cloned()
    }

    fn kept(&self) -> impl Iterator<Item = &Sampled> {
        let samples = self.times.len() as u64;
        self.columns.iter().filter(move |column| column.verdict(samples).is_none())
    }

    /// Hands the changes of the kept columns on.
    pub(crate) fn finish(self, intake: &mut Intake) -> Result<(), FormatError> {
        // Words are split here, where samples become changes.
        intake.words.clear();
        let samples = self.times.len() as u64;
        if samples == 0 {
            return Ok(());
        }
        self.report_bad(intake)?;
        let bits = BitNames::of(self.columns.iter().map(|column| column.name.as_str()));
        let mut signals: Vec<Signals> = Vec::new();
        for column in &self.columns {
            if let Some(reason) = column.verdict(samples) {
                intake.report.leave_out(&column.name, reason);
                signals.push(Signals::None);
                continue;
            }
            signals.push(column.signals(bits, intake));
        }
        self.say_spacing(intake);
        self.emit(&signals, intake);
        Ok(())
    }

    /// Bad cells count only in columns that are kept, which is known only now.
    fn report_bad(&self, intake: &mut Intake) -> Result<(), FormatError> {
        let Some((row, reason)) = self.first_bad() else { return Ok(()) };
        if self.stop_at_first {
            return intake.bad(row, reason);
        }
        let mut rows: Vec<u64> =
            self.kept().flat_map(|column| column.bad.iter().copied()).collect();
        rows.sort_unstable();
        rows.dedup();
        intake.report.bad_rows += rows.len() as u64;
        let mut shown: Vec<(u64, RowFault)> =
            self.kept().flat_map(|column| column.first_bad.iter().cloned()).collect();
        shown.sort_by_key(|(row, _)| *row);
        shown.dedup_by_key(|(row, _)| *row);
        let bad = &mut intake.report.bad;
        bad.extend(
            shown.into_iter().map(|(row, reason)| BadRow { row, reason: reason.to_string() }),
        );
        bad.sort_by_key(|bad| bad.row);
        bad.truncate(SHOWN_BAD_ROWS);
        Ok(())
    }

    /// The scan interval is the median spacing; spacings far beyond it are gaps.
    fn say_spacing(&self, intake: &mut Intake) {
        let mut spacings: Vec<Nanoseconds> =
            self.times.windows(2).map(|pair| pair[1].saturating_sub(pair[0])).collect();
        let Some(median) = median(&mut spacings) else { return };
        if median <= 0 {
            return;
        }
        intake.scan_interval = Some(median);
        let longest = median.saturating_mul(10).max(SECOND);
        intake.gaps.extend(
            self.times
                .windows(2)
                .filter(|pair| pair[1].saturating_sub(pair[0]) > longest)
                .map(|pair| Gap { start: pair[0], end: pair[1] }),
        );
    }

    fn emit(&self, signals: &[Signals], intake: &mut Intake) {
        let mut words = vec![None; self.columns.len()];
        let mut first: Option<(SignalIndex, i64)> = None;
        let mut newest_sample = None;
        for change in &self.changes {
            let column = change.column as usize;
            let time = self.times[change.sample];
            let mut push = |signal: SignalIndex, value: i64| {
                intake.push(time, signal, value);
                newest_sample = Some(change.sample);
                if signal == 0 {
                    first = Some((signal, value));
                }
            };
            match &signals[column] {
                Signals::None => {}
                Signals::One(signal) => push(*signal, change.value),
                Signals::Bits(bits) => {
                    let word = change.value as u64;
                    let changed = words[column].map_or(u64::MAX, |before: u64| before ^ word);
                    for (bit, signal) in bits.iter().filter(|(bit, _)| changed >> bit & 1 == 1) {
                        push(*signal, (word >> bit & 1) as i64);
                    }
                    words[column] = Some(word);
                }
            }
        }
        // A last sample without change still proves that the recording went on.
        if let (Some((signal, value)), Some(&end)) = (first, self.times.last())
            && newest_sample != Some(self.times.len() - 1)
        {
            intake.push(end, signal, value);
        }
    }
}

/// The signals a column becomes.
enum Signals {
    None,
    One(SignalIndex),
    Bits(Vec<(u32, SignalIndex)>),
}

impl Sampled {
    fn new(name: String, options: &ReadOptions) -> Self {
        let mut thresholds: Vec<f64> = options
            .analog
            .iter()
            .filter(|(column, _)| *column == name)
            .map(|(_, threshold)| *threshold)
            .collect();
        thresholds.sort_by(f64::total_cmp);
        Self {
            split: options.bits.contains(&name),
            name,
            thresholds,
            last: None,
            changes: 0,
            distinct: Vec::new(),
            lowest: i64::MAX,
            highest: i64::MIN,
            ever_set: 0,
            left_out: None,
            bad: Vec::new(),
            first_bad: Vec::new(),
        }
    }

    /// The number of thresholds reached.
    fn band(&self, real: f64) -> i64 {
        self.thresholds.iter().filter(|threshold| real >= **threshold).count() as i64
    }

    fn take_change(&mut self, value: i64) {
        self.changes += u64::from(self.last.is_some());
        self.last = Some(value);
        self.lowest = self.lowest.min(value);
        self.highest = self.highest.max(value);
        self.ever_set |= value as u64;
        let exempt = self.split || !self.thresholds.is_empty();
        if exempt || self.distinct.contains(&value) {
            return;
        }
        self.distinct.push(value);
        if self.distinct.len() > WORD_VALUES_MOST {
            self.left_out = Some(
                "holds measurements (more than 64 different values); give analog with a threshold, or bits, to keep it",
            );
            self.bad = Vec::new();
        }
    }

    fn take_bad(&mut self, row: u64, found: &[u8], stop_at_first: bool) {
        if self.first_bad.len() < SHOWN_BAD_ROWS {
            let reason = if found.is_empty() {
                RowFault::EmptyCell { column: self.name.clone(), expected: value::EXPECTED }
            } else {
                RowFault::Cell {
                    column: self.name.clone(),
                    found: shortened(found),
                    expected: value::EXPECTED,
                }
            };
            self.first_bad.push((row, reason));
        }
        if !stop_at_first {
            self.bad.push(row);
        }
    }

    /// Why the column is no signal, as far as the samples so far tell.
    fn verdict(&self, samples: u64) -> Option<&'static str> {
        let exempt = self.split || !self.thresholds.is_empty();
        if self.left_out.is_some() {
            return self.left_out;
        }
        if self.last.is_none() {
            return Some(if self.first_bad.is_empty() || self.all_empty() {
                "is empty"
            } else {
                "holds text, not values"
            });
        }
        let is_truth = self.lowest >= 0 && self.highest <= 1;
        (!exempt && !is_truth && samples >= SAMPLES_TO_JUDGE && 2 * self.changes > samples).then_some(
            "holds measurements (a new value in most samples); give analog with a threshold, or bits, to keep it",
        )
    }

    fn all_empty(&self) -> bool {
        self.first_bad.iter().all(|(_, reason)| matches!(reason, RowFault::EmptyCell { .. }))
    }

    fn signals(&self, names: BitNames, intake: &mut Intake) -> Signals {
        if self.last.is_none() || !self.split {
            return Signals::One(intake.names.intern(self.name.as_bytes()));
        }
        let bits: Vec<(u32, SignalIndex)> = (0..width_of(self.lowest, self.highest))
            .filter(|bit| self.ever_set >> bit & 1 == 1)
            .map(|bit| (bit, intake.names.intern(names.name(&self.name, bit).as_bytes())))
            .collect();
        if bits.is_empty() {
            intake.report.leave_out(&self.name, "no bit of it is ever set");
        }
        Signals::Bits(bits)
    }
}

/// The median; the mean of the middle two where their number is even.
fn median(numbers: &mut [Nanoseconds]) -> Option<Nanoseconds> {
    let middle = numbers.len() / 2;
    let odd = numbers.len() % 2 == 1;
    let (lower, upper, _) = (!numbers.is_empty()).then(|| numbers.select_nth_unstable(middle))?;
    let upper = *upper;
    match lower.iter().max() {
        Some(&below) if !odd => Some(below + upper.saturating_sub(below) / 2),
        _ => Some(upper),
    }
}

/// Holds rows back until none can come before them any more, and gives them out in time order;
/// rows of one time keep the order of the file.
pub(crate) struct Reorder<T> {
    waiting: std::collections::VecDeque<(Nanoseconds, T)>,
    window: Nanoseconds,
}

impl<T> Reorder<T> {
    pub(crate) fn new(window: Nanoseconds) -> Self {
        Self { waiting: std::collections::VecDeque::new(), window }
    }

    pub(crate) fn put(&mut self, time: Nanoseconds, row: T) {
        let place = self.waiting.partition_point(|(earlier, _)| *earlier <= time);
        self.waiting.insert(place, (time, row));
    }

    /// The next row that is certain; any row where `all` are wanted.
    pub(crate) fn take(&mut self, all: bool) -> Option<(Nanoseconds, T)> {
        let newest = self.waiting.back()?.0;
        let oldest = self.waiting.front()?.0;
        if all || newest.saturating_sub(oldest) >= self.window {
            return self.waiting.pop_front();
        }
        None
    }
}
