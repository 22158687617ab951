//! Writes long CSV: `time,signal,value`.

use std::io::{self, Write};

use runglight_engine::log::ChangeLog;

use crate::time;

/// Writes the log with the delimiter given.
pub(crate) fn write(log: &ChangeLog, into: &mut dyn Write, delimiter: u8) -> io::Result<()> {
    let names: Vec<Vec<u8>> = log.signals.iter().map(|name| quoted(name, delimiter)).collect();
    let mut line = Vec::with_capacity(128);
    for name in ["time", "signal"] {
        line.extend_from_slice(name.as_bytes());
        line.push(delimiter);
    }
    line.extend_from_slice(b"value\n");
    into.write_all(&line)?;
    for ((&time, &signal), &value) in log.time.iter().zip(&log.signal).zip(&log.value) {
        line.clear();
        time::write_iso(time, &mut line);
        line.push(delimiter);
        line.extend_from_slice(names.get(signal as usize).map_or(&[][..], Vec::as_slice));
        line.push(delimiter);
        writeln!(line, "{value}")?;
        into.write_all(&line)?;
    }
    Ok(())
}

/// A name as a field: in quotes where a reader would cut or trim it.
fn quoted(name: &str, delimiter: u8) -> Vec<u8> {
    let plain = name.bytes().all(|byte| byte != delimiter && !matches!(byte, b'"' | b'\n' | b'\r'))
        && name.trim() == name;
    if plain {
        return name.as_bytes().to_vec();
    }
    format!("\"{}\"", name.replace('"', "\"\"")).into_bytes()
}
