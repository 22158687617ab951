//! From logs to happenings: all events of all logs, in order.

use serde::{Deserialize, Serialize};

use crate::log::{ChangeLog, Nanoseconds, SignalIndex};
use crate::plant::Plant;
use crate::signal_state::enabling::Happening;
use crate::signal_state::events::{Meaning, Row, Values, is_image};
use crate::signal_state::order::ScanOrder;
use crate::signal_state::states::States;

/// Symbols of all logs in the order they are first named.
pub(super) fn all_symbols(logs: &[&ChangeLog]) -> Vec<String> {
    let mut seen = std::collections::HashSet::new();
    logs.iter()
        .flat_map(|log| &log.signals)
        .filter(|symbol| seen.insert(symbol.as_str()))
        .cloned()
        .collect()
}

/// A signal that ever holds a value other than 0 and 1 is a word.
pub(super) fn mark_words(plant: &mut Plant, logs: &[&ChangeLog]) {
    for log in logs {
        let to_plant = indices(log, plant);
        for (&signal, &value) in log.signal.iter().zip(&log.value) {
            if value & !1 != 0 {
                plant.signals[to_plant[signal as usize] as usize].word = true;
            }
        }
    }
}

/// The plant's index of each of a log's signals.
fn indices(log: &ChangeLog, plant: &Plant) -> Vec<SignalIndex> {
    let by_symbol: std::collections::HashMap<&str, SignalIndex> =
        plant.signals.iter().zip(0..).map(|(s, index)| (s.symbol.as_str(), index)).collect();
    log.signals.iter().map(|symbol| by_symbol.get(symbol.as_str()).copied().unwrap_or(0)).collect()
}

/// Where rows begin that have no predecessor: those of a log, and those after a gap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Run {
    /// Time of the plant's first row.
    pub(super) begins: Nanoseconds,
    /// Rows of that time are an image of the plant, and no events.
    pub(super) image: bool,
}

/// The runs of a log in time order.
pub(super) fn runs(log: &ChangeLog) -> Vec<Run> {
    let first = log.time.first().map(|&begins| Run { begins, image: is_image(first_values(log)) });
    let after_gaps = log.gaps.iter().filter_map(|gap| {
        let row = log.time.partition_point(|&time| time < gap.end);
        Some(Run { begins: *log.time.get(row)?, image: true })
    });
    first.into_iter().chain(after_gaps).collect()
}

/// Events of logs, in order.
#[derive(Default)]
pub(super) struct Events {
    pub(super) happenings: Vec<Happening>,
    /// By happening: its row; empty where scans are brought into canonical order.
    pub(super) rows: Vec<u32>,
}

/// All events of all logs and their runs, scans in canonical order where `order` is given.
pub(super) fn read_events<'a>(
    logs: impl Iterator<Item = (&'a ChangeLog, &'a [Run])> + Clone,
    plant: &Plant,
    states: &mut States,
    order: Option<&ScanOrder>,
) -> Events {
    let mut events = Events {
        happenings: Vec::with_capacity(logs.clone().map(|(log, _)| log.len()).sum()),
        rows: Vec::new(),
    };
    let mut run = 0;
    for (log, runs) in logs {
        let to_plant = indices(log, plant);
        let mut values = Values::new(plant.signals.len());
        let mut runs = runs.iter().peekable();
        let mut seen = false;
        let mut start = 0;
        let mut scan: Vec<Row> = Vec::new();
        while start < log.len() {
            let time = log.time[start];
            let end = start + log.time[start..].iter().take_while(|&&t| t == time).count();
            scan.clear();
            scan.extend((start..end).map(|row| Row {
                time,
                signal: to_plant[log.signal[row] as usize],
                value: log.value[row],
            }));
            let mut image = false;
            while let Some(begun) = runs.next_if(|run| run.begins <= time) {
                run += 1;
                image = begun.image && begun.begins == time;
                if std::mem::replace(&mut seen, true) {
                    values.doubt();
                }
            }
            if let Some(order) = order {
                order.sort(&mut scan);
            }
            for (row, at) in scan.iter().zip(start as u32..) {
                let meaning = values.take(row.signal, row.value);
                if meaning == Meaning::Sample || image {
                    continue;
                }
                let state = states.intern(row.signal, row.value);
                let doubtful = meaning == Meaning::Doubtful;
                let happening = Happening { time, signal: row.signal, state, run, doubtful };
                events.happenings.push(happening);
                if order.is_none() {
                    events.rows.push(at);
                }
            }
            start = end;
        }
    }
    events
}

fn first_values(log: &ChangeLog) -> impl Iterator<Item = i64> + '_ {
    let first = log.time.first().copied();
    log.time
        .iter()
        .zip(&log.value)
        .take_while(move |(time, _)| Some(**time) == first)
        .map(|(_, value)| *value)
}
