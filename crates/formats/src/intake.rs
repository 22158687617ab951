//! Where rows of every format come in: bad rows, disorder and the report are handled once.

use std::path::{Path, PathBuf};

use runglight_engine::bits::split_words;
use runglight_engine::log::{ChangeLog, Gap, Nanoseconds, SECOND, SignalIndex};

use crate::Reading;
use crate::error::{FormatError, RowFault};
use crate::format::Format;
use crate::names::{NameQueue, SignalNames};
use crate::options::{OnError, ReadOptions};
use crate::report::{BadRow, ReadReport, SHOWN_BAD_ROWS};

/// Collects rows into a log.
pub(crate) struct Intake {
    pub(crate) path: PathBuf,
    pub(crate) report: ReadReport,
    pub(crate) names: SignalNames,
    pub(crate) scan_interval: Option<Nanoseconds>,
    pub(crate) gaps: Vec<Gap>,
    /// Words that are still to be split into bits.
    pub(crate) words: Vec<String>,
    on_error: OnError,
    reorder: Nanoseconds,
    newest: Nanoseconds,
    time: Vec<Nanoseconds>,
    signal: Vec<SignalIndex>,
    value: Vec<i64>,
    /// Names of the last rows, whose signals are not in their column yet.
    queue: NameQueue,
}

impl Intake {
    pub(crate) fn new(
        path: &Path,
        format: Format,
        options: &ReadOptions,
    ) -> Result<Self, FormatError> {
        Ok(Self {
            path: path.to_owned(),
            report: ReadReport::new(format),
            names: SignalNames::default(),
            scan_interval: None,
            gaps: Vec::new(),
            words: options.bits.clone(),
            on_error: options.on_error,
            reorder: reorder_window(path, options)?,
            newest: Nanoseconds::MIN,
            time: Vec::new(),
            signal: Vec::new(),
            value: Vec::new(),
            queue: NameQueue::default(),
        })
    }

    /// Several sources are merged by time: no row is too old.
    pub(crate) fn accept_any_order(&mut self) {
        self.reorder = Nanoseconds::MAX;
    }

    pub(crate) fn on_error(&self) -> OnError {
        self.on_error
    }

    /// The reorder window.
    pub(crate) fn reorder(&self) -> Nanoseconds {
        self.reorder
    }

    /// True where a row of this time is older than the window allows.
    pub(crate) fn is_late(&self, time: Nanoseconds) -> bool {
        time < self.newest && self.newest.saturating_sub(time) > self.reorder
    }

    /// Counts a bad row, or ends reading with it.
    #[cold]
    pub(crate) fn bad(&mut self, row: u64, reason: RowFault) -> Result<(), FormatError> {
        if self.on_error == OnError::Fail {
            return Err(FormatError::BadRow { path: self.path.clone(), row, reason });
        }
        self.report.bad_rows += 1;
        if self.report.bad.len() < SHOWN_BAD_ROWS {
            self.report.bad.push(BadRow { row, reason: reason.to_string() });
        }
        Ok(())
    }

    /// True where a row of this time may come now; else it is a bad row.
    #[inline]
    pub(crate) fn in_order(&mut self, row: u64, time: Nanoseconds) -> Result<bool, FormatError> {
        if time >= self.newest {
            self.newest = time;
            return Ok(true);
        }
        let late = self.newest.saturating_sub(time);
        if late <= self.reorder {
            return Ok(true);
        }
        let in_seconds = |nanoseconds| format!("{:.3}", nanoseconds as f64 / SECOND as f64);
        let reorder_s = in_seconds(self.reorder);
        self.bad(row, RowFault::Late { late_s: in_seconds(late), reorder_s })?;
        Ok(false)
    }

    /// Takes a row whose time is [in order](Self::in_order).
    #[inline]
    pub(crate) fn push(&mut self, time: Nanoseconds, signal: SignalIndex, value: i64) {
        self.time.push(time);
        self.signal.push(signal);
        self.value.push(value);
    }

    /// An occurrence has no value: the signal goes to 1 and back to 0 at the same time.
    #[inline]
    pub(crate) fn push_pulse(&mut self, time: Nanoseconds, signal: SignalIndex) {
        self.push(time, signal, 1);
        self.push(time, signal, 0);
    }

    /// Takes a row whose time is [in order](Self::in_order) and whose signal has a name only.
    /// A file's rows are taken all by this, or none.
    #[inline]
    pub(crate) fn push_named(&mut self, time: Nanoseconds, name: &[u8], value: i64) {
        self.time.push(time);
        self.value.push(value);
        if self.queue.push(name) {
            self.names.intern_all(&mut self.queue, &mut self.signal);
        }
    }

    pub(crate) fn finish(mut self) -> Result<Reading, FormatError> {
        self.names.intern_all(&mut self.queue, &mut self.signal);
        if self.names.latin_1 {
            self.report.note("names that are not UTF-8 are read as Latin-1 (Windows-1252)");
        }
        if self.time.is_empty() {
            self.report.note("the file has no rows");
        }
        let mut log = ChangeLog {
            signals: self.names.into_names(),
            time: self.time,
            signal: self.signal,
            value: self.value,
            scan_interval: self.scan_interval,
            gaps: self.gaps,
        };
        // The window was applied row by row; here rows are only put in order.
        log.sort_within(Nanoseconds::MAX)?;
        if !self.words.is_empty() {
            log = split_words(&log, &self.words)
                .map_err(|source| FormatError::Words { path: self.path, source })?;
        }
        Ok(Reading { log, report: self.report })
    }
}

/// The reorder window in nanoseconds.
fn reorder_window(path: &Path, options: &ReadOptions) -> Result<Nanoseconds, FormatError> {
    if options.reorder_s.is_nan() || options.reorder_s < 0.0 {
        return Err(FormatError::Option {
            path: path.to_owned(),
            option: "reorder_s",
            found: options.reorder_s.to_string(),
            expected: "a number of seconds, 0 or more",
        });
    }
    Ok((options.reorder_s * SECOND as f64) as Nanoseconds)
}
