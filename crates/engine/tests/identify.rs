//! Identification by events, against what was worked out by hand, against the tables of Cadiou
//! 2019, and against a plain re-statement of its method.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot go on says why")]

use std::collections::BTreeSet;

use proptest::prelude::*;

use runglight_engine::identify::candidates::Candidate;
use runglight_engine::identify::sweep::{suggested, sweep};
use runglight_engine::identify::timeline::Window;
use runglight_engine::identify::trace::trace;
use runglight_engine::identify::view::View;
use runglight_engine::identify::{Identification, IdentifyError, Settings, identify};
use runglight_engine::log::{ChangeLog, ChangeLogBuilder, Gap, Nanoseconds, SECOND};

const MS: Nanoseconds = SECOND / 1000;

/// A log in seconds; `end_s` closes it with a sample.
fn log(rows: &[(f64, &str, i64)], end_s: f64) -> ChangeLog {
    let mut sorted = rows.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut builder = ChangeLogBuilder::default();
    let clock = builder.intern("clock");
    builder.push(0, clock, 0);
    for (time_s, signal, value) in sorted {
        let signal = builder.intern(signal);
        builder.push(ns(time_s), signal, value);
    }
    builder.push(ns(end_s), clock, 0);
    builder.finish()
}

/// A boolean that is OFF at 0 s and toggles at the given times.
fn toggles<'n>(name: &'n str, times_s: &[f64]) -> Vec<(f64, &'n str, i64)> {
    let toggles =
        times_s.iter().enumerate().map(|(at, &time_s)| (time_s, name, (at as i64 + 1) % 2));
    std::iter::once((0.0, name, 0)).chain(toggles).collect()
}

fn ns(time_s: f64) -> Nanoseconds {
    (time_s * 1000.0).round() as i64 * MS
}

fn found(log: &ChangeLog, events_s: &[f64], tau_s: f64, view: View) -> Identification {
    let events: Vec<Nanoseconds> = events_s.iter().map(|&event| ns(event)).collect();
    let settings = Settings { tau: ns(tau_s), view, share: 1.0, words: Vec::new() };
    identify(log, &events, &settings).unwrap()
}

fn scores(found: &Identification, name: &str) -> (f64, f64) {
    let ranked = found.ranked.iter().find(|ranked| ranked.name == name).unwrap();
    (ranked.score_in, ranked.score_out)
}

/// Windows [9, 11] and [19, 21] of a log from 0 to 30 s: areas of 9, 8 and 9 s.
#[test]
fn one_change_for_one_event_is_perfect() {
    let log = log(&toggles("Right", &[10.0, 20.4]), 30.0);
    let found = found(&log, &[10.0, 20.0], 1.0, View::All);
    assert_eq!(scores(&found, "Right"), (0.0, 0.0));
    assert_eq!(found.areas_s, [9.0, 8.0, 9.0]);
    assert_eq!(found.changing, 1);
}

#[test]
fn score_in_is_the_mean_over_windows_of_one_minus_the_ratio() {
    // 1 change for 1 event, then 2 changes for 1 event: (0 + (1 - 1/2)) / 2.
    let mut rows = toggles("Half", &[10.0, 19.5, 20.5]);
    // 1 change, then none: (0 + 1) / 2.
    rows.extend(toggles("Missing", &[10.0]));
    // 4 changes for 1 event, then none: (3/4 + 1) / 2.
    rows.extend(toggles("Busy", &[9.0, 9.5, 10.5, 11.0]));
    let found = found(&log(&rows, 30.0), &[10.0, 20.0], 1.0, View::All);
    assert_eq!(scores(&found, "Half"), (0.25, 0.0));
    assert_eq!(scores(&found, "Missing"), (0.5, 0.0));
    assert_eq!(scores(&found, "Busy"), (0.875, 0.0));
}

#[test]
fn score_out_is_the_mean_over_areas_of_changes_per_second() {
    // Areas of 9, 8 and 9 s: 1 change in the first, 2 in the second: (1/9 + 2/8 + 0) / 3.
    let rows = toggles("Noise", &[3.0, 13.0, 14.0]);
    let found = found(&log(&rows, 30.0), &[10.0, 20.0], 1.0, View::All);
    assert_eq!(scores(&found, "Noise"), (1.0, 0.1204));
}

#[test]
fn overlapping_windows_are_one_with_a_series_of_events() {
    // 10, 11.5 and 13 s with tau 1 s are one window [9, 14] of 3 events; 20 s is its own.
    let mut rows = toggles("Series", &[10.0, 11.5, 13.0, 20.0]);
    // 2 changes for 3 events, 1 for 1: ((1 - 2/3) + 0) / 2.
    rows.extend(toggles("Two", &[10.0, 13.0, 20.0]));
    let found = found(&log(&rows, 30.0), &[13.0, 20.0, 10.0, 11.5], 1.0, View::All);
    let windows: Vec<(i64, i64, u32)> = found
        .windows
        .iter()
        .map(|&Window { start, end, events }| (start / SECOND, end / SECOND, events))
        .collect();
    assert_eq!(windows, [(9, 14, 3), (19, 21, 1)]);
    assert_eq!(scores(&found, "Series"), (0.0, 0.0));
    assert_eq!(scores(&found, "Two"), (0.1667, 0.0));
}

#[test]
fn areas_of_width_zero_are_none() {
    // [0, 4] begins with the recording, [4, 8] touches it, and [26, 30] ends with it: two windows
    // and one area of 18 s.
    let mut rows = toggles("Right", &[2.0, 6.0, 28.0]);
    rows.extend(toggles("Between", &[10.0]));
    let found = found(&log(&rows, 30.0), &[2.0, 6.0, 28.0], 2.0, View::All);
    assert_eq!(found.windows.len(), 2);
    assert_eq!(found.areas_s, [18.0]);
    assert_eq!(scores(&found, "Right"), (0.0, 0.0));
    assert_eq!(scores(&found, "Between"), (1.0, 0.0556));
}

#[test]
fn without_any_area_nothing_happens_outside() {
    let found = found(&log(&toggles("A", &[5.0, 6.0]), 10.0), &[5.0], 60.0, View::All);
    assert!(found.areas_s.is_empty());
    assert_eq!(scores(&found, "A"), (0.5, 0.0));
}

#[test]
fn the_ends_of_a_window_belong_to_it() {
    let rows = toggles("Edges", &[8.0, 12.0, 12.001]);
    let found = found(&log(&rows, 30.0), &[10.0], 2.0, View::All);
    // Two changes inside, one outside of it: areas of 8 and 18 s.
    assert_eq!(scores(&found, "Edges"), (0.5, 0.0278));
}

#[test]
fn tau_may_be_nothing() {
    let found = found(&log(&toggles("A", &[5.0]), 10.0), &[5.0], 0.0, View::All);
    assert_eq!(scores(&found, "A"), (0.0, 0.0));
    assert_eq!(found.areas_s, [5.0, 5.0]);
}

/// 18 windows, one of them with 4 events: the values of the paper's Fig. 4.
#[test]
fn the_quarters_of_the_table_of_parts() {
    let single: Vec<f64> = (1..=17).map(|window| f64::from(window) * 20.0).collect();
    let series = [400.0, 401.0, 402.0, 403.0];
    let events: Vec<f64> = single.iter().chain(&series).copied().collect();
    // Windows with two changes, windows without, and changes in the window of 4 events.
    let cases = [
        ("0.0000", 0, 0, 4),
        ("0.0139", 0, 0, 3),
        ("0.0833", 3, 0, 4),
        ("0.0972", 3, 0, 3),
        ("0.1111", 2, 1, 4),
        ("0.1944", 5, 1, 4),
        ("0.3194", 0, 5, 1),
        ("0.3889", 0, 7, 4),
        ("0.4028", 0, 7, 3),
    ];
    let mut rows = Vec::new();
    for (name, twice, none, of_series) in cases {
        let mut times = Vec::new();
        for &event in single.iter().skip(none) {
            times.push(event);
        }
        for &event in single.iter().rev().take(twice) {
            times.push(event + 0.5);
        }
        times.extend(&series[..of_series]);
        times.sort_by(f64::total_cmp);
        rows.extend(toggles(name, &times));
    }
    let found = found(&log(&rows, 500.0), &events, 2.0, View::All);
    assert_eq!(found.windows.len(), 18);
    for (name, ..) in cases {
        assert_eq!(format!("{:.4}", scores(&found, name).0), name);
    }
}

/// 11 windows, one of them with 9 events: the values of the paper's Fig. 6.
#[test]
fn the_halves_and_ninths_of_the_table_of_the_conveyor() {
    let single: Vec<f64> = (1..=10).map(|window| f64::from(window) * 20.0).collect();
    let series: Vec<f64> = (0..9).map(|event| 300.0 + f64::from(event)).collect();
    let events: Vec<f64> = single.iter().chain(&series).copied().collect();
    let cases = [
        ("0.0000", 0, 0, 9),
        ("0.0657", 1, 0, 7),
        ("0.1010", 0, 1, 8),
        ("0.1313", 0, 1, 5),
        ("0.2424", 0, 2, 3),
        ("0.3737", 0, 4, 8),
    ];
    let mut rows = Vec::new();
    for (name, twice, none, of_series) in cases {
        let mut times: Vec<f64> = single[none..].to_vec();
        times.extend(single.iter().rev().take(twice).map(|event| event + 0.5));
        times.extend(&series[..of_series]);
        times.sort_by(f64::total_cmp);
        rows.extend(toggles(name, &times));
    }
    let found = found(&log(&rows, 400.0), &events, 2.0, View::All);
    assert_eq!(found.windows.len(), 11);
    for (name, ..) in cases {
        assert_eq!(format!("{:.4}", scores(&found, name).0), name);
    }
}

#[test]
fn words_are_ranked_with_their_bits() {
    // Bit 0 is the conveyor, bits 3 and 4 belong to others.
    let rows = [
        (0.0, "%MW74", 0b0_0000),
        (5.0, "%MW74", 0b0_1000),
        (10.0, "%MW74", 0b0_1001),
        (15.0, "%MW74", 0b1_0001),
        (20.0, "%MW74", 0b1_0000),
    ];
    let found = found(&log(&rows, 30.0), &[10.0, 20.0], 1.0, View::All);
    let names: Vec<&str> = found.ranked.iter().map(|ranked| ranked.name.as_str()).collect();
    assert_eq!(names, ["%MW74.0", "%MW74", "%MW74.4", "%MW74.3"]);
    assert_eq!(scores(&found, "%MW74.0"), (0.0, 0.0));
    // Two changes outside: 1/9, 1/8 and nothing over three areas.
    assert_eq!(scores(&found, "%MW74"), (0.0, 0.0787));
    assert_eq!(scores(&found, "%MW74.4"), (1.0, 0.0417));
}

#[test]
fn a_word_that_only_moves_its_lowest_bit_is_known_by_its_address_or_by_name() {
    let rows = [(0.0, "%MW7", 0), (0.0, "Status", 0), (5.0, "%MW7", 1), (5.0, "Status", 1)];
    let log = log(&rows, 10.0);
    let names = |words: &[&str]| -> Vec<String> {
        let words = words.iter().map(|&word| word.to_owned()).collect();
        let settings = Settings { share: 1.0, words, ..Settings::default() };
        identify(&log, &[ns(5.0)], &settings).unwrap().ranked.into_iter().map(|r| r.name).collect()
    };
    assert_eq!(names(&[]), ["%MW7", "%MW7.0", "Status"]);
    assert_eq!(names(&["Status"]), ["%MW7", "%MW7.0", "Status", "Status.0"]);
}

#[test]
fn a_bit_that_is_a_signal_of_its_own_is_not_there_twice() {
    let rows = [(0.0, "%MW7", 4), (0.0, "%MW7.0", 0), (5.0, "%MW7", 5), (5.0, "%MW7.0", 1)];
    let found = found(&log(&rows, 10.0), &[5.0], 1.0, View::All);
    let names: Vec<&str> = found.ranked.iter().map(|ranked| ranked.name.as_str()).collect();
    assert_eq!(names, ["%MW7", "%MW7.0"]);
}

#[test]
fn a_slot_is_found_by_its_rising_edge() {
    // A sensor sees each part for 0.6 s; the user declares one event a part.
    let rows = toggles("Sensor", &[10.0, 10.6, 20.0, 20.6]);
    let log = log(&rows, 30.0);
    let events = [10.0, 20.0];
    assert_eq!(scores(&found(&log, &events, 1.0, View::All), "Sensor"), (0.5, 0.0));
    assert_eq!(scores(&found(&log, &events, 1.0, View::Rising), "Sensor"), (0.0, 0.0));
    assert_eq!(scores(&found(&log, &events, 1.0, View::Falling), "Sensor"), (0.0, 0.0));
    // Whose falling edge comes late is told apart.
    assert_eq!(scores(&found(&log, &events, 0.3, View::Falling), "Sensor").0, 1.0);
}

#[test]
fn counters_count_by_increments() {
    let rows = [
        (0.0, "%MW33", 65_534),
        (10.0, "%MW33", 65_535),
        (15.0, "%MW34", 7),
        (15.0, "%MW34", 0),
        (20.0, "%MW33", 0),
    ];
    let found = found(&log(&rows, 30.0), &[10.0, 20.0], 1.0, View::Increments);
    assert_eq!(scores(&found, "%MW33"), (0.0, 0.0));
    assert_eq!(found.changing, 1, "a counter set back is no increment, and bits are no counters");
}

#[test]
fn copies_are_told_as_identical() {
    let mut rows = toggles("Conveyor", &[10.0, 20.0]);
    rows.extend(toggles("Copy", &[10.0, 20.0]));
    rows.extend(toggles("Near", &[10.0, 20.1]));
    // The inverse changes at the same moments: this recording cannot tell it apart.
    rows.extend([(0.0, "Standstill", 1), (10.0, "Standstill", 0), (20.0, "Standstill", 1)]);
    let found = found(&log(&rows, 30.0), &[10.0, 20.0], 1.0, View::All);
    let told: Vec<(&str, u32, u32)> =
        found.ranked.iter().map(|r| (r.name.as_str(), r.rank, r.same_as)).collect();
    assert_eq!(told, [("Conveyor", 1, 0), ("Copy", 1, 0), ("Near", 1, 2), ("Standstill", 1, 0)]);
}

#[test]
fn the_best_fifth_is_kept_rounded_up_with_its_ties() {
    // 11 signals change: a fifth is 2.2, so 3 are kept, and with the third all that tie with it.
    let names: Vec<String> = (0..11).map(|number| format!("S{number:02}")).collect();
    let mut rows = Vec::new();
    for (number, name) in names.iter().enumerate() {
        let times: &[f64] = match number {
            0 => &[10.0, 20.0],
            1 => &[10.0, 19.5, 20.5],
            2..=5 => &[10.0],
            _ => &[15.0],
        };
        rows.extend(toggles(name, times));
    }
    rows.extend([(0.0, "Constant", 1), (15.0, "Constant", 1)]);
    let log = log(&rows, 30.0);
    let settings = Settings { tau: SECOND, ..Settings::default() };
    let found = identify(&log, &[10 * SECOND, 20 * SECOND], &settings).unwrap();
    assert_eq!(found.changing, 11);
    let kept: Vec<&str> = found.ranked.iter().map(|ranked| ranked.name.as_str()).collect();
    assert_eq!(kept, ["S00", "S01", "S02", "S03", "S04", "S05"]);
    let ranks: Vec<u32> = found.ranked.iter().map(|ranked| ranked.rank).collect();
    assert_eq!(ranks, [1, 2, 3, 3, 3, 3]);
}

#[test]
fn gaps_count_for_nothing() {
    // Nothing is known of 12 to 18 s; at 18 s all signals are told as they stand.
    let mut rows = toggles("Right", &[10.0, 20.0]);
    rows.extend([(0.0, "Unseen", 0), (18.0, "Unseen", 1), (10.0, "Other", 0), (14.0, "Other", 1)]);
    let mut log = log(&rows, 30.0);
    log.gaps = vec![Gap { start: ns(12.0), end: ns(18.0) }];
    let found = found(&log, &[10.0, 15.0, 20.0], 1.0, View::All);
    // The event at 15 s is in the gap. The area between the windows is 11 to 19 s without it: 2 s.
    assert_eq!(found.unrecorded, [ns(15.0)]);
    assert_eq!(found.areas_s, [9.0, 2.0, 9.0]);
    assert_eq!(found.windows.len(), 2);
    assert_eq!(scores(&found, "Right"), (0.0, 0.0));
    assert_eq!(found.changing, 1, "what changed unseen did not change");
}

#[test]
fn an_event_beyond_the_end_hides_what_lies_around_it() {
    // The event at 31 s was declared after the recording had ended; its change at 29.5 s is
    // neither missed nor out of place, and the last area ends at 29 s.
    let mut rows = toggles("Right", &[10.0, 29.5]);
    rows.extend(toggles("Outside", &[20.0]));
    let found = found(&log(&rows, 30.0), &[10.0, 31.0], 2.0, View::All);
    assert_eq!(found.unrecorded, [ns(31.0)]);
    assert_eq!(found.areas_s, [8.0, 17.0]);
    assert_eq!(scores(&found, "Right"), (0.0, 0.0));
    assert_eq!(scores(&found, "Outside"), (1.0, 0.0294));
}

#[test]
fn what_cannot_be_done_is_said() {
    let log = log(&toggles("A", &[5.0]), 10.0);
    let settings = Settings::default();
    let error = |log: &ChangeLog, events: &[i64], settings: &Settings| {
        identify(log, events, settings).unwrap_err()
    };
    assert_eq!(error(&ChangeLog::default(), &[5], &settings), IdentifyError::NoRows);
    assert_eq!(error(&log, &[], &settings), IdentifyError::NoEvents);
    let end = 10 * SECOND;
    assert_eq!(
        error(&log, &[-1, 11 * SECOND], &settings),
        IdentifyError::NoneRecorded { events: 2, start: 0, end }
    );
    let backwards = Settings { tau: -SECOND, ..settings.clone() };
    assert_eq!(error(&log, &[5], &backwards), IdentifyError::Tau { tau_s: -1.0 });
    for share in [0.0, 1.1, f64::NAN] {
        let wrong = Settings { share, ..settings.clone() };
        assert!(matches!(error(&log, &[5], &wrong), IdentifyError::Share { .. }));
    }
}

#[test]
fn a_sweep_takes_the_windows_that_the_best_meets() {
    // The conveyor's events are declared up to 0.8 s late; another signal moves all the time.
    let changes = [20.0, 50.0, 80.0, 110.0, 140.0, 170.0];
    let declared = [20.3, 50.8, 80.5, 110.1, 140.7, 170.2];
    let mut rows = toggles("Conveyor", &changes);
    let busy: Vec<f64> = (1..190).map(|second| f64::from(second) + 0.5).collect();
    rows.extend(toggles("Busy", &busy));
    rows.extend(toggles("Every third", &[21.9, 81.9, 141.9]));
    let log = log(&rows, 190.0);
    let events = declared.map(ns);
    let taus = [0.2, 0.5, 1.0, 2.0, 5.0, 40.0].map(ns);
    let steps = sweep(&log, &events, &taus, &Settings::default()).unwrap();
    assert_eq!(steps.iter().map(|s| s.windows).collect::<Vec<_>>(), [6, 6, 6, 6, 6, 1]);
    let best = &steps[suggested(&steps).unwrap()];
    // At 0.5 s half the events are missed, at 1, 2 and 5 s all are met, at 40 s they are one.
    assert_eq!(best.tau, 2 * SECOND, "{steps:#?}");
    assert_eq!(best.met, 6.0);
    assert_eq!(best.best.as_ref().unwrap().name, "Conveyor");
    assert!(best.lead > 1.0);
    assert_eq!(suggested(&[]), None);
}

#[test]
fn a_trace_tells_when_a_candidate_changed() {
    let rows = [(0.0, "%MW7", 0), (5.0, "%MW7", 3), (6.0, "%MW7", 2), (8.0, "%MW7", 0)];
    let mut log = log(&rows, 10.0);
    log.gaps = vec![Gap { start: ns(7.0), end: ns(8.0) }];
    let signal = log.signals.iter().position(|name| name == "%MW7").unwrap() as u32;
    let wanted = [0, 1].map(|bit| Candidate { signal, bit: Some(bit) });
    let whole = [Candidate { signal, bit: None }];
    assert_eq!(trace(&log, &wanted, View::All), [vec![ns(5.0), ns(6.0)], vec![ns(5.0)]]);
    assert_eq!(trace(&log, &whole, View::Falling), [vec![ns(6.0)]]);
}

/// The method as the paper tells it, window by window and area by area.
fn by_the_paper(changes: &[i64], windows: &[Window], recorded: (i64, i64)) -> (f64, f64) {
    let inside =
        |from: i64, to: i64| changes.iter().filter(|&&c| from <= c && c <= to).count() as f64;
    let score_in: f64 = windows
        .iter()
        .map(|window| {
            let (e, c) = (f64::from(window.events), inside(window.start, window.end));
            1.0 - e.min(c) / e.max(c)
        })
        .sum::<f64>()
        / windows.len() as f64;
    let mut rates = Vec::new();
    let mut from = recorded.0;
    for at in 0..=windows.len() {
        let to = windows.get(at).map_or(recorded.1, |window| window.start);
        if to > from {
            let first = from + i64::from(at > 0);
            let last = to - i64::from(at < windows.len());
            rates.push(inside(first, last) / ((to - from) as f64 / SECOND as f64));
        }
        from = windows.get(at).map_or(to, |window| window.end);
    }
    let areas = rates.len().max(1) as f64;
    (score_in, rates.iter().sum::<f64>() / areas)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Any log, any events, any order of the signals.
    #[test]
    fn it_is_the_method_of_the_paper(
        rows in prop::collection::vec((0..60i64, 0..4usize, 0..8i64), 1..120),
        events in prop::collection::vec(0..60i64, 1..8),
        tau in 0..12i64,
        view in prop::sample::select(vec![View::All, View::Rising, View::Falling]),
        order in Just([0usize, 1, 2, 3]).prop_shuffle(),
    ) {
        let names = ["%M1", "%MW2", "Level", "40001"];
        let mut rows = rows;
        rows.sort_by_key(|row| row.0);
        let build = |order: &[usize; 4]| {
            let mut log = ChangeLog {
                signals: order.iter().map(|&s| names[s].to_owned()).collect(),
                ..ChangeLog::default()
            };
            for &(time, signal, value) in &rows {
                log.time.push(time * SECOND);
                log.signal.push(order.iter().position(|&s| s == signal).unwrap() as u32);
                log.value.push(if signal == 0 { value % 2 } else { value });
            }
            log
        };
        let log = build(&[0, 1, 2, 3]);
        let events: Vec<i64> = events.iter().map(|event| event * SECOND).collect();
        let settings = Settings { tau: tau * SECOND, view, share: 1.0, words: Vec::new() };
        let found = identify(&log, &events, &settings);
        let recorded = (log.time[0], log.time[log.len() - 1]);
        prop_assume!(events.iter().all(|event| (recorded.0..=recorded.1).contains(event)));
        let found = found.unwrap();
        let wanted: Vec<Candidate> = found.ranked.iter().map(|ranked| ranked.candidate).collect();
        let traces = trace(&log, &wanted, view);
        for (ranked, changes) in found.ranked.iter().zip(&traces) {
            let (score_in, score_out) = by_the_paper(changes, &found.windows, recorded);
            prop_assert!((ranked.score_in - score_in).abs() <= 0.000_050_1, "{}", ranked.name);
            prop_assert!((ranked.score_out - score_out).abs() <= 0.000_050_1, "{}", ranked.name);
            prop_assert_eq!(ranked.changes as usize, changes.len());
            prop_assert_eq!(&traces[ranked.same_as as usize], changes);
        }
        // All that changes is there, once.
        let there: BTreeSet<&Candidate> = wanted.iter().collect();
        prop_assert_eq!(there.len(), found.changing);

        let turned = identify(&build(&order), &events, &settings).unwrap();
        prop_assert_eq!(turned.windows, found.windows);
        let told = |found: &[runglight_engine::identify::ranking::Ranked]| -> Vec<_> {
            found.iter().map(|r| (r.name.clone(), r.rank, r.score_in, r.score_out, r.same_as)).collect()
        };
        prop_assert_eq!(told(&turned.ranked), told(&found.ranked));
    }
}
