//! The tank of Theis 2019 under its counting program: whether the tank is filled once more or
//! emptied is told by nothing but how often it was filled before.

use runglight_engine::log::{Nanoseconds, SECOND};
use runglight_engine::plant::SignalClass;
use runglight_engine::process::baseline::Markov;
use runglight_engine::process::event_log::{Activity, EventLog};
use runglight_engine::process::lesson::{Foretold, foretell};
use runglight_engine::process::petri::{PetriNet, Transition};
use runglight_engine::process::succession::Succession;
use runglight_neural::learn::learn;
use runglight_neural::training::{Settings, TrainingError};

const EMPTY: u32 = 0;
const FILL: u32 = 1;
const ABOVE_LOW: u32 = 2;
const ABOVE_MIDDLE: u32 = 3;
const FULL: u32 = 4;
const DRAIN: u32 = 5;
const BELOW_FULL: u32 = 6;
const BELOW_MIDDLE: u32 = 7;

const NAMES: [&str; 8] = [
    "%IX0.1=0",
    "%QX0.0=1 & %QX0.1=0",
    "%IX0.1=1",
    "%IX0.2=1",
    "%IX0.0=1",
    "%QX0.0=0 & %QX0.1=1",
    "%IX0.0=0",
    "%IX0.2=0",
];

/// Fills at 9 gallons a second: 80 gallons the first time, 40 between middle and full.
fn tank(traces: usize, fillings: usize) -> EventLog {
    let activities = NAMES
        .iter()
        .map(|&name| Activity {
            name: name.to_owned(),
            class: Some(if name.starts_with("%I") {
                SignalClass::Input
            } else {
                SignalClass::Output
            }),
            changes: Vec::new(),
        })
        .collect();
    let mut log = EventLog { activities, bounds: vec![0], ..EventLog::default() };
    let mut now: Nanoseconds = 0;
    let mut event = |log: &mut EventLog, activity: u32, gallons: i64| {
        now += gallons * SECOND / 9;
        log.activity.push(activity);
        log.time.push(now);
    };
    for trace in 0..traces {
        event(&mut log, EMPTY, 40);
        event(&mut log, FILL, 1);
        event(&mut log, ABOVE_LOW, 1);
        for filling in 0..fillings {
            if filling > 0 {
                event(&mut log, FILL, 1);
            }
            event(&mut log, ABOVE_MIDDLE, if filling == 0 { 40 } else { 1 });
            event(&mut log, FULL, 40);
            event(&mut log, DRAIN, 1);
            event(&mut log, BELOW_FULL, 1);
            event(&mut log, BELOW_MIDDLE, 40);
        }
        log.bounds.push(log.activity.len());
        log.names.push(trace.to_string());
    }
    log
}

/// What a miner finds: a run opens, and then fills and drains any number of times.
fn net(log: &EventLog) -> PetriNet {
    let arcs: [(Option<u32>, u32, u32); 11] = [
        (Some(EMPTY), 0, 1),
        (None, 1, 2),
        (Some(FILL), 2, 3),
        (Some(ABOVE_LOW), 3, 4),
        (None, 3, 4),
        (Some(ABOVE_MIDDLE), 4, 5),
        (Some(FULL), 5, 6),
        (Some(DRAIN), 6, 7),
        (Some(BELOW_FULL), 7, 8),
        (Some(BELOW_MIDDLE), 8, 9),
        (None, 9, 2),
    ];
    let transitions = arcs.iter().enumerate().map(|(index, &(label, from, to))| {
        let activity = label.map(|label| &log.activities[label as usize]);
        Transition {
            id: format!("t{index}"),
            label: activity.map(|a| a.name.clone()),
            class: activity.and_then(|a| a.class),
            inputs: vec![from],
            outputs: vec![to],
        }
    });
    let mut initial = vec![0; 10];
    let mut last = vec![0; 10];
    (initial[0], last[9]) = (1, 1);
    PetriNet {
        name: "tank".to_owned(),
        places: (0..10).map(|place| format!("p{place}")).collect(),
        transitions: transitions.collect(),
        initial,
        last,
    }
}

const TRAIN: std::ops::Range<usize> = 0..17;
const TEST: std::ops::Range<usize> = 17..22;

/// Trains on 17 traces and foretells the other 5.
fn study(settings: &Settings) -> Result<Vec<Foretold>, TrainingError> {
    let log = tank(22, 3);
    let net = net(&log);
    let (train, test): (Vec<usize>, Vec<usize>) = (TRAIN.collect(), TEST.collect());
    let succession = Succession::of(&log);
    let mut next = learn(&net, &log, &train, succession, settings, |_| true)?;
    Ok(foretell(&mut next, &net, &log, &test, succession))
}

fn accuracy(foretold: &[Foretold]) -> f64 {
    foretold.iter().filter(|event| event.right).count() as f64 / foretold.len() as f64
}

#[test]
#[ignore = "prints numbers"]
fn numbers() -> Result<(), TrainingError> {
    let log = tank(22, 3);
    let (train, test): (Vec<usize>, Vec<usize>) = (TRAIN.collect(), TEST.collect());
    for order in 0..4 {
        let markov = Markov::fit(&log, &train, order, Succession::of(&log));
        eprintln!("markov {order} {:?}", markov.score(&log, &test, Succession::of(&log)));
    }
    for (batch, epochs, rate) in [
        (64, 5, 1e-3),
        (1, 5, 1e-3),
        (4, 5, 1e-3),
        (8, 5, 1e-3),
        (64, 5, 1e-2),
        (64, 50, 1e-3),
        (64, 100, 1e-3),
        (64, 200, 1e-3),
    ] {
        let mut all = Vec::new();
        for seed in 0..10 {
            let settings =
                Settings { seed, batch, epochs, learning_rate: rate, ..Settings::default() };
            all.push((accuracy(&study(&settings)?) * 1000.0).round() / 10.0);
        }
        eprintln!("batch {batch} epochs {epochs} rate {rate}: {all:?}");
    }
    Ok(())
}
