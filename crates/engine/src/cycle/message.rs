//! The sentences of the cycle machine's findings. One place for all wording.

use crate::finding::{Finding, Kind, Model, Suspect, stable_id};
use crate::log::{Nanoseconds, SECOND};

use super::image::Phase;
use super::model::CycleModel;
use super::rate::Rise;
use super::regions::{Bit, Word};

/// Changes named in one sentence.
const NAMED_AT_MOST: usize = 3;

/// What is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Told {
    /// A word that never followed.
    Transition,
    /// A sequence ended where none ended.
    End,
    /// A sequence began where none began.
    Start,
    /// A region waits too long.
    Overdue,
    /// A known change came too soon.
    Early,
}

fn bit_text(bit: &Bit) -> String {
    let name = format!("{} {}", bit.device, bit.short_name());
    match &bit.address {
        Some(address) if *address != bit.symbol || bit.symbol != bit.name => {
            format!("{name} ({address})")
        }
        _ => name,
    }
}

/// "CLAMP2 ADV (I12.2) ON and CLAMP2 RET (I12.3) OFF".
fn changes(model: &CycleModel, region: usize, from: Word, to: Word) -> String {
    let shown = &model.regions[region];
    let mut named = Vec::new();
    for (slot, bit) in shown.slots.iter().enumerate() {
        if let Some(bit) = bit.filter(|_| (from ^ to) & shown.mask(slot) != 0) {
            let value = if to & shown.mask(slot) == 0 { "OFF" } else { "ON" };
            named.push(format!("{} {value}", bit_text(&model.bits[bit])));
        }
    }
    let more = named.len().saturating_sub(NAMED_AT_MOST);
    named.truncate(NAMED_AT_MOST);
    let text = named.join(" and ");
    if more > 0 { format!("{text} and {more} more") } else { text }
}

/// How a region left its sequences; `before` is the word it stood at.
pub fn departure(
    model: &CycleModel,
    region: usize,
    phase: Phase,
    told: Told,
    before: Word,
    finding: &Finding,
) -> String {
    let shown = &model.regions[region];
    let word_of = |state: &str| {
        state.rsplit_once('=').and_then(|(_, hex)| Word::from_str_radix(hex, 16).ok())
    };
    let expected = finding.expected.first().and_then(|expected| word_of(&expected.state));
    let awaited = expected
        .map(|word| changes(model, region, before, word))
        .filter(|text| !text.is_empty())
        .unwrap_or_else(|| "nothing more".to_owned());
    let seen = finding.to.as_deref().and_then(word_of).unwrap_or(before);
    let (phase, name) = (phase.name(), &shown.name);
    let what = match told {
        Told::Transition => format!(
            "{name}: {} came out of turn during {phase} ({} after {}); expected {awaited}",
            changes(model, region, before, seen),
            shown.hex(seen),
            shown.hex(before),
        ),
        Told::End => format!(
            "{name}: {phase} ended at {}, where it never ended; expected {awaited} first",
            shown.hex(before)
        ),
        Told::Start => {
            let expected = expected.map_or_else(|| "another".to_owned(), |w| shown.hex(w));
            format!("{name}: {phase} began at {}, expected {expected}", shown.hex(seen))
        }
        Told::Early => format!(
            "{name}: {} came sooner than ever during {phase}",
            changes(model, region, before, seen)
        ),
        Told::Overdue => format!(
            "{name}: {awaited} did not come: due within {:.1} s, waited {:.1} s",
            finding.limit_s.unwrap_or_default(),
            finding.observed_s.unwrap_or_default()
        ),
    };
    format!("{what}{}", first_suspect(model, finding))
}

fn first_suspect(model: &CycleModel, finding: &Finding) -> String {
    let bit = |suspect: &Suspect| model.bits.iter().find(|bit| bit.name == suspect.signal);
    let text = finding.suspects.first().and_then(bit).map(bit_text);
    text.map_or_else(String::new, |text| format!("; look at {text} first"))
}

/// The machine stopped with an alarm after it.
pub fn alarm(message: &str) -> String {
    format!("{message}; the machine has stopped with an alarm since")
}

/// The machine stopped as it often does, and nothing is broken.
pub fn known_stop(message: &str, seen: u64) -> String {
    let first = message.split("; look at").next().unwrap_or_default();
    format!("{first}; the machine stopped so {seen} times while it was learned: no failure")
}

/// Back on known words.
pub fn returned(message: &str) -> String {
    let first = message.split("; look at").next().unwrap_or_default();
    format!("{first}; it is back on a known sequence")
}

/// A sequence that takes too long.
pub fn never_ends(
    phase: Phase,
    took: Nanoseconds,
    longest: Nanoseconds,
    finding: &Finding,
) -> String {
    let seconds = |time: Nanoseconds| time as f64 / SECOND as f64;
    format!(
        "The {} sequence does not end: {:.0} s, the longest learned took {:.0} s; {}",
        phase.name(),
        seconds(took),
        seconds(longest),
        finding.message
    )
}

/// Class 3 and 4 come more often at an address.
pub fn rising(model: &CycleModel, bit: usize, rise: Rise, time: Nanoseconds) -> Finding {
    let bit = &model.bits[bit];
    let window = model.parameters.rate_window;
    let mut finding = Finding::new(Kind::Sequence, Model::Cycle, time);
    finding.id = stable_id(Kind::Sequence, &bit.name, "rising", "", time);
    finding.incident.clone_from(&finding.id);
    finding.group = Some(bit.group.clone());
    finding.device = Some(bit.device.clone());
    finding.signal = Some(bit.short_name().to_owned());
    finding.address.clone_from(&bit.address);
    finding.observed_s = Some(rise.recent as f64 / f64::from(window));
    finding.limit_s = Some(rise.before as f64 / rise.sequences_before as f64);
    finding.suspects =
        vec![Suspect { address: bit.address.clone(), signal: bit.name.clone(), score: 1.0 }];
    finding.message = format!(
        "{} leaves its sequence more and more often: {} times in the last {window} sequences, {} in the {} before (chance {:.1e}); see to it before it stops the machine",
        bit_text(bit),
        rise.recent,
        rise.before,
        rise.sequences_before,
        rise.chance
    );
    finding
}
