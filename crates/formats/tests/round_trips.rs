//! log → file → log gives the same log, in every format.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod scratch;

use proptest::prelude::*;
use runglight_engine::log::{ChangeLog, ChangeLogBuilder, Gap};
use runglight_formats::{Format, ReadOptions, arrow, read, write};
use scratch::Scratch;

/// Logs with odd names, samples, ties and pulses, as they come from a tap.
fn logs(names: &'static str) -> impl Strategy<Value = ChangeLog> {
    let value = prop_oneof![4 => 0..2_i64, 1 => any::<i64>()];
    let step =
        prop_oneof![2 => Just(0_i64), 4 => 0..5_000_000_000_i64, 1 => 0..100_000_000_000_000_i64];
    let start = prop_oneof![
        Just(0_i64),
        Just(1_515_157_696_042_000_000),
        -9_000_000_000_000_000_000..9_000_000_000_000_000_000_i64
    ];
    let rows = prop::collection::vec((step, 0..6_usize, value), 0..60);
    (prop::collection::vec(names, 6), start, rows).prop_map(|(mut names, start, rows)| {
        names.sort();
        names.dedup();
        let mut builder = ChangeLogBuilder::default();
        let mut time = start;
        for (step, name, value) in rows {
            time += step;
            let signal = builder.intern(&names[name % names.len()]);
            builder.push(time, signal, value);
        }
        builder.finish()
    })
}

const ANY_NAME: &str = "[^\0\u{FFFE}\u{FFFF}\u{FEFF}]{1,12}";

fn there_and_back(log: &ChangeLog, name: &str) -> ChangeLog {
    let scratch = Scratch::new();
    let path = scratch.path(name);
    assert_eq!(write(log, &path, None).unwrap(), log.len() as u64);
    read(&path, &ReadOptions::default()).unwrap().log
}

/// What CSV cannot say is dropped before comparing.
fn rows_only(mut log: ChangeLog) -> ChangeLog {
    log.scan_interval = None;
    log.gaps.clear();
    log
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn csv(log in logs(ANY_NAME)) {
        prop_assert_eq!(there_and_back(&log, "log.csv"), rows_only(log));
    }

    #[test]
    fn tsv(log in logs(ANY_NAME)) {
        prop_assert_eq!(there_and_back(&log, "log.tsv"), rows_only(log));
    }

    #[test]
    fn parquet(log in logs(ANY_NAME), interval in prop::option::of(1..i64::MAX), gap in prop::option::of(any::<(i64, i64)>())) {
        let log = ChangeLog { scan_interval: interval, gaps: gap.map(|(start, end)| Gap { start, end }).into_iter().collect(), ..log };
        prop_assert_eq!(there_and_back(&log, "log.parquet"), log);
    }

    #[test]
    fn xes(log in logs(ANY_NAME), interval in prop::option::of(1..i64::MAX), gap in prop::option::of(any::<(i64, i64)>())) {
        let log = ChangeLog { scan_interval: interval, gaps: gap.map(|(start, end)| Gap { start, end }).into_iter().collect(), ..log };
        prop_assert_eq!(there_and_back(&log, "log.xes"), log);
    }

    #[test]
    fn vcd(log in logs(ANY_NAME), interval in prop::option::of(1..i64::MAX), gap in prop::option::of(any::<(i64, i64)>())) {
        let log = ChangeLog { scan_interval: interval, gaps: gap.map(|(start, end)| Gap { start, end }).into_iter().collect(), ..log };
        prop_assert_eq!(there_and_back(&log, "log.vcd"), log);
    }

    #[test]
    fn arrow_batches(log in logs(".{1,8}"), cut in 0..60_usize) {
        let batch = arrow::to_batch(&log);
        let cut = cut.min(batch.num_rows());
        let parts = [batch.slice(0, cut), batch.slice(cut, batch.num_rows() - cut)];
        let back = arrow::from_batches(parts.into_iter().map(Ok), 0).unwrap();
        prop_assert_eq!(back, log);
    }
}

#[test]
fn many_signals_keep_their_names_in_every_format() {
    let mut builder = ChangeLogBuilder::default();
    for number in 0..20_000 {
        let signal = builder.intern(&format!("Group {}$Device[{}]%", number % 7, number));
        builder.push(1_700_000_000_000_000_000 + number, signal, number % 3);
    }
    let log = builder.finish();
    for name in ["log.csv", "log.parquet", "log.xes", "log.vcd"] {
        assert!(there_and_back(&log, name) == log, "{name}");
    }
}

#[test]
fn empty_logs_stay_empty() {
    for name in ["log.csv", "log.parquet", "log.xes", "log.vcd"] {
        assert_eq!(there_and_back(&ChangeLog::default(), name), ChangeLog::default(), "{name}");
    }
}

#[test]
fn writing_replaces_whole_files_and_names_unknown_formats() {
    let scratch = Scratch::new();
    let path = scratch.file("log.csv", "old");
    write(&ChangeLog::default(), &path, None).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "time,signal,value\n");
    let error = write(&ChangeLog::default(), &scratch.path("log.doc"), None).unwrap_err();
    assert!(error.to_string().contains("csv, parquet, xes or vcd"), "{error}");
    write(&ChangeLog::default(), &scratch.path("log.doc"), Some(Format::Vcd)).unwrap();
    let error = write(&ChangeLog::default(), &scratch.path("no/log.csv"), None).unwrap_err();
    assert!(error.to_string().contains("log.csv"), "{error}");
    let left: Vec<_> = std::fs::read_dir(scratch.path("")).unwrap().collect();
    assert_eq!(left.len(), 2, "temporary files are left behind: {left:?}");
}

#[test]
fn csv_is_written_as_the_contract_says() {
    let mut builder = ChangeLogBuilder::default();
    let name = builder.intern("Group2-Device1-Signal2");
    let odd = builder.intern("a,\"b\"");
    for (time, signal, value) in [
        (0, name, 1),
        (1_500_000_000, name, 0),
        (1_000_001_000_000_001, odd, -5),
        (1_515_157_696_042_100_000, odd, 7),
    ] {
        builder.push(time, signal, value);
    }
    let scratch = Scratch::new();
    let path = scratch.path("log.csv");
    write(&builder.finish(), &path, None).unwrap();
    assert_eq!(
        std::fs::read_to_string(&path).unwrap(),
        "time,signal,value\n\
         1970-01-01T00:00:00Z,Group2-Device1-Signal2,1\n\
         1970-01-01T00:00:01.500Z,Group2-Device1-Signal2,0\n\
         1970-01-12T13:46:41.000000001Z,\"a,\"\"b\"\"\",-5\n\
         2018-01-05T13:08:16.042100Z,\"a,\"\"b\"\"\",7\n"
    );
}

#[test]
fn logs_that_no_file_could_carry_are_refused() {
    let scratch = Scratch::new();
    let signals = vec!["a".to_owned()];
    for log in [
        ChangeLog { signals: signals.clone(), time: vec![1], ..ChangeLog::default() },
        ChangeLog {
            signals: signals.clone(),
            time: vec![1],
            signal: vec![1],
            value: vec![0],
            ..ChangeLog::default()
        },
        ChangeLog {
            signals,
            time: vec![1, 0],
            signal: vec![0, 0],
            value: vec![0, 0],
            ..ChangeLog::default()
        },
    ] {
        write(&log, &scratch.path("log.vcd"), None).unwrap_err();
    }
}
