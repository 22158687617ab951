//! The bytes of a file: what kind they are, unpacked and as UTF-8.

use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use crate::error::FormatError;

const MIB: u64 = 1 << 20;
/// Bytes that sniffing looks at.
const HEAD: usize = 4 << 20;
/// Unpacked size from which on the ratio counts, and the most that is ever unpacked.
const UNPACKED_FREE: u64 = 256 * MIB;
const UNPACKED_MOST: u64 = 8192 * MIB;
/// Logs pack to a tenth or a fiftieth; a bomb packs a thousandfold.
const RATIO_MOST: u64 = 250;

/// The start of a file, and the rest of it.
pub(crate) struct Source {
    /// The first bytes, UTF-8 or Latin-1, without byte order mark.
    pub(crate) head: Vec<u8>,
    /// True where the head is the whole file.
    pub(crate) complete: bool,
    /// True where the bytes are not those of the file but what it unpacks to.
    pub(crate) is_unpacked: bool,
    pub(crate) notes: Vec<&'static str>,
    rest: Box<dyn Read>,
}

impl Source {
    /// Opens a file.
    pub(crate) fn open(path: &Path) -> Result<Self, FormatError> {
        let file = open_file(path)?;
        let packed =
            file.metadata().map_err(|error| FormatError::io(path, "read this file", error))?.len();
        let mut source = Self::start(path, Box::new(file), packed)?;
        if source.head.is_empty() {
            return Err(FormatError::Empty { path: path.to_owned() });
        }
        if source.head.starts_with(&[0x1F, 0x8B]) {
            let limit = UNPACKED_MOST.min(UNPACKED_FREE.max(packed.saturating_mul(RATIO_MOST)));
            let unpacked = MultiGzDecoder::new(source.into_reader());
            let guard =
                Guard { inner: unpacked, left: limit, limit, packed, path: path.to_owned() };
            source = Self::start(path, Box::new(guard), packed)?;
            source.is_unpacked = true;
            source.notes.push("unpacked from gzip");
            if source.head.is_empty() {
                return Err(FormatError::Empty { path: path.to_owned() });
            }
        }
        source.decode(path)
    }

    /// Reads the head of about `expected` bytes.
    fn start(path: &Path, mut reader: Box<dyn Read>, expected: u64) -> Result<Self, FormatError> {
        let mut head = Vec::with_capacity(expected.min(HEAD as u64) as usize);
        reader
            .by_ref()
            .take(HEAD as u64)
            .read_to_end(&mut head)
            .map_err(|error| FormatError::io(path, "read this file", error))?;
        let complete = head.len() < HEAD;
        Ok(Self { head, complete, is_unpacked: false, notes: Vec::new(), rest: reader })
    }

    /// Takes byte order marks off, and UTF-16 to UTF-8.
    fn decode(mut self, path: &Path) -> Result<Self, FormatError> {
        let encoding = match encoding_rs::Encoding::for_bom(&self.head) {
            Some((encoding, mark)) if encoding == encoding_rs::UTF_8 => {
                self.head.drain(..mark);
                return Ok(self);
            }
            Some((encoding, _)) => encoding,
            None => return Ok(self),
        };
        let mut notes = std::mem::take(&mut self.notes);
        let mut bytes = Vec::new();
        self.into_reader()
            .read_to_end(&mut bytes)
            .map_err(|error| FormatError::io(path, "read this file", error))?;
        let text = encoding.decode_with_bom_removal(&bytes).0.into_owned();
        notes.push("decoded from UTF-16");
        let expected = text.len() as u64;
        let mut decoded = Self::start(path, Box::new(Cursor::new(text.into_bytes())), expected)?;
        decoded.notes = notes;
        Ok(decoded)
    }

    /// All bytes from the start.
    pub(crate) fn into_reader(self) -> Box<dyn Read> {
        Box::new(Cursor::new(self.head).chain(self.rest))
    }
}

/// Opens a regular file; a pipe or a device would block or never end.
pub(crate) fn open_file(path: &Path) -> Result<File, FormatError> {
    let failed = |error| FormatError::io(path, "read this file", error);
    let metadata = std::fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        let found = if metadata.is_dir() { "a directory" } else { "a device or a pipe" };
        return Err(FormatError::NotAFile { path: path.to_owned(), found });
    }
    File::open(path).map_err(failed)
}

/// Stops unpacking where no log would go on.
struct Guard<R> {
    inner: R,
    left: u64,
    limit: u64,
    packed: u64,
    path: std::path::PathBuf,
}

impl<R: Read> Read for Guard<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self
            .inner
            .read(buffer)
            .map_err(|error| io::Error::other(FormatError::damaged(&self.path, "gzip", error)))?;
        self.left = self.left.checked_sub(read as u64).ok_or_else(|| {
            io::Error::other(FormatError::TooLarge {
                path: self.path.clone(),
                packed_mib: self.packed.div_ceil(MIB),
                limit_mib: self.limit / MIB,
            })
        })?;
        Ok(read)
    }
}
