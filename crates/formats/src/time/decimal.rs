//! Times written as a decimal number of units since an epoch.

use runglight_engine::log::{Nanoseconds, SECOND};

use super::{A_NUMBER, IN_RANGE, NOT_NEGATIVE};

/// A decimal number: `mantissa · 10^exponent`, without the rounding of a float.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decimal {
    mantissa: i128,
    exponent: i32,
}

impl Decimal {
    /// The number times `unit`, cut to an integer.
    pub(super) fn scaled(self, unit: i64) -> Option<i128> {
        let product = self.mantissa.checked_mul(i128::from(unit))?;
        let power = 10_i128.checked_pow(self.exponent.unsigned_abs());
        if self.exponent >= 0 {
            product.checked_mul(power?)
        } else {
            Some(power.map_or(0, |power| product / power))
        }
    }
}

pub(super) fn decimal(cell: &[u8]) -> Option<Decimal> {
    // 25 digits are more than any time needs, and times 10^9 they still fit 128 bits.
    const DIGITS: u32 = 25;
    let (negative, digits) = match cell {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        digits => (false, digits),
    };
    let mut mantissa: i128 = 0;
    let mut exponent: i32 = 0;
    let (mut seen, mut point, mut rest) = (0, false, digits);
    while let [byte, tail @ ..] = rest {
        match byte {
            b'0'..=b'9' => {
                let significant = mantissa != 0 || *byte != b'0';
                if seen < DIGITS {
                    mantissa = mantissa * 10 + i128::from(byte - b'0');
                    seen += u32::from(significant);
                    exponent -= i32::from(point);
                } else {
                    exponent += i32::from(!point);
                }
            }
            b'.' | b',' if !point => point = true,
            b'e' | b'E' if rest.len() < digits.len() => {
                exponent = exponent
                    .checked_add(std::str::from_utf8(tail).ok()?.parse::<i16>().ok()?.into())?;
                break;
            }
            _ => return None,
        }
        rest = tail;
    }
    let has_digit = digits.first()?.is_ascii_digit() || digits.get(1)?.is_ascii_digit();
    has_digit.then_some(Decimal { mantissa: if negative { -mantissa } else { mantissa }, exponent })
}

pub(super) fn number(
    cell: &[u8],
    unit: Nanoseconds,
    epoch_s: i64,
) -> Result<Nanoseconds, &'static str> {
    let scaled = if !cell.is_empty() && cell.len() <= 18 && cell.iter().all(u8::is_ascii_digit) {
        let whole = cell.iter().fold(0_i64, |sum, byte| sum * 10 + i64::from(byte - b'0'));
        i128::from(whole) * i128::from(unit)
    } else {
        let number = decimal(cell).ok_or(A_NUMBER)?;
        if number.mantissa < 0 {
            return Err(NOT_NEGATIVE);
        }
        number.scaled(unit).ok_or(IN_RANGE)?
    };
    let time = scaled + i128::from(epoch_s) * i128::from(SECOND);
    Nanoseconds::try_from(time).map_err(|_| IN_RANGE)
}
