//! Timing diagrams: what to draw of each signal between two times, at any scale.
//!
//! A window is cut into columns, a pixel or so each. A column with one or two changes gives those,
//! at their exact times, so that a pulse of one scan is seen in a view of a year; one with more
//! gives a *busy* span from the first to the last of them. Finding a column's last change is a
//! search, not a walk: what a window costs grows with its columns, not with its changes.

use crate::log::{ChangeLog, Nanoseconds, SignalIndex};

/// 73 years on either side of 1970: no PLC is that old.
const FARTHEST: Nanoseconds = 1 << 61;

/// A stretch of one signal that is drawn in one stroke; it ends where the next one begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// When it begins.
    pub start: Nanoseconds,
    /// The value it begins with.
    pub value: i64,
    /// Changes after its beginning and before the next span that are too close together to be
    /// drawn; 0 where it is level.
    pub changes: u32,
    /// False before the first row of the signal: nobody knows.
    pub known: bool,
}

/// One change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// When.
    pub time: Nanoseconds,
    /// The value from then on.
    pub value: i64,
}

/// The changes of every signal, each in its own lane.
#[derive(Debug, Clone, Default)]
pub struct TimingDiagram {
    lanes: Vec<Lane>,
}

#[derive(Debug, Clone, Default)]
struct Lane {
    time: Vec<Nanoseconds>,
    value: Vec<i64>,
}

impl TimingDiagram {
    /// The diagram of a whole log.
    pub fn of(log: &ChangeLog) -> Self {
        let mut rows = vec![0_usize; log.signals.len()];
        for &signal in &log.signal {
            rows[signal as usize] += 1;
        }
        let lanes = rows
            .iter()
            .map(|&rows| Lane { time: Vec::with_capacity(rows), value: Vec::with_capacity(rows) })
            .collect();
        let mut diagram = Self { lanes };
        diagram.append(&log.time, &log.signal, &log.value);
        diagram
    }

    /// Adds rows that are no older than those before. Samples are left out; signals that are new
    /// get a lane.
    pub fn append(&mut self, time: &[Nanoseconds], signal: &[SignalIndex], value: &[i64]) {
        for ((&time, &signal), &value) in time.iter().zip(signal).zip(value) {
            let at = signal as usize;
            if at >= self.lanes.len() {
                self.lanes.resize_with(at + 1, Lane::default);
            }
            self.lanes[at].push(time, value);
        }
    }

    /// Forgets what was over before a time; the level each signal had then is kept.
    pub fn forget_before(&mut self, time: Nanoseconds) {
        for lane in &mut self.lanes {
            let over = lane.time.partition_point(|&change| change < time).saturating_sub(1);
            lane.time.drain(..over);
            lane.value.drain(..over);
        }
    }

    /// Number of lanes.
    pub fn lanes(&self) -> usize {
        self.lanes.len()
    }

    /// Changes of one lane, the first row counted.
    pub fn changes(&self, lane: usize) -> usize {
        self.lanes.get(lane).map_or(0, |lane| lane.time.len())
    }

    /// Smallest and largest value a lane ever had.
    pub fn value_range(&self, lane: usize) -> Option<(i64, i64)> {
        let values = &self.lanes.get(lane)?.value;
        Some((*values.iter().min()?, *values.iter().max()?))
    }

    /// What to draw of a lane from `from` up to (not including) `until`, in time order.
    ///
    /// The first span begins at `from`; there are at most three a column. Empty for a lane that
    /// is not there, and for a window without length.
    pub fn spans(
        &self,
        lane: usize,
        from: Nanoseconds,
        until: Nanoseconds,
        columns: u32,
    ) -> Vec<Span> {
        match self.lanes.get(lane) {
            Some(lane) if until > from && from < FARTHEST && until > -FARTHEST => {
                lane.spans(from, until, columns.max(1))
            }
            _ => Vec::new(),
        }
    }

    /// The changes of a lane from `from` up to (not including) `until`, at most `limit` of them.
    pub fn edges(
        &self,
        lane: usize,
        from: Nanoseconds,
        until: Nanoseconds,
        limit: usize,
    ) -> Vec<Edge> {
        let Some(lane) = self.lanes.get(lane) else { return Vec::new() };
        let first = lane.time.partition_point(|&change| change < from);
        (first..lane.time.len())
            .take_while(|&at| lane.time[at] < until)
            .take(limit)
            .map(|at| lane.edge(at))
            .collect()
    }

    /// The first change of a lane after a time.
    pub fn next_edge(&self, lane: usize, after: Nanoseconds) -> Option<Edge> {
        let lane = self.lanes.get(lane)?;
        let at = lane.time.partition_point(|&change| change <= after);
        (at < lane.time.len()).then(|| lane.edge(at))
    }

    /// The last change of a lane before a time.
    pub fn previous_edge(&self, lane: usize, before: Nanoseconds) -> Option<Edge> {
        let lane = self.lanes.get(lane)?;
        let at = lane.time.partition_point(|&change| change < before);
        at.checked_sub(1).map(|at| lane.edge(at))
    }
}

impl Lane {
    fn push(&mut self, time: Nanoseconds, value: i64) {
        if self.value.last() != Some(&value) {
            self.time.push(time);
            self.value.push(value);
        }
    }

    fn edge(&self, at: usize) -> Edge {
        Edge { time: self.time[at], value: self.value[at] }
    }

    fn spans(&self, from: Nanoseconds, until: Nanoseconds, columns: u32) -> Vec<Span> {
        // Differences of times beyond these would not fit.
        let (from, until) = (from.max(-FARTHEST), until.min(FARTHEST));
        let width = ((until - from) / i64::from(columns)).max(1);
        let first = self.time.partition_point(|&change| change <= from);
        let mut spans = vec![Span {
            start: from,
            value: first.checked_sub(1).map_or(0, |at| self.value[at]),
            changes: 0,
            known: first > 0,
        }];
        let mut at = first;
        let mut column_before = -1;
        while at < self.time.len() && self.time[at] < until {
            let column = (self.time[at] - from) / width;
            let column_end = from.saturating_add((column + 1).saturating_mul(width)).min(until);
            let next = self.first_from(at, column_end).max(at + 1);
            if next - at > 2 {
                self.push_busy(&mut spans, at, next, column == column_before + 1);
            } else {
                spans.extend((at..next).map(|change| level(self.edge(change))));
            }
            column_before = column;
            at = next;
        }
        spans
    }

    /// Many changes in one column: a busy span, and the level after it. Columns in a row that are
    /// busy become one span.
    fn push_busy(&self, spans: &mut Vec<Span>, at: usize, next: usize, follows: bool) {
        let changes = u32::try_from(next - at - 2).unwrap_or(u32::MAX);
        let before = spans.len().checked_sub(2).filter(|&before| spans[before].changes > 0);
        match before {
            Some(before) if follows => {
                spans.pop();
                // The level between the two columns is one of the changes now, and so is the first.
                spans[before].changes = spans[before].changes.saturating_add(changes + 2);
            }
            _ => spans.push(Span { changes, ..level(self.edge(at)) }),
        }
        spans.push(level(self.edge(next - 1)));
    }

    /// The first change at or after `time`, looked for from `at` on in growing steps.
    fn first_from(&self, at: usize, time: Nanoseconds) -> usize {
        let mut step = 1;
        let mut low = at;
        while low + step < self.time.len() && self.time[low + step] < time {
            low += step;
            step *= 2;
        }
        let high = (low + step).min(self.time.len());
        low + self.time[low..high].partition_point(|&change| change < time)
    }
}

fn level(edge: Edge) -> Span {
    Span { start: edge.time, value: edge.value, changes: 0, known: true }
}
