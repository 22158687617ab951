//! Enabling events: what a transition waits for is found, and delays are judged from there.

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

/// Two feeders arrive at random; the press closes 30 ms after the later of them, opens 500 ms
/// after that. `late(cycle)` holds the press back; `alone(cycle)` lets it close without feeders.
fn press_line(
    cycles: i64,
    group_of_feeders: &str,
    seed: u64,
    late: impl Fn(i64) -> i64,
    alone: impl Fn(i64) -> bool,
) -> ChangeLog {
    let feeders = Feeders { pause: 0, within: 20_000, right_after: 0 };
    press_line_fed(cycles, group_of_feeders, seed, &feeders, late, alone)
}

/// When the feeders come, in milliseconds.
struct Feeders {
    /// After this pause,
    pause: i64,
    /// within so long,
    within: i64,
    /// and the right one so much later.
    right_after: i64,
}

fn press_line_fed(
    cycles: i64,
    group_of_feeders: &str,
    seed: u64,
    feeders: &Feeders,
    late: impl Fn(i64) -> i64,
    alone: impl Fn(i64) -> bool,
) -> ChangeLog {
    let mut dice = Dice(seed);
    let mut rows: Vec<(i64, String, i64)> = Vec::new();
    let mut start = 1000;
    for cycle in 0..cycles {
        start += feeders.pause;
        let left = start + dice.roll(feeders.within);
        let right = start + feeders.right_after + dice.roll(feeders.within);
        let press = left.max(right) + 30 + dice.roll(20) + late(cycle);
        let name = |device: &str| format!("{group_of_feeders}-{device}-PART");
        if !alone(cycle) {
            rows.push((left, name("Left"), 1));
            rows.push((right, name("Right"), 1));
        }
        rows.push((press, "Line-Press-CLOSE".to_owned(), 1));
        let open = press + 500 + dice.roll(20);
        rows.push((open, "Line-Press-CLOSE".to_owned(), 0));
        if !alone(cycle) {
            rows.push((open + 40 + dice.roll(500), name("Left"), 0));
            rows.push((open + 600 + dice.roll(500), name("Right"), 0));
        }
        start = open + 1200 + dice.roll(15_000);
    }
    rows.sort_by_key(|row| row.0);
    let mut builder = ChangeLogBuilder::default();
    for (time, name, value) in rows {
        let signal = builder.intern(&name);
        // A logger writes on a 10 ms grid.
        builder.push(time / 10 * 10 * MS, signal, value);
    }
    builder.finish()
}

fn model_of(log: &ChangeLog) -> Arc<NominalModel> {
    Arc::new(
        learn(std::slice::from_ref(log), &SymbolTable::default(), &Parameters::default())
            .expect("the log has events"),
    )
}

fn alarms(model: &Arc<NominalModel>, log: &ChangeLog) -> Vec<Finding> {
    let mut monitor = Monitor::new(Arc::clone(model));
    let numbers: Vec<u32> = log
        .signals
        .iter()
        .map(|symbol| {
            let known = model.plant.signals.iter().position(|s| s.symbol() == *symbol);
            monitor.signal_index(symbol, known.map(|k| k as u32))
        })
        .collect();
    let rows: Vec<Row> = (0..log.len())
        .map(|i| Row {
            time: log.time[i],
            signal: numbers[log.signal[i] as usize],
            value: log.value[i],
        })
        .collect();
    let mut findings = monitor.observe(&rows).expect("rows in order");
    findings.extend(monitor.finish());
    findings.retain(|finding| finding.severity != Severity::Notice);
    findings
}

fn triggers_of(model: &NominalModel, next: &str) -> Vec<String> {
    let rule = model
        .rules
        .iter()
        .find(|r| model.kind(r.chain) == ChainKind::Device && model.state_name(r.next) == next)
        .expect("the rule was learned");
    rule.trigger.iter().flat_map(|t| t.states()).map(|s| model.state_name(s)).collect()
}

const NEVER: fn(i64) -> bool = |_| false;

#[test]
fn the_later_of_two_feeders_enables_the_press() {
    let model = model_of(&press_line(120, "Line", 7, |_| 0, NEVER));
    let mut triggers = triggers_of(&model, "Line-Press-CLOSE_ON");
    triggers.sort();
    assert_eq!(triggers, ["Line-Left-PART_ON", "Line-Right-PART_ON"]);
    // The press opens after its own time: no other event explains that better.
    assert_eq!(triggers_of(&model, "Line-Press-CLOSE_OFF"), Vec::<String>::new());
}

#[test]
fn a_delay_hidden_in_random_waits_is_found_and_nothing_else() {
    let model = model_of(&press_line(120, "Line", 7, |_| 0, NEVER));
    let watched =
        press_line(300, "Line", 8, |cycle| if cycle % 50 == 20 { 1500 } else { 0 }, NEVER);
    let found = alarms(&model, &watched);
    assert_eq!(found.len(), 6, "{found:?}");
    for finding in &found {
        assert_eq!(finding.kind, Kind::Late);
        assert_eq!(finding.to.as_deref(), Some("Line-Press-CLOSE_ON"));
        assert!((1.5..1.6).contains(&finding.observed_s.unwrap_or_default()));
        assert!(finding.message.contains("which it waits for"), "{}", finding.message);
    }
}

#[test]
fn outliers_while_learning_do_not_hide_the_trigger() {
    let learned = press_line(200, "Line", 3, |cycle| if cycle == 77 { 9000 } else { 0 }, NEVER);
    assert_eq!(triggers_of(&model_of(&learned), "Line-Press-CLOSE_ON").len(), 2);
}

#[test]
fn a_partner_that_is_seldom_the_later_is_found_by_what_the_other_leaves() {
    let feeders = Feeders { pause: 0, within: 20_000, right_after: 15_000 };
    let log = press_line_fed(300, "Line", 7, &feeders, |_| 0, NEVER);
    let mut triggers = triggers_of(&model_of(&log), "Line-Press-CLOSE_ON");
    triggers.sort();
    assert_eq!(triggers, ["Line-Left-PART_ON", "Line-Right-PART_ON"]);
}

#[test]
fn a_wait_of_minutes_that_varies_by_a_second_has_its_trigger_too() {
    let feeders = Feeders { pause: 300_000, within: 1500, right_after: 0 };
    let log = press_line_fed(120, "Line", 7, &feeders, |_| 0, NEVER);
    assert_eq!(triggers_of(&model_of(&log), "Line-Press-CLOSE_ON").len(), 2);
}

#[test]
fn an_occurrence_enables_once() {
    // Without feeders the press closes by hand; the last feeders are long gone.
    let model = model_of(&press_line(120, "Line", 7, |_| 0, NEVER));
    let watched = press_line(60, "Line", 9, |_| 0, |cycle| cycle > 30 && cycle < 34);
    let mut found = alarms(&model, &watched);
    // The feeders come late after three cycles without them, and the group's order is another; but
    // the press is as ever.
    found.retain(|finding| finding.device.as_deref() == Some("Press"));
    assert_eq!(found, Vec::new());
}

#[test]
fn another_group_is_no_trigger() {
    let model = model_of(&press_line(120, "Feeders", 7, |_| 0, NEVER));
    assert_eq!(triggers_of(&model, "Line-Press-CLOSE_ON"), Vec::<String>::new());
}

#[test]
fn logs_of_the_same_time_teach_as_logs_one_after_the_other() {
    let first = press_line(60, "Line", 11, |_| 0, NEVER);
    let second = press_line(60, "Line", 12, |_| 0, NEVER);
    let rules = |after: i64| {
        let time = second.time.iter().map(|time| time + after).collect();
        let logs = [first.clone(), ChangeLog { time, ..second.clone() }];
        let model = learn(&logs, &SymbolTable::default(), &Parameters::default());
        model.expect("the logs have events").rules
    };
    let same_time = rules(0);
    assert!(same_time.iter().any(|rule| rule.trigger.is_some()));
    assert_eq!(same_time, rules(100_000_000 * MS));
}

#[test]
fn the_graph_shows_what_is_waited_for_as_dashed_arrows() {
    let model = model_of(&press_line(120, "Line", 7, |_| 0, NEVER));
    let press = model.find_chain("Line", Some("Press")).expect("the device is there");
    let dot = model.dot(press);
    assert!(dot.contains("label=\"Left-PART_ON\", shape=box, style=dashed"), "{dot}");
    assert_eq!(dot.matches("arrowhead=open").count(), 2, "{dot}");
}
