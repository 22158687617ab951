//! What reading did: nothing is dropped without being said.

use serde::Serialize;

use crate::format::Format;

/// Bad rows shown in full; the rest are counted.
pub const SHOWN_BAD_ROWS: usize = 5;

/// What reading a file did.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ReadReport {
    /// The format the file had.
    pub format: Format,
    /// Rows of data in the file, bad ones included.
    pub rows: u64,
    /// Rows that could not be used.
    pub bad_rows: u64,
    /// The first [`SHOWN_BAD_ROWS`] of them.
    pub bad: Vec<BadRow>,
    /// Columns that are not in the log.
    pub left_out: Vec<LeftOut>,
    /// Decisions a reader should know about.
    pub notes: Vec<String>,
}

/// A row that could not be used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct BadRow {
    /// Row, as a text editor shows it (the header is row 1); in Parquet the data row, from 1.
    pub row: u64,
    /// What is wrong with it.
    pub reason: String,
}

/// A column that is not in the log.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// The column's name.
    pub column: String,
    /// Why it was left out.
    pub reason: String,
}

impl ReadReport {
    /// A report of nothing yet.
    pub(crate) fn new(format: Format) -> Self {
        Self {
            format,
            rows: 0,
            bad_rows: 0,
            bad: Vec::new(),
            left_out: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Says something once.
    pub(crate) fn note(&mut self, note: impl Into<String>) {
        let note = note.into();
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    /// Names a column that is not in the log.
    pub(crate) fn leave_out(&mut self, column: &str, reason: impl Into<String>) {
        self.left_out.push(LeftOut { column: column.to_owned(), reason: reason.into() });
    }
}
