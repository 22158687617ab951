//! Wide text logs: samples to changes.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod scratch;

use proptest::prelude::*;
use runglight_engine::log::Gap;
use scratch::{csv, read_as, rows};

const MS: i64 = 1_000_000;

/// A wide file with times every 100 ms from 2018-01-05 on.
fn wide(header: &str, samples: &[&str]) -> String {
    let mut text = format!("Timestamp,{header}\n");
    for (step, sample) in samples.iter().enumerate() {
        text.push_str(&format!("{},{sample}\n", START / MS + 100 * step as i64));
    }
    text
}

const START: i64 = 1_515_157_696_000 * MS;

#[test]
fn first_row_then_changes_then_the_end() {
    let log = csv(&wide("A,B", &["0,1", "0,1", "1,1", "1,0", "1,0"])).log;
    assert_eq!(
        rows(&log),
        [
            (START, "A", 0),
            (START, "B", 1),
            (START + 200 * MS, "A", 1),
            (START + 300 * MS, "B", 0),
            (START + 400 * MS, "A", 1),
        ]
    );
    assert_eq!(log.scan_interval, Some(100 * MS));
    assert!(log.gaps.is_empty());
}

#[test]
fn no_sample_is_added_where_the_last_row_changes() {
    let log = csv(&wide("A", &["0", "0", "1"])).log;
    assert_eq!(rows(&log), [(START, "A", 0), (START + 200 * MS, "A", 1)]);
    let single = csv(&wide("A,B", &["0,1"])).log;
    assert_eq!(single.len(), 2);
}

#[test]
fn truth_values_words_and_constants_are_kept_reals_are_left_out() {
    let samples: Vec<String> = (0..100)
        .map(|step| {
            format!(
                "{},{},{},7,{},{}.5",
                ["true", "False"][step % 2],
                step / 20,
                step * 3,
                ["1.0", "0.0"][step / 50],
                step
            )
        })
        .collect();
    let samples: Vec<&str> = samples.iter().map(String::as_str).collect();
    let reading = csv(&wide("Lamp,Step,Position,Constant,Valve,Level", &samples));
    assert_eq!(reading.log.signals, ["Lamp", "Step", "Constant", "Valve"]);
    let left_out: Vec<&str> =
        reading.report.left_out.iter().map(|left_out| left_out.column.as_str()).collect();
    assert_eq!(left_out, ["Position", "Level"]);
    assert!(reading.report.left_out[0].reason.contains("more than 64"));
    assert!(reading.report.left_out[1].reason.contains("fraction"));
}

#[test]
fn integers_with_a_new_value_in_most_samples_are_measurements() {
    let noisy: Vec<String> = (0..50).map(|step| format!("{},{}", step * 7 % 5, step % 2)).collect();
    let noisy: Vec<&str> = noisy.iter().map(String::as_str).collect();
    let reading = csv(&wide("Weight,Clock", &noisy));
    assert_eq!(reading.log.signals, ["Clock"]);
    assert!(reading.report.left_out[0].reason.contains("most samples"));
    let few = csv(&wide("Step", &["1", "2", "3", "4"]));
    assert_eq!(few.log.signals, ["Step"]);
}

#[test]
fn analog_gives_a_threshold_and_bands() {
    let text = wide("Level,On", &["0.5,1", "1.5,1", "2.5,1", "1.5,1"]);
    let log = read_as("log.csv", &text, r#"{"analog": [["Level", 1.5]]}"#).unwrap().log;
    let level: Vec<i64> =
        rows(&log).iter().filter(|row| row.1 == "Level").map(|row| row.2).collect();
    assert_eq!(level[..2], [0, 1]);
    let bands = r#"{"analog": [["Level", 2.0], ["Level", 1.0]]}"#;
    let log = read_as("log.csv", &text, bands).unwrap().log;
    let level: Vec<i64> =
        rows(&log).iter().filter(|row| row.1 == "Level").map(|row| row.2).collect();
    assert_eq!(level, [0, 1, 2, 1]);
}

#[test]
fn bits_that_are_ever_set() {
    let text = wide("Ctrl", &["0", "5", "5", "4", "-32768"]);
    let log = read_as("log.csv", &text, r#"{"bits": ["Ctrl"]}"#).unwrap().log;
    assert_eq!(log.signals, ["Ctrl.0", "Ctrl.2", "Ctrl.15"]);
    assert_eq!(
        rows(&log),
        [
            (START, "Ctrl.0", 0),
            (START, "Ctrl.2", 0),
            (START, "Ctrl.15", 0),
            (START + 100 * MS, "Ctrl.0", 1),
            (START + 100 * MS, "Ctrl.2", 1),
            (START + 300 * MS, "Ctrl.0", 0),
            (START + 400 * MS, "Ctrl.2", 0),
            (START + 400 * MS, "Ctrl.15", 1),
        ]
    );
    let none = read_as("log.csv", wide("Ctrl,A", &["0,1"]), r#"{"bits": ["Ctrl"]}"#).unwrap();
    assert_eq!(none.log.signals, ["A"]);
    assert_eq!(none.report.left_out[0].column, "Ctrl");
}

#[test]
fn gaps_are_found() {
    let mut text = wide("A", &["0"; 20]);
    text.push_str(&format!("{},1\n{},1\n", START / MS + 5_000, START / MS + 5_100));
    let log = csv(&text).log;
    assert_eq!(log.gaps, [Gap { start: START + 1_900 * MS, end: START + 5_000 * MS }]);
}

#[test]
fn skipped_cells_hold_their_value() {
    let text = wide("A,B", &["0,1", ",1", "1,x", "NaN,0"]);
    let reading = read_as("log.csv", &text, r#"{"on_error": "skip"}"#).unwrap();
    assert_eq!(
        rows(&reading.log),
        [(START, "A", 0), (START, "B", 1), (START + 200 * MS, "A", 1), (START + 300 * MS, "B", 0)]
    );
    assert_eq!((reading.report.rows, reading.report.bad_rows), (4, 3));
    let shown: Vec<u64> = reading.report.bad.iter().map(|bad| bad.row).collect();
    assert_eq!(shown, [3, 4, 5]);
}

#[test]
fn empty_cells_of_left_out_columns_do_no_harm() {
    let reading = csv(&wide("A,Level,Unused,Remark", &["0,,,good", "1,0.5,,bad"]));
    assert_eq!(reading.log.signals, ["A"]);
    let left_out: Vec<&str> =
        reading.report.left_out.iter().map(|left_out| left_out.column.as_str()).collect();
    assert_eq!(left_out.len(), 3, "{left_out:?}");
}

#[test]
fn names_that_stand_twice_stay_apart() {
    let log = csv(&wide("A,A", &["0,1"])).log;
    assert_eq!(log.signals, ["A", "A#3"]);
}

#[test]
fn a_lamp_called_signal_does_not_make_a_long_log() {
    let log = csv(&wide("Signal,Status,Pump", &["0,1,1", "1,1,0"])).log;
    assert_eq!(log.signals, ["Signal", "Status", "Pump"]);
}

#[test]
fn time_column_without_a_name_that_helps() {
    let log = csv("Zyklus,A\n2024-04-15 12:00:00,1\n2024-04-15 12:00:01,0\n").log;
    assert_eq!(log.signals, ["A"]);
}

#[test]
fn late_rows_are_sorted_before_they_are_compared() {
    let base = START / MS;
    let text =
        format!("Timestamp,A\n{},0\n{},1\n{},0\n{},1\n", base, base + 300, base + 200, base + 400);
    let log = csv(&text).log;
    assert_eq!(
        rows(&log),
        [(START, "A", 0), (START + 300 * MS, "A", 1), (START + 400 * MS, "A", 1)]
    );
    let text = format!("Timestamp,A\n{},0\n{},1\n{},0\n", base, base + 5_000, base + 200);
    let error = read_as("log.csv", &text, "{}").unwrap_err();
    assert!(error.contains("row 4") && error.contains("reorder"), "{error}");
    let reading = read_as("log.csv", &text, r#"{"on_error": "skip"}"#).unwrap();
    assert_eq!((reading.report.bad_rows, reading.log.len()), (1, 2));
}

proptest! {
    /// Playing the changes back gives every sample, and nothing is said twice but the end.
    #[test]
    fn changes_give_the_samples_back(samples in prop::collection::vec(prop::collection::vec(0..3_i64, 3), 1..9)) {
        let lines: Vec<String> = samples
            .iter()
            .map(|sample| sample.iter().map(i64::to_string).collect::<Vec<_>>().join(","))
            .collect();
        let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        let log = csv(&wide("A,B,C", &lines)).log;
        let mut state = [-1; 3];
        let mut row = 0;
        for (step, sample) in samples.iter().enumerate() {
            while row < log.len() && log.time[row] == START + 100 * MS * step as i64 {
                let signal = log.signal[row] as usize;
                let is_end = row + 1 == log.len();
                prop_assert!(state[signal] != log.value[row] || is_end);
                state[signal] = log.value[row];
                row += 1;
            }
            prop_assert_eq!(&state[..], &sample[..]);
        }
        prop_assert_eq!(row, log.len());
        prop_assert_eq!(*log.time.last().unwrap(), START + 100 * MS * (samples.len() as i64 - 1));
    }
}
