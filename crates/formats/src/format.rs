//! The file formats, by name and by file ending.

use std::path::Path;

use crate::error::FormatError;

/// A file format that change logs are read from and written to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Delimited text: comma, semicolon, tab or pipe.
    Csv,
    /// Apache Parquet.
    Parquet,
    /// IEEE 1849 event logs.
    Xes,
    /// Value change dump, IEEE 1364.
    Vcd,
}

impl Format {
    /// The format's name, which is also its usual file ending.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
            Self::Xes => "xes",
            Self::Vcd => "vcd",
        }
    }

    /// The format of a name in any case, or of a file ending.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_str() {
            "csv" | "tsv" | "tab" | "txt" | "log" => Self::Csv,
            "parquet" | "pq" => Self::Parquet,
            "xes" => Self::Xes,
            "vcd" => Self::Vcd,
            _ => return None,
        })
    }

    /// The format a file's ending stands for.
    ///
    /// # Errors
    /// No ending, or one that stands for no format.
    pub fn from_path(path: &Path) -> Result<Self, FormatError> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        Self::from_name(&ending).ok_or_else(|| FormatError::UnknownFormat {
            path: path.to_owned(),
            found: format!(".{ending}"),
        })
    }
}
