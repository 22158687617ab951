//! Counts lines while somebody else reads.

use std::io::{self, BufRead, Read};

/// A reader that knows which line it is on.
pub(crate) struct LineCounter<R> {
    inner: R,
    line: u64,
}

impl<R> LineCounter<R> {
    pub(crate) fn new(inner: R) -> Self {
        Self { inner, line: 1 }
    }

    /// The line of the next byte, from 1.
    pub(crate) fn line(&self) -> u64 {
        self.line
    }
}

impl<R: BufRead> Read for LineCounter<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let available = self.fill_buf()?;
        let length = available.len().min(into.len());
        into[..length].copy_from_slice(&available[..length]);
        self.consume(length);
        Ok(length)
    }
}

impl<R: BufRead> BufRead for LineCounter<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.inner.fill_buf()
    }

    fn consume(&mut self, length: usize) {
        // The bytes are still buffered: asking for them again reads nothing.
        if let Ok(buffered) = self.inner.fill_buf() {
            let consumed = &buffered[..length.min(buffered.len())];
            self.line += memchr::memchr_iter(b'\n', consumed).count() as u64;
        }
        self.inner.consume(length);
    }
}
