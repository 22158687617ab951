//! Random bytes, truncations and bit flips end in data or in one line, never in a panic.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod scratch;

use std::io::Write;

use proptest::prelude::*;
use runglight_engine::log::{ChangeLog, ChangeLogBuilder, Gap};
use runglight_formats::{read, write};
use scratch::{Scratch, options, read_as};

const ENDINGS: [&str; 6] = ["csv", "parquet", "xes", "vcd", "txt", "dat"];

fn log() -> ChangeLog {
    let mut builder = ChangeLogBuilder::default();
    for step in 0..200_i64 {
        let signal = builder.intern(["Motor", "a \"b\", c", "%IX0.1", "Wörd"][step as usize % 4]);
        builder.push(1_700_000_000_000_000_000 + step * 55_000_000, signal, step % 3 - 1);
    }
    let mut log = builder.finish();
    log.scan_interval = Some(55_000_000);
    log.gaps.push(Gap { start: log.time[3], end: log.time[4] });
    log
}

fn valid(ending: &str) -> Vec<u8> {
    let scratch = Scratch::new();
    let path = scratch.path(&format!("log.{ending}"));
    write(&log(), &path, None).unwrap();
    std::fs::read(path).unwrap()
}

/// Reads in both ways; whatever is wrong is said in one line that names the file.
fn survives(name: &str, bytes: &[u8]) {
    let scratch = Scratch::new();
    let path = scratch.file(name, bytes);
    for json in [r#"{"on_error": "skip"}"#, r#"{"on_error": "fail"}"#] {
        match read(&path, &options(json)) {
            Ok(reading) => {
                let log = reading.log;
                assert!(log.time.is_sorted());
                assert!(log.signal.iter().all(|&signal| (signal as usize) < log.signals.len()));
            }
            Err(error) => {
                let error = error.to_string();
                assert!(error.contains(name), "{error}");
                assert!(!error.contains(['\n', '\r', '\0']), "{error:?}");
                assert!(error.len() < 1_200, "{error}");
            }
        }
    }
}

fn changed(mut bytes: Vec<u8>, cut: usize, flips: &[(usize, u8)]) -> Vec<u8> {
    for (place, mask) in flips {
        let place = place % bytes.len();
        bytes[place] ^= mask;
    }
    bytes.truncate(bytes.len() - cut % bytes.len());
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..2_000), ending in 0..ENDINGS.len()) {
        survives(&format!("log.{}", ENDINGS[ending]), &bytes);
    }

    #[test]
    fn random_text(text in "[0-9a-z,;\t\"\n\r:. TZ+-]{0,400}") {
        survives("log.csv", text.as_bytes());
    }

    #[test]
    fn random_tables(text in "(time|date|zeit|a)(,(signal|b|c|value|name))?,(value|d|e)\r?\n(([0-9]{1,13}|[0-9]{2}:[0-9]{2}:[0-9]{2}|),(x|1|0|\"),?(1|0|-7|1.5|on|)\n){0,30}") {
        survives("log.csv", text.as_bytes());
    }

    #[test]
    fn random_xml(text in "<log>(<trace>|<event>|</event>|</trace>|<string key=\"concept:name\" value=\"[a&;]{1,4}\"/>|<date key=\"time:timestamp\" value=\"2024-01-01T00:00:00Z\"/>|&a;|<!--|-->){0,20}(</log>)?") {
        survives("log.xes", text.as_bytes());
    }

    #[test]
    fn random_vcd(text in "(\\$timescale [0-9]{1,12} (ns|s|fs) \\$end\n)?\\$var (wire|integer|real) [0-9]{1,10} ! a \\$end\n\\$enddefinitions \\$end\n(#[0-9]{1,22}\n|[01xz]!\n|b[01x]{1,70} !\n|r1.5 !\n|\\$dumpvars\n|\\$end\n){0,20}") {
        survives("log.vcd", text.as_bytes());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_500))]

    #[test]
    fn damaged_files(
        ending in 0..4_usize,
        cut in prop_oneof![Just(0_usize), 0..100_000_usize],
        flips in prop::collection::vec((any::<usize>(), 1..=255_u8), 0..8),
    ) {
        thread_local! {
            static VALID: Vec<Vec<u8>> = ENDINGS[..4].iter().map(|ending| valid(ending)).collect();
        }
        let bytes = VALID.with(|valid| changed(valid[ending].clone(), cut, &flips));
        survives(&format!("log.{}", ENDINGS[ending]), &bytes);
    }
}

#[test]
fn every_bit_of_the_parquet_footer() {
    let valid = valid("parquet");
    let footer = valid.len().saturating_sub(1_400);
    for place in footer..valid.len() {
        for bit in [0, 3, 6, 7] {
            let mut bytes = valid.clone();
            bytes[place] ^= 1 << bit;
            survives("log.parquet", &bytes);
        }
    }
}

#[test]
fn billion_laughs_are_refused() {
    let bomb = r#"<?xml version="1.0"?><!DOCTYPE log [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]>
        <log><trace><event><string key="concept:name" value="&b;"/></event></trace></log>"#;
    let error = read_as("laughs.xes", bomb, "{}").unwrap_err();
    assert!(error.contains("laughs.xes") && error.contains("document type"), "{error}");
    let entity =
        r#"<log><trace><event><string key="concept:name" value="&b;"/></event></trace></log>"#;
    let error = read_as("entity.xes", entity, "{}").unwrap_err();
    assert!(error.contains("row 1"), "{error}");
}

#[test]
fn gzip_bombs_are_refused() {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    packer.write_all(b"time,signal,value\n2024-01-01T00:00:00Z,a,1\n").unwrap();
    let zeros = vec![b'\n'; 1 << 20];
    for _ in 0..300 {
        packer.write_all(&zeros).unwrap();
    }
    let error = read_as("bomb.csv.gz", packer.finish().unwrap(), "{}").unwrap_err();
    assert!(error.contains("bomb.csv.gz") && error.contains("unpacks to more than"), "{error}");
}

#[test]
fn deep_nesting_does_not_overflow_the_stack() {
    let mut xes = "<log>".to_owned();
    xes.push_str(&"<list key=\"a\">".repeat(200_000));
    survives("deep.xes", xes.as_bytes());
    let mut vcd = "$scope module a $end ".repeat(200_000);
    vcd.push_str("$enddefinitions $end");
    survives("deep.vcd", vcd.as_bytes());
}

#[test]
fn quotes_that_never_close_take_no_quadratic_time() {
    let mut text = "time,signal,value\n".to_owned();
    text.push_str(&"\"a\n".repeat(500_000));
    survives("quotes.csv", text.as_bytes());
    survives(
        "quotes.csv",
        format!("time,signal,value\n{}", "x,\"y\"\"\n".repeat(200_000)).as_bytes(),
    );
    survives("quotes.csv", format!("time,signal,value\n\"{}", "\n".repeat(2_000_000)).as_bytes());
}
