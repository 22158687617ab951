//! Malformed files and what is said about them: one line with file, place and mend.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod scratch;

use scratch::{Scratch, options, read_as};

/// File name, bytes, options, and words the sentence must have.
const CASES: &[(&str, &[u8], &str, &[&str])] = &[
    ("empty.csv", b"", "{}", &["empty"]),
    ("empty.parquet", b"", "{}", &["empty"]),
    ("blank.csv", b"\n\n  \n", "{}", &["blank lines"]),
    ("zip.csv", b"PK\x03\x04rest", "{}", &["zip archive", "unpack it first"]),
    ("book.xlsx", b"PK\x03\x04rest", "{}", &["Excel"]),
    ("old.xls", b"\xD0\xCF\x11\xE0rest", "{}", &["Office"]),
    ("zstd.csv", b"\x28\xB5\x2F\xFDrest", "{}", &["zstd"]),
    ("broken.csv.gz", b"\x1F\x8Brest of it", "{}", &["gzip"]),
    ("binary.csv", b"time,signal,value\n\0\x01\x02", "{}", &["binary"]),
    ("base.db", b"SQLite format 3\0", "{}", &["SQLite"]),
    ("page.html", b"<!DOCTYPE html><html></html>", "{}", &["row 1"]),
    ("page.xml", b"<html></html>", "{}", &["<log>"]),
    ("no_value.csv", b"time,signal,reading\n2024-01-01,a,1\n", "{}", &["row 1", "value column", "value_column"]),
    ("no_time.csv", b"signal,value\na,1\n", "{}", &["time column", "time_column"]),
    ("time_text.csv", b"time,signal,value\nyesterday,a,1\n", "{}", &["row 2", "'time'", "'yesterday'", "2024-04-15T12:00:00.5Z"]),
    ("value_text.csv", b"time,signal,value\n2024-01-01,a,1\n2024-01-01,a,open\n", "{}", &["row 3", "'value'", "'open'", "integer"]),
    ("value_float.csv", b"time,signal,value\n2024-01-01,a,1.5\n", "{}", &["row 2", "'1.5'"]),
    ("value_huge.csv", b"time,signal,value\n2024-01-01,a,99999999999999999999\n", "{}", &["row 2", "99999999999999999999"]),
    ("value_empty.csv", b"time,signal,value\n2024-01-01,a,\n", "{}", &["row 2", "empty"]),
    ("signal_empty.csv", b"time,signal,value\n2024-01-01,,1\n", "{}", &["row 2", "'signal'", "empty"]),
    ("month.csv", b"time,signal,value\n2024-01-01,a,1\n2024-13-01,a,1\n", "{}", &["row 3", "2024-13-01"]),
    ("leap.csv", b"time,signal,value\n2024-01-01,a,1\n2023-02-29,a,1\n", "{}", &["row 3"]),
    ("hour.csv", b"time,signal,value\n2024-01-01 00:00:00,a,1\n2024-01-01 24:00:00,a,1\n", "{}", &["row 3"]),
    ("early.csv", b"time,signal,value\n2024-01-01,a,1\n1500-01-01,a,1\n", "{}", &["row 3", "1678"]),
    ("negative.csv", b"time,signal,value\n1700000000,a,1\n-5,a,1\n", "{}", &["row 3", "negative"]),
    ("huge.csv", b"time,signal,value\n1700000000,a,1\n1e40,a,1\n", "{}", &["row 3", "1678"]),
    ("short.csv", b"time,signal,value\n2024-01-01,a,1\n2024-01-01,a\n", "{}", &["row 3", "2 fields", "3"]),
    ("long.csv", b"time,signal,value\n2024-01-01,a,1,x,y\n", "{}", &["row 2", "5 fields"]),
    ("quote.csv", b"time,signal,value\n2024-01-01,\"a,1\n2024-01-01,b,1\n", "{}", &["row 2", "quote"]),
    ("late.csv", b"time,signal,value\n2024-01-01 00:01:00,a,1\n2024-01-01 00:00:00,a,0\n", "{}", &["row 3", "60.000 s", "1.000 s", "sort"]),
    ("headerless.csv", b"2024-01-01 00:00:00,1,0,1,1\n2024-01-01 00:00:01,1,0,1,1\n", "{}", &["header row"]),
    ("texts.csv", b"case,timestamp,source,info\n1,2024-01-01,s1,Start\n", "{}", &["signal_columns", "source and info"]),
    ("wide_text.csv", b"time,A,B\n2024-01-01 00:00:00,1,0\n2024-01-01 00:00:01,1,0\n2024-01-01 00:00:02,broken,0\n", "{}", &["row 4", "'A'", "'broken'"]),
    ("wide_empty.csv", b"time,A,B\n2024-01-01 00:00:00,1,0\n2024-01-01 00:00:01,,0\n", "{}", &["row 3", "'A'", "empty"]),
    ("wide_nan.csv", b"time,A,B\n2024-01-01 00:00:00,1,0\n2024-01-01 00:00:01,NaN,0\n", "{}", &["row 3", "'A'"]),
    ("first_bad.csv", b"time,A,B\n2024-01-01 00:00:00,1,0\n2024-01-01 00:00:01,,0\nnever,1,1\n", "{}", &["row 3"]),
    ("column.csv", b"time,signal,value\n2024-01-01,a,1\n", r#"{"value_column": "worth"}"#, &["'worth'", "value_column", "'signal'"]),
    ("analog.csv", b"time,A\n2024-01-01,1\n", r#"{"analog": [["B", 1.0]]}"#, &["'B'", "analog"]),
    ("bits.csv", b"time,A\n2024-01-01,1\n", r#"{"bits": ["B"]}"#, &["'B'", "bits"]),
    ("format.csv", b"time,signal,value\n", r#"{"time_format": "fancy"}"#, &["time_format", "'fancy'", "strptime"]),
    ("date.csv", b"time,signal,value\n12:00:00,a,1\n", r#"{"date": "01.02.2024"}"#, &["date", "YYYY-MM-DD"]),
    ("delimiter.csv", b"time,signal,value\n", r#"{"delimiter": "\n"}"#, &["delimiter"]),
    ("window.csv", b"time,signal,value\n", r#"{"reorder_s": -1}"#, &["reorder_s"]),
    ("text.parquet", b"time,signal,value\n2024-01-01,a,1\n", "{}", &["Parquet"]),
    ("cut.parquet", b"PAR1\x15\x04\x15", "{}", &["Parquet"]),
    ("asked.parquet", b"PAR1\x15\x04\x15", r#"{"format": "csv"}"#, &["Parquet"]),
    ("cut.xes", b"<log><trace><event>", "{}", &["breaks off"]),
    ("no_name.xes", b"<log>\n<trace>\n<event>\n<date key=\"time:timestamp\" value=\"2024-01-01T00:00:00Z\"/></event></trace></log>", "{}", &["row 3", "event 1", "concept:name"]),
    ("no_time.xes", b"<log><trace><event><string key=\"concept:name\" value=\"a\"/></event></trace></log>", "{}", &["row 1", "time:timestamp"]),
    ("value.xes", b"<log><trace><event><string key=\"concept:name\" value=\"a\"/><date key=\"time:timestamp\" value=\"2024-01-01T00:00:00Z\"/><string key=\"value\" value=\"open\"/></event></trace></log>", "{}", &["row 1", "'open'"]),
    ("tags.xes", b"<log><trace></log>", "{}", &["row 1"]),
    ("cut.vcd", b"$timescale 1 ns $end\n$var wire 1 ! a $end\n", "{}", &["$enddefinitions"]),
    ("code.vcd", b"$timescale 1 ns $end\n$enddefinitions $end\n#0\n1!\n", "{}", &["row 4", "!"]),
    ("word.vcd", b"$timescale 1 ns $end\n$nonsense\n", "{}", &["row 2"]),
    ("time.vcd", b"$timescale 1 s $end\n$var wire 1 ! a $end\n$enddefinitions $end\n#99999999999\n1!\n", "{}", &["row 4", "2261"]),
];

#[test]
fn each_is_one_sentence() {
    assert!(CASES.len() >= 30);
    for (name, bytes, json, words) in CASES {
        let error = match read_as(name, bytes, json) {
            Ok(reading) => panic!("{name} was read: {:?}", reading.report),
            Err(error) => error,
        };
        assert!(error.contains(name), "{name}: {error}");
        assert!(!error.contains('\n'), "{name}: {error}");
        for word in *words {
            assert!(error.contains(word), "{name} lacks {word:?}: {error}");
        }
    }
}

#[test]
fn bad_rows_are_counted_and_the_first_five_shown() {
    let mut text = "time;signal;value\n".to_owned();
    for row in 0..10 {
        text.push_str(&format!("2024-01-01 00:00:0{row};a;{}\n", row % 2));
        text.push_str("2024-01-01 00:00:00;a;open\n");
    }
    let reading = read_as("log.csv", &text, r#"{"on_error": "skip"}"#).unwrap();
    assert_eq!((reading.report.rows, reading.report.bad_rows, reading.log.len()), (20, 10, 10));
    let rows: Vec<u64> = reading.report.bad.iter().map(|bad| bad.row).collect();
    assert_eq!(rows, [3, 5, 7, 9, 11]);
    assert!(reading.report.bad[0].reason.contains("'open'"));
}

#[test]
fn directories_and_missing_files() {
    let scratch = Scratch::new();
    let error = runglight_formats::read(&scratch.path(""), &options("{}")).unwrap_err().to_string();
    assert!(error.contains("a directory"), "{error}");
    let error = runglight_formats::read(&scratch.path("none.csv"), &options("{}")).unwrap_err();
    assert!(error.to_string().contains("no such file"), "{error}");
    let error =
        runglight_formats::read(&scratch.path("line\nbreak.csv"), &options("{}")).unwrap_err();
    assert!(!error.to_string().contains('\n'), "{error}");
}

#[test]
fn a_line_without_end_is_a_bad_row() {
    let mut text = b"time,signal,value\n2024-01-01,a,1\n".to_vec();
    text.extend(vec![b'x'; 40 << 20]);
    text.extend(b"\n2024-01-02,a,0\n");
    let error = read_as("log.csv", &text, "{}").unwrap_err();
    assert!(error.contains("row 3") && error.contains("MiB"), "{error}");
    let reading = read_as("log.csv", &text, r#"{"on_error": "skip"}"#).unwrap();
    assert_eq!((reading.log.len(), reading.report.bad_rows), (2, 1));
}

#[test]
fn options_have_no_unknown_fields() {
    assert!(serde_json::from_str::<runglight_formats::ReadOptions>(r#"{"colour": 1}"#).is_err());
}
