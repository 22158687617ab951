//! Reads VCD files of any tool; reals are left out, x and z are passed over.

use std::io::{BufRead, BufReader, Cursor, ErrorKind, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use hashbrown::HashMap;
use runglight_engine::log::{Nanoseconds, SignalIndex};
use vcd::{Command, IdCode, Parser, ReferenceIndex, TimescaleUnit, Value, VarType};

use super::{OWN, names};
use crate::Reading;
use crate::error::{FormatError, RowFault};
use crate::format::Format;
use crate::intake::Intake;
use crate::options::ReadOptions;
use crate::source::Source;
use crate::time::{TimeFormat, TimeParser};

/// Words wider than this do not fit a value.
const WIDTH_MOST: u32 = 64;

/// Reads a value change dump.
pub(crate) fn read(
    path: &Path,
    source: Source,
    options: &ReadOptions,
) -> Result<Reading, FormatError> {
    let mut intake = Intake::new(path, Format::Vcd, options)?;
    for note in &source.notes {
        intake.report.note(*note);
    }
    // The parser wants white space behind the last token; many files end without a line end.
    let reader = BufReader::with_capacity(1 << 18, source.into_reader().chain(Cursor::new(b"\n")));
    catch_unwind(AssertUnwindSafe(|| Dump::new(Parser::new(reader)).read(intake)))
        .unwrap_or_else(|_| Err(FormatError::damaged(path, "VCD", "its parser gave up")))
}

struct Variable {
    scopes: Vec<String>,
    name: String,
    /// The name before our writer had to change it.
    original: Option<String>,
    kind: VarType,
    width: u32,
    signal: Option<SignalIndex>,
    left_out: bool,
}

struct Dump<R> {
    parser: Parser<R>,
    scopes: Vec<String>,
    variables: HashMap<IdCode, Variable>,
    order: Vec<IdCode>,
    originals: HashMap<String, String>,
    femtoseconds: u128,
    epoch: Option<Nanoseconds>,
    own: bool,
    now: Option<Nanoseconds>,
    unknown: u64,
    first: Option<(SignalIndex, i64)>,
    newest_row: Option<Nanoseconds>,
}

impl<R: BufRead> Dump<R> {
    fn new(parser: Parser<R>) -> Self {
        Self {
            parser,
            scopes: Vec::new(),
            variables: HashMap::new(),
            order: Vec::new(),
            originals: HashMap::new(),
            femtoseconds: 1_000_000,
            epoch: None,
            own: false,
            now: None,
            unknown: 0,
            first: None,
            newest_row: None,
        }
    }

    fn read(mut self, mut intake: Intake) -> Result<Reading, FormatError> {
        let mut defined = false;
        while !defined {
            let Some(command) = self.next(&intake)? else {
                let reason = "it breaks off before $enddefinitions";
                return Err(FormatError::damaged(&intake.path, "VCD", reason));
            };
            defined = command == Command::Enddefinitions;
            self.define(command, &mut intake)?;
        }
        self.name_signals(&mut intake);
        while let Some(command) = self.next(&intake)? {
            self.change(command, &mut intake)?;
        }
        // A time at the end without a change still proves that the recording went on.
        if let (Some(now), Some(newest), Some((signal, value))) =
            (self.now, self.newest_row, self.first)
            && now > newest
        {
            intake.push(now, signal, value);
        }
        if self.unknown > 0 {
            intake.report.note(format!("{} values x or z are passed over", self.unknown));
        }
        intake.finish()
    }

    fn next(&mut self, intake: &Intake) -> Result<Option<Command>, FormatError> {
        match self.parser.next() {
            None => Ok(None),
            Some(Ok(command)) => Ok(Some(command)),
            Some(Err(error)) if error.kind() == ErrorKind::InvalidData => {
                let found =
                    error.get_ref().and_then(|inner| inner.downcast_ref::<vcd::ParseError>());
                let found =
                    found.map_or_else(|| error.to_string(), |found| found.kind().to_string());
                let reason = RowFault::Syntax { found, expected: "a value change dump (VCD)" };
                Err(FormatError::BadRow {
                    path: intake.path.clone(),
                    row: self.parser.line(),
                    reason,
                })
            }
            Some(Err(error)) if error.kind() == ErrorKind::UnexpectedEof => {
                Err(FormatError::damaged(&intake.path, "VCD", "it breaks off in a command"))
            }
            Some(Err(error)) => Err(FormatError::io(&intake.path, "read this file", error)),
        }
    }

    fn define(&mut self, command: Command, intake: &mut Intake) -> Result<(), FormatError> {
        match command {
            Command::Comment(text) => self.comment(&text, intake),
            Command::Date(text) => self.epoch = self.epoch.or_else(|| date(&text)),
            Command::Timescale(number, unit) => {
                self.femtoseconds = u128::from(number) * femtoseconds(unit);
            }
            Command::ScopeDef(_, name) => {
                // A scope nested this deep is a defect, and its names would never end.
                if self.scopes.len() >= 1_000 {
                    return Err(FormatError::damaged(
                        &intake.path,
                        "VCD",
                        "its scopes are nested more than 1000 deep",
                    ));
                }
                self.scopes.push(name);
            }
            Command::Upscope => {
                self.scopes.pop();
            }
            Command::VarDef(kind, width, code, name, index) => {
                self.variable(kind, width, code, name, index, intake);
            }
            _ => {}
        }
        Ok(())
    }

    fn comment(&mut self, text: &str, intake: &mut Intake) {
        let Some(note) = text.strip_prefix(OWN) else { return };
        let note = note.trim();
        self.own = true;
        if let Some((_, encoded)) = note.strip_prefix("name ").and_then(|rest| rest.split_once(' '))
        {
            let code = note["name ".len()..].split(' ').next().unwrap_or_default();
            if let Some(name) = names::decode(encoded) {
                self.originals.insert(code.to_owned(), name);
            }
        } else if let Some(epoch) = note.strip_prefix("epoch_ns=") {
            self.epoch = epoch.parse().ok();
        } else if let Some(interval) = note.strip_prefix("scan_interval_ns=") {
            intake.scan_interval = interval.parse().ok();
        } else if let Some(gaps) = note.strip_prefix("gaps=") {
            intake.gaps = serde_json::from_str(gaps).unwrap_or_default();
        }
    }

    fn variable(
        &mut self,
        kind: VarType,
        width: u32,
        code: IdCode,
        name: String,
        index: Option<ReferenceIndex>,
        intake: &mut Intake,
    ) {
        let name = match index {
            Some(ReferenceIndex::BitSelect(bit)) => format!("{name}[{bit}]"),
            _ => name,
        };
        let reason = match kind {
            VarType::Real => Some("holds real numbers"),
            VarType::String => Some("holds text, not values"),
            _ if width > WIDTH_MOST => Some("is wider than 64 bits"),
            _ => None,
        };
        if let Some(reason) = reason {
            intake.report.leave_out(&name, reason);
        }
        if let Some(known) = self.variables.get(&code) {
            if known.name != name {
                intake.report.leave_out(&name, format!("is the same wire as {}", known.name));
            }
            return;
        }
        self.order.push(code);
        let original = self.originals.remove(&code.to_string());
        let scopes = self.scopes.clone();
        let left_out = reason.is_some();
        self.variables
            .insert(code, Variable { scopes, name, original, kind, width, signal: None, left_out });
    }

    /// Scopes that all variables share say nothing; the others are part of the name.
    fn name_signals(&mut self, intake: &mut Intake) {
        if self.epoch.is_none() {
            intake.report.note("the file has no date: its times are taken from 1970-01-01 on");
        }
        let roots: Vec<Option<&String>> =
            self.variables.values().map(|variable| variable.scopes.first()).collect();
        let shared = usize::from(roots.iter().all(|root| root.is_some() && *root == roots[0]));
        for variable in self.variables.values_mut() {
            variable.name = match variable.original.take() {
                Some(original) => original,
                None if self.own => std::mem::take(&mut variable.name),
                None => {
                    let mut parts = variable.scopes.split_off(shared.min(variable.scopes.len()));
                    parts.push(std::mem::take(&mut variable.name));
                    parts.join("-")
                }
            };
        }
    }

    fn change(&mut self, command: Command, intake: &mut Intake) -> Result<(), FormatError> {
        let row = self.parser.line();
        let (code, value) = match command {
            Command::Timestamp(ticks) => {
                self.now = self.time(ticks);
                if self.now.is_none() {
                    let found = format!("time {ticks} lies beyond the year 2261");
                    intake.bad(row, RowFault::Syntax { found, expected: "a time that fits" })?;
                }
                return Ok(());
            }
            Command::ChangeScalar(code, value) => (code, word([value].into_iter())),
            Command::ChangeVector(code, vector) => (code, word(vector.iter())),
            Command::ChangeReal(code, _) | Command::ChangeString(code, _) => {
                if let Some(variable) = self.variables.get_mut(&code)
                    && !variable.left_out
                {
                    variable.left_out = true;
                    intake.report.leave_out(&variable.name, "holds values that are no integers");
                }
                return Ok(());
            }
            _ => return Ok(()),
        };
        intake.report.rows += 1;
        let Some(variable) = self.variables.get_mut(&code) else {
            let found = format!("{code} is no variable of the header");
            return intake
                .bad(row, RowFault::Syntax { found, expected: "a code that $var defines" });
        };
        if variable.left_out {
            return Ok(());
        }
        let value = match value {
            Word::Known(bits) => signed(bits, variable.kind, variable.width),
            Word::Unknown => {
                self.unknown += 1;
                return Ok(());
            }
            Word::TooWide => {
                let found = format!("the value of {} has more than 64 bits", variable.name);
                return intake.bad(row, RowFault::Syntax { found, expected: "at most 64" });
            }
        };
        // Values before the first time are those the recording starts with.
        let epoch = self.epoch.unwrap_or(0);
        let time = *self.now.get_or_insert(epoch);
        if !intake.in_order(row, time)? {
            return Ok(());
        }
        let signal = match variable.signal {
            Some(signal) => signal,
            None => *variable.signal.insert(intake.names.intern(variable.name.as_bytes())),
        };
        if self.first.is_none_or(|(first, _)| first == signal) {
            self.first = Some((signal, value));
        }
        self.newest_row = self.newest_row.max(Some(time));
        intake.push(time, signal, value);
        Ok(())
    }

    fn time(&self, ticks: u64) -> Option<Nanoseconds> {
        let offset = u128::from(ticks).checked_mul(self.femtoseconds)? / 1_000_000;
        let time = i128::from(self.epoch.unwrap_or(0)) + i128::try_from(offset).ok()?;
        Nanoseconds::try_from(time).ok()
    }
}

enum Word {
    Known(u64),
    Unknown,
    TooWide,
}

fn word(bits: impl Iterator<Item = Value>) -> Word {
    let mut word: u64 = 0;
    for bit in bits {
        let bit = match bit {
            Value::V0 => 0,
            Value::V1 => 1,
            Value::X | Value::Z => return Word::Unknown,
        };
        if word >> 63 == 1 {
            return Word::TooWide;
        }
        word = word << 1 | bit;
    }
    Word::Known(word)
}

/// Integers are signed, wires are not; 64 bits are signed because values are.
fn signed(bits: u64, kind: VarType, width: u32) -> i64 {
    if kind == VarType::Integer && (1..64).contains(&width) {
        let shift = 64 - width;
        return ((bits << shift) as i64) >> shift;
    }
    bits as i64
}

const fn femtoseconds(unit: TimescaleUnit) -> u128 {
    match unit {
        TimescaleUnit::S => 1_000_000_000_000_000,
        TimescaleUnit::MS => 1_000_000_000_000,
        TimescaleUnit::US => 1_000_000_000,
        TimescaleUnit::NS => 1_000_000,
        TimescaleUnit::PS => 1_000,
        TimescaleUnit::FS => 1,
    }
}

/// ISO 8601, or the way C's `asctime` and simulators write dates.
fn date(text: &str) -> Option<Nanoseconds> {
    let text = text.split_ascii_whitespace().collect::<Vec<_>>().join(" ");
    [TimeFormat::Iso]
        .into_iter()
        .chain(
            [
                "%a %b %d %H:%M:%S %Y",
                "%b %d, %Y %H:%M:%S",
                "%B %d, %Y %H:%M:%S",
                "%d %B %Y %H:%M:%S",
                "%Y-%m-%d %H:%M:%S",
            ]
            .map(|pattern| TimeFormat::Pattern(pattern.to_owned())),
        )
        .find_map(|format| TimeParser::new(format, 0).parse(text.as_bytes()).ok())
}
