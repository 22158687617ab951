//! Change logs in files: CSV, Parquet, XES and VCD, read by sniffing or by option.
//!
//! [`read`] takes any of them to a [`ChangeLog`] and a [`ReadReport`] that says what was left
//! out; [`write()`] goes the other way, by a temporary name that is renamed when complete.

pub mod arrow;
pub mod bpmn;
mod columns;
mod csv;
mod error;
pub mod event_log;
mod format;
mod intake;
mod layout;
mod lines;
pub mod model_directory;
mod names;
pub mod next_directory;
mod options;
mod output;
mod parquet;
pub mod pnml;
mod report;
pub mod rules_table;
mod sampler;
mod sniff;
mod source;
mod staged;
mod time;
mod value;
mod vcd;
mod xes;
mod xml;

use std::path::Path;

use runglight_engine::log::ChangeLog;

pub use csv::{DeclaredEvents, read_events};
pub use error::{FormatError, RowFault, TableFault};
pub use format::Format;
pub use layout::columns_of_changes;
pub use options::{OnError, ReadOptions};
pub use output::write;
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
    let source = source::Source::open(path)?;
    match sniff::format(path, &source.head, options.format)? {
        Format::Csv => csv::read(path, source, options),
        Format::Parquet if source.is_unpacked => Err(FormatError::NotALog {
            path: path.to_owned(),
            found: "a gzip archive of a Parquet file",
            mend: "unpack it first",
        }),
        Format::Parquet => parquet::read(path, options),
        Format::Xes => xes::read(path, source, options),
        Format::Vcd => vcd::read(path, source, options),
    }
}
