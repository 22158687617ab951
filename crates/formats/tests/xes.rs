//! XES of other tools.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod scratch;

use scratch::{read_as, rows};

const S: i64 = 1_000_000_000;
const NOON: i64 = 1_713_182_400 * S;

fn event(name: &str, second: u32, more: &str) -> String {
    format!(
        "<event><string key=\"concept:name\" value=\"{name}\"/>\
         <date key=\"time:timestamp\" value=\"2024-04-15T14:00:{second:02}.000+02:00\"/>{more}</event>\n"
    )
}

fn log(traces: &[&[String]]) -> String {
    let traces: String = traces
        .iter()
        .map(|events| {
            format!(
                "<trace><string key=\"concept:name\" value=\"case\"/>{}</trace>\n",
                events.concat()
            )
        })
        .collect();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- made by hand -->\n<log xmlns=\"http://www.xes-standard.org/\">\n\
         <global scope=\"event\"><string key=\"concept:name\" value=\"none\"/></global>\n\
         <classifier name=\"a\" keys=\"concept:name\"/>{traces}</log>"
    )
}

#[test]
fn traces_are_merged_by_time_whatever_the_window() {
    let text =
        log(&[&[event("a", 1, ""), event("b", 9, "")], &[event("c", 1, ""), event("d", 2, "")]]);
    let reading = read_as("log.xes", text, r#"{"reorder_s": 0}"#).unwrap();
    let names: Vec<_> = rows(&reading.log).iter().map(|row| (row.0, row.1, row.2)).collect();
    let pulse = |second: i64, name| [(NOON + second * S, name, 1), (NOON + second * S, name, 0)];
    assert_eq!(names, [pulse(1, "a"), pulse(1, "c"), pulse(2, "d"), pulse(9, "b")].concat());
    assert!(reading.report.notes.iter().any(|note| note.contains("2 traces")));
    assert_eq!(reading.report.rows, 4);
}

#[test]
fn values_of_every_attribute() {
    for (attribute, expected) in [
        ("<int key=\"value\" value=\"7\"/>", 7),
        ("<boolean key=\"value\" value=\"true\"/>", 1),
        ("<string key=\"status\" value=\"OFF\"/>", 0),
        ("<float key=\"Value\" value=\"1.0\"/>", 1),
    ] {
        let text = log(&[&[event("a", 0, attribute)]]);
        let reading = read_as("log.xes", text, "{}").unwrap();
        assert_eq!(rows(&reading.log), [(NOON, "a", expected)], "{attribute}");
    }
}

#[test]
fn lifecycle_lasts_where_there_is_a_start() {
    let step = |name| format!("<string key=\"lifecycle:transition\" value=\"{name}\"/>");
    let text = log(&[&[event("a", 0, &step("start")), event("a", 5, &step("complete"))]]);
    let reading = read_as("log.xes", text, "{}").unwrap();
    assert_eq!(rows(&reading.log), [(NOON, "a", 1), (NOON + 5 * S, "a", 0)]);
    let text = log(&[&[event("a", 0, &step("complete"))]]);
    let reading = read_as("log.xes", text, "{}").unwrap();
    assert_eq!(rows(&reading.log), [(NOON, "a", 1), (NOON, "a", 0)]);
}

#[test]
fn attributes_of_attributes_are_no_attributes() {
    let nested = "<string key=\"note\" value=\"x\"><int key=\"value\" value=\"9\"/></string>";
    let text = log(&[&[event("a &lt;&#65;&amp;&gt;", 0, nested)]]);
    let reading = read_as("log.xes", text, "{}").unwrap();
    assert_eq!(rows(&reading.log)[0], (NOON, "a <A&>", 1));
}

#[test]
fn bad_events_are_counted() {
    let text = log(&[&[
        "<event/>\n".to_owned(),
        event("a", 0, ""),
        "<event><date key=\"time:timestamp\" value=\"soon\"/></event>".to_owned(),
    ]]);
    let reading = read_as("log.xes", text, r#"{"on_error": "skip"}"#).unwrap();
    assert_eq!((reading.report.rows, reading.report.bad_rows, reading.log.len()), (3, 2, 2));
    assert_eq!(reading.report.bad[0].row, 5);
}
