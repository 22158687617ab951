//! Which format the bytes of a file have.

use std::path::Path;

use crate::error::FormatError;
use crate::format::Format;

/// Kinds of files people hand over instead of a log: first bytes, what they are, the mend.
const OTHERS: [(&[u8], &str, &str); 13] = [
    (
        b"PK\x03\x04",
        "a zip archive or an Excel workbook",
        "unpack it first, or save the sheet as CSV",
    ),
    (b"PK\x05\x06", "an empty zip archive", "export the log again"),
    (b"\x28\xB5\x2F\xFD", "a zstd archive", "unpack it first"),
    (b"\xFD7zXZ\0", "an xz archive", "unpack it first"),
    (b"BZh", "a bzip2 archive", "unpack it first"),
    (b"7z\xBC\xAF\x27\x1C", "a 7-Zip archive", "unpack it first"),
    (b"Rar!", "a rar archive", "unpack it first"),
    (b"\x1F\x8B", "a gzip archive inside a gzip archive", "unpack it first"),
    (b"\xD0\xCF\x11\xE0", "an old Office document", "save the sheet as CSV"),
    (b"SQLite format 3\0", "an SQLite database", "import it with --sql"),
    (b"%PDF", "a PDF document", "export the log as CSV"),
    (b"ARROW1", "an Arrow IPC file", "save it as Parquet"),
    (b"\x89HDF", "an HDF5 file", "save it as CSV or Parquet"),
];

/// The format of a file by its first bytes, its name and what was asked for.
pub(crate) fn format(
    path: &Path,
    head: &[u8],
    asked: Option<Format>,
) -> Result<Format, FormatError> {
    let not_a_log = |found, mend| FormatError::NotALog { path: path.to_owned(), found, mend };
    for (magic, found, mend) in OTHERS {
        if head.starts_with(magic) {
            return Err(not_a_log(found, mend));
        }
    }
    let is_parquet = head.starts_with(b"PAR1");
    let by_name = Format::from_path(path).ok();
    let format = match asked {
        Some(asked) => asked,
        None if is_parquet => Format::Parquet,
        None if by_name == Some(Format::Parquet) => Format::Parquet,
        None if looks_like_xml(head) => Format::Xes,
        None if looks_like_vcd(head) => Format::Vcd,
        None => by_name.unwrap_or(Format::Csv),
    };
    if is_parquet && format != Format::Parquet {
        return Err(not_a_log("a Parquet file", "read it without the option format"));
    }
    if format != Format::Parquet && memchr::memchr(0, head).is_some() {
        return Err(not_a_log("binary data", "export the log as CSV, Parquet, XES or VCD"));
    }
    Ok(format)
}

fn looks_like_xml(head: &[u8]) -> bool {
    head.trim_ascii_start().starts_with(b"<")
}

fn looks_like_vcd(head: &[u8]) -> bool {
    const WORDS: [&[u8]; 7] =
        [b"date", b"version", b"timescale", b"comment", b"scope", b"var", b"enddefinitions"];
    let head = head.trim_ascii_start();
    head.first() == Some(&b'$') && WORDS.iter().any(|word| head[1..].starts_with(word))
}
