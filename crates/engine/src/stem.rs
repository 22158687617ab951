//! Devices for names that tell none: signals whose names begin alike belong together.
//!
//! `I_CapGrabberDown`, `I_CapGrabberUp` and `O_CapGrabberOpenClose` are one device, `CapGrabber`:
//! the `I_` and `O_` say where a signal lies, not what it belongs to.

use std::collections::HashMap;

/// The device of each name: the longest run of leading words it shares with another name.
pub fn devices_by_stem<'a>(names: impl Iterator<Item = &'a String>) -> HashMap<String, String> {
    let words: Vec<(&String, Vec<&str>)> = names.map(|name| (name, words(bare(name)))).collect();
    let mut shared: HashMap<Vec<String>, usize> = HashMap::new();
    for (_, words) in &words {
        for end in 1..=stem_limit(words) {
            *shared.entry(key(&words[..end])).or_default() += 1;
        }
    }
    words
        .iter()
        .map(|(name, words)| {
            let end = (1..=stem_limit(words))
                .rev()
                .find(|&end| shared.get(&key(&words[..end])).is_some_and(|&count| count > 1))
                .unwrap_or(words.len());
            // One spelling for the device, whatever the case of the word in each name.
            let device: String = words[..end].iter().map(|w| capitalised(w)).collect();
            let device = if device.is_empty() { (*name).clone() } else { device };
            ((*name).clone(), device)
        })
        .collect()
}

/// The last word of a name of several words is the signal's own.
fn stem_limit(words: &[&str]) -> usize {
    if words.len() > 1 { words.len() - 1 } else { words.len() }
}

fn key(words: &[&str]) -> Vec<String> {
    words.iter().map(|w| w.to_lowercase()).collect()
}

fn capitalised(word: &str) -> String {
    let mut characters = word.chars();
    characters.next().map_or_else(String::new, |first| {
        first.to_uppercase().collect::<String>() + characters.as_str()
    })
}

/// The name without `%I`, `%Q`, `%M`, `I_`, `O_w_` and the like.
fn bare(name: &str) -> &str {
    if let Some(address) = name.strip_prefix('%') {
        let mut characters = address.chars();
        characters.next();
        return if characters.as_str().is_empty() { name } else { characters.as_str() };
    }
    let mut rest = name;
    while let Some((head, tail)) = rest.split_once('_') {
        if head.chars().count() != 1 || !head.chars().all(char::is_alphabetic) || tail.is_empty() {
            break;
        }
        rest = tail;
    }
    rest
}

/// Splits at `_`, `.`, `-`, blanks, before a capital that follows a small letter, and before
/// digits.
fn words(name: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let mut start = 0;
    let mut before: Option<char> = None;
    for (at, character) in name.char_indices() {
        let separator = !character.is_alphanumeric();
        let boundary = before.is_some_and(|b| {
            (b.is_lowercase() && character.is_uppercase())
                || (b.is_alphabetic() && character.is_numeric())
        });
        if (separator || boundary) && at > start {
            words.push(&name[start..at]);
        }
        if separator {
            start = at + character.len_utf8();
        } else if boundary {
            start = at;
        }
        before = Some(character);
    }
    if start < name.len() {
        words.push(&name[start..]);
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn device(of: &str, names: &[&str]) -> String {
        let names: Vec<String> = names.iter().map(|n| (*n).to_owned()).collect();
        devices_by_stem(names.iter())[of].clone()
    }

    #[test]
    fn markers_are_no_devices() {
        let names = ["I_CapGrabberDown", "O_CapGrabberOpenClose", "I_Pump_Up", "O_PumpUpDown"];
        assert_eq!(device("I_CapGrabberDown", &names), "CapGrabber");
        assert_eq!(device("O_CapGrabberOpenClose", &names), "CapGrabber");
        assert_eq!(device("O_PumpUpDown", &names), "Pump");
        assert_eq!(device("I_Pump_Up", &names), "Pump");
    }

    #[test]
    fn addresses_of_one_byte_are_one_device() {
        assert_eq!(device("%IX0.1", &["%IX0.0", "%IX0.1", "%QX0.0"]), "X0");
    }

    #[test]
    fn a_lonely_name_is_its_own_device() {
        assert_eq!(device("Heartbeat", &["Heartbeat", "I_Pump_Up"]), "Heartbeat");
    }
}
