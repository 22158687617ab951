//! From logs to happenings: all events of all logs, in order.

use crate::log::{ChangeLog, SignalIndex};
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
        plant.signals.iter().zip(0..).map(|(s, index)| (s.symbol(), index)).collect();
    log.signals.iter().map(|symbol| by_symbol.get(symbol.as_str()).copied().unwrap_or(0)).collect()
}

/// All events of all logs, scans in canonical order where `order` is given.
pub(super) fn read_events(
    logs: &[&ChangeLog],
    plant: &Plant,
    states: &mut States,
    order: Option<&ScanOrder>,
) -> Vec<Happening> {
    let mut events = Vec::with_capacity(logs.iter().map(|log| log.len()).sum());
    let mut run = 0;
    for log in logs {
        let to_plant = indices(log, plant);
        let mut values = Values::new(plant.signals.len());
        let mut gaps = log.gaps.iter().peekable();
        run += 1;
        let mut resynchronise = is_image(first_values(log));
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
            start = end;
            while gaps.next_if(|gap| gap.end <= time).is_some() {
                run += 1;
                resynchronise = true;
                values.doubt();
            }
            if let Some(order) = order {
                order.sort(&mut scan);
            }
            for row in &scan {
                let meaning = values.take(row.signal, row.value);
                if meaning == Meaning::Sample || resynchronise {
                    continue;
                }
                let state = states.intern(row.signal, row.value);
                let doubtful = meaning == Meaning::Doubtful;
                events.push(Happening { time, signal: row.signal, state, run, doubtful });
            }
            resynchronise = false;
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
