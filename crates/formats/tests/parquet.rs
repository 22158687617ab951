//! Parquet of other writers: long with other names and types, wide, empty, with nulls.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod scratch;

use std::sync::Arc;

use arrow_array::types::{Int8Type, UInt64Type};
use arrow_array::{
    ArrayRef, BooleanArray, DictionaryArray, Float64Array, Int16Array, Int32Array, Int64Array,
    LargeStringArray, RecordBatch, StringArray, StringViewArray, TimestampMicrosecondArray,
    TimestampMillisecondArray, TimestampSecondArray, UInt64Array,
};
use parquet::arrow::ArrowWriter;
use runglight_engine::log::ChangeLogBuilder;
use runglight_formats::{arrow, read, write};
use scratch::{Scratch, options, read_as, rows};

const S: i64 = 1_000_000_000;
const NOON: i64 = 1_713_182_400 * S;

fn batch(columns: Vec<(&str, ArrayRef)>) -> RecordBatch {
    RecordBatch::try_from_iter(columns).unwrap()
}

fn file(batch: &RecordBatch) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = ArrowWriter::try_new(&mut bytes, batch.schema(), None).unwrap();
    writer.write(batch).unwrap();
    writer.close().unwrap();
    bytes
}

fn names() -> Vec<ArrayRef> {
    let names = ["a", "b", "a"];
    vec![
        Arc::new(StringArray::from_iter_values(names)),
        Arc::new(LargeStringArray::from_iter_values(names)),
        Arc::new(StringViewArray::from_iter_values(names)),
        Arc::new(names.into_iter().collect::<DictionaryArray<Int8Type>>()),
        Arc::new(names.into_iter().collect::<DictionaryArray<UInt64Type>>()),
    ]
}

fn values() -> Vec<ArrayRef> {
    vec![
        Arc::new(Int64Array::from_iter_values([1, 0, 1])),
        Arc::new(Int16Array::from_iter_values([1, 0, 1])),
        Arc::new(UInt64Array::from_iter_values([1, 0, 1])),
        Arc::new(BooleanArray::from(vec![true, false, true])),
        Arc::new(Float64Array::from_iter_values([1.0, 0.0, 1.0])),
    ]
}

fn times() -> Vec<ArrayRef> {
    let seconds = [NOON / S, NOON / S + 1, NOON / S + 2];
    vec![
        Arc::new(TimestampSecondArray::from_iter_values(seconds)),
        Arc::new(
            TimestampMillisecondArray::from_iter_values(seconds.map(|s| s * 1_000))
                .with_timezone("UTC"),
        ),
        Arc::new(
            TimestampMicrosecondArray::from_iter_values(seconds.map(|s| s * 1_000_000))
                .with_timezone("Europe/Berlin"),
        ),
    ]
}

fn expected() -> Vec<(i64, &'static str, i64)> {
    vec![(NOON, "a", 1), (NOON + S, "b", 0), (NOON + 2 * S, "a", 1)]
}

#[test]
fn every_type_that_says_the_same() {
    for time in times() {
        for name in names() {
            for value in values() {
                let table =
                    batch(vec![("time", time.clone()), ("signal", name.clone()), ("value", value)]);
                let log = arrow::from_batches([Ok(table.clone())], 0).unwrap();
                assert_eq!(rows(&log), expected(), "{:?}", table.schema());
                let reading = read_as("log.parquet", file(&table), "{}").unwrap();
                assert_eq!(reading.log, log);
                assert_eq!(reading.report.rows, 3);
            }
        }
    }
}

#[test]
fn other_names_and_written_times() {
    for time in [
        Arc::new(Int64Array::from_iter_values([
            NOON / 1_000_000,
            NOON / 1_000_000 + 1_000,
            NOON / 1_000_000 + 2_000,
        ])) as ArrayRef,
        Arc::new(Float64Array::from_iter_values([
            NOON as f64 / 1e9,
            NOON as f64 / 1e9 + 1.0,
            NOON as f64 / 1e9 + 2.0,
        ])),
        Arc::new(StringArray::from_iter_values([
            "2024-04-15T12:00:00Z",
            "2024-04-15T12:00:01Z",
            "2024-04-15T12:00:02Z",
        ])),
    ] {
        let table = batch(vec![
            ("id", Arc::new(Int32Array::from_iter_values([1, 2, 3]))),
            ("_NAME", names()[0].clone()),
            ("_VALUE", Arc::new(StringArray::from_iter_values(["on", "OFF", "true"]))),
            ("_TIMESTAMP", time),
        ]);
        let reading = read_as("log.parquet", file(&table), "{}").unwrap();
        assert_eq!(rows(&reading.log), expected());
        assert_eq!(reading.report.left_out[0].column, "id");
    }
}

#[test]
fn wide_tables() {
    let time: Vec<i64> = (0..100).map(|step| NOON / 1_000 + 100_000 * step).collect();
    let table = batch(vec![
        ("A", Arc::new(BooleanArray::from_iter((0..100).map(|step| Some(step >= 50))))),
        ("timestamp", Arc::new(TimestampMicrosecondArray::from_iter_values(time))),
        (
            "Level",
            Arc::new(Float64Array::from_iter_values((0..100).map(|step| f64::from(step) / 7.0))),
        ),
        ("Step", Arc::new(Int32Array::from_iter_values((0..100).map(|step| step / 30)))),
    ]);
    let Reading { log, left_out } = wide(&table, "{}");
    assert_eq!(log.signals, ["A", "Step"]);
    assert_eq!(left_out, ["Level"]);
    assert_eq!(log.scan_interval, Some(S / 10));
    assert_eq!(log.len(), 2 + 1 + 3 + 1);
    let log = wide(&table, r#"{"analog": [["Level", 7.0]], "bits": ["Step"]}"#).log;
    assert_eq!(log.signals, ["A", "Level", "Step.0", "Step.1"]);
}

struct Reading {
    log: runglight_engine::log::ChangeLog,
    left_out: Vec<String>,
}

fn wide(table: &RecordBatch, json: &str) -> Reading {
    let reading = read_as("log.parquet", file(table), json).unwrap();
    let left_out = reading.report.left_out.into_iter().map(|left_out| left_out.column).collect();
    Reading { log: reading.log, left_out }
}

#[test]
fn nulls_name_their_row() {
    let table = batch(vec![
        ("time", times()[0].clone()),
        ("signal", names()[0].clone()),
        ("value", Arc::new(Int64Array::from(vec![Some(1), None, Some(1)]))),
    ]);
    let error = arrow::from_batches([Ok(table.clone())], 0).unwrap_err().to_string();
    assert!(error.contains("row 2") && error.contains("'value'"), "{error}");
    let error = read_as("log.parquet", file(&table), "{}").unwrap_err();
    assert!(error.contains("log.parquet") && error.contains("row 2"), "{error}");
    let reading = read_as("log.parquet", file(&table), r#"{"on_error": "skip"}"#).unwrap();
    assert_eq!((reading.log.len(), reading.report.bad_rows), (2, 1));
    let names = batch(vec![
        ("time", times()[0].clone()),
        ("signal", Arc::new(StringArray::from(vec![Some("a"), Some("b"), None]))),
        ("value", values()[0].clone()),
    ]);
    let error = arrow::from_batches([Ok(names)], 0).unwrap_err().to_string();
    assert!(error.contains("row 3") && error.contains("'signal'"), "{error}");
}

#[test]
fn tables_that_are_no_log() {
    let table = batch(vec![("time", times()[0].clone()), ("signal", names()[0].clone())]);
    let error = arrow::from_batches([Ok(table)], 0).unwrap_err().to_string();
    assert!(error.contains("'value'") && error.contains("'signal'"), "{error}");
    let table = batch(vec![
        ("time", values()[0].clone()),
        ("signal", names()[0].clone()),
        ("value", values()[0].clone()),
    ]);
    let error = arrow::from_batches([Ok(table)], 0).unwrap_err().to_string();
    assert!(error.contains("'time'") && error.contains("timestamp"), "{error}");
    let halves = Arc::new(Float64Array::from_iter_values([1.0, 0.5, 1.0]));
    let table = batch(vec![
        ("time", times()[0].clone()),
        ("signal", names()[0].clone()),
        ("value", halves),
    ]);
    let error = arrow::from_batches([Ok(table)], 0).unwrap_err().to_string();
    assert!(error.contains("row 2") && error.contains("0.5"), "{error}");
    let far = Arc::new(TimestampSecondArray::from_iter_values([0, i64::MAX, 0]));
    let table =
        batch(vec![("time", far), ("signal", names()[0].clone()), ("value", values()[0].clone())]);
    let error = arrow::from_batches([Ok(table)], 0).unwrap_err().to_string();
    assert!(error.contains("row 2") && error.contains("2261"), "{error}");
}

#[test]
fn late_rows_of_a_table() {
    let time = Arc::new(TimestampSecondArray::from_iter_values([10, 0, 11]));
    let table =
        batch(vec![("time", time), ("signal", names()[0].clone()), ("value", values()[0].clone())]);
    let error = arrow::from_batches([Ok(table.clone())], S).unwrap_err().to_string();
    assert!(error.contains("row 2"), "{error}");
    assert_eq!(arrow::from_batches([Ok(table)], 10 * S).unwrap().time, [0, 10 * S, 11 * S]);
}

#[test]
fn no_rows_are_an_empty_log_with_a_note() {
    let scratch = Scratch::new();
    let path = scratch.path("log.parquet");
    write(&ChangeLogBuilder::default().finish(), &path, None).unwrap();
    let reading = read(&path, &options("{}")).unwrap();
    assert!(reading.log.is_empty());
    assert!(reading.report.notes.iter().any(|note| note.contains("no rows")));
}

#[test]
fn our_own_columns_are_the_contract() {
    let mut builder = ChangeLogBuilder::default();
    let signal = builder.intern("a");
    builder.push(NOON, signal, 1);
    let batch = arrow::to_batch(&builder.finish());
    let shown: Vec<String> = batch
        .schema()
        .fields()
        .iter()
        .map(|field| format!("{}: {}", field.name(), field.data_type()))
        .collect();
    assert_eq!(
        shown,
        ["time: Timestamp(ns, \"UTC\")", "signal: Dictionary(UInt32, Utf8)", "value: Int64"]
    );
}

#[test]
fn date_and_time_in_two_columns() {
    let days = arrow_array::Date32Array::from_iter_values([19_828; 3]);
    let table = batch(vec![
        ("date", Arc::new(days)),
        ("time", Arc::new(StringArray::from_iter_values(["12:00:00", "12:00:01", "12:00:02"]))),
        ("signal", names()[0].clone()),
        ("value", values()[0].clone()),
    ]);
    assert_eq!(rows(&read_as("log.parquet", file(&table), "{}").unwrap().log), expected());
}
