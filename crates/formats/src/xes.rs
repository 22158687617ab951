//! XES, IEEE 1849: event logs of process mining.

use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

use quick_xml::Reader;
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use runglight_engine::log::{ChangeLog, Gap, Nanoseconds, SignalIndex};

use crate::Reading;
use crate::error::{FormatError, RowFault};
use crate::format::Format;
use crate::intake::Intake;
use crate::lines::LineCounter;
use crate::options::ReadOptions;
use crate::source::Source;
use crate::time::{self, TimeFormat, TimeParser};
use crate::value::{self, Cell};
use crate::xml::escaped;

const NAME: &str = "concept:name";
const TIME: &str = "time:timestamp";
const LIFECYCLE: &str = "lifecycle:transition";
const VALUES: [&str; 2] = ["value", "status"];
const SCAN_INTERVAL: &str = "runglight:scan_interval_ns";
const GAPS: &str = "runglight:gaps";

/// Reads all traces, merged by time.
pub(crate) fn read(
    path: &Path,
    source: Source,
    options: &ReadOptions,
) -> Result<Reading, FormatError> {
    let mut intake = Intake::new(path, Format::Xes, options)?;
    intake.accept_any_order();
    for note in &source.notes {
        intake.report.note(*note);
    }
    let lines = LineCounter::new(BufReader::with_capacity(1 << 18, source.into_reader()));
    let mut document = Document {
        xml: Reader::from_reader(lines),
        depth: 0,
        traces: 0,
        events: 0,
        event: None,
        marks: Vec::new(),
        parser: TimeParser::new(TimeFormat::Iso, 0),
        is_log: false,
    };
    document.read(&mut intake)?;
    document.finish(intake)
}

/// What an event says of its signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    Value(i64),
    Start,
    Complete,
    Occurrence,
}

/// The event being read.
#[derive(Debug, Default)]
struct OpenEvent {
    row: u64,
    depth: usize,
    name: Option<String>,
    time: Option<String>,
    value: Option<String>,
    lifecycle: Option<String>,
}

struct Document<R: BufRead> {
    xml: Reader<LineCounter<R>>,
    depth: usize,
    traces: u64,
    events: u64,
    event: Option<OpenEvent>,
    marks: Vec<(Nanoseconds, SignalIndex, Mark)>,
    parser: TimeParser,
    is_log: bool,
}

impl<R: BufRead> Document<R> {
    fn read(&mut self, intake: &mut Intake) -> Result<(), FormatError> {
        let mut buffer = Vec::new();
        loop {
            buffer.clear();
            let row = self.xml.get_ref().line();
            let event = self.xml.read_event_into(&mut buffer);
            let event = event.map_err(|error| match error {
                quick_xml::Error::Io(error) => FormatError::io(
                    &intake.path,
                    "read this file",
                    io::Error::new(error.kind(), error.to_string()),
                ),
                error => syntax(intake, row, error.to_string()),
            })?;
            match event {
                Event::Start(element) => {
                    let ended = self.open(&element, row, intake);
                    self.depth += 1;
                    ended?;
                }
                Event::Empty(element) => {
                    self.open(&element, row, intake)?;
                    self.close_event(intake)?;
                }
                Event::End(_) => {
                    self.depth = self.depth.saturating_sub(1);
                    self.close_event(intake)?;
                }
                // Entities are the way to blow a small file up; no log needs its own.
                Event::DocType(_) => {
                    return Err(syntax(intake, row, "a document type definition".to_owned()));
                }
                Event::Eof => break,
                _ => {}
            }
        }
        if !self.is_log {
            return Err(FormatError::damaged(&intake.path, "XES", "it has no <log> element"));
        }
        if self.depth > 0 {
            return Err(FormatError::damaged(&intake.path, "XES", "it breaks off before </log>"));
        }
        Ok(())
    }

    fn open(
        &mut self,
        element: &BytesStart<'_>,
        row: u64,
        intake: &mut Intake,
    ) -> Result<(), FormatError> {
        let tag = element.local_name();
        match tag.as_ref() {
            "log" if self.depth == 0 => self.is_log = true,
            _ if self.depth == 0 => {
                let found = format!("the root element is <{}>, not <log>", tag.as_ref());
                return Err(FormatError::damaged(&intake.path, "XES", found));
            }
            "trace" => self.traces += 1,
            "event" if self.event.is_none() => {
                self.events += 1;
                self.event = Some(OpenEvent { row, depth: self.depth, ..OpenEvent::default() });
            }
            _ => self.attribute(element, row, intake)?,
        }
        Ok(())
    }

    /// An attribute of the log or of the event; attributes of attributes are passed over.
    fn attribute(
        &mut self,
        element: &BytesStart<'_>,
        row: u64,
        intake: &mut Intake,
    ) -> Result<(), FormatError> {
        let of_log = self.depth == 1;
        let of_event = self.event.as_ref().is_some_and(|event| self.depth == event.depth + 1);
        if !of_log && !of_event {
            return Ok(());
        }
        let (mut key, mut text) = (String::new(), String::new());
        for attribute in element.attributes() {
            let attribute = attribute.map_err(|error| syntax(intake, row, error.to_string()))?;
            let into = match attribute.key.as_ref() {
                "key" => &mut key,
                "value" => &mut text,
                _ => continue,
            };
            *into = attribute
                .normalized_value(XmlVersion::Explicit1_1)
                .map_err(|error| syntax(intake, row, error.to_string()))?
                .into_owned();
        }
        if of_log {
            match key.as_str() {
                SCAN_INTERVAL => intake.scan_interval = text.parse().ok(),
                GAPS => intake.gaps = serde_json::from_str::<Vec<Gap>>(&text).unwrap_or_default(),
                _ => {}
            }
        }
        let Some(event) = self.event.as_mut().filter(|_| of_event) else { return Ok(()) };
        match key.as_str() {
            NAME => event.name = Some(text),
            TIME => event.time = Some(text),
            LIFECYCLE => event.lifecycle = Some(text),
            key if VALUES.iter().any(|name| key.eq_ignore_ascii_case(name)) => {
                event.value = Some(text);
            }
            _ => {}
        }
        Ok(())
    }

    /// Takes the event in where its element has ended.
    fn close_event(&mut self, intake: &mut Intake) -> Result<(), FormatError> {
        let Some(event) = self.event.take_if(|event| event.depth == self.depth) else {
            return Ok(());
        };
        intake.report.rows += 1;
        match self.row_of(&event, intake) {
            Ok(row) => {
                self.marks.push(row);
                Ok(())
            }
            Err(fault) => intake.bad(event.row, fault),
        }
    }

    fn row_of(
        &mut self,
        event: &OpenEvent,
        intake: &mut Intake,
    ) -> Result<(Nanoseconds, SignalIndex, Mark), RowFault> {
        let number = self.events;
        let missing =
            |attribute, expected| RowFault::Attribute { event: number, attribute, expected };
        let name = event.name.as_deref().filter(|name| !name.is_empty());
        let name = name.ok_or_else(|| missing(NAME, "the name of a signal"))?;
        let written = event.time.as_deref().ok_or_else(|| missing(TIME, "an ISO 8601 time"))?;
        let time = self
            .parser
            .parse(written.trim().as_bytes())
            .map_err(|expected| RowFault::cell(TIME, written.as_bytes(), expected))?;
        let mark = match (&event.value, event.lifecycle.as_deref()) {
            (Some(written), _) => match Cell::parse(written.trim().as_bytes()) {
                Cell::Integer(number) => Mark::Value(number),
                _ => return Err(RowFault::cell("value", written.as_bytes(), value::EXPECTED)),
            },
            (None, Some(step)) if step.eq_ignore_ascii_case("start") => Mark::Start,
            (None, Some(step)) if step.eq_ignore_ascii_case("complete") => Mark::Complete,
            _ => Mark::Occurrence,
        };
        Ok((time, intake.names.intern(name.as_bytes()), mark))
    }

    fn finish(mut self, mut intake: Intake) -> Result<Reading, FormatError> {
        self.marks.sort_by_key(|(time, _, _)| *time);
        let has = |wanted| self.marks.iter().any(|(_, _, mark)| *mark == wanted);
        // Many logs mark every event complete: without a start that says nothing of a duration.
        let lasting = has(Mark::Start) && has(Mark::Complete);
        let pulses = |mark: Mark| match mark {
            Mark::Value(_) => false,
            Mark::Start | Mark::Complete => !lasting,
            Mark::Occurrence => true,
        };
        if lasting {
            intake.report.note("lifecycle start and complete are read as values 1 and 0");
        }
        if self.marks.iter().any(|(_, _, mark)| pulses(*mark)) {
            intake.report.note(
                "events without a value are occurrences, written as value 1 and then 0 at the same time",
            );
        }
        if self.traces > 1 {
            intake.report.note(format!("{} traces are merged by time", self.traces));
        }
        for (time, signal, mark) in self.marks {
            match mark {
                mark if pulses(mark) => intake.push_pulse(time, signal),
                Mark::Value(number) => intake.push(time, signal, number),
                Mark::Start => intake.push(time, signal, 1),
                Mark::Complete | Mark::Occurrence => intake.push(time, signal, 0),
            }
        }
        self.parser.say(&mut intake.report);
        intake.finish()
    }
}

fn syntax(intake: &Intake, row: u64, found: String) -> FormatError {
    let reason =
        RowFault::Syntax { found, expected: "well-formed XML without entities of its own" };
    FormatError::BadRow { path: intake.path.clone(), row, reason }
}

/// True where XES can carry all names: no version of XML has a way to write NUL.
pub(crate) fn can_write(log: &ChangeLog) -> bool {
    !log.signals.iter().any(|name| name.contains(['\0', '\u{FFFE}', '\u{FFFF}']))
}

/// Writes one trace with one event per row.
pub(crate) fn write(log: &ChangeLog, into: &mut dyn Write) -> io::Result<()> {
    // XML 1.0 has no way to write control characters; 1.1 has.
    let old = |name: &String| name.chars().all(|c| c >= ' ' || matches!(c, '\t' | '\n' | '\r'));
    let version = if log.signals.iter().all(old) { "1.0" } else { "1.1" };
    writeln!(into, "<?xml version=\"{version}\" encoding=\"UTF-8\"?>")?;
    into.write_all(
        concat!(
            "<log xes.version=\"1849.2016\" xes.features=\"\" xmlns=\"http://www.xes-standard.org/\">\n",
            "\t<extension name=\"Concept\" prefix=\"concept\" uri=\"http://www.xes-standard.org/concept.xesext\"/>\n",
            "\t<extension name=\"Time\" prefix=\"time\" uri=\"http://www.xes-standard.org/time.xesext\"/>\n",
        )
        .as_bytes(),
    )?;
    if let Some(interval) = log.scan_interval {
        writeln!(into, "\t<int key=\"{SCAN_INTERVAL}\" value=\"{interval}\"/>")?;
    }
    if !log.gaps.is_empty() {
        let gaps = serde_json::to_string(&log.gaps).map_err(io::Error::other)?;
        writeln!(into, "\t<string key=\"{GAPS}\" value=\"{}\"/>", escaped(&gaps))?;
    }
    writeln!(into, "\t<trace>\n\t\t<string key=\"{NAME}\" value=\"recording\"/>")?;
    let names: Vec<String> = log.signals.iter().map(|name| escaped(name)).collect();
    let mut iso = Vec::new();
    for ((&time, &signal), &value) in log.time.iter().zip(&log.signal).zip(&log.value) {
        iso.clear();
        time::write_iso(time, &mut iso);
        let name = names.get(signal as usize).map_or("", String::as_str);
        write!(
            into,
            "\t\t<event><string key=\"{NAME}\" value=\"{name}\"/><date key=\"{TIME}\" value=\""
        )?;
        into.write_all(&iso)?;
        writeln!(into, "\"/><int key=\"value\" value=\"{value}\"/></event>")?;
    }
    into.write_all(b"\t</trace>\n</log>\n")
}
