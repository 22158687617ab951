//! What the mode bits are to the signal-state models: no device of the machine, but what tells
//! whether it goes by itself.
//!
//! Their rows are kept from those models, and so is everything that happens while the machine is
//! moved by hand or stands with an alarm: an operator keeps to no sequence, and the time until he
//! comes is no time of the machine. What follows has no predecessor, as after a gap.

use serde::{Deserialize, Serialize};

use crate::cycle::regions::{ModeBit, Modes};
use crate::log::{ChangeLog, Gap, Nanoseconds, SignalIndex};
use crate::signal_state::events::Row;

/// What a row means to the signal-state models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// A row of a machine that goes by itself.
    Own,
    /// Nothing: a mode bit that changes nothing of that, or a row of a pause.
    Nothing,
    /// Manual or alarm comes.
    PauseBegins,
    /// Neither is left.
    PauseEnds,
}

/// Follows the mode bits row by row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Aside {
    is_mode: Vec<bool>,
    /// Manual and alarm bits, and whether each says so.
    pausing: Vec<(ModeBit, bool)>,
    paused: bool,
    /// By signal.
    last: Vec<Option<i64>>,
}

impl Aside {
    /// Nothing has been seen; `signals` is how many the plant has.
    pub fn new(modes: &Modes, signals: usize) -> Self {
        let mut is_mode = vec![false; signals];
        for mode in modes.all() {
            is_mode[mode.bit] = true;
        }
        let pausing = modes.manual.iter().chain(&modes.alarm);
        Self {
            is_mode,
            // What nobody has seen says nothing.
            pausing: pausing.map(|mode| (*mode, false)).collect(),
            paused: false,
            last: vec![None; signals],
        }
    }

    /// Takes a row and says what it means.
    #[inline]
    pub fn take(&mut self, signal: SignalIndex, value: i64) -> Meaning {
        let signal = signal as usize;
        match self.is_mode.get(signal) {
            Some(true) => return self.mode(signal, value),
            Some(false) => self.last[signal] = Some(value),
            None => {}
        }
        if self.paused { Meaning::Nothing } else { Meaning::Own }
    }

    #[cold]
    fn mode(&mut self, signal: usize, value: i64) -> Meaning {
        for (mode, says) in self.pausing.iter_mut().filter(|(mode, _)| mode.bit == signal) {
            *says = (value != 0) == mode.active;
        }
        let paused = self.pausing.iter().any(|(_, says)| *says);
        match (std::mem::replace(&mut self.paused, paused), paused) {
            (false, true) => Meaning::PauseBegins,
            (true, false) => Meaning::PauseEnds,
            _ => Meaning::Nothing,
        }
    }

    /// Whether a signal is one of the plant's.
    pub fn knows(&self, signal: SignalIndex) -> bool {
        (signal as usize) < self.last.len()
    }

    /// True while the machine is moved by hand, or stands with an alarm.
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// How all signals stand that have been seen, but for the mode bits.
    pub fn image(&self, time: Nanoseconds) -> impl Iterator<Item = Row> + '_ {
        (0..)
            .zip(&self.last)
            .filter_map(move |(signal, value)| value.map(|value| Row { time, signal, value }))
    }

    /// A log as the signal-state models learn it: without mode bits, each pause a gap.
    /// `signals` says which of the plant's each signal of the log is.
    pub fn by_itself(mut self, log: &ChangeLog, signals: &[SignalIndex]) -> ChangeLog {
        let own_of: std::collections::HashMap<SignalIndex, SignalIndex> =
            signals.iter().copied().zip(0..).collect();
        let mut left = ChangeLog {
            signals: log.signals.clone(),
            scan_interval: log.scan_interval,
            gaps: log.gaps.clone(),
            ..ChangeLog::default()
        };
        let mut since = 0;
        for ((&time, &signal), &value) in log.time.iter().zip(&log.signal).zip(&log.value) {
            match self.take(signals[signal as usize], value) {
                Meaning::Own => {
                    left.time.push(time);
                    left.signal.push(signal);
                    left.value.push(value);
                }
                Meaning::Nothing => {}
                Meaning::PauseBegins => since = time,
                Meaning::PauseEnds => {
                    left.gaps.push(Gap { start: since, end: time });
                    for row in self.image(time) {
                        left.time.push(time);
                        left.signal.push(own_of[&row.signal]);
                        left.value.push(row.value);
                    }
                }
            }
        }
        left.gaps.sort_by_key(|gap| (gap.end, gap.start));
        left
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ON: bool = true;

    fn aside() -> Aside {
        let bit = |bit| ModeBit { bit, active: ON };
        let modes = Modes {
            work_complete: bit(1),
            manual: vec![bit(2)],
            alarm: vec![ModeBit { bit: 3, active: false }],
            setup: None,
        };
        Aside::new(&modes, 5)
    }

    #[test]
    fn mode_bits_are_nothing_and_pauses_are_told() {
        let mut aside = aside();
        assert_eq!(aside.take(0, 1), Meaning::Own);
        assert_eq!(aside.take(1, 1), Meaning::Nothing);
        assert_eq!(aside.take(2, 1), Meaning::PauseBegins);
        assert_eq!(aside.take(0, 0), Meaning::Nothing);
        assert_eq!(aside.take(3, 0), Meaning::Nothing);
        assert_eq!(aside.take(2, 0), Meaning::Nothing);
        assert!(aside.is_paused());
        assert_eq!(aside.take(3, 1), Meaning::PauseEnds);
        assert_eq!(aside.take(9, 1), Meaning::Own);
        let stands: Vec<Row> = aside.image(7).collect();
        assert_eq!(stands, [Row { time: 7, signal: 0, value: 0 }]);
    }

    #[test]
    fn a_pause_becomes_a_gap() {
        let log = ChangeLog {
            signals: ["a", "work", "manual", "alarm", "b"].map(str::to_owned).to_vec(),
            time: vec![1, 2, 3, 4, 5, 6],
            signal: vec![0, 2, 4, 0, 2, 0],
            value: vec![1, 1, 1, 0, 0, 1],
            ..ChangeLog::default()
        };
        let left = aside().by_itself(&log, &[0, 1, 2, 3, 4]);
        assert_eq!(left.gaps, [Gap { start: 2, end: 5 }]);
        assert_eq!(left.time, [1, 5, 5, 6]);
        assert_eq!(left.signal, [0, 0, 4, 0]);
        assert_eq!(left.value, [1, 0, 1, 1]);
    }
}
