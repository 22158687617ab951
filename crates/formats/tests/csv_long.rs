//! Long text logs: delimiters, headers, times, values, occurrences, order.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod scratch;

use scratch::{csv, csv_error, read_as, rows};

const S: i64 = 1_000_000_000;
/// 2024-04-15 12:00:00 UTC.
const NOON: i64 = 1_713_182_400 * S;

#[test]
fn paper_000_table_1_reads_as_printed() {
    let table = "14:45:34.17;Group2-Device1-Signal2;1\n\
                 14:46:57.12;Group1-Device3-Signal1;1\n\
                 14:48:14.31;Group2-Device1-Signa12;0\n\
                 14:49:19.23;Group1-Device1-Signal1;1\n\
                 14:52:41.15;Group1-Device1-Signal3;1\n";
    for header in ["", "Time stamp;Symbol name;Status\n"] {
        for delimiter in [";", ",", "\t", "|"] {
            let text = format!("{header}{table}").replace(';', delimiter);
            let reading = csv(&text);
            assert_eq!(reading.log.len(), 5);
            let first = (14 * 3600 + 45 * 60 + 34) * S + 170_000_000;
            assert_eq!(rows(&reading.log)[0], (first, "Group2-Device1-Signal2", 1));
            assert!(reading.report.notes.iter().any(|note| note.contains("1970-01-01")));
            let dated = read_as("log.csv", &text, r#"{"date": "2024-04-15"}"#).unwrap();
            assert_eq!(dated.log.time[0], NOON - 12 * 3600 * S + first);
        }
    }
}

#[test]
fn clocks_roll_over_at_midnight() {
    // A row of the old day may come late; forward by more than half a day is a pause.
    let text = "Time stamp,Symbol name,Status\n\
                23:59:59.9,a,1\n00:00:00.1,a,0\n23:59:59.95,b,1\n00:00:01,a,1\n13:30:00,a,0\n";
    let day = 86_400 * S;
    let expected = [day - S / 10, day - S / 20, day + S / 10, day + S, day + 48_600 * S];
    assert_eq!(csv(text).log.time, expected);
    // Half a day back or less is disorder, not midnight.
    let error = csv_error("time,signal,value\n13:30:00,a,1\n02:00:00,a,0\n", "{}");
    assert!(error.contains("row 3") && error.contains("earlier"), "{error}");
}

#[test]
fn headers_in_any_dress() {
    for header in [
        "time,signal,value",
        "TIMESTAMP,Tag,Value",
        "Time stamp,Symbol name,Status",
        "\"Date and Time\",\"Variable Name\",\"Value\"",
        "_TIMESTAMP,_NAME,_VALUE",
        "date,variable,STATE",
        " DateTime , address , status ",
        "date_time,symbol_name,VALUE",
    ] {
        let reading = csv(&format!("{header}\n2024-04-15T12:00:00Z,Motor,1\n"));
        assert_eq!(rows(&reading.log), [(NOON, "Motor", 1)], "{header}");
    }
}

#[test]
fn columns_of_sql_exports() {
    let reading = csv("id; date and time; variable name; value\n1;2024-04-15 12:00:00;Motor;1\n");
    assert_eq!(rows(&reading.log), [(NOON, "Motor", 1)]);
    assert_eq!(reading.report.left_out[0].column, "id");
    let reading =
        csv("_NAME,_NUMERICID,_VALUE,_TIMESTAMP,_QUALITY\nMotor,0,1,2024-04-15 12:00:00.000,192\n");
    assert_eq!(rows(&reading.log), [(NOON, "Motor", 1)]);
}

#[test]
fn every_time_format_is_found() {
    for (written, expected) in [
        ("2024-04-15T12:00:00Z", NOON),
        ("2024-04-15T12:00:00", NOON),
        ("2024-04-15 12:00:00.5", NOON + S / 2),
        ("\"2024-04-15 12:00:00,25\"", NOON + S / 4),
        ("2024-04-15T14:00:00.000000001+02:00", NOON + 1),
        ("2024-04-15T07:00:00-0500", NOON),
        ("2024-04-15 12:00:00 UTC", NOON),
        ("2024-04-15 12:00:00+00", NOON),
        ("2024/04/15 12:00:00", NOON),
        ("2024-04-15 12:00", NOON),
        ("1713182400", NOON),
        ("1713182400.123456789", NOON + 123_456_789),
        ("1.7131824e9", NOON),
        ("1713182400500", NOON + S / 2),
        ("1713182400000001", NOON + 1_000),
        ("1713182400000000001", NOON + 1),
        ("63601502741.055", 1_465_905_941_055_000_000),
        ("15-04-24 12:00:00.50", NOON + S / 2),
        ("15/04/2024 12:00:00", NOON),
        ("\"15/04/2024,12:00:00\"", NOON),
        ("15.04.2024 12:00:00", NOON),
        ("4/15/2024 12:00:00 PM", NOON),
    ] {
        let reading = csv(&format!("time,signal,value\n{written},a,1\n"));
        assert_eq!(
            rows(&reading.log),
            [(expected, "a", 1)],
            "{written}: {:?}",
            reading.report.notes
        );
    }
}

#[test]
fn times_of_one_minute_are_read_each_by_itself() {
    // One behind the other, so that each may lean on the one before.
    let written = [
        ("2024-04-15T12:00:00Z", NOON),
        ("2024-04-15T12:00:01.5Z", NOON + 3 * S / 2),
        ("2024-04-15T12:00:2Z", NOON + 2 * S),
        ("2024-04-15T12:00:03", NOON + 3 * S),
        ("2024-04-15T12:00:04.000000001999Z", NOON + 4 * S + 1),
        ("2024-04-15T12:00:05,25 +00:00", NOON + 5 * S + S / 4),
        ("2024-04-15T14:00:06+02:00", NOON + 6 * S),
        ("2024-04-15T14:00:07.5+0200", NOON + 15 * S / 2),
        ("2024-04-15T12:00:60Z", NOON + 60 * S),
        ("2024-04-15T12:00:60.5Z", NOON + 60 * S + S / 2),
        ("2024-04-15T12:01:00.75Z", NOON + 60 * S + 3 * S / 4),
        ("2024-04-15 12:01:01Z", NOON + 61 * S),
        ("2024-04-15 12:01:02Z", NOON + 62 * S),
        ("2024/04/15 12:01:03Z", NOON + 63 * S),
        ("2024-04-15T12:02", NOON + 120 * S),
        ("2024-04-15T12:02Z", NOON + 120 * S),
    ];
    let lines: String = written.iter().map(|(time, _)| format!("{time};a;1\n")).collect();
    let expected: Vec<i64> = written.iter().map(|&(_, time)| time).collect();
    assert_eq!(csv(&format!("time;signal;value\n{lines}")).log.time, expected);
    for wrong in ["61Z", "5xZ", ".5Z", "", "7.Z", "07.5X", "07.5+25:00"] {
        let right = "2024-04-15T12:02:00Z;a;1";
        let text = format!("time;signal;value\n{right}\n2024-04-15T12:02:{wrong};a;1\n");
        let error = csv_error(&text, "{}");
        assert!(error.contains("row 3"), "{wrong}: {error}");
    }
}

#[test]
fn a_quote_counts_for_its_own_line_wherever_it_stands() {
    // More than is read at once, and quotes far apart, close together, and over line ends.
    let mut text = String::from("time,signal,value\n");
    let mut expected = Vec::new();
    for row in 0..30_000 {
        let (name, cell) = match row {
            17 | 18 | 9_000 | 29_999 => ("a,\"b\"", "\"a,\"\"b\"\"\""),
            12_345 => ("two\nlines", "\"two\nlines\""),
            _ if row % 7_001 == 0 => ("quoted", "\"quoted\""),
            _ => ("plain", "plain"),
        };
        text += &format!("{}.0,{cell},1\n", 1_713_182_400 + row);
        expected.push((NOON + row * S, name, 1));
    }
    assert!(text.len() > 2 * (256 << 10));
    assert_eq!(rows(&csv(&text).log), expected);
}

#[test]
fn names_are_numbered_in_the_order_they_first_come() {
    // Among rows that are left out, and more than are numbered together.
    let mut text = String::from("time,signal,value\n");
    let mut names: Vec<String> = Vec::new();
    for row in 0..1_000_usize {
        let name = format!("signal{}", row * row % 501);
        let value = if row % 10 == 3 { "broken" } else { "1" };
        text += &format!("{},{name},{value}\n", 1_713_182_400 + row);
        if row % 10 != 3 && !names.contains(&name) {
            names.push(name);
        }
    }
    let reading = read_as("log.csv", &text, r#"{"on_error": "skip"}"#).unwrap();
    assert_eq!((reading.log.len(), reading.report.bad_rows), (900, 100));
    assert_eq!(reading.log.signals, names);
    let read = rows(&reading.log);
    let kept = (0..1_000_usize).filter(|row| row % 10 != 3);
    assert!(kept.zip(read).all(|(row, read)| read.1 == format!("signal{}", row * row % 501)));
}

#[test]
fn day_first_is_said() {
    let reading = csv("time,signal,value\n03-04-24 15:02:34.34,a,1\n");
    assert!(reading.report.notes.iter().any(|note| note.contains("day first")));
    let reading = csv("time,signal,value\n03/14/2024 15:02:34,a,1\n");
    assert!(reading.report.notes.iter().any(|note| note.contains("month first")));
}

#[test]
fn date_and_time_in_two_columns() {
    let reading = csv("Date,Time,Name,Value\n15/04/2024,12:00:00,a,1\n");
    assert_eq!(rows(&reading.log), [(NOON, "a", 1)]);
}

#[test]
fn an_unquoted_comma_between_date_and_time() {
    for text in [
        "Time stamp,Symbol name,Status\n15/04/2024,12:00:00,a,1\n15/04/2024,12:00:01,a,0\n",
        "15/04/2024,12:00:00,a,1\n15/04/2024,12:00:01,a,0\n",
    ] {
        let reading = csv(text);
        assert_eq!(rows(&reading.log), [(NOON, "a", 1), (NOON + S, "a", 0)]);
    }
}

#[test]
fn time_formats_by_option() {
    let pattern = r#"{"time_format": "%Y%m%d-%H%M%S%.f"}"#;
    let reading =
        read_as("log.csv", "time,signal,value\n20240415-120000.25,a,1\n", pattern).unwrap();
    assert_eq!(reading.log.time, [NOON + S / 4]);
    for (format, written, expected) in [
        ("s", "5.5", 5 * S + S / 2),
        ("ms", "5", 5_000_000),
        ("us", "5", 5_000),
        ("ns", "5", 5),
        ("s-year1", "62135596800", 0),
        ("clock", "00:00:01", S),
        ("iso", "1970-01-01", 0),
        ("%H:%M:%S", "00:00:02", 2 * S),
    ] {
        let json = format!(r#"{{"time_format": "{format}"}}"#);
        let reading = read_as("log.csv", format!("time,signal,value\n{written},a,1\n"), &json);
        assert_eq!(reading.unwrap().log.time, [expected], "{format}");
    }
}

#[test]
fn numbers_of_no_plausible_year_are_said() {
    let reading = csv("time,signal,value\n0,a,1\n0.5,a,0\n");
    assert_eq!(reading.log.time, [0, S / 2]);
    assert!(reading.report.notes[0].contains("time_format"));
    let reading = csv("time_ms,signal,value\n0,a,1\n500,a,0\n");
    assert_eq!(reading.log.time, [0, S / 2]);
}

#[test]
fn values_of_every_kind() {
    for (written, expected) in [
        ("1", 1),
        ("0", 0),
        ("true", 1),
        ("FALSE", 0),
        ("On", 1),
        ("OFF", 0),
        ("1.0", 1),
        ("0.0", 0),
        ("-7", -7),
        ("+7", 7),
        ("65535", 65_535),
        ("9223372036854775807", i64::MAX),
        ("-9223372036854775808", i64::MIN),
        ("12.000", 12),
        ("1e3", 1_000),
        ("\"1\"", 1),
        (" 1 ", 1),
        ("9007199254740993.0", 9_007_199_254_740_993),
    ] {
        let reading = csv(&format!("time,signal,value\n2024-04-15T12:00:00Z,a,{written}\n"));
        assert_eq!(reading.log.value, [expected], "{written}");
    }
    for written in ["1.5", "open", "1e30", "inf", "--1", "0x10", "1,5,", "9223372036854775808"] {
        csv_error(&format!("time,signal,value\n2024-04-15T12:00:00Z,a,{written}\n"), "{}");
    }
}

#[test]
fn traffic_controller_events_are_pulses() {
    let reading = csv("TimeStamp,DeviceId,EventId,Parameter\n2024-04-15 12:00:00.000,1136,1,5\n");
    assert_eq!(rows(&reading.log), [(NOON, "1136-5-1", 1), (NOON, "1136-5-1", 0)]);
    assert!(reading.report.notes[0].contains("occurrence"));
}

#[test]
fn signal_columns_without_value_are_pulses() {
    let json = r#"{"signal_columns": ["source", "info"]}"#;
    let text = "case,timestamp,source,info\n1,15-04-24 12:00:00,s1,Start\n";
    let reading = read_as("log.csv", text, json).unwrap();
    assert_eq!(rows(&reading.log), [(NOON, "s1-Start", 1), (NOON, "s1-Start", 0)]);
    let valued = "t,area,unit,value\n2024-04-15 12:00:00,North,Pump,1\n";
    let json = r#"{"signal_columns": ["area", "unit"], "time_column": "t"}"#;
    assert_eq!(rows(&read_as("log.csv", valued, json).unwrap().log), [(NOON, "North-Pump", 1)]);
}

#[test]
fn small_disorder_is_sorted_and_ties_keep_the_order_of_the_file() {
    let text = "time,signal,value\n10.0,a,1\n9.5,b,1\n10.0,c,1\n9.5,d,1\n";
    let reading = read_as("log.csv", text, r#"{"time_format": "s"}"#).unwrap();
    let names: Vec<&str> = rows(&reading.log).iter().map(|row| row.1).collect();
    assert_eq!(names, ["b", "d", "a", "c"]);
    let wide = r#"{"time_format": "s", "reorder_s": 0.1}"#;
    assert!(read_as("log.csv", text, wide).unwrap_err().contains("row 3"));
    let skip = r#"{"time_format": "s", "reorder_s": 0.1, "on_error": "skip"}"#;
    assert_eq!(read_as("log.csv", text, skip).unwrap().report.bad_rows, 2);
}

#[test]
fn repeated_rows_are_samples() {
    let reading = csv("time,signal,value\n2024-04-15,a,1\n2024-04-15,a,1\n2024-04-15,a,1\n");
    assert_eq!(reading.log.len(), 3);
}

#[test]
fn encodings_and_line_ends() {
    let text = "time,signal,value\n2024-04-15T12:00:00Z,Förderer,1\n";
    let expected = [(NOON, "Förderer", 1)];
    let utf_16 = |little: bool| -> Vec<u8> {
        let units = std::iter::once(0xFEFF).chain(text.encode_utf16());
        units
            .flat_map(|unit| if little { unit.to_le_bytes() } else { unit.to_be_bytes() })
            .collect()
    };
    let latin_1: Vec<u8> = text.chars().map(|character| character as u8).collect();
    for bytes in [
        text.as_bytes().to_vec(),
        format!("\u{FEFF}{text}").into_bytes(),
        text.replace('\n', "\r\n").into_bytes(),
        text.replace('\n', "\r").into_bytes(),
        text.trim_end().as_bytes().to_vec(),
        format!("sep=,\n{text}").into_bytes(),
        text.replace('\n', ",\n").into_bytes(),
        utf_16(true),
        utf_16(false),
        latin_1,
    ] {
        let reading = read_as("log.csv", &bytes, "{}").unwrap();
        assert_eq!(rows(&reading.log), expected, "{:?}", String::from_utf8_lossy(&bytes));
    }
}

#[test]
fn gzip_is_unpacked() {
    use std::io::Write;
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(b"time,signal,value\n2024-04-15T12:00:00Z,a,1\n").unwrap();
    let reading = read_as("log.csv.gz", packer.finish().unwrap(), "{}").unwrap();
    assert_eq!(rows(&reading.log), [(NOON, "a", 1)]);
}

#[test]
fn quoted_fields_may_hold_anything() {
    let text = "time,signal,value\n\"2024-04-15T12:00:00Z\",\"a, \"\"b\"\"\nc\",\"1\"\nbad,x,1\n";
    let error = csv_error(text, "{}");
    assert!(error.contains("row 4"), "{error}");
    let reading = read_as("log.csv", text, r#"{"on_error": "skip"}"#).unwrap();
    assert_eq!(rows(&reading.log), [(NOON, "a, \"b\"\nc", 1)]);
}

#[test]
fn header_alone_is_an_empty_log() {
    for text in ["time,signal,value\n", "time,signal,value", "time,A,B\n"] {
        let reading = csv(text);
        assert!(reading.log.is_empty() && reading.log.signals.is_empty());
        assert!(reading.report.notes.iter().any(|note| note.contains("no rows")), "{text}");
    }
}

#[test]
fn decimal_commas_and_semicolons() {
    let reading =
        csv("time;signal;value\n2024-04-15 12:00:00,500;a;1,0\n2024-04-15 12:00:00,750;a;0,0\n");
    assert_eq!(rows(&reading.log), [(NOON + S / 2, "a", 1), (NOON + S / 4 * 3, "a", 0)]);
    let clock = csv("14:45:34,17;a;1\n14:45:35,17;a;0\n");
    assert_eq!(clock.log.time[0] % S, 170_000_000);
}
