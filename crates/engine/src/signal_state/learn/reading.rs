//! From logs to happenings: all events of all logs, each group's in order.

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

/// The plant's number of each of a log's signals.
pub(super) fn numbers(log: &ChangeLog, plant: &Plant) -> Vec<SignalIndex> {
    let by_symbol: std::collections::HashMap<&str, SignalIndex> =
        plant.signals.iter().zip(0..).map(|(s, index)| (s.symbol(), index)).collect();
    log.signals.iter().map(|symbol| by_symbol.get(symbol.as_str()).copied().unwrap_or(0)).collect()
}

/// Values looked at together for one beyond 0 and 1.
const VALUES_AT_ONCE: usize = 1024;

/// A signal that ever holds a value other than 0 and 1 is a word.
pub(super) fn mark_words(plant: &mut Plant, source: &Source<'_>) {
    let Source { log, numbers, .. } = *source;
    let signals = log.signal.chunks(VALUES_AT_ONCE);
    for (signals, values) in signals.zip(log.value.chunks(VALUES_AT_ONCE)) {
        if values.iter().fold(0, |all, value| all | value) & !1 == 0 {
            continue;
        }
        for (&signal, &value) in signals.iter().zip(values) {
            if value & !1 != 0 {
                plant.signals[numbers[signal as usize] as usize].word = true;
            }
        }
    }
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

/// A log, its runs, and the plant's number of each of its signals.
pub(super) struct Source<'a> {
    pub(super) log: &'a ChangeLog,
    pub(super) runs: &'a [Run],
    pub(super) numbers: &'a [SignalIndex],
}

/// The events of one group, in order.
#[derive(Default)]
pub(super) struct GroupEvents {
    pub(super) happenings: Vec<Happening>,
    /// By happening: its place among those of the whole plant.
    pub(super) order: Vec<u32>,
}

/// Events of logs.
#[derive(Default)]
pub(super) struct Events {
    pub(super) groups: Vec<GroupEvents>,
    pub(super) number: u32,
    /// By event in the order of the plant: its row; empty where scans are brought into canonical
    /// order.
    pub(super) rows: Vec<u32>,
    /// By state: how often it was entered.
    pub(super) entries: Vec<u32>,
    /// By device: the signal of its first event.
    pub(super) first: Vec<Option<SignalIndex>>,
}

/// All events of all logs and their runs, scans in canonical order where `order` is given.
pub(super) fn read_events(
    sources: &[Source<'_>],
    plant: &Plant,
    states: &mut States,
    order: Option<&ScanOrder>,
) -> Events {
    let mut reader = Reader::new(sources, plant, states, order);
    for source in sources {
        reader.read(source);
    }
    reader.events
}

struct Reader<'a> {
    states: &'a mut States,
    order: Option<&'a ScanOrder>,
    /// By signal: its device and its group.
    places: Vec<(u32, u32)>,
    events: Events,
    run: u32,
    /// When the last event happened.
    newest: Nanoseconds,
}

impl<'a> Reader<'a> {
    fn new(
        sources: &[Source<'_>],
        plant: &Plant,
        states: &'a mut States,
        order: Option<&'a ScanOrder>,
    ) -> Self {
        let place = |device: usize| (device as u32, plant.devices[device].group as u32);
        let places: Vec<_> = plant.signals.iter().map(|signal| place(signal.device())).collect();
        let mut rows = vec![0usize; plant.groups.len()];
        for source in sources {
            let mut of_signal = vec![0usize; source.numbers.len()];
            for &signal in &source.log.signal {
                of_signal[signal as usize] += 1;
            }
            for (&signal, of_signal) in source.numbers.iter().zip(of_signal) {
                rows[places[signal as usize].1 as usize] += of_signal;
            }
        }
        let group = |rows| GroupEvents {
            happenings: Vec::with_capacity(rows),
            order: Vec::with_capacity(rows),
        };
        let events = Events {
            groups: rows.into_iter().map(group).collect(),
            entries: vec![0; states.len()],
            first: vec![None; plant.devices.len()],
            ..Events::default()
        };
        Self { states, order, places, events, run: 0, newest: Nanoseconds::MIN }
    }

    fn read(&mut self, source: &Source<'_>) {
        let Source { log, runs, numbers } = *source;
        let (times, signals, log_values) = (&log.time, &log.signal, &log.value);
        // Times go up over all runs: a log that begins before the one before it ended is moved.
        let behind = self.newest.saturating_add(1);
        let shift = times.first().map_or(0, |&first| behind.saturating_sub(first).max(0));
        let mut values = Values::new(self.places.len());
        let mut runs = runs.iter().peekable();
        let mut seen = false;
        let mut start = 0;
        let mut scan: Vec<Row> = Vec::new();
        while start < log.len() {
            let time = times[start];
            let end = start + 1 + times[start + 1..].iter().take_while(|&&t| t == time).count();
            let mut image = false;
            while let Some(begun) = runs.next_if(|run| run.begins <= time) {
                self.run += 1;
                image = begun.image && begun.begins == time;
                if std::mem::replace(&mut seen, true) {
                    values.doubt();
                }
            }
            let row = |row: usize| Row {
                time: time.saturating_add(shift),
                signal: numbers[signals[row] as usize],
                value: log_values[row],
            };
            match self.order {
                Some(order) if end - start > 1 => {
                    scan.clear();
                    scan.extend((start..end).map(row));
                    order.sort(&mut scan);
                    for &row in &scan {
                        self.take(row, &mut values, image);
                    }
                }
                Some(_) => self.take(row(start), &mut values, image),
                None => {
                    for at in start..end {
                        let before = self.events.number;
                        self.take(row(at), &mut values, image);
                        if self.events.number != before {
                            self.events.rows.push(at as u32);
                        }
                    }
                }
            }
            start = end;
        }
    }

    /// Takes a row; one of an `image` of the plant is no event.
    #[inline(always)]
    fn take(&mut self, row: Row, values: &mut Values, image: bool) {
        let Row { time, signal, value } = row;
        let meaning = values.take(signal, value);
        if meaning == Meaning::Sample || image {
            return;
        }
        let state = self.states.intern(signal, value);
        let events = &mut self.events;
        if events.entries.len() <= state as usize {
            events.entries.resize(state as usize + 1, 0);
        }
        let (device, group) = self.places[signal as usize];
        let entries = &mut events.entries[state as usize];
        // The first event of a device is one that enters its state for the first time.
        if *entries == 0 {
            events.first[device as usize].get_or_insert(signal);
        }
        *entries += 1;
        let group = &mut events.groups[group as usize];
        let doubtful = meaning == Meaning::Doubtful;
        group.happenings.push(Happening::new(time, state, self.run, doubtful));
        group.order.push(events.number);
        events.number += 1;
        self.newest = time;
    }
}

fn first_values(log: &ChangeLog) -> impl Iterator<Item = i64> + '_ {
    let first = log.time.first().copied();
    log.time
        .iter()
        .zip(&log.value)
        .take_while(move |(time, _)| Some(**time) == first)
        .map(|(_, value)| *value)
}
