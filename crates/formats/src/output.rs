//! Files appear under their name only when they are complete and on the disk.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use runglight_engine::log::{ChangeLog, LogError, SECOND};

use crate::csv;
use crate::error::FormatError;
use crate::format::Format;
use crate::parquet;
use crate::vcd;
use crate::xes;

/// Writes a log; the format follows the file's ending where it is not given. Returns the rows
/// written.
///
/// # Errors
/// An unknown format, a log that is not in order, a full disk, or any other refusal of the file system; a file that was
/// there before is then untouched.
pub fn write(log: &ChangeLog, path: &Path, format: Option<Format>) -> Result<u64, FormatError> {
    let format = format.map_or_else(|| Format::from_path(path), Ok)?;
    check(log)?;
    if format == Format::Xes && !xes::can_write(log) {
        return Err(FormatError::Unwritable {
            path: path.to_owned(),
            format: "XES",
            reason: "a signal's name holds a character that XML does not have; rename it"
                .to_owned(),
        });
    }
    whole(path, |into| match format {
        Format::Csv => csv::write(log, into, delimiter(path)),
        Format::Parquet => parquet::write(log, into).map_err(std::io::Error::other),
        Format::Xes => xes::write(log, into),
        Format::Vcd => vcd::write(log, into),
    })?;
    Ok(log.len() as u64)
}

/// Writes a file by a temporary name that is renamed when it is complete and on the disk.
pub(crate) fn whole(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<tempfile::NamedTempFile>) -> std::io::Result<()>,
) -> Result<(), FormatError> {
    let failed = |error| FormatError::io(path, "write this file", error);
    if path.is_dir() {
        return Err(FormatError::NotAFile { path: path.to_owned(), found: "a directory" });
    }
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let temporary = temporary_file(directory).map_err(failed)?;
    let mut buffered = BufWriter::with_capacity(1 << 20, temporary);
    write(&mut buffered).map_err(failed)?;
    buffered.flush().map_err(failed)?;
    let temporary = buffered.into_inner().map_err(|error| failed(error.into_error()))?;
    temporary.as_file().sync_all().map_err(failed)?;
    temporary.persist(path).map_err(|error| failed(error.error))?;
    sync_directory(directory).map_err(failed)
}

/// A log with rows that no format could carry is refused: rows never vanish.
fn check(log: &ChangeLog) -> Result<(), LogError> {
    let (time, signal, value) = (log.time.len(), log.signal.len(), log.value.len());
    if time != signal || time != value {
        return Err(LogError::Lengths { time, signal, value });
    }
    let signals = log.signals.len();
    if let Some(row) = log.signal.iter().position(|&index| index as usize >= signals) {
        return Err(LogError::Signal { row: row + 1, signal: log.signal[row], signals });
    }
    if let Some(row) = log.time.windows(2).position(|pair| pair[1] < pair[0]) {
        let late = log.time[row].saturating_sub(log.time[row + 1]);
        let late_s = late as f64 / SECOND as f64;
        return Err(LogError::Order { row: row + 2, late_s, reorder_s: 0.0 });
    }
    Ok(())
}

fn delimiter(path: &Path) -> u8 {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    if matches!(ending.as_str(), "tsv" | "tab") { b'\t' } else { b',' }
}

/// A temporary file with the permissions an ordinary new file would get.
fn temporary_file(directory: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".runglight-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(directory)
}

/// The new name itself must survive a power cut.
fn sync_directory(directory: &Path) -> std::io::Result<()> {
    if cfg!(unix) { File::open(directory)?.sync_all() } else { Ok(()) }
}
