//! The monitor from outside: any batch split and any checkpoint give the same findings; gaps
//! resynchronise; stalls are told at the time they fall due.

#![allow(clippy::expect_used, reason = "a test that cannot go on says why")]

use std::sync::Arc;

use proptest::prelude::*;

use runglight_engine::finding::{Finding, Kind, Severity, State};
use runglight_engine::log::{ChangeLog, ChangeLogBuilder, SECOND};
use runglight_engine::signal_state::events::Row;
use runglight_engine::signal_state::learn::learn;
use runglight_engine::signal_state::model::NominalModel;
use runglight_engine::signal_state::monitor::{Columns, Monitor, MonitorError};
use runglight_engine::signal_state::parameters::{Parameters, Timing};
use runglight_engine::symbols::SymbolTable;

const MS: i64 = 1_000_000;
const SIGNALS: [&str; 6] = ["G-A-X", "G-A-Y", "G-B-X", "G-B-STEP", "H-C-X", "H-C-Y"];

fn log_of(rows: &[(i64, usize, i64)]) -> ChangeLog {
    let mut builder = ChangeLogBuilder::default();
    for name in SIGNALS {
        builder.intern(name);
    }
    for &(time, signal, value) in rows {
        builder.push(time, signal as u32, value);
    }
    builder.finish()
}

fn rows_of(log: &ChangeLog) -> Vec<Row> {
    (0..log.len())
        .map(|i| Row { time: log.time[i], signal: log.signal[i], value: log.value[i] })
        .collect()
}

/// A device that goes X on, Y on, X off, Y off, `period` ms a step.
fn steady(cycles: i64, period: i64) -> ChangeLog {
    let mut rows = Vec::new();
    for cycle in 0..cycles {
        for (step, (signal, value)) in [(0, 1), (1, 1), (0, 0), (1, 0)].into_iter().enumerate() {
            let jitter = (cycle * 7 + step as i64 * 3) % 5;
            rows.push(((1 + cycle * 4 + step as i64) * period * MS + jitter * MS, signal, value));
        }
    }
    log_of(&rows)
}

fn model_of(logs: &[ChangeLog], parameters: &Parameters) -> Arc<NominalModel> {
    Arc::new(learn(logs, &SymbolTable::default(), parameters).expect("the log has events"))
}

fn random_log(events: usize) -> impl Strategy<Value = ChangeLog> {
    prop::collection::vec((0i64..4000, 0usize..SIGNALS.len(), 0i64..3), events).prop_map(|steps| {
        let mut time = 0;
        let rows: Vec<_> = steps
            .into_iter()
            .map(|(step, signal, value)| {
                // Often the same time, sometimes a long pause.
                time += if step < 1000 {
                    0
                } else if step > 3990 {
                    400 * SECOND
                } else {
                    step * MS
                };
                let value = if signal == 3 { value * 5 } else { value.min(1) };
                (time, signal, value)
            })
            .collect();
        log_of(&rows)
    })
}

/// Parameters that report nearly everything.
fn touchy(plat: bool, scan_ms: Option<u32>) -> Parameters {
    Parameters {
        timing: if plat { Timing::Plat } else { Timing::Adaptive },
        check_every: 2,
        false_alarms_per_day: 1e6,
        scan_interval_s: scan_ms.map(|ms| f64::from(ms) / 1000.0),
        ..Parameters::default()
    }
}

/// The model of a log; none where it has no events.
fn model_if_any(nominal: ChangeLog, parameters: &Parameters) -> Option<Arc<NominalModel>> {
    learn(&[nominal], &SymbolTable::default(), parameters).ok().map(Arc::new)
}

fn watch_whole(model: &Arc<NominalModel>, rows: &[Row]) -> Vec<Finding> {
    let mut monitor = Monitor::new(Arc::clone(model));
    let mut findings = monitor.observe(rows).expect("rows in order");
    findings.extend(monitor.finish());
    findings
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn any_split_and_any_checkpoint_give_the_same_findings(
        nominal in random_log(150),
        watched in random_log(200),
        cuts in prop::collection::vec(0usize..=200, 0..8),
        plat in any::<bool>(),
        scan_ms in prop::option::of(1u32..2500),
    ) {
        let Some(model) = model_if_any(nominal, &touchy(plat, scan_ms)) else { return Ok(()) };
        let rows = rows_of(&watched);
        let whole = watch_whole(&model, &rows);
        let mut cuts = cuts;
        cuts.extend([0, rows.len()]);
        cuts.sort_unstable();
        let mut monitor = Monitor::new(Arc::clone(&model));
        let mut split = Vec::new();
        for pair in cuts.windows(2) {
            split.extend(monitor.observe(&rows[pair[0]..pair[1]]).expect("rows in order"));
            monitor = Monitor::restore(Arc::clone(&model), &monitor.save()).expect("own state");
        }
        split.extend(monitor.finish());
        prop_assert_eq!(whole, split);
    }

    #[test]
    fn columns_come_to_the_same_as_rows(
        nominal in random_log(150),
        watched in random_log(400),
        cut in 0usize..=400,
        unknown in 0u32..6,
        plat in any::<bool>(),
        scan_ms in prop::option::of(1u32..2500),
    ) {
        let Some(model) = model_if_any(nominal, &touchy(plat, scan_ms)) else { return Ok(()) };
        // Keys run the other way round, and one stands for a signal that nobody learned.
        let mut monitor = Monitor::new(Arc::clone(&model));
        let numbers: Vec<u32> = (0..6)
            .rev()
            .map(|signal| {
                let symbol = if signal == unknown { "Z-Z-Z" } else { SIGNALS[signal as usize] };
                monitor.signal_index(symbol, model.symbols().find(&model.plant, symbol))
            })
            .collect();
        let keys = monitor.keys(numbers.clone());
        let key: Vec<u32> = watched.signal.iter().map(|signal| 5 - signal).collect();
        let rows: Vec<Row> = (0..watched.len())
            .map(|i| Row {
                time: watched.time[i],
                signal: numbers[key[i] as usize],
                value: watched.value[i],
            })
            .collect();
        let mut by_rows = monitor.clone();
        by_rows.take_rows(&rows).expect("rows in order");
        for range in [0..cut, cut..watched.len()] {
            let (time, value) = (&watched.time[range.clone()], &watched.value[range.clone()]);
            let columns = Columns::new(time, &key[range], value, &keys);
            monitor.take_columns(columns).expect("rows in order");
        }
        prop_assert_eq!(by_rows.finish(), monitor.finish());
        if monitor.now() > Some(watched.time[0]) {
            let early = Columns::new(&watched.time[..1], &key[..1], &watched.value[..1], &keys);
            let refused = monitor.take_columns(early);
            prop_assert!(matches!(refused, Err(MonitorError::Order { row: 1, .. })), "{refused:?}");
        }
    }

    #[test]
    fn saying_how_late_it_is_changes_nothing(
        nominal in random_log(150),
        watched in random_log(200),
        hurry in prop::collection::vec(0i64..=1000, 200),
        scan_ms in prop::option::of(1u32..2500),
        stall_after_s in prop::sample::select(vec![0.5, 3.0, 180.0]),
    ) {
        let parameters =
            Parameters { stall_after_s, return_within_s: 5.0, ..touchy(false, scan_ms) };
        let Some(model) = model_if_any(nominal, &parameters) else { return Ok(()) };
        let rows = rows_of(&watched);
        let whole = watch_whole(&model, &rows);
        let mut monitor = Monitor::new(Arc::clone(&model));
        let mut live = Vec::new();
        for (index, row) in rows.iter().enumerate() {
            live.extend(monitor.observe(&[*row]).expect("rows in order"));
            // Somewhere on the way to the next row, its own time included.
            if let Some(next) = rows.get(index + 1).filter(|next| next.time > row.time) {
                let way = (next.time - row.time) as i128 * i128::from(hurry[index]) / 1000;
                live.extend(monitor.advance(row.time + way as i64));
            }
        }
        live.extend(monitor.finish());
        prop_assert_eq!(whole, live);
    }

    #[test]
    fn damaged_state_is_refused(at in 0usize..10_000, flip in 1u8..=255) {
        let model = model_of(&[steady(20, 500)], &Parameters::default());
        let mut monitor = Monitor::new(Arc::clone(&model));
        monitor.observe(&rows_of(&steady(3, 500))).expect("rows in order");
        let mut bytes = monitor.save();
        let at = at % bytes.len();
        bytes[at] ^= flip;
        prop_assert_eq!(Monitor::restore(model, &bytes).err(), Some(MonitorError::Damaged));
    }

    #[test]
    fn what_was_learned_is_no_alarm(nominal in random_log(300)) {
        let Ok(model) = learn(std::slice::from_ref(&nominal), &SymbolTable::default(), &Parameters::default()) else {
            return Ok(());
        };
        let findings = watch_whole(&Arc::new(model), &rows_of(&nominal));
        prop_assert!(findings.iter().all(|f| f.kind == Kind::Stall || f.severity == Severity::Notice
            || matches!(f.kind, Kind::TransitionProbability | Kind::TimeProbability | Kind::AverageTime)),
            "{:?}", findings);
    }
}

#[test]
fn a_state_of_another_model_is_refused() {
    let (one, other) = (steady(20, 500), steady(30, 700));
    let parameters = Parameters::default();
    let state = Monitor::new(model_of(&[one], &parameters)).save();
    let error = Monitor::restore(model_of(&[other], &parameters), &state).err();
    assert_eq!(error, Some(MonitorError::OtherModel));
}

#[test]
fn rows_out_of_order_are_refused_whole() {
    let mut monitor = Monitor::new(model_of(&[steady(20, 500)], &Parameters::default()));
    let rows = [Row { time: 5, signal: 0, value: 1 }, Row { time: 4, signal: 1, value: 1 }];
    assert!(matches!(monitor.observe(&rows), Err(MonitorError::Order { row: 2, .. })));
    assert_eq!(monitor.observe(&[Row { time: 4, signal: 0, value: 1 }]), Ok(Vec::new()));
}

#[test]
fn a_gap_is_a_gap_and_never_a_fault() {
    let model = model_of(&[steady(50, 500)], &Parameters::default());
    let rows = rows_of(&steady(20, 500));
    let mut monitor = Monitor::new(model);
    let mut findings = monitor.observe(&rows[..41]).expect("rows in order");
    // An hour later the device stands elsewhere: events 41 and 42 were never seen.
    let hour = 3600 * SECOND;
    findings.extend(monitor.gap(rows[40].time, rows[43].time + hour));
    let later: Vec<Row> =
        rows[43..].iter().map(|row| Row { time: row.time + hour, ..*row }).collect();
    findings.extend(monitor.observe(&later).expect("rows in order"));
    findings.extend(monitor.finish());
    let kinds: Vec<Kind> = findings.iter().map(|f| f.kind).collect();
    assert_eq!(kinds, [Kind::Gap]);
}

#[test]
fn a_stop_is_told_when_it_falls_due_and_when_it_ends() {
    let model = model_of(&[steady(50, 500)], &Parameters::default());
    let rows = rows_of(&steady(10, 500));
    let mut monitor = Monitor::new(model);
    assert_eq!(monitor.observe(&rows), Ok(Vec::new()));
    let last = rows[39].time;
    assert_eq!(monitor.advance(last + 179 * SECOND), Vec::new());
    let stall = monitor.advance(last + 181 * SECOND);
    assert_eq!(stall.len(), 1);
    assert_eq!((stall[0].kind, stall[0].time), (Kind::Stall, last + 180 * SECOND));
    assert_eq!(stall[0].from.as_deref(), Some("G-A-Y_OFF"));
    assert_eq!(monitor.advance(last + 500 * SECOND), Vec::new());
    monitor.observe(&[Row { time: last + 600 * SECOND, signal: 0, value: 1 }]).expect("in order");
    let back = monitor.finish();
    assert_eq!((back[0].kind, back[0].state), (Kind::Stall, State::Returned));
    assert_eq!(back[0].id, stall[0].id);
}

#[test]
fn an_image_is_no_event() {
    let model = model_of(&[steady(50, 500)], &Parameters::default());
    let rows = rows_of(&steady(20, 500));
    let mut monitor = Monitor::new(model);
    // Outputs are read a little after inputs, and may all be on.
    let image = [Row { time: 0, signal: 0, value: 1 }, Row { time: MS, signal: 1, value: 1 }];
    assert_eq!(monitor.image(&image), Ok(Vec::new()));
    assert_eq!(monitor.now(), Some(MS));
    // Y goes off after X: with X's step seen as an event, the image would be a fault by now.
    assert_eq!(monitor.observe(&rows[2..]), Ok(Vec::new()));
    let old = [Row { time: 0, signal: 0, value: 1 }];
    assert!(matches!(monitor.image(&old), Err(MonitorError::Order { row: 1, .. })));
    let unknown = monitor.image(&[Row { time: 60 * SECOND, signal: 6, value: 1 }]);
    assert_eq!(unknown, Ok(Vec::new()));
}

#[test]
fn a_machine_that_stopped_in_a_gap_is_told_once() {
    let model = model_of(&[steady(50, 500)], &Parameters::default());
    let rows = rows_of(&steady(10, 500));
    let still = |time| [Row { time, signal: 0, value: 0 }, Row { time, signal: 1, value: 0 }];
    let mut monitor = Monitor::new(model);
    monitor.observe(&rows).expect("in order");
    let (start, end) = (rows[39].time, rows[39].time + 1000 * SECOND);
    assert_eq!(monitor.gap(start, end).len(), 1);
    monitor.image(&still(end)).expect("in order");
    // The time of the gap does not count.
    assert_eq!(monitor.advance(end + 179 * SECOND), Vec::new());
    let told = monitor.advance(end + 181 * SECOND);
    assert_eq!(told.iter().map(|f| f.kind).collect::<Vec<_>>(), [Kind::Stall]);
    assert_eq!(monitor.gap(end + 182 * SECOND, end + 183 * SECOND).len(), 1);
    monitor.observe(&still(end + 183 * SECOND)).expect("in order");
    assert_eq!(monitor.advance(end + 900 * SECOND), Vec::new());
}

#[test]
fn events_of_one_scan_have_no_order() {
    // X and Y switch in one scan; the log writes them in either order.
    let rows: Vec<(i64, usize, i64)> = (0..40i64)
        .flat_map(|i| {
            let value = (i + 1) % 2;
            [((i + 1) * SECOND, 0, value), ((i + 1) * SECOND, 1, value)]
        })
        .collect();
    let turned: Vec<_> = rows.chunks(2).flat_map(|pair| [pair[1], pair[0]]).collect();
    let model = model_of(&[log_of(&rows)], &Parameters::default());
    assert_eq!(watch_whole(&model, &rows_of(&log_of(&turned))), Vec::new());
}

#[test]
fn a_path_that_returns_can_be_confirmed_and_is_known_then() {
    let model = model_of(&[steady(50, 500)], &Parameters::default());
    // X blinks once where Y_ON is awaited.
    let mut rows = rows_of(&steady(20, 500));
    let at = rows[40].time;
    rows.insert(41, Row { time: at + 10 * MS, signal: 0, value: 0 });
    rows.insert(42, Row { time: at + 20 * MS, signal: 0, value: 1 });
    let findings = watch_whole(&model, &rows);
    let offered = findings.iter().find(|f| f.kind == Kind::AlarmPath).expect("the path is offered");
    assert_eq!(offered.path, ["G-A-X_ON", "G-A-X_OFF", "G-A-X_ON"]);
    let first = &findings[0];
    assert_eq!(
        (first.kind, first.severity, first.state),
        (Kind::Transition, Severity::Fault, State::Suspected)
    );
    assert!(first.snapshot_id.is_some());
    let (model, new) = model.confirm(offered).expect("a path of this plant");
    assert_eq!(new, 2);
    let model = Arc::new(model);
    let left: Vec<Kind> = watch_whole(&model, &rows).iter().map(|f| f.kind).collect();
    assert!(!left.contains(&Kind::Transition), "{left:?}");
    assert_eq!(model.confirm(offered).map(|(_, new)| new), Ok(0));
}

#[test]
fn a_signal_nobody_learned_is_named_once() {
    let model = model_of(&[steady(20, 500)], &Parameters::default());
    let mut monitor = Monitor::new(model);
    let unknown = monitor.signal_index("G-Z-NEW", None);
    let rows: Vec<Row> =
        (0..4).map(|i| Row { time: i * SECOND, signal: unknown, value: i % 2 }).collect();
    let mut findings = monitor.observe(&rows).expect("rows in order");
    findings.extend(monitor.finish());
    assert_eq!(findings.len(), 1);
    assert_eq!((findings[0].kind, findings[0].severity), (Kind::UnknownSignal, Severity::Notice));
}
