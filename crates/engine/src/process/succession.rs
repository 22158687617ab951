//! Which event comes next: inside a trace, and from one trace to another.

use super::event_log::EventLog;

/// How the traces of an event log follow one another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Succession {
    /// Runs of one machine: what follows the last event of a run is the reset that opens the next.
    /// It is the very event that tells *once more* from *that was the last time*.
    Consecutive,
    /// Cases that have nothing to do with one another.
    Separate,
}

impl Succession {
    /// Consecutive where the events are those of a PLC and no trace opens before the one before
    /// it has ended.
    pub fn of(log: &EventLog) -> Self {
        let of_plc = log.activities.iter().any(|activity| activity.class.is_some());
        let ordered = (1..log.traces()).all(|trace| {
            match (log.times(trace - 1).last(), log.times(trace).first()) {
                (Some(end), Some(start)) => end <= start,
                _ => false,
            }
        });
        if of_plc && ordered { Self::Consecutive } else { Self::Separate }
    }

    /// Trace and number of the event that follows an event of a trace.
    pub fn next(self, log: &EventLog, trace: usize, event: usize) -> Option<(usize, usize)> {
        if event + 1 < log.trace(trace).len() {
            return Some((trace, event + 1));
        }
        let opens = self == Self::Consecutive && trace + 1 < log.traces();
        (opens && !log.trace(trace + 1).is_empty()).then_some((trace + 1, 0))
    }
}
