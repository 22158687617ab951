//! Values as logs write them: integers, truth values, and floats that are integers.

/// What a cell of a log should hold.
pub(crate) const EXPECTED: &str = "an integer, true/false or on/off";

/// One cell of a value column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cell {
    /// An integer, or a truth value as 0 or 1.
    Integer(i64),
    /// A number that is no integer.
    Real(f64),
    /// Nothing, or NaN.
    Empty,
    /// Something else.
    Text,
}

impl Cell {
    /// A float as a cell: integral ones are integers.
    pub(crate) fn from_real(real: f64) -> Self {
        // Above 2^63 a float is no i64; both bounds are exact as floats.
        const LIMIT: f64 = 9_223_372_036_854_775_808.0;
        if real.is_nan() {
            Self::Empty
        } else if real.trunc() == real && (-LIMIT..LIMIT).contains(&real) {
            Self::Integer(real as i64)
        } else {
            Self::Real(real)
        }
    }

    /// Parses a cell that blanks were trimmed from.
    #[inline]
    pub(crate) fn parse(cell: &[u8]) -> Self {
        match cell {
            [digit @ b'0'..=b'9'] => Self::Integer(i64::from(digit - b'0')),
            _ => Self::parse_longer(cell),
        }
    }

    fn parse_longer(cell: &[u8]) -> Self {
        let Ok(text) = std::str::from_utf8(cell) else { return Self::Text };
        let Some(first) = cell.first() else { return Self::Empty };
        if matches!(first, b'0'..=b'9' | b'-' | b'+' | b'.') {
            return Self::parse_number(text);
        }
        for (word, meant) in [
            ("true", Self::Integer(1)),
            ("false", Self::Integer(0)),
            ("on", Self::Integer(1)),
            ("off", Self::Integer(0)),
            ("nan", Self::Empty),
            ("null", Self::Empty),
            ("none", Self::Empty),
            ("na", Self::Empty),
            ("n/a", Self::Empty),
        ] {
            if text.eq_ignore_ascii_case(word) {
                return meant;
            }
        }
        Self::Text
    }

    fn parse_number(text: &str) -> Self {
        if let Ok(integer) = text.parse() {
            return Self::Integer(integer);
        }
        // "12.000" stays exact even where a float would round it.
        if let Some((whole, fraction)) = text.split_once(['.', ','])
            && fraction.bytes().all(|byte| byte == b'0')
            && let Ok(integer) = whole.parse()
        {
            return Self::Integer(integer);
        }
        let real = match text.parse::<f64>() {
            Ok(real) => real,
            // A decimal comma, where the delimiter is another character.
            Err(_) => match text.replacen(',', ".", 1).parse::<f64>() {
                Ok(real) => real,
                Err(_) => return Self::Text,
            },
        };
        Self::from_real(real)
    }
}
