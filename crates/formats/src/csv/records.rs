//! Splits bytes into records and fields: RFC 4180 with any delimiter, and any line ending.

use std::io::{self, Read};
use std::ops::Range;

/// The longest line a log may have.
pub(crate) const LINE_MOST: usize = 16 << 20;
/// The longest record whose quoted fields hold line breaks: beyond, a quote was left open.
const QUOTED_MOST: usize = 64 << 10;
/// Bytes read at once: few enough to stay in the processor's second cache.
const BLOCK: usize = 256 << 10;

/// Where a record was found, or why there is none.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// A record; its fields can be fetched.
    Record,
    /// A line longer than [`LINE_MOST`]; it is passed over.
    LongLine,
    /// A quoted field that is never closed; reading goes on behind its first line.
    OpenQuote,
}

/// Reads records block by block.
pub(crate) struct Records<R> {
    reader: R,
    delimiter: u8,
    newline: u8,
    buffer: Vec<u8>,
    /// Bytes of the buffer that are filled.
    filled: usize,
    /// Start of what is not yet read.
    start: usize,
    /// No quote stands between there and here.
    unquoted_until: usize,
    at_end: bool,
    next_row: u64,
    row: u64,
    record: Range<usize>,
    fields: Vec<Field>,
    unquoted: Vec<u8>,
}

/// Where splitting a record with quotes has come to; `at` counts from the record's start.
#[derive(Debug, Clone, Copy)]
enum Splitting {
    /// Before a field.
    Between { at: usize },
    /// Inside quotes; the field starts at `start` of the unquoted bytes.
    Inside { start: usize, at: usize },
    /// Behind the closing quote.
    Behind { start: usize, at: usize },
    /// Behind the last field.
    Done,
}

/// A field, from the record's start.
#[derive(Debug, Clone, Copy)]
struct Field {
    start: usize,
    end: usize,
    /// The field was quoted and stands, without quotes, in the second buffer.
    quoted: bool,
}

impl<R: Read> Records<R> {
    pub(crate) fn new(reader: R, delimiter: u8, newline: u8) -> Self {
        Self {
            reader,
            delimiter,
            newline,
            buffer: vec![0; BLOCK],
            filled: 0,
            start: 0,
            unquoted_until: 0,
            at_end: false,
            next_row: 1,
            row: 0,
            record: 0..0,
            fields: Vec::new(),
            unquoted: Vec::new(),
        }
    }

    /// Row of the record found last, as a text editor counts lines.
    pub(crate) fn row(&self) -> u64 {
        self.row
    }

    /// Bytes of the record found last.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.buffer[self.record.clone()]
    }

    /// Number of fields of the record found last.
    pub(crate) fn len(&self) -> usize {
        self.fields.len()
    }

    /// A field of the record found last, blanks around it taken off unless it was quoted; empty
    /// where the record is shorter.
    #[inline(always)]
    pub(crate) fn field(&self, index: usize) -> &[u8] {
        match self.fields.get(index) {
            Some(field) if field.quoted => &self.unquoted[field.start..field.end],
            Some(field) => {
                let start = self.record.start;
                trimmed(&self.buffer[start + field.start..start + field.end])
            }
            None => &[],
        }
    }

    /// Goes to the next record, passing blank lines; `None` at the end.
    pub(crate) fn advance(&mut self) -> io::Result<Option<Found>> {
        loop {
            let Some(end) = self.find_line_end(0)? else {
                self.skip_long_line()?;
                return Ok(Some(Found::LongLine));
            };
            if end == self.start && self.at_end && self.start == self.filled {
                return Ok(None);
            }
            self.row = self.next_row;
            self.next_row += 1;
            let line = self.start..end;
            if self.has_quote(&line) {
                return self.quoted(line).map(Some);
            }
            self.start = (end + 1).min(self.filled);
            self.record = without_return(&self.buffer, line);
            if trimmed(&self.buffer[self.record.clone()]).is_empty() {
                continue;
            }
            self.split_plain();
            return Ok(Some(Found::Record));
        }
    }

    /// Whether a quote stands in the next line. One look reaches as far as there is none, mostly
    /// over many lines.
    #[inline]
    fn has_quote(&mut self, line: &Range<usize>) -> bool {
        if line.end > self.unquoted_until {
            let from = self.unquoted_until.max(line.start);
            let quote = memchr::memchr(b'"', &self.buffer[from..self.filled]);
            self.unquoted_until = quote.map_or(self.filled, |quote| from + quote);
        }
        line.end > self.unquoted_until
    }

    fn split_plain(&mut self) {
        self.fields.clear();
        let record = &self.buffer[self.record.clone()];
        let mut start = 0;
        for end in memchr::memchr_iter(self.delimiter, record) {
            self.fields.push(Field { start, end, quoted: false });
            start = end + 1;
        }
        self.fields.push(Field { start, end: record.len(), quoted: false });
    }

    /// A record with quotes somewhere; `line` is its first line. A line end inside quotes belongs
    /// to the field, so the record grows line by line until its quotes are closed.
    fn quoted(&mut self, line: Range<usize>) -> io::Result<Found> {
        self.fields.clear();
        self.unquoted.clear();
        // Offsets count from the record's start: filling the buffer moves it.
        let mut end = line.len();
        let mut state = Splitting::Between { at: 0 };
        let mut lines = 0;
        loop {
            state = self.split_quoted(state, end);
            if matches!(state, Splitting::Done) {
                self.next_row += lines;
                let record = self.start..self.start + end;
                self.start = (record.end + 1).min(self.filled);
                self.record = without_return(&self.buffer, record);
                return Ok(Found::Record);
            }
            let exhausted = self.at_end && self.start + end >= self.filled;
            let next =
                if exhausted || end > QUOTED_MOST { None } else { self.find_line_end(end + 1)? };
            let Some(next) = next else {
                let first = self.find_line_end(0)?.unwrap_or(self.filled);
                self.start = (first + 1).min(self.filled);
                return Ok(Found::OpenQuote);
            };
            end = next - self.start;
            lines += 1;
        }
    }

    /// Splits on to a line end, `end` bytes behind the start.
    fn split_quoted(&mut self, mut state: Splitting, end: usize) -> Splitting {
        let line = &self.buffer[self.start..self.start + end];
        let content = line.strip_suffix(b"\r").unwrap_or(line).len();
        loop {
            state = match state {
                Splitting::Between { at } => {
                    let blanks = line[at..content].iter().take_while(|byte| **byte == b' ').count();
                    if line[at..content].get(blanks) == Some(&b'"') {
                        Splitting::Inside { start: self.unquoted.len(), at: at + blanks + 1 }
                    } else {
                        let next = memchr::memchr(self.delimiter, &line[at..content]);
                        let end = next.map_or(content, |next| at + next);
                        self.fields.push(Field { start: at, end, quoted: false });
                        next.map_or(Splitting::Done, |_| Splitting::Between { at: end + 1 })
                    }
                }
                Splitting::Inside { start, at } => {
                    let Some(quote) = memchr::memchr(b'"', &line[at..]) else {
                        self.unquoted.extend_from_slice(&line[at..]);
                        return Splitting::Inside { start, at: end };
                    };
                    self.unquoted.extend_from_slice(&line[at..at + quote]);
                    let at = at + quote + 1;
                    if line.get(at) == Some(&b'"') {
                        self.unquoted.push(b'"');
                        Splitting::Inside { start, at: at + 1 }
                    } else {
                        Splitting::Behind { start, at: at.min(content) }
                    }
                }
                // What follows the closing quote still belongs to the field.
                Splitting::Behind { start, at } => {
                    let next = memchr::memchr(self.delimiter, &line[at..content]);
                    let end = next.map_or(content, |next| at + next);
                    self.unquoted.extend_from_slice(line[at..end].trim_ascii());
                    self.fields.push(Field { start, end: self.unquoted.len(), quoted: true });
                    next.map_or(Splitting::Done, |_| Splitting::Between { at: end + 1 })
                }
                Splitting::Done => return Splitting::Done,
            };
        }
    }

    /// The first line end at or behind `offset` from the start; `None` where the line is too long.
    /// The end of the file ends a line.
    fn find_line_end(&mut self, offset: usize) -> io::Result<Option<usize>> {
        let mut searched = self.start + offset;
        loop {
            if searched < self.filled
                && let Some(found) =
                    memchr::memchr(self.newline, &self.buffer[searched..self.filled])
            {
                return Ok(Some(searched + found));
            }
            if self.at_end {
                return Ok(Some(self.filled));
            }
            let known = self.filled - self.start;
            if known > LINE_MOST {
                return Ok(None);
            }
            self.fill()?;
            searched = self.start + known.max(offset);
        }
    }

    fn skip_long_line(&mut self) -> io::Result<()> {
        self.row = self.next_row;
        self.next_row += 1;
        loop {
            self.start = self.filled;
            self.fill()?;
            if let Some(end) = memchr::memchr(self.newline, &self.buffer[self.start..self.filled]) {
                self.start += end + 1;
                return Ok(());
            }
            if self.at_end {
                self.start = self.filled;
                return Ok(());
            }
        }
    }

    /// Moves what is left to the front and reads on.
    fn fill(&mut self) -> io::Result<()> {
        self.buffer.copy_within(self.start..self.filled, 0);
        self.filled -= self.start;
        self.unquoted_until = self.unquoted_until.saturating_sub(self.start);
        self.start = 0;
        if self.filled == self.buffer.len() {
            self.buffer.resize(2 * self.filled, 0);
        }
        loop {
            match self.reader.read(&mut self.buffer[self.filled..]) {
                Ok(0) => self.at_end = true,
                Ok(read) => self.filled += read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            }
            return Ok(());
        }
    }
}

#[inline]
fn trimmed(bytes: &[u8]) -> &[u8] {
    match bytes {
        // Nothing to take off, as in nearly every field.
        [first, .., last] if *first > b' ' && *last > b' ' => bytes,
        _ => without_blanks(bytes),
    }
}

fn without_blanks(mut bytes: &[u8]) -> &[u8] {
    while let [b' ' | b'\t', rest @ ..] = bytes {
        bytes = rest;
    }
    while let [rest @ .., b' ' | b'\t' | b'\r'] = bytes {
        bytes = rest;
    }
    bytes
}

/// A line without the carriage return of Windows line ends.
fn without_return(buffer: &[u8], mut line: Range<usize>) -> Range<usize> {
    if line.end > line.start && buffer[line.end - 1] == b'\r' {
        line.end -= 1;
    }
    line
}
