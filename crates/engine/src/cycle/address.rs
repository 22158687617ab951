//! Addresses in their order: `I5.0`, `%IX5.0`, `E5.0` and `DB1.DBX0.0` name a bit of a byte,
//! `10001` and `%M7` a flat number.

/// Where a signal lies, so that addresses can be sorted and ranges told.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// `I`, `Q`, `M`, `DB1.DB`; empty for bare numbers.
    pub area: String,
    /// Byte, or the flat number where there is no bit.
    pub number: u32,
    /// Bit of the byte.
    pub bit: Option<u8>,
}

impl Place {
    /// Reads an address; `None` for what is none.
    pub fn parse(address: &str) -> Option<Self> {
        let text = address.trim().trim_start_matches('%').to_ascii_uppercase();
        let (head, last) = split_number(&text)?;
        if let Some(front) = head.strip_suffix('.') {
            let (area, byte) = split_number(front)?;
            let bit: u8 = last.parse().ok().filter(|bit| *bit < 8)?;
            return Some(Self { area: area_of(area), number: byte.parse().ok()?, bit: Some(bit) });
        }
        Some(Self { area: area_of(head), number: last.parse().ok()?, bit: None })
    }

    /// Order inside a word: bytes ascending, in each byte the high bit first, so that a word
    /// reads like the hexadecimal numbers of the paper; flat numbers high first, like bits.
    pub fn word_order(&self) -> (String, u32, u8) {
        match self.bit {
            Some(bit) => (self.area.clone(), self.number, 7 - bit),
            None => (self.area.clone(), u32::MAX - self.number, 0),
        }
    }
}

/// The digits at the end of a text, and what stands before them.
fn split_number(text: &str) -> Option<(&str, &str)> {
    let digits = text.bytes().rev().take_while(u8::is_ascii_digit).count();
    (digits > 0).then(|| text.split_at(text.len() - digits))
}

/// German areas by their English letters; `IX`, `IB` and `DBX` name the same area as `I`, `DB`.
fn area_of(written: &str) -> String {
    let area = match written.strip_suffix(['X', 'B']) {
        Some(front) if !front.is_empty() && !front.ends_with('D') => front,
        _ => written,
    };
    match area {
        "E" => "I".to_owned(),
        "A" => "Q".to_owned(),
        other => other.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(area: &str, number: u32, bit: Option<u8>) -> Option<Place> {
        Some(Place { area: area.to_owned(), number, bit })
    }

    #[test]
    fn every_notation_is_read() {
        assert_eq!(Place::parse("I5.0"), place("I", 5, Some(0)));
        assert_eq!(Place::parse("%IX5.7"), place("I", 5, Some(7)));
        assert_eq!(Place::parse("E12.3"), place("I", 12, Some(3)));
        assert_eq!(Place::parse("DB1.DBX0.4"), place("DB1.DB", 0, Some(4)));
        assert_eq!(Place::parse("IB7"), place("I", 7, None));
        assert_eq!(Place::parse("10001"), place("", 10001, None));
        assert_eq!(Place::parse("%M7"), place("M", 7, None));
        for none in ["", "Clamp", "I5.8", "I5.99", "I.", "I99999999999"] {
            assert_eq!(Place::parse(none), None, "{none}");
        }
    }
}
