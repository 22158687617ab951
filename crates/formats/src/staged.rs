//! Directories that appear whole: written beside their place, and renamed when complete.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Writes a directory by `write` and puts it in the place of `path`. Files there that are none of
/// `own` are kept.
pub fn replace(
    path: &Path,
    own: &[&str],
    write: impl FnOnce(&Path) -> io::Result<()>,
) -> io::Result<()> {
    let staging = beside(path, "new");
    let _ = fs::remove_dir_all(&staging);
    fs::create_dir_all(&staging)?;
    let written = write(&staging).and_then(|()| swap(path, own, &staging));
    if written.is_err() {
        let _ = fs::remove_dir_all(&staging);
    }
    written
}

/// A file that has reached the disk.
pub fn write_synced(path: &Path, bytes: &[u8]) -> io::Result<()> {
    fs::write(path, bytes)?;
    File::open(path)?.sync_all()
}

/// True where there is an empty directory.
pub fn is_empty_directory(path: &Path) -> bool {
    fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none())
}

/// What tells whether bytes are still those that were written.
pub fn checksum(bytes: &[u8]) -> String {
    format!("{:016x}", xxhash_rust::xxh3::xxh3_64(bytes))
}

/// `model.new-123` beside `model`.
fn beside(path: &Path, purpose: &str) -> PathBuf {
    let mut name = path.file_name().map_or_else(|| OsString::from("model"), OsString::from);
    name.push(format!(".{purpose}-{}", std::process::id()));
    path.with_file_name(name)
}

/// Moves what else lies in the old directory over, then swaps the two.
fn swap(path: &Path, own: &[&str], staging: &Path) -> io::Result<()> {
    if !path.exists() {
        return fs::rename(staging, path);
    }
    let old = beside(path, "old");
    for entry in fs::read_dir(path)? {
        let name = entry?.file_name();
        if !own.iter().any(|own| name == *own) {
            fs::rename(path.join(&name), staging.join(&name))?;
        }
    }
    fs::rename(path, &old)?;
    fs::rename(staging, path)?;
    fs::remove_dir_all(old)
}
