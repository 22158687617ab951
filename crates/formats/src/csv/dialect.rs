//! What a text file is like: delimiter, line ends, header and first rows.

use std::path::Path;

use super::records::{Found, Records};
use crate::error::{FormatError, RowFault};
use crate::layout::{Column, Kind, Layout, TimeColumns};
use crate::names;
use crate::options::ReadOptions;
use crate::value::Cell;

/// Rows that sniffing looks at.
const SAMPLE: usize = 500;
const DELIMITERS: [u8; 4] = *b"\t;|,";

/// How a file is written.
#[derive(Debug)]
pub(super) struct Dialect {
    pub(super) delimiter: u8,
    pub(super) newline: u8,
    /// Row of the header.
    pub(super) header_row: u64,
    /// True where the first record is data already.
    pub(super) headerless: bool,
    pub(super) columns: Vec<Column>,
    /// True where a column's name is no UTF-8.
    pub(super) latin_1: bool,
    /// The first rows of data.
    pub(super) sample: Vec<Vec<Vec<u8>>>,
}

impl Dialect {
    /// Looks at the head of a file.
    pub(super) fn sniff(
        path: &Path,
        head: &[u8],
        complete: bool,
        options: &ReadOptions,
    ) -> Result<Self, FormatError> {
        let newline = if memchr::memchr(b'\n', head).is_none() && head.contains(&b'\r') {
            b'\r'
        } else {
            b'\n'
        };
        // The last line of a head that was cut off is not whole.
        let head = match memchr::memrchr(newline, head) {
            Some(end) if !complete => &head[..end],
            _ => head,
        };
        let delimiter = delimiter(path, head, newline, options)?;
        let mut records = Vec::new();
        let mut header_row = 1;
        let mut reader = Records::new(head, delimiter, newline);
        while records.len() <= SAMPLE {
            let found =
                reader.advance().map_err(|error| FormatError::io(path, "read this file", error))?;
            match found {
                None => break,
                Some(Found::Record) if records.is_empty() && is_separator_line(reader.bytes()) => {}
                Some(Found::Record) => {
                    if records.is_empty() {
                        header_row = reader.row();
                    }
                    records.push(
                        (0..reader.len()).map(|field| reader.field(field).to_vec()).collect(),
                    );
                }
                Some(fault) if records.is_empty() => {
                    let reason = super::fault_of(&fault).unwrap_or(RowFault::OpenQuote);
                    return Err(FormatError::BadRow {
                        path: path.to_owned(),
                        row: reader.row(),
                        reason,
                    });
                }
                Some(_) => {}
            }
        }
        Self::from_records(path, records, delimiter, newline, header_row)
    }

    fn from_records(
        path: &Path,
        records: Vec<Vec<Vec<u8>>>,
        delimiter: u8,
        newline: u8,
        header_row: u64,
    ) -> Result<Self, FormatError> {
        let mut sample = records;
        if sample.is_empty() {
            return Err(FormatError::NotALog {
                path: path.to_owned(),
                found: "a file of blank lines",
                mend: "check that the export finished",
            });
        }
        let headerless = looks_like_data(&sample[0]);
        let mut header = if headerless { sample[0].clone() } else { sample.remove(0) };
        if let Some(date) = split_time(&header, &sample) {
            header[date] = b"date".to_vec();
            header.insert(date + 1, b"time".to_vec());
        }
        let columns = header
            .iter()
            .enumerate()
            .map(|(index, name)| Column {
                name: if headerless {
                    format!("column {}", index + 1)
                } else {
                    names::decode(name)
                },
                kind: Kind::of(
                    sample.iter().filter_map(|record| record.get(index)).map(Vec::as_slice),
                ),
            })
            .collect();
        let latin_1 = !headerless && header.iter().any(|name| std::str::from_utf8(name).is_err());
        Ok(Self { delimiter, newline, header_row, headerless, columns, latin_1, sample })
    }

    /// The layout of a file without header: paper 000's Table 1 has time, symbol name, status.
    pub(super) fn headerless_layout(&self, path: &Path) -> Result<Option<Layout>, FormatError> {
        if !self.headerless {
            return Ok(None);
        }
        let filled = self.columns.iter().rposition(|column| column.kind != Kind::Empty);
        let first = self.sample.first();
        let time = match filled {
            Some(2) => Some(TimeColumns { date: None, time: 0 }),
            Some(3) if first.is_some_and(|first| is_date_and_clock(&first[0], &first[1])) => {
                Some(TimeColumns { date: Some(0), time: 1 })
            }
            _ => None,
        };
        if let Some(time) = time {
            let (signal, value) = (vec![time.time + 1], Some(time.time + 2));
            return Ok(Some(Layout::Long { time, signal, value }));
        }
        Err(FormatError::Columns {
            path: path.to_owned(),
            row: self.header_row,
            role: "header row",
            columns: self.sample.first().map_or_else(Vec::new, |first| {
                first.iter().map(|cell| names::decode(cell)).collect()
            }),
            mend: "add one that names the columns, such as time,signal,value".to_owned(),
        })
    }

    /// The first row behind the header.
    pub(super) fn first_data_row(&self) -> u64 {
        self.header_row + u64::from(!self.headerless)
    }

    /// Names of the columns; a name that stands twice gets its place added.
    pub(super) fn unique_names(&self) -> Vec<String> {
        let mut seen = hashbrown::HashSet::new();
        self.columns
            .iter()
            .enumerate()
            .map(|(index, column)| {
                let mut name = column.name.clone();
                while !seen.insert(name.clone()) {
                    name = format!("{name}#{}", index + 1);
                }
                name
            })
            .collect()
    }
}

/// Excel's own way to say the delimiter.
fn is_separator_line(line: &[u8]) -> bool {
    line.len() <= 6 && line.to_ascii_lowercase().starts_with(b"sep=")
}

fn delimiter(
    path: &Path,
    head: &[u8],
    newline: u8,
    options: &ReadOptions,
) -> Result<u8, FormatError> {
    if let Some(asked) = options.delimiter {
        return u8::try_from(asked)
            .ok()
            .filter(|byte| byte.is_ascii() && !matches!(byte, b'"' | b'\n' | b'\r' | 0))
            .ok_or_else(|| FormatError::Option {
                path: path.to_owned(),
                option: "delimiter",
                found: asked.to_string(),
                expected: "one ASCII character such as , or ;",
            });
    }
    let mut lines = head
        .split(|byte| *byte == newline)
        .filter(|line| !line.trim_ascii().is_empty())
        .take(20)
        .peekable();
    if let Some(first) = lines.peek()
        && is_separator_line(first.trim_ascii())
        && let Some(&named) = first.trim_ascii().get(4)
    {
        return Ok(named);
    }
    let lines: Vec<&[u8]> = lines.collect();
    let Some(first) = lines.first() else { return Ok(b',') };
    // A delimiter stands in the first line, and as often in the others: a decimal comma does not.
    let score = |delimiter: &u8| {
        let fields = outside_quotes(first, *delimiter);
        let alike = lines.iter().filter(|line| outside_quotes(line, *delimiter) == fields).count();
        if fields == 0 { (0, 0) } else { (alike, fields) }
    };
    let best = DELIMITERS.iter().rev().max_by_key(|delimiter| score(delimiter));
    Ok(best.copied().unwrap_or(b','))
}

fn outside_quotes(line: &[u8], delimiter: u8) -> usize {
    let mut inside = false;
    let mut count = 0;
    for &byte in line {
        inside ^= byte == b'"';
        count += usize::from(byte == delimiter && !inside);
    }
    count
}

/// The date's place where `dd/mm/yyyy,hh:mm:ss` in a file with commas makes two fields of one
/// time, so that every row has one field more than the header.
fn split_time(header: &[Vec<u8>], sample: &[Vec<Vec<u8>>]) -> Option<usize> {
    let first = sample.first().filter(|first| first.len() == header.len() + 1)?;
    if sample.iter().any(|record| record.len() != first.len()) {
        return None;
    }
    first.windows(2).position(|pair| is_date_and_clock(&pair[0], &pair[1]))
}

fn is_date_and_clock(date: &[u8], clock: &[u8]) -> bool {
    let is_time = |cell: &[u8]| Kind::of([cell].into_iter()) == Kind::Time;
    let is_number = |cell: &[u8]| cell.iter().all(|byte| byte.is_ascii_digit() || *byte == b'.');
    !date.contains(&b':')
        && clock.contains(&b':')
        && is_time(date)
        && is_time(clock)
        && !(is_number(date) && date.iter().filter(|byte| **byte == b'.').count() < 2)
}

/// A first row with a time in it is no header.
fn looks_like_data(record: &[Vec<u8>]) -> bool {
    let is_time = |cell: &Vec<u8>| Kind::of([cell.as_slice()].into_iter()) == Kind::Time;
    let is_number = |cell: &Vec<u8>| matches!(Cell::parse(cell), Cell::Integer(_) | Cell::Real(_));
    record.len() > 1 && (record.first().is_some_and(is_time) || record.iter().all(is_number))
}
