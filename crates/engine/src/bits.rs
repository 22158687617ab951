//! Words and their bits: which addresses are words, and what each bit of one is called.
//!
//! PLCs pack booleans into words for their displays and for SCADA. A bit is called the way its
//! PLC's own tool calls it: `%MW33.5` of `%MW33` (IEC 61131-3, Schneider), `40001.5` of a Modbus
//! register, `DB1.DBX3.5` of `DB1.DBW2` (S7 keeps the high byte first).

mod split;

pub use split::{SplitError, split_words};

/// Bits of a word by the values it takes, in two's complement: 16 where they hold all, else 32,
/// else 64.
pub fn width_of(lowest: i64, highest: i64) -> u32 {
    match (lowest, highest) {
        (-0x8000.., ..=0xFFFF) => 16,
        (-0x8000_0000.., ..=0xFFFF_FFFF) => 32,
        _ => 64,
    }
}

/// True where an address by itself says that it is a word: a word in which only the lowest bit
/// ever moved takes no other values than a boolean.
pub fn is_word_address(name: &str) -> bool {
    let last = last_part(name);
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    // Modbus registers, by the book: 3xxxx are inputs, 4xxxx holding registers.
    if is_number(last) {
        return matches!(last.len(), 5 | 6) && last.starts_with(['3', '4']);
    }
    let text = last.strip_prefix('%').unwrap_or(last).to_ascii_uppercase();
    ["IW", "QW", "MW", "EW", "AW", "ID", "QD", "MD", "ED", "AD", "DBW", "DBD"]
        .iter()
        .any(|kind| text.strip_prefix(kind).is_some_and(is_number))
}

/// `MW33` of `Modbus TCP.M340.MW33`, `DBW2` of `DB1.DBW2`.
fn last_part(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(_, last)| last)
}

/// How the bits of a log's words are called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BitNames {
    /// `WORD.BIT`; only data blocks, which no other PLC has, in the manner of S7.
    Dotted,
    /// `MW10` and `IW0` are words of an S7 too: their bits are `M11.0` and `I1.0`.
    S7,
}

impl BitNames {
    /// What fits the signals of a log: bare `MW10` may be Schneider's or Siemens', but `M10.3`,
    /// `IB7` and `DB1.DBX0.0` only stand in the logs of an S7.
    pub fn of<'s>(signals: impl IntoIterator<Item = &'s str>) -> Self {
        if signals.into_iter().any(is_s7_only) { Self::S7 } else { Self::Dotted }
    }

    /// The name of one bit.
    pub fn name(self, word: &str, bit: u32) -> String {
        s7_bit(self, word, bit).unwrap_or_else(|| format!("{word}.{bit}"))
    }
}

/// The signal an address is, or the word and its bit; `None` where the log has neither.
pub fn find_address<'s>(signals: &'s [String], address: &str) -> Option<(&'s str, Option<u32>)> {
    if let Some(signal) = signals.iter().find(|signal| *signal == address) {
        return Some((signal, None));
    }
    let names = BitNames::of(signals.iter().map(String::as_str));
    signals.iter().find_map(|word| {
        // A bit's name begins as its word's does, as far as the number.
        let alike = word.bytes().zip(address.bytes()).take_while(|(a, b)| a == b).count();
        let bits = if alike == 0 { 0..0 } else { 0..64 };
        bits.into_iter()
            .find(|&bit| names.name(word, bit) == address)
            .map(|bit| (word.as_str(), Some(bit)))
    })
}

fn is_s7_only(name: &str) -> bool {
    let name = name.to_ascii_uppercase();
    if let Some((block, rest)) = name.trim_start_matches('%').split_once('.')
        && let Some(number) = block.strip_prefix("DB")
    {
        return is_digits(number) && rest.starts_with("DB");
    }
    let Some(rest) = name.strip_prefix(['I', 'Q', 'M', 'E', 'A']) else { return false };
    match rest.split_once('.') {
        Some((byte, bit)) => is_digits(byte) && bit.len() == 1 && ("0"..="7").contains(&bit),
        None => rest.strip_prefix('B').is_some_and(is_digits),
    }
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// The bit's own address, where the word is one of an S7: bit 0 lies in the last byte.
fn s7_bit(names: BitNames, word: &str, bit: u32) -> Option<String> {
    let digits = word.bytes().rev().take_while(u8::is_ascii_digit).count();
    let (head, number) = word.split_at(word.len() - digits);
    let first: u32 = number.parse().ok()?;
    let (front, size) = head.split_at_checked(head.len().checked_sub(1)?)?;
    let bytes = match size {
        "W" | "w" => 2,
        "D" | "d" => 4,
        _ => return None,
    };
    let byte = first.checked_add((bytes - 1u32).checked_sub(bit / 8)?)?;
    let area = front.to_ascii_uppercase();
    match area.trim_start_matches('%').rsplit_once('.') {
        Some((block, "DB")) if block.strip_prefix("DB").is_some_and(is_digits) => {
            Some(format!("{front}X{byte}.{}", bit % 8))
        }
        None if names == BitNames::S7 && ["I", "Q", "M", "E", "A"].contains(&area.as_str()) => {
            Some(format!("{front}{byte}.{}", bit % 8))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_say_that_they_are_words() {
        for word in [
            "%MW33",
            "%IW0",
            "%QW5",
            "MW10",
            "40001",
            "400001",
            "30012",
            "DB1.DBW2",
            "DB7.DBD4",
            "%DB1.DBW0",
            "Modbus TCP.M340.MW74",
            "EW4",
            "%MD8",
        ] {
            assert!(is_word_address(word), "{word}");
        }
        for other in [
            "%M98",
            "%IX0.1",
            "I5.0",
            "00001",
            "10001",
            "1",
            "STEP",
            "MW",
            "DB1.DBX0.0",
            "%MW33.5",
            "40001.5",
            "Line-Conveyor-Running",
            "",
        ] {
            assert!(!is_word_address(other), "{other}");
        }
    }

    #[test]
    fn bits_are_called_as_their_plc_calls_them() {
        let dotted = BitNames::of(["%M98", "%MW33", "MW33"]);
        assert_eq!(dotted.name("%MW33", 5), "%MW33.5");
        assert_eq!(dotted.name("40001", 15), "40001.15");
        assert_eq!(dotted.name("MW33", 5), "MW33.5");
        assert_eq!(dotted.name("Modbus TCP.M340.MW74", 0), "Modbus TCP.M340.MW74.0");
        assert_eq!(dotted.name("ns=2;s=Status", 7), "ns=2;s=Status.7");
        assert_eq!(dotted.name("DB1.DBW2", 0), "DB1.DBX3.0");
        assert_eq!(dotted.name("DB1.DBW2", 9), "DB1.DBX2.1");
        assert_eq!(dotted.name("%DB1.DBD4", 31), "%DB1.DBX4.7");
        let s7 = BitNames::of(["MW10", "I5.0"]);
        assert_eq!(s7.name("MW10", 0), "M11.0");
        assert_eq!(s7.name("MW10", 8), "M10.0");
        assert_eq!(s7.name("ED4", 0), "E7.0");
        assert_eq!(s7.name("%MW10", 3), "%MW10.3", "a percent sign is IEC 61131-3");
        assert_eq!(s7.name("SEW1", 3), "SEW1.3");
        // A word whose values fit no 16 bits has bits its address has not.
        assert_eq!(s7.name("MW10", 16), "MW10.16");
    }

    #[test]
    fn siemens_is_told_from_its_bits() {
        for s7 in ["M10.3", "I5.0", "E5.0", "DB1.DBX0.0", "DB2.DBW4", "IB7", "%DB1.DBX0.0"] {
            assert_eq!(BitNames::of(["MW10", s7]), BitNames::S7, "{s7}");
        }
        for other in ["MW10", "%IX5.0", "M98", "I", "INT.5", "40001", "M10.9", "DB1", "%M10.3"] {
            assert_eq!(BitNames::of([other]), BitNames::Dotted, "{other}");
        }
    }

    #[test]
    fn addresses_are_found_whole_or_as_bits() {
        let signals = ["%MW7", "%M1", "DB1.DBW2", "Status"].map(str::to_owned);
        assert_eq!(find_address(&signals, "%M1"), Some(("%M1", None)));
        assert_eq!(find_address(&signals, "%MW7.5"), Some(("%MW7", Some(5))));
        assert_eq!(find_address(&signals, "DB1.DBX3.5"), Some(("DB1.DBW2", Some(5))));
        assert_eq!(find_address(&signals, "Status.0"), Some(("Status", Some(0))));
        for none in ["%MW8.0", "%MW7.64", "DB1.DBX9.5", "", "%MW7."] {
            assert_eq!(find_address(&signals, none), None, "{none}");
        }
    }

    #[test]
    fn widths() {
        assert_eq!(width_of(-0x8000, 0xFFFF), 16);
        assert_eq!(width_of(0, 0x1_0000), 32);
        assert_eq!(width_of(-0x8001, 5), 32);
        assert_eq!(width_of(i64::MIN, 0), 64);
    }
}
