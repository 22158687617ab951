//! Files for a test, and the shortest ways to read them.
#![allow(dead_code, reason = "each test file uses its part")]
#![allow(clippy::unwrap_used, clippy::new_without_default, reason = "only tests use it")]

use std::path::{Path, PathBuf};

use runglight_engine::log::ChangeLog;
use runglight_formats::{ReadOptions, Reading, read};

/// A directory that goes with the test.
pub struct Scratch(tempfile::TempDir);

impl Scratch {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn file(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

/// Options from JSON, as they come from Python.
pub fn options(json: &str) -> ReadOptions {
    serde_json::from_str(json).unwrap()
}

/// Reads text as a file of some name.
pub fn read_as(name: &str, bytes: impl AsRef<[u8]>, json: &str) -> Result<Reading, String> {
    let scratch = Scratch::new();
    let path = scratch.file(name, bytes);
    read(&path, &options(json)).map_err(|error| error.to_string())
}

/// Reads CSV that must be good.
pub fn csv(text: &str) -> Reading {
    read_as("log.csv", text, "{}").unwrap()
}

/// The error that reading CSV ends with.
pub fn csv_error(text: &str, json: &str) -> String {
    read_as("log.csv", text, json).unwrap_err()
}

/// Rows as (nanoseconds, name, value).
pub fn rows(log: &ChangeLog) -> Vec<(i64, &str, i64)> {
    (0..log.len())
        .map(|row| (log.time[row], log.signals[log.signal[row] as usize].as_str(), log.value[row]))
        .collect()
}

/// The folder of real logs, where it is there.
pub fn real_file(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("RUNGLIGHT_DATA")
        .map(PathBuf::from)
        .unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"));
    let path = folder.join(name);
    path.exists().then_some(path)
}
