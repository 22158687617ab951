//! What can go wrong with a file. Variants carry the data; `Display` holds the wording: one
//! sentence with the file, the place, what was expected and how to mend it.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use runglight_engine::bits::SplitError;
use runglight_engine::log::LogError;
use thiserror::Error;

/// Why a file could not be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The file system refused.
    #[error("{}: cannot {action}: {}", Shown(path), OneLine(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried, as a verb: "read this file".
        action: &'static str,
        /// What the system said.
        source: io::Error,
    },
    /// There is no such file.
    #[error("{}: there is no such file; check the path", Shown(path))]
    Missing {
        /// The path given.
        path: PathBuf,
    },
    /// The path is a directory, a pipe or a device.
    #[error("{}: is {found}, not a file; name the log file itself", Shown(path))]
    NotAFile {
        /// The path given.
        path: PathBuf,
        /// What it is instead.
        found: &'static str,
    },
    /// The file has no bytes.
    #[error("{}: is empty (0 bytes); check that the export finished", Shown(path))]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The bytes belong to some other kind of file.
    #[error("{}: this is {found}, not a log: {mend}", Shown(path))]
    NotALog {
        /// The file.
        path: PathBuf,
        /// What the bytes look like.
        found: &'static str,
        /// How to mend it.
        mend: &'static str,
    },
    /// Neither the name nor the ending tells the format.
    #[error(
        "{}: no format is known by {}; use csv, parquet, xes or vcd",
        Shown(path),
        Quoted(found)
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// The format name or file ending found.
        found: String,
    },
    /// An option cannot be used.
    #[error("{}: option {option} is {}, expected {expected}", Shown(path), Quoted(found))]
    Option {
        /// The file being read.
        path: PathBuf,
        /// Name of the option.
        option: &'static str,
        /// What was given.
        found: String,
        /// What would do.
        expected: &'static str,
    },
    /// A column that was named is not there.
    #[error(
        "{}: has no column {} (option {option}); its columns are {}",
        Shown(path),
        Quoted(column),
        List(columns)
    )]
    UnknownColumn {
        /// The file.
        path: PathBuf,
        /// The option that named the column.
        option: &'static str,
        /// The column asked for.
        column: String,
        /// The columns there are.
        columns: Vec<String>,
    },
    /// The columns do not say which is which.
    #[error(
        "{}: row {row}: no {role} found among the columns {}; {}",
        Shown(path),
        List(columns),
        OneLine(mend)
    )]
    Columns {
        /// The file.
        path: PathBuf,
        /// Row of the header.
        row: u64,
        /// What was looked for: "time column".
        role: &'static str,
        /// The columns there are.
        columns: Vec<String>,
        /// How to mend it.
        mend: String,
    },
    /// A row cannot be used.
    #[error("{}: row {row}: {reason}; mend the row, or read with on_error=skip", Shown(path))]
    BadRow {
        /// The file.
        path: PathBuf,
        /// Row, as a text editor shows it; in Parquet the data row, from 1.
        row: u64,
        /// What is wrong with it.
        reason: RowFault,
    },
    /// The file breaks off or its structure is damaged.
    #[error(
        "{}: not a readable {format} file: {}; export or copy it again",
        Shown(path),
        OneLine(reason)
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The format it should have.
        format: &'static str,
        /// What the decoder found.
        reason: String,
    },
    /// Unpacking would give far more bytes than a log has.
    #[error(
        "{}: unpacks to more than {limit_mib} MiB from {packed_mib} MiB, which no log does; unpack it yourself if it is one",
        Shown(path)
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Size of the file in MiB.
        packed_mib: u64,
        /// Where reading stopped, in MiB.
        limit_mib: u64,
    },
    /// Arrow columns that are not a change log.
    #[error("the table is not a change log: {0}")]
    Table(TableFault),
    /// Columns of a table are out of order or of different length.
    #[error(transparent)]
    Log(#[from] LogError),
    /// Words cannot be split into bits.
    #[error("{}: {source}", Shown(path))]
    Words {
        /// The file.
        path: PathBuf,
        /// Which word, and why.
        source: SplitError,
    },
    /// A log cannot be expressed in the format asked for.
    #[error("{}: cannot be written as {format}: {reason}", Shown(path))]
    Unwritable {
        /// The file to write.
        path: PathBuf,
        /// The format asked for.
        format: &'static str,
        /// What stands against it.
        reason: String,
    },
}

/// What is wrong with an Arrow table.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum TableFault {
    /// A column is missing.
    #[error(
        "it has no column {}, only {}; name its columns time, signal and value",
        Quoted(column),
        List(columns)
    )]
    Missing {
        /// The column looked for.
        column: &'static str,
        /// The columns there are.
        columns: Vec<String>,
    },
    /// A column has a type that cannot be used.
    #[error("column {} has type {found}, expected {expected}", Quoted(column))]
    Type {
        /// The column.
        column: String,
        /// Its type.
        found: String,
        /// What would do.
        expected: &'static str,
    },
    /// One row cannot be used.
    #[error("row {row}: {reason}")]
    Row {
        /// Row over all batches, from 1.
        row: u64,
        /// What is wrong with it.
        reason: RowFault,
    },
    /// A batch could not be fetched.
    #[error("{}", OneLine(reason))]
    Source {
        /// What the source said.
        reason: String,
    },
}

/// What is wrong with one row.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum RowFault {
    /// A cell does not hold what its column needs.
    #[error("{} is {}, expected {expected}", Column(column), Quoted(found))]
    Cell {
        /// The column's name.
        column: String,
        /// The text found, shortened.
        found: String,
        /// What would do.
        expected: &'static str,
    },
    /// A cell is empty or null.
    #[error("{} is empty, expected {expected}", Column(column))]
    EmptyCell {
        /// The column's name.
        column: String,
        /// What would do.
        expected: &'static str,
    },
    /// The row has too few or too many fields.
    #[error("has {found} fields, expected {expected} as in the header")]
    Fields {
        /// Fields in the row.
        found: usize,
        /// Fields in the header.
        expected: usize,
    },
    /// A quote is never closed.
    #[error("a quoted field that starts here is never closed, expected a closing quote")]
    OpenQuote,
    /// The line is longer than any row of a log.
    #[error("is longer than {limit_mib} MiB, expected one row per line")]
    LongLine {
        /// The limit in MiB.
        limit_mib: usize,
    },
    /// The row lies too far before an earlier one.
    #[error(
        "lies {late_s} s before an earlier row, expected at most the reorder window of {reorder_s} s (sort the file by time or widen the window)"
    )]
    Late {
        /// How far back it lies, in seconds with three digits.
        late_s: String,
        /// The window, in seconds.
        reorder_s: String,
    },
    /// An XES event lacks an attribute.
    #[error("event {event} has no attribute {}, expected {expected}", Quoted(attribute))]
    Attribute {
        /// Number of the event in the file, from 1.
        event: u64,
        /// The attribute looked for.
        attribute: &'static str,
        /// What would do.
        expected: &'static str,
    },
    /// Anything a decoder reports about one place.
    #[error("{}, expected {expected}", OneLine(found))]
    Syntax {
        /// What was found.
        found: String,
        /// What would do.
        expected: &'static str,
    },
}

impl RowFault {
    /// A cell that does not fit; its text is shortened to what a terminal line can bear.
    pub(crate) fn cell(column: &str, found: &[u8], expected: &'static str) -> Self {
        if found.is_empty() {
            Self::EmptyCell { column: column.to_owned(), expected }
        } else {
            Self::Cell { column: column.to_owned(), found: shortened(found), expected }
        }
    }
}

impl FormatError {
    /// Wraps an I/O error, telling a missing file and an unpacking guard from the rest.
    pub(crate) fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        if source.kind() == io::ErrorKind::NotFound && action.starts_with("read") {
            return Self::Missing { path: path.to_owned() };
        }
        match source.downcast::<FormatError>() {
            Ok(own) => own,
            Err(source) => Self::Io { path: path.to_owned(), action, source },
        }
    }

    /// A damaged file.
    pub(crate) fn damaged(path: &Path, format: &'static str, reason: impl fmt::Display) -> Self {
        Self::Damaged { path: path.to_owned(), format, reason: reason.to_string() }
    }
}

/// The first characters of a cell, for a message.
pub(crate) fn shortened(bytes: &[u8]) -> String {
    const SHOWN: usize = 40;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * SHOWN)]);
    if text.chars().count() > SHOWN {
        text.chars().take(SHOWN - 1).chain(['…']).collect()
    } else {
        text.into_owned()
    }
}

/// Shows a text without line breaks or other control characters: messages are one line. What
/// decoders say of damaged bytes can be as long as the file, so it is cut.
struct OneLine<T>(T);

impl<T: fmt::Display> fmt::Display for OneLine<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use fmt::Write;
        const SHOWN: usize = 400;
        let text = self.0.to_string();
        for character in text.chars().take(SHOWN) {
            f.write_char(if is_unprintable(character) { ' ' } else { character })?;
        }
        if text.chars().nth(SHOWN).is_some() {
            f.write_char('…')?;
        }
        Ok(())
    }
}

/// Shows a path in full, on one line.
struct Shown<'a>(&'a Path);

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.0.to_string_lossy();
        f.write_str(&path.replace(is_unprintable, " "))
    }
}

/// Shows a text in single quotes, control characters escaped.
struct Quoted<T>(T);

impl<T: AsRef<str>> fmt::Display for Quoted<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use fmt::Write;
        f.write_char('\'')?;
        for character in shortened(self.0.as_ref().as_bytes()).chars() {
            if is_unprintable(character) {
                write!(f, "{}", character.escape_default())?;
            } else {
                f.write_char(character)?;
            }
        }
        f.write_char('\'')
    }
}

/// Line and paragraph separators break a line as well as control characters do.
fn is_unprintable(character: char) -> bool {
    character.is_control() || matches!(character, '\u{2028}' | '\u{2029}')
}

/// Names a column, or the row where there is none.
struct Column<'a>(&'a str);

impl fmt::Display for Column<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "column {}", Quoted(self.0))
    }
}

/// Shows the first names of a list.
struct List<'a>(&'a [String]);

impl fmt::Display for List<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 8;
        for (position, name) in self.0.iter().take(SHOWN).enumerate() {
            if position > 0 {
                f.write_str(", ")?;
            }
            write!(f, "{}", Quoted(name))?;
        }
        match self.0.len().saturating_sub(SHOWN) {
            0 => Ok(()),
            more => write!(f, " and {more} more"),
        }
    }
}
