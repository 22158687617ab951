//! Words of a log split into one signal per bit.

use std::collections::HashMap;

use thiserror::Error;

use super::{BitNames, width_of};
use crate::log::{ChangeLog, SignalIndex};

/// Why words cannot be split.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SplitError {
    /// The log has no such signal.
    #[error("bits: the log has no signal '{word}'")]
    Unknown {
        /// The word asked for.
        word: String,
    },
    /// A bit would be called like another signal.
    #[error("bits: '{bit}' of '{word}' is a signal of its own already; split only one of them")]
    Taken {
        /// The word asked for.
        word: String,
        /// Its bit.
        bit: String,
    },
}

/// A word on its way to being bits.
struct Word {
    mask: u64,
    last: Option<u64>,
    bits: Vec<SignalIndex>,
}

/// Replaces each of the words by the bits of it that are ever set. A row becomes a row for each
/// bit that changes; the first row, and those at the end of a gap, tell all bits.
///
/// # Errors
/// A word the log has not, or a bit that has a signal of its own.
pub fn split_words(log: &ChangeLog, words: &[String]) -> Result<ChangeLog, SplitError> {
    let names = BitNames::of(log.signals.iter().map(String::as_str));
    let known: HashMap<&str, usize> =
        log.signals.iter().enumerate().map(|(index, name)| (name.as_str(), index)).collect();
    let mut split: Vec<Option<Word>> = log.signals.iter().map(|_| None).collect();
    for word in words {
        let &index =
            known.get(word.as_str()).ok_or_else(|| SplitError::Unknown { word: word.clone() })?;
        split[index] = Some(Word { mask: 0, last: None, bits: Vec::new() });
    }
    set_masks(log, &mut split);

    let mut signals = Vec::new();
    let mut whole = vec![0; log.signals.len()];
    for (index, word) in split.iter_mut().enumerate() {
        let Some(word) = word else {
            whole[index] = signals.len() as SignalIndex;
            signals.push(log.signals[index].clone());
            continue;
        };
        for bit in bits_of(word.mask) {
            let name = names.name(&log.signals[index], bit);
            if known.contains_key(name.as_str()) {
                return Err(SplitError::Taken { word: log.signals[index].clone(), bit: name });
            }
            word.bits.push(signals.len() as SignalIndex);
            signals.push(name);
        }
    }

    let mut out = ChangeLog {
        signals,
        scan_interval: log.scan_interval,
        gaps: log.gaps.clone(),
        ..ChangeLog::default()
    };
    let mut push = |time, signal, value| {
        out.time.push(time);
        out.signal.push(signal);
        out.value.push(value);
    };
    let mut ends = log.gaps.iter().map(|gap| gap.end).peekable();
    for ((&time, &signal), &value) in log.time.iter().zip(&log.signal).zip(&log.value) {
        while ends.peek().is_some_and(|&end| end < time) {
            ends.next();
        }
        let Some(word) = &mut split[signal as usize] else {
            push(time, whole[signal as usize], value);
            continue;
        };
        let bits = value as u64 & word.mask;
        let told = match word.last.replace(bits) {
            Some(last) if ends.peek() != Some(&time) => last ^ bits,
            _ => word.mask,
        };
        for (place, bit) in bits_of(word.mask).enumerate() {
            if told >> bit & 1 == 1 {
                push(time, word.bits[place], (bits >> bit & 1) as i64);
            }
        }
    }
    Ok(out)
}

/// The bits of each word that are ever set, as wide as its values need.
fn set_masks(log: &ChangeLog, split: &mut [Option<Word>]) {
    let mut ranges = vec![(i64::MAX, i64::MIN); split.len()];
    for (&signal, &value) in log.signal.iter().zip(&log.value) {
        if let Some(word) = &mut split[signal as usize] {
            let (lowest, highest) = &mut ranges[signal as usize];
            (*lowest, *highest) = (value.min(*lowest), value.max(*highest));
            word.mask |= value as u64;
        }
    }
    for (word, (lowest, highest)) in split.iter_mut().zip(ranges) {
        if let Some(word) = word {
            word.mask &= u64::MAX >> (64 - width_of(lowest, highest));
        }
    }
}

/// Places of the bits that are set, lowest first.
fn bits_of(mut mask: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let bit = mask.trailing_zeros();
        (bit < 64).then(|| {
            mask &= mask - 1;
            bit
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{ChangeLogBuilder, Gap};

    fn log(rows: &[(i64, &str, i64)]) -> ChangeLog {
        let mut builder = ChangeLogBuilder::default();
        for &(time, signal, value) in rows {
            let signal = builder.intern(signal);
            builder.push(time, signal, value);
        }
        builder.finish()
    }

    fn rows(log: &ChangeLog) -> Vec<(i64, &str, i64)> {
        log.time
            .iter()
            .zip(&log.signal)
            .zip(&log.value)
            .map(|((&time, &signal), &value)| (time, log.signals[signal as usize].as_str(), value))
            .collect()
    }

    #[test]
    fn a_word_becomes_its_bits_where_they_change() {
        let split = split_words(
            &log(&[(0, "%MW7", 0), (0, "%M1", 1), (1, "%MW7", 5), (2, "%MW7", 4), (3, "%MW7", 4)]),
            &["%MW7".to_owned()],
        )
        .unwrap();
        assert_eq!(split.signals, ["%MW7.0", "%MW7.2", "%M1"]);
        assert_eq!(
            rows(&split),
            [
                (0, "%MW7.0", 0),
                (0, "%MW7.2", 0),
                (0, "%M1", 1),
                (1, "%MW7.0", 1),
                (1, "%MW7.2", 1),
                (2, "%MW7.0", 0),
            ]
        );
    }

    #[test]
    fn after_a_gap_all_bits_are_told() {
        let mut recorded = log(&[(0, "%MW7", 3), (9, "%MW7", 3)]);
        recorded.gaps = vec![Gap { start: 1, end: 9 }];
        let split = split_words(&recorded, &["%MW7".to_owned()]).unwrap();
        assert_eq!(rows(&split)[2..], [(9, "%MW7.0", 1), (9, "%MW7.1", 1)]);
        assert_eq!(split.gaps, recorded.gaps);
    }

    #[test]
    fn negative_words_have_sixteen_bits() {
        let split = split_words(&log(&[(0, "W", 0), (1, "W", -1)]), &["W".to_owned()]).unwrap();
        assert_eq!(split.signals.len(), 16);
    }

    #[test]
    fn what_cannot_be_split_is_said() {
        let words = ["%MW8".to_owned()];
        let error = split_words(&log(&[(0, "%MW7", 1)]), &words).unwrap_err();
        assert_eq!(error.to_string(), "bits: the log has no signal '%MW8'");
        let error = split_words(&log(&[(0, "%MW8", 1), (0, "%MW8.0", 1)]), &words).unwrap_err();
        assert_eq!(
            error.to_string(),
            "bits: '%MW8.0' of '%MW8' is a signal of its own already; split only one of them"
        );
    }
}
