//! Writes a VCD that GTKWave opens: wires for truth values, 64-bit integers for words.

use std::io::{self, Write};

use hashbrown::HashSet;
use runglight_engine::log::ChangeLog;

use super::{OWN, names};
use crate::time;

/// Writes the log with a timescale of 1 ns, from its first row on.
pub(crate) fn write(log: &ChangeLog, into: &mut dyn Write) -> io::Result<()> {
    let epoch = log.time.first().copied().unwrap_or(0);
    let mut date = Vec::new();
    time::write_iso(epoch, &mut date);
    write!(into, "$date {} $end\n$version runglight $end\n", String::from_utf8_lossy(&date))?;
    writeln!(into, "$comment {OWN} epoch_ns={epoch} $end")?;
    if let Some(interval) = log.scan_interval {
        writeln!(into, "$comment {OWN} scan_interval_ns={interval} $end")?;
    }
    if !log.gaps.is_empty() {
        let gaps = serde_json::to_string(&log.gaps).map_err(io::Error::other)?;
        writeln!(into, "$comment {OWN} gaps={gaps} $end")?;
    }
    writeln!(into, "$timescale 1 ns $end\n$scope module {OWN} $end")?;
    let words = words(log);
    let mut taken = HashSet::new();
    for (index, name) in log.signals.iter().enumerate() {
        let (kind, width) = if words[index] { ("integer", 64) } else { ("wire", 1) };
        let code = code(index);
        let reference = names::reference(name, &mut taken);
        if reference != *name {
            writeln!(into, "$comment {OWN} name {code} {} $end", names::encode(name))?;
        }
        writeln!(into, "$var {kind} {width} {code} {reference} $end")?;
    }
    writeln!(into, "$upscope $end\n$enddefinitions $end")?;
    let codes: Vec<String> = (0..log.signals.len()).map(code).collect();
    let mut now = None;
    for ((&time, &signal), &value) in log.time.iter().zip(&log.signal).zip(&log.value) {
        if now != Some(time) {
            writeln!(into, "#{}", i128::from(time) - i128::from(epoch))?;
            now = Some(time);
        }
        let Some(code) = codes.get(signal as usize) else { continue };
        if words[signal as usize] {
            writeln!(into, "b{value:b} {code}")?;
        } else {
            writeln!(into, "{value}{code}")?;
        }
    }
    Ok(())
}

/// Which signals have other values than 0 and 1.
fn words(log: &ChangeLog) -> Vec<bool> {
    let mut words = vec![false; log.signals.len()];
    for (&signal, &value) in log.signal.iter().zip(&log.value) {
        if let Some(word) = words.get_mut(signal as usize) {
            *word |= !matches!(value, 0 | 1);
        }
    }
    words
}

/// The short code of a variable: printable characters, as 18.2.3.7 has them.
fn code(index: usize) -> String {
    const FIRST: u8 = b'!';
    const COUNT: usize = 94;
    let mut code = String::new();
    let mut left = index;
    loop {
        code.push(char::from(FIRST + (left % COUNT) as u8));
        left /= COUNT;
        if left == 0 {
            return code;
        }
        left -= 1;
    }
}
