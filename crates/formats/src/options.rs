//! How to read a file, where sniffing is not enough.

use serde::Deserialize;

use crate::format::Format;

/// Options of [`read`](crate::read); everything not given is sniffed.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReadOptions {
    /// File format; by content and file ending where absent.
    pub format: Option<Format>,
    /// Delimiter of the columns of a text file.
    pub delimiter: Option<char>,
    /// Column that holds the time.
    pub time_column: Option<String>,
    /// Columns that name the signal; several are joined with `-`.
    pub signal_columns: Vec<String>,
    /// Column that holds the value.
    pub value_column: Option<String>,
    /// `auto`, `iso`, `clock`, `s`, `ms`, `us`, `ns`, `s-year1` (seconds since 0001-01-01), or a
    /// strptime pattern such as `%d.%m.%Y %H:%M:%S%.f`.
    pub time_format: String,
    /// Day of the first row, `YYYY-MM-DD`, for files whose times are clock times only.
    pub date: Option<String>,
    /// Columns of a wide file with a threshold: the value is 1 at or above it, else 0, without
    /// hysteresis. A column named with several thresholds counts how many are reached.
    pub analog: Vec<(String, f64)>,
    /// Words to split into one signal per bit, `WORD.0` and up: columns of a wide file, signals
    /// of any other.
    pub bits: Vec<String>,
    /// What a bad row does.
    pub on_error: OnError,
    /// Rows at most this many seconds before an earlier row are sorted in.
    pub reorder_s: f64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            format: None,
            delimiter: None,
            time_column: None,
            signal_columns: Vec::new(),
            value_column: None,
            time_format: "auto".to_owned(),
            date: None,
            analog: Vec::new(),
            bits: Vec::new(),
            on_error: OnError::Fail,
            reorder_s: 1.0,
        }
    }
}

/// What a bad row does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OnError {
    /// Reading ends with an error that names the row.
    #[default]
    Fail,
    /// The row is counted, reported and left out.
    Skip,
}
