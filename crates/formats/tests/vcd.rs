//! VCD of other tools, and what ours looks like.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod scratch;

use runglight_engine::log::ChangeLogBuilder;
use runglight_formats::write;
use scratch::{Scratch, read_as, rows};

const S: i64 = 1_000_000_000;

#[test]
fn a_simulator_s_dump() {
    let text = "$date Mon Apr 15 12:00:00 2024 $end\n$version some tool $end\n$timescale 10us $end\n\
        $scope module top $end\n$var wire 1 ! motor $end\n$var reg 8 \" speed [7:0] $end\n\
        $scope module station1 $end\n$var wire 1 # motor $end\n$var integer 32 % offset $end\n$var real 64 $ level $end\n$upscope $end\n\
        $var wire 1 ! motor_alias $end\n$upscope $end\n$enddefinitions $end\n\
        $dumpvars\n0!\nb101 \"\nx#\nb11111111111111111111111111111110 %\nr0.5 $\n$end\n\
        #5\n1!\n#100000\n1#\nb0 \"\nbz \"\n#200000";
    let reading = read_as("dump.vcd", text, "{}").unwrap();
    let start = 1_713_182_400 * S;
    assert_eq!(
        rows(&reading.log),
        [
            (start, "motor", 0),
            (start, "speed", 5),
            (start, "station1-offset", -2),
            (start + 50_000, "motor", 1),
            (start + S, "station1-motor", 1),
            (start + S, "speed", 0),
            (start + 2 * S, "motor", 1),
        ]
    );
    let left_out: Vec<&str> =
        reading.report.left_out.iter().map(|left_out| left_out.column.as_str()).collect();
    assert_eq!(left_out, ["level", "motor_alias"]);
    assert!(reading.report.notes.iter().any(|note| note.contains("2 values x or z")));
}

#[test]
fn a_dump_without_date_says_so() {
    let text = "$timescale 1 ms $end\n$var wire 1 ! a $end\n$enddefinitions $end\n#1\n1!";
    let reading = read_as("dump.vcd", text, "{}").unwrap();
    assert_eq!(rows(&reading.log), [(1_000_000, "a", 1)]);
    assert!(reading.report.notes.iter().any(|note| note.contains("1970")));
}

#[test]
fn ours_has_names_without_white_space() {
    let mut builder = ChangeLogBuilder::default();
    for (step, name) in ["Motor", "two words", "two_words", "a[3]", "$end", "%IX0.1", "Förderer"]
        .into_iter()
        .enumerate()
    {
        let signal = builder.intern(name);
        builder.push(1_713_182_400 * S + step as i64, signal, if step == 0 { -1 } else { 1 });
    }
    let log = builder.finish();
    let scratch = Scratch::new();
    let path = scratch.path("log.vcd");
    write(&log, &path, None).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let variables: Vec<&str> = text.lines().filter(|line| line.starts_with("$var")).collect();
    assert_eq!(
        variables,
        [
            "$var integer 64 ! Motor $end",
            "$var wire 1 \" two_words $end",
            "$var wire 1 # two_words_2 $end",
            "$var wire 1 $ a_3_ $end",
            "$var wire 1 % _end $end",
            "$var wire 1 & %IX0.1 $end",
            "$var wire 1 ' F_rderer $end",
        ]
    );
    assert!(text.contains("$timescale 1 ns $end"));
    assert!(
        text.contains("#0\nb1111111111111111111111111111111111111111111111111111111111111111 !\n")
    );
    assert_eq!(read_as("log.vcd", text, "{}").unwrap().log, log);
}
