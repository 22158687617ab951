//! Cause and effect in one scan: a program sets an output as it reads an input, and nothing says
//! which of the two is which.

#![allow(clippy::expect_used, reason = "a test that cannot go on says why")]

use std::sync::Arc;

use runglight_engine::finding::{Finding, Kind, Severity};
use runglight_engine::log::{ChangeLog, ChangeLogBuilder};
use runglight_engine::signal_state::chains::ChainKind;
use runglight_engine::signal_state::events::Row;
use runglight_engine::signal_state::learn::learn;
use runglight_engine::signal_state::model::NominalModel;
use runglight_engine::signal_state::monitor::Monitor;
use runglight_engine::signal_state::parameters::Parameters;
use runglight_engine::symbols::SymbolTable;

const MS: i64 = 1_000_000;
const CYCLES: i64 = 150;

/// A small repeatable source of numbers.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, below: i64) -> i64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % below as u64) as i64
    }
}

/// What is late in a cycle, in milliseconds.
#[derive(Clone, Copy, Default)]
struct Late {
    /// The first unit on its way down.
    unit: i64,
    /// The first tool, though its unit is down.
    tool: i64,
}

/// Two units start together, at random; each takes 0.8 s to go down. With the scan that reads so,
/// its tool starts; with the one that reads that the tool has stopped, it goes up again. Two lamps
/// are switched together by hand.
fn units(seed: u64, late: impl Fn(i64) -> Late) -> ChangeLog {
    let mut dice = Dice(seed);
    let mut rows: Vec<(i64, String, i64)> = Vec::new();
    let mut start = 1000;
    for cycle in 0..CYCLES {
        let mut end = start;
        for unit in 1..=2 {
            let late = if unit == 1 { late(cycle) } else { Late::default() };
            let mut row = |time: i64, signal: &str, value: i64| {
                rows.push((time / 10 * 10, format!("Line-{signal}"), value));
            };
            let (body, tool) = (format!("Unit{unit}"), format!("Unit{unit}Tool"));
            let down = start + 150 + dice.roll(10);
            row(down, &format!("{body}-DOWN"), 1);
            let is_down = down + 780 + dice.roll(40) + late.unit;
            row(is_down, &format!("{body}-IS_DOWN"), 1);
            row(is_down + late.tool, &format!("{tool}-ON"), 1);
            let ready = is_down + late.tool + 3000 * unit + dice.roll(100);
            row(ready, &format!("{tool}-READY"), 1);
            row(ready + 50, &format!("{tool}-ON"), 0);
            let stopped = ready + 340 + dice.roll(30);
            row(stopped, &format!("{tool}-READY"), 0);
            row(stopped, &format!("{body}-DOWN"), 0);
            row(stopped + 100, &format!("{body}-IS_DOWN"), 0);
            end = end.max(stopped + 100);
        }
        let lamps = end + 500 + dice.roll(4000);
        for lamp in ["Left", "Right"] {
            rows.push((lamps, format!("Line-{lamp}-LAMP"), 1 - cycle % 2));
        }
        start = lamps + 500 + dice.roll(15_000);
    }
    rows.sort_by_key(|row| row.0);
    let mut builder = ChangeLogBuilder::default();
    for (time, name, value) in rows {
        let signal = builder.intern(&name);
        builder.push(time * MS, signal, value);
    }
    builder.finish()
}

fn model_of(log: &ChangeLog) -> Arc<NominalModel> {
    let logs = std::slice::from_ref(log);
    let model = learn(logs, &SymbolTable::default(), &Parameters::default());
    Arc::new(model.expect("the log has events"))
}

fn learned() -> Arc<NominalModel> {
    model_of(&units(7, |_| Late::default()))
}

/// The rows of a log, as the model numbers their signals.
fn rows_of(model: &NominalModel, log: &ChangeLog) -> Vec<Row> {
    let number = |symbol: &String| {
        let known = model.plant.signals.iter().position(|signal| signal.symbol() == *symbol);
        known.expect("all signals were learned") as u32
    };
    let numbers: Vec<u32> = log.signals.iter().map(number).collect();
    let row = |at: usize| Row {
        time: log.time[at],
        signal: numbers[log.signal[at] as usize],
        value: log.value[at],
    };
    (0..log.len()).map(row).collect()
}

fn watch(model: &Arc<NominalModel>, rows: &[Row], batch: usize) -> Vec<Finding> {
    let mut monitor = Monitor::new(Arc::clone(model));
    let mut findings = Vec::new();
    for rows in rows.chunks(batch) {
        findings.extend(monitor.observe(rows).expect("rows in order"));
    }
    findings.extend(monitor.finish());
    findings
}

/// What alarms of delays say: the state that came late, and after how long.
fn delays(findings: &[Finding]) -> Vec<(&str, f64)> {
    let of_time = findings.iter().filter(|finding| {
        finding.severity != Severity::Notice && matches!(finding.kind, Kind::Late | Kind::Early)
    });
    of_time.map(|it| (it.to.as_deref().unwrap_or(""), it.observed_s.unwrap_or(-1.0))).collect()
}

/// By transition into it: what a state waits for, and the shortest time it takes.
fn triggers_of(model: &NominalModel, next: &str) -> Vec<(Vec<String>, f64)> {
    let rules = model.rules.iter().filter(|rule| {
        model.kind(rule.chain) == ChainKind::Device && model.state_name(rule.next) == next
    });
    let of = |trigger: &runglight_engine::signal_state::enabling::Trigger| {
        let least = trigger.clusters.iter().map(|cluster| cluster.minimum_s);
        let states = trigger.states().map(|state| model.state_name(state));
        (states.collect(), least.fold(f64::INFINITY, f64::min))
    };
    rules.filter_map(|rule| rule.trigger.as_deref()).map(of).collect()
}

#[test]
fn an_effect_waits_for_the_cause_in_its_own_scan() {
    let model = learned();
    for unit in 1..=2 {
        let cause = |name: &str| vec![(vec![format!("Line-Unit{unit}{name}")], 0.0)];
        assert_eq!(
            triggers_of(&model, &format!("Line-Unit{unit}Tool-ON_ON")),
            cause("-IS_DOWN_ON")
        );
        assert_eq!(
            triggers_of(&model, &format!("Line-Unit{unit}-DOWN_OFF")),
            cause("Tool-READY_OFF")
        );
        assert_eq!(triggers_of(&model, &format!("Line-Unit{unit}-IS_DOWN_ON")), Vec::new());
    }
}

#[test]
fn of_two_that_only_come_together_neither_is_the_cause() {
    let model = learned();
    for lamp in ["Left", "Right"] {
        for state in ["ON", "OFF"] {
            let triggers = triggers_of(&model, &format!("Line-{lamp}-LAMP_{state}"));
            assert!(triggers.iter().all(|(_, least)| *least > 0.0), "{triggers:?}");
        }
    }
}

#[test]
fn none_waits_for_one_that_waits_for_it_in_the_same_scan() {
    let model = learned();
    let at_once = |next: &str| -> Vec<String> {
        let triggers = triggers_of(&model, next).into_iter().filter(|(_, least)| *least <= 0.01);
        triggers.flat_map(|(states, _)| states).collect()
    };
    let mut followed = 0;
    for rule in &model.rules {
        let first = model.state_name(rule.next);
        let mut open = at_once(&first);
        while let Some(state) = open.pop() {
            followed += 1;
            assert_ne!(state, first);
            open.extend(at_once(&state));
        }
    }
    assert!(followed >= 4, "{followed}");
}

#[test]
fn a_late_cause_is_told_once() {
    let model = learned();
    let late = |cycle| Late { unit: if cycle % 50 == 20 { 1500 } else { 0 }, tool: 0 };
    let findings = watch(&model, &rows_of(&model, &units(8, late)), usize::MAX);
    let delays = delays(&findings);
    assert_eq!(delays.len(), 3, "{delays:?}");
    assert!(delays.iter().all(|(to, _)| *to == "Line-Unit1-IS_DOWN_ON"), "{delays:?}");
}

#[test]
fn an_effect_that_is_late_itself_is_told() {
    let model = learned();
    let late = |cycle| Late { unit: 0, tool: if cycle % 50 == 20 { 1500 } else { 0 } };
    let findings = watch(&model, &rows_of(&model, &units(8, late)), usize::MAX);
    assert_eq!(delays(&findings), [("Line-Unit1Tool-ON_ON", 1.5); 3]);
}

#[test]
fn batches_and_the_order_inside_a_scan_are_all_one() {
    let model = learned();
    let late = |cycle| Late {
        unit: if cycle % 10 == 3 { 1500 } else { 0 },
        tool: if cycle % 10 == 7 { 1500 } else { 0 },
    };
    let rows = rows_of(&model, &units(8, late));
    let whole = watch(&model, &rows, usize::MAX);
    assert!(delays(&whole).len() >= 30, "{}", whole.len());
    let turned: Vec<Row> = rows
        .chunk_by(|one, other| one.time == other.time)
        .flat_map(|scan| scan.iter().rev().copied())
        .collect();
    assert_ne!(turned, rows);
    for batch in [1, 2, 3, 7, usize::MAX] {
        assert_eq!(watch(&model, &rows, batch), whole, "{batch}");
        assert_eq!(watch(&model, &turned, batch), whole, "{batch}");
    }
}
