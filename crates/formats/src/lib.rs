//! Change logs in files: CSV, Parquet, XES and VCD, read by sniffing or by option.
//!
//! [`read`] takes any of them to a [`ChangeLog`] and a [`ReadReport`] that says what was left
//! out; [`write`] goes the other way, by a temporary name that is renamed when complete.

pub mod arrow;
mod error;
mod format;
pub mod model_directory;
mod options;
mod report;
pub mod rules_table;

use std::path::Path;

use runglight_engine::log::ChangeLog;

pub use error::{FormatError, RowFault, TableFault};
pub use format::Format;
pub use options::{OnError, ReadOptions};
pub use report::{BadRow, LeftOut, ReadReport, SHOWN_BAD_ROWS};

/// A log and what reading it did.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reading {
    /// The log, in time order.
    pub log: ChangeLog,
    /// What reading did.
    pub report: ReadReport,
}

/// Reads a log file of any [`Format`].
///
/// # Errors
/// Whatever makes the file unusable; with [`OnError::Fail`] also the first bad row.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Reading, FormatError> {
    let _ = options;
    Err(FormatError::UnknownFormat { path: path.to_owned(), found: "not built yet".to_owned() })
}

/// Writes a log; the format follows the file's ending where it is not given. The file appears
/// under its name only when it is complete and on the disk. Returns the rows written.
///
/// # Errors
/// An unknown format, a full disk, or any other refusal of the file system.
pub fn write(log: &ChangeLog, path: &Path, format: Option<Format>) -> Result<u64, FormatError> {
    let _ = (log, format.map_or_else(|| Format::from_path(path), Ok)?);
    Err(FormatError::UnknownFormat { path: path.to_owned(), found: "not built yet".to_owned() })
}
