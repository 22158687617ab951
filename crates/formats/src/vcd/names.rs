//! Signal names in a format whose names have no white space.

use hashbrown::HashSet;
use std::fmt::Write;

/// A name that every VCD reader takes, and no two signals share.
pub(super) fn reference(name: &str, taken: &mut HashSet<String>) -> String {
    // Brackets would be read as a bit range, a dollar sign as a keyword.
    let fits = |character: char| {
        character.is_ascii_graphic() && !matches!(character, '$' | '[' | ']' | '\\')
    };
    let base: String =
        name.chars().map(|character| if fits(character) { character } else { '_' }).collect();
    let base = if base.is_empty() { "_".to_owned() } else { base };
    let mut reference = base.clone();
    let mut number = 2;
    while !taken.insert(reference.clone()) {
        reference = format!("{base}_{number}");
        number += 1;
    }
    reference
}

/// A name as one word of a comment: percent-encoded.
pub(super) fn encode(name: &str) -> String {
    let mut encoded = String::with_capacity(name.len());
    for byte in name.bytes() {
        if byte.is_ascii_graphic() && !matches!(byte, b'%' | b'$') {
            encoded.push(char::from(byte));
        } else {
            // Writing into a string cannot fail.
            let _ = write!(encoded, "%{byte:02X}");
        }
    }
    encoded
}

/// The inverse of [`encode`].
pub(super) fn decode(encoded: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(encoded.len());
    let mut rest = encoded.as_bytes();
    while let [first, tail @ ..] = rest {
        rest = tail;
        if *first == b'%' {
            let (digits, tail) = tail.split_at_checked(2)?;
            bytes.push(u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()?);
            rest = tail;
        } else {
            bytes.push(*first);
        }
    }
    String::from_utf8(bytes).ok()
}
