//! What terminals are called in Structured Text, and where the PLC keeps them.

use crate::control::program::{Program, TerminalIndex};

/// Names, places and types of a program's terminals.
pub(super) struct Names {
    terminals: Vec<Name>,
}

struct Name {
    identifier: String,
    /// `%IX0.1`; none where the log knew a name only.
    place: Option<String>,
    kind: &'static str,
}

impl Names {
    pub(super) fn of(program: &Program) -> Self {
        let mut terminals: Vec<Name> = Vec::new();
        for terminal in &program.terminals {
            let place = place(&terminal.address);
            let stem = Self::identifier(place.as_deref().unwrap_or(&terminal.address));
            let taken = |name: &str| {
                terminals.iter().any(|known: &Name| known.identifier.eq_ignore_ascii_case(name))
            };
            let mut identifier = stem.clone();
            let mut number = 2;
            while taken(&identifier) {
                identifier = format!("{stem}_{number}");
                number += 1;
            }
            let kind = place.as_deref().map_or("BOOL", kind);
            terminals.push(Name { identifier, place, kind });
        }
        Self { terminals }
    }

    pub(super) fn get(&self, terminal: TerminalIndex) -> &str {
        &self.terminals[terminal].identifier
    }

    pub(super) fn is_bit(&self, terminal: TerminalIndex) -> bool {
        self.kind(terminal) == "BOOL"
    }

    pub(super) fn kind(&self, terminal: TerminalIndex) -> &'static str {
        self.terminals[terminal].kind
    }

    pub(super) fn place(&self, terminal: TerminalIndex) -> Option<&str> {
        self.terminals[terminal].place.as_deref()
    }

    /// Letters, digits and single underscores, beginning with a letter (IEC 61131-3, 6.1.2).
    pub(super) fn identifier(text: &str) -> String {
        let mut identifier = String::new();
        for letter in text.chars() {
            if letter.is_ascii_alphanumeric() {
                identifier.push(letter);
            } else if !identifier.is_empty() && !identifier.ends_with('_') {
                identifier.push('_');
            }
        }
        let identifier = identifier.trim_end_matches('_');
        if identifier.starts_with(|first: char| first.is_ascii_alphabetic()) {
            identifier.to_owned()
        } else {
            format!("v_{identifier}")
        }
    }
}

/// `%IX0.1` of `%IX0.1`, `%I0.1` and `I0.1`; none of a name.
fn place(address: &str) -> Option<String> {
    let bare = address.strip_prefix('%').unwrap_or(address);
    let mut letters = bare.chars();
    let area = letters.next().filter(|area| "IQM".contains(*area))?;
    let rest = letters.as_str();
    let (size, number) = match rest.chars().next()? {
        size @ ('X' | 'B' | 'W' | 'D') => (size, &rest[1..]),
        _ => ('X', rest),
    };
    let is_number = !number.is_empty()
        && number.starts_with(|c: char| c.is_ascii_digit())
        && number.ends_with(|c: char| c.is_ascii_digit())
        && number.chars().all(|c| c.is_ascii_digit() || c == '.');
    is_number.then(|| format!("%{area}{size}{number}"))
}

fn kind(place: &str) -> &'static str {
    match place.as_bytes().get(2) {
        Some(b'B') => "USINT",
        Some(b'W') => "UINT",
        Some(b'D') => "UDINT",
        _ => "BOOL",
    }
}
