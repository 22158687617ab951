//! Event logs as XES, IEEE 1849: traces of events, γ as the attribute `runglight:class`.

use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use runglight_engine::plant::SignalClass;
use runglight_engine::process::event_log::{EventLog, EventLogBuilder};

use crate::error::{FormatError, RowFault};
use crate::lines::LineCounter;
use crate::output;
use crate::source::Source;
use crate::time::{self, TimeFormat, TimeParser};
use crate::xml::escaped;

const NAME: &str = "concept:name";
const TIME: &str = "time:timestamp";
const LIFECYCLE: &str = "lifecycle:transition";
const CLASS: &str = "runglight:class";

/// Reads an event log of any tool. Of events that have a life cycle, those of `complete` count
/// (all, where none is). Events without a time follow the one before them.
///
/// # Errors
/// No XES, or an event without a name or with a time that is none.
pub fn read(path: &Path) -> Result<EventLog, FormatError> {
    let source = Source::open(path)?;
    let lines = LineCounter::new(BufReader::with_capacity(1 << 18, source.into_reader()));
    let mut document = Document {
        path,
        xml: Reader::from_reader(lines),
        depth: 0,
        event: None,
        trace: None,
        traces: Vec::new(),
        parser: TimeParser::new(TimeFormat::Iso, 0),
        is_log: false,
        completes: false,
        last: 0,
    };
    document.read()?;
    Ok(document.finish())
}

/// Writes an event log; the file appears whole or not at all.
///
/// # Errors
/// A name that XML cannot hold, or what the file system refuses.
pub fn write(log: &EventLog, path: &Path) -> Result<(), FormatError> {
    let names = log.activities.iter().map(|activity| &activity.name).chain(&log.names);
    if names
        .into_iter()
        .any(|name| name.contains(|c: char| c.is_control() || matches!(c, '\u{FFFE}'..='\u{FFFF}')))
    {
        return Err(FormatError::Unwritable {
            path: path.to_owned(),
            format: "XES",
            reason: "a name holds a character that XML does not have; rename it".to_owned(),
        });
    }
    output::whole(path, |into| write_to(log, into))
}

fn write_to(log: &EventLog, into: &mut dyn Write) -> io::Result<()> {
    into.write_all(
        concat!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n",
            "<log xes.version=\"1849.2016\" xes.features=\"\" xmlns=\"http://www.xes-standard.org/\">\n",
            "\t<extension name=\"Concept\" prefix=\"concept\" uri=\"http://www.xes-standard.org/concept.xesext\"/>\n",
            "\t<extension name=\"Time\" prefix=\"time\" uri=\"http://www.xes-standard.org/time.xesext\"/>\n",
            "\t<extension name=\"Lifecycle\" prefix=\"lifecycle\" uri=\"http://www.xes-standard.org/lifecycle.xesext\"/>\n",
            "\t<classifier name=\"Activity\" keys=\"concept:name\"/>\n",
        )
        .as_bytes(),
    )?;
    let activities: Vec<String> = log
        .activities
        .iter()
        .map(|activity| {
            let mut text = format!(
                "<string key=\"{NAME}\" value=\"{}\"/><string key=\"{LIFECYCLE}\" value=\"complete\"/>",
                escaped(&activity.name)
            );
            if let Some(class) = activity.class {
                let class = class_name(class);
                text.push_str(&format!("<string key=\"{CLASS}\" value=\"{class}\"/>"));
            }
            text
        })
        .collect();
    let mut iso = Vec::new();
    for trace in 0..log.traces() {
        let name = escaped(&log.names[trace]);
        writeln!(into, "\t<trace>\n\t\t<string key=\"{NAME}\" value=\"{name}\"/>")?;
        for (&activity, &time) in log.trace(trace).iter().zip(log.times(trace)) {
            iso.clear();
            time::write_iso(time, &mut iso);
            write!(
                into,
                "\t\t<event>{}<date key=\"{TIME}\" value=\"",
                activities[activity as usize]
            )?;
            into.write_all(&iso)?;
            into.write_all(b"\"/></event>\n")?;
        }
        into.write_all(b"\t</trace>\n")?;
    }
    into.write_all(b"</log>\n")
}

fn class_name(class: SignalClass) -> &'static str {
    match class {
        SignalClass::Input => "input",
        SignalClass::Memory => "memory",
        SignalClass::Output => "output",
    }
}

#[derive(Debug, Default)]
struct OpenEvent {
    row: u64,
    depth: usize,
    name: Option<String>,
    time: Option<String>,
    lifecycle: Option<String>,
    class: Option<String>,
}

/// An event that was read.
struct Read {
    name: String,
    time: i64,
    complete: Option<bool>,
    class: Option<SignalClass>,
}

#[derive(Default)]
struct OpenTrace {
    depth: usize,
    name: Option<String>,
    events: Vec<Read>,
}

struct Document<'p, R: BufRead> {
    path: &'p Path,
    xml: Reader<LineCounter<R>>,
    depth: usize,
    event: Option<OpenEvent>,
    trace: Option<OpenTrace>,
    traces: Vec<OpenTrace>,
    parser: TimeParser,
    is_log: bool,
    completes: bool,
    last: i64,
}

impl<R: BufRead> Document<'_, R> {
    fn read(&mut self) -> Result<(), FormatError> {
        let mut buffer = Vec::new();
        loop {
            buffer.clear();
            let row = self.xml.get_ref().line();
            let event = self.xml.read_event_into(&mut buffer).map_err(|error| match error {
                quick_xml::Error::Io(error) => FormatError::io(
                    self.path,
                    "read this file",
                    io::Error::new(error.kind(), error.to_string()),
                ),
                error => self.syntax(row, error.to_string()),
            })?;
            match event {
                Event::Start(element) => {
                    self.open(&element, row)?;
                    self.depth += 1;
                }
                Event::Empty(element) => {
                    self.open(&element, row)?;
                    self.close()?;
                }
                Event::End(_) => {
                    self.depth = self.depth.saturating_sub(1);
                    self.close()?;
                }
                // Entities are the way to blow a small file up; no log needs its own.
                Event::DocType(_) => {
                    return Err(self.syntax(row, "a document type definition".to_owned()));
                }
                Event::Eof => break,
                _ => {}
            }
        }
        match (self.is_log, self.depth) {
            (true, 0) => Ok(()),
            (true, _) => Err(FormatError::damaged(self.path, "XES", "it breaks off before </log>")),
            (false, _) => Err(FormatError::damaged(self.path, "XES", "it has no <log> element")),
        }
    }

    fn syntax(&self, row: u64, found: String) -> FormatError {
        let reason =
            RowFault::Syntax { found, expected: "well-formed XML without entities of its own" };
        FormatError::BadRow { path: self.path.to_owned(), row, reason }
    }

    fn open(&mut self, element: &BytesStart<'_>, row: u64) -> Result<(), FormatError> {
        let tag = element.local_name();
        match tag.as_ref() {
            "log" if self.depth == 0 => self.is_log = true,
            _ if self.depth == 0 => {
                let found = format!("the root element is <{}>, not <log>", tag.as_ref());
                return Err(FormatError::damaged(self.path, "XES", found));
            }
            "trace" if self.trace.is_none() => {
                self.trace = Some(OpenTrace { depth: self.depth, ..OpenTrace::default() });
            }
            "event" if self.event.is_none() && self.trace.is_some() => {
                self.event = Some(OpenEvent { row, depth: self.depth, ..OpenEvent::default() });
            }
            _ => self.attribute(element, row)?,
        }
        Ok(())
    }

    fn attribute(&mut self, element: &BytesStart<'_>, row: u64) -> Result<(), FormatError> {
        let of_event = self.event.as_ref().is_some_and(|event| self.depth == event.depth + 1);
        let of_trace = self.event.is_none()
            && self.trace.as_ref().is_some_and(|trace| self.depth == trace.depth + 1);
        if !of_event && !of_trace {
            return Ok(());
        }
        let (mut key, mut text) = (String::new(), String::new());
        for attribute in element.attributes() {
            let attribute = attribute.map_err(|error| self.syntax(row, error.to_string()))?;
            let into = match attribute.key.as_ref() {
                "key" => &mut key,
                "value" => &mut text,
                _ => continue,
            };
            *into = attribute
                .normalized_value(XmlVersion::Explicit1_1)
                .map_err(|error| self.syntax(row, error.to_string()))?
                .into_owned();
        }
        match (&mut self.event, &mut self.trace, key.as_str()) {
            (Some(event), _, NAME) => event.name = Some(text),
            (Some(event), _, TIME) => event.time = Some(text),
            (Some(event), _, LIFECYCLE) => event.lifecycle = Some(text),
            (Some(event), _, CLASS) => event.class = Some(text),
            (None, Some(trace), NAME) => trace.name = Some(text),
            _ => {}
        }
        Ok(())
    }

    fn close(&mut self) -> Result<(), FormatError> {
        if let Some(event) = self.event.take_if(|event| event.depth == self.depth) {
            let row = event.row;
            let read = self.event_of(event).map_err(|reason| FormatError::BadRow {
                path: self.path.to_owned(),
                row,
                reason,
            })?;
            self.completes |= read.complete == Some(true);
            if let Some(trace) = &mut self.trace {
                trace.events.push(read);
            }
        }
        if let Some(trace) = self.trace.take_if(|trace| trace.depth == self.depth) {
            self.traces.push(trace);
        }
        Ok(())
    }

    fn event_of(&mut self, event: OpenEvent) -> Result<Read, RowFault> {
        let missing = RowFault::EmptyCell { column: NAME.to_owned(), expected: "an activity" };
        let name = event.name.filter(|name| !name.trim().is_empty()).ok_or(missing)?;
        if let Some(written) = &event.time {
            self.last = self
                .parser
                .parse(written.trim().as_bytes())
                .map_err(|expected| RowFault::cell(TIME, written.as_bytes(), expected))?;
        }
        Ok(Read {
            name,
            time: self.last,
            complete: event.lifecycle.map(|step| step.eq_ignore_ascii_case("complete")),
            class: event.class.as_deref().and_then(SignalClass::parse),
        })
    }

    fn finish(self) -> EventLog {
        let mut builder = EventLogBuilder::default();
        for trace in self.traces {
            for event in trace.events {
                if self.completes && event.complete == Some(false) {
                    continue;
                }
                builder.push(&event.name, event.time);
                if event.class.is_some() {
                    builder.set_class(&event.name, event.class);
                }
            }
            builder.end_trace(trace.name);
        }
        builder.finish()
    }
}
