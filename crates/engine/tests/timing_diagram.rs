//! What a timing diagram draws, at every scale.

use runglight_engine::log::ChangeLog;
use runglight_engine::timing_diagram::{Edge, Span, TimingDiagram};

fn diagram(rows: &[(i64, u32, i64)]) -> TimingDiagram {
    TimingDiagram::of(&ChangeLog {
        signals: vec!["A".into(), "B".into()],
        time: rows.iter().map(|row| row.0).collect(),
        signal: rows.iter().map(|row| row.1).collect(),
        value: rows.iter().map(|row| row.2).collect(),
        ..ChangeLog::default()
    })
}

fn span(start: i64, value: i64, changes: u32) -> Span {
    Span { start, value, changes, known: true }
}

#[test]
fn changes_far_apart_are_drawn_where_they_were() {
    let spans = diagram(&[(0, 0, 0), (100, 0, 1), (500, 0, 0)]).spans(0, 0, 1000, 10);
    assert_eq!(spans, [span(0, 0, 0), span(100, 1, 0), span(500, 0, 0)]);
}

#[test]
fn a_pulse_of_one_scan_is_seen_in_a_view_of_a_year() {
    const YEAR: i64 = 365 * 86_400 * 1_000_000_000;
    let at = YEAR / 3;
    let spans = diagram(&[(0, 0, 0), (at, 0, 1), (at + 1, 0, 0)]).spans(0, 0, YEAR, 1000);
    assert_eq!(spans, [span(0, 0, 0), span(at, 1, 0), span(at + 1, 0, 0)]);
}

#[test]
fn busy_columns_in_a_row_are_one_span_with_all_their_changes() {
    let rows: Vec<_> = (0..=100).map(|n| (n * 10, 0, n % 2)).collect();
    let spans = diagram(&rows).spans(0, -1, 2000, 10);
    assert!(!spans[0].known);
    assert_eq!(&spans[1..], [span(0, 0, 98), span(990, 1, 0), span(1000, 0, 0)]);
}

#[test]
fn no_change_is_lost_at_any_scale() {
    let mut state = 7_u64;
    let mut time = 0_i64;
    let mut rows = vec![(0, 0, 0)];
    for n in 1..5000_i64 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        time += 1 + (state >> 54) as i64 * if n % 50 == 0 { 1000 } else { 1 };
        rows.push((time, 0, n % 2));
    }
    let diagram = diagram(&rows);
    for columns in [1, 2, 7, 100, 1000, 4_000_000] {
        let spans = diagram.spans(0, 0, time + 1, columns);
        let drawn: u64 = spans[1..].iter().map(|span| 1 + u64::from(span.changes)).sum();
        assert_eq!(drawn, 4999, "{columns} columns");
        assert!(spans.windows(2).all(|pair| pair[0].start <= pair[1].start));
        assert!(spans.len() as u64 <= 3 * u64::from(columns) + 1);
    }
}

#[test]
fn the_value_before_the_window_is_known_and_before_the_first_row_is_not() {
    let diagram = diagram(&[(10, 0, 7), (90, 0, 8)]);
    assert_eq!(diagram.spans(0, 50, 60, 5), [span(50, 7, 0)]);
    assert_eq!(diagram.spans(0, 0, 5, 5), [Span { known: false, ..span(0, 0, 0) }]);
    assert_eq!(diagram.spans(1, 0, 5, 5), [Span { known: false, ..span(0, 0, 0) }]);
}

#[test]
fn windows_without_length_and_lanes_that_are_not_there_are_empty() {
    let diagram = diagram(&[(10, 0, 7)]);
    assert!(diagram.spans(0, 5, 5, 10).is_empty());
    assert!(diagram.spans(9, 0, 5, 10).is_empty());
    assert_eq!(diagram.spans(0, i64::MIN, i64::MAX, 10).len(), 2);
}

#[test]
fn edges_are_found_forwards_and_backwards() {
    let diagram = diagram(&[(0, 0, 0), (10, 0, 1), (10, 1, 5), (20, 0, 0)]);
    let edge = |time, value| Some(Edge { time, value });
    assert_eq!(diagram.next_edge(0, 0), edge(10, 1));
    assert_eq!(diagram.next_edge(0, 20), None);
    assert_eq!(diagram.previous_edge(0, 20), edge(10, 1));
    assert_eq!(diagram.previous_edge(0, 0), None);
    assert_eq!(diagram.edges(0, 5, 20, 9), [Edge { time: 10, value: 1 }]);
}

#[test]
fn what_is_appended_goes_on_and_what_is_forgotten_leaves_its_level() {
    let mut diagram = diagram(&[(0, 0, 0), (10, 0, 1)]);
    diagram.append(&[20, 30, 30], &[0, 0, 3], &[1, 0, 4]);
    assert_eq!((diagram.lanes(), diagram.changes(0), diagram.changes(3)), (4, 3, 1));
    assert_eq!(diagram.value_range(0), Some((0, 1)));
    diagram.forget_before(25);
    assert_eq!(diagram.spans(0, 25, 40, 10), [span(25, 1, 0), span(30, 0, 0)]);
}
