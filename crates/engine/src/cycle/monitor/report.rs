//! Findings as they are made: what should have come, which bits say so, and what came before.

use std::sync::Arc;

use crate::cycle::image::Phase;
use crate::cycle::localise::{self, Candidate};
use crate::cycle::machine::{State, Then};
use crate::cycle::regions::Word;
use crate::cycle::stops::{Showed, Sign};
use crate::cycle::{message, order};
use crate::finding::{
    Expected, Finding, Kind, Model, Severity, State as Standing, Suspect, stable_id,
};
use crate::log::{Nanoseconds, SECOND};

use super::{Monitor, Open};

/// Candidates listed with a finding.
const CANDIDATES_AT_MOST: usize = 32;
/// Suspects listed with a finding.
const SUSPECTS_AT_MOST: usize = 16;
/// The highest final score, 2 · 1 + 1: suspects are scored from 0 to 1.
const HIGHEST_SCORE: f64 = 3.0;
/// Mode `element`: a change that was overtaken, one that came unexpectedly, one that is awaited.
const OVERTAKEN: f64 = 0.9;
const UNEXPECTED: f64 = 0.6;
const AWAITED: f64 = 0.3;

/// How a region left its sequences.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Departure {
    /// A word that never followed.
    Transition { from: State },
    /// A sequence that ended in a state none ended in.
    End { at: State },
    /// A sequence that began with a word none began with.
    Start,
    /// A region that stays longer than it ever did.
    Overdue,
    /// Its latest change is a known one, but never came so soon.
    Early,
}

impl Monitor {
    /// Notes a departure of this reading; it is told once the whole reading is judged.
    pub(super) fn report(
        &mut self,
        region: usize,
        phase: Phase,
        time: Nanoseconds,
        departure: Departure,
    ) {
        if let Some(open) = self.make(region, phase, time, departure) {
            self.fresh.push(open);
        }
    }

    /// A departure in the phase that runs.
    pub(super) fn departed(
        &self,
        region: usize,
        time: Nanoseconds,
        departure: Departure,
    ) -> Option<Open> {
        self.make(region, self.watch.phase?, time, departure)
    }

    fn make(
        &self,
        region: usize,
        phase: Phase,
        time: Nanoseconds,
        departure: Departure,
    ) -> Option<Open> {
        let model = Arc::clone(&self.model);
        let machine = model.machine(region, phase);
        let shown = &model.regions[region];
        let here = self.here(region, phase);
        let word = self.word(region);
        let stay_s = match departure {
            Departure::Overdue => {
                Some(machine.outlook(here.state, here.came).stay as f64 / SECOND as f64)
            }
            _ => None,
        };
        let (from, seen) = match departure {
            Departure::Transition { from } => (Some(from), word),
            Departure::End { at } => (Some(at), machine.word(at)),
            Departure::Start => (None, word),
            Departure::Overdue => (Some(here.state), word),
            Departure::Early => (Some(here.before.0), word),
        };
        let possible: Vec<(Word, u64)> = match departure {
            // Beyond the paper, which waits for a word that never comes.
            Departure::Overdue => {
                let then = machine.outlook(here.state, here.came).then;
                let due = |then: &Then| {
                    let (_, count) = then.due(self.watch.position)?;
                    Some((machine.word(then.to), count))
                };
                let awaited: Vec<(Word, u64)> = then.iter().filter_map(due).collect();
                if self.element {
                    order::unskipped(machine, machine.word(here.state), awaited)
                } else {
                    awaited
                }
            }
            Departure::Transition { from } => machine.weights(from, here.came),
            // It should have stayed.
            Departure::Early => vec![(machine.word(here.before.0), 1)],
            Departure::End { .. } => {
                machine.nodes.iter().filter(|n| n.last > 0).map(|n| (n.word, n.last)).collect()
            }
            Departure::Start => {
                let initial = machine.nodes.iter().filter(|n| n.initial > 0);
                initial.map(|n| (n.word, n.initial)).collect()
            }
        };
        // A state nothing ever followed should have been kept.
        let possible = match from {
            Some(from) if possible.is_empty() => vec![(machine.word(from), 1)],
            _ => possible,
        };
        let candidates = localise::candidates(possible, seen, shown.width());
        let suspects = match departure {
            Departure::Transition { from } if self.element => {
                self.element_suspects(region, phase, from, word, &candidates)
            }
            Departure::Overdue if here.ahead => {
                // What has happened before its turn is not what is missing.
                let ahead = machine.word(here.state) ^ word;
                word_suspects(&candidates, !ahead)
            }
            _ => word_suspects(&candidates, Word::MAX),
        };
        let suspects = self.named(region, &suspects);
        let first = suspects.first().and_then(|s| model.bits.iter().find(|b| b.name == s.signal));
        let state_name = |word: Word| format!("{}={}", shown.name, shown.hex(word));
        let kind = if departure == Departure::Start { Kind::StartState } else { Kind::Sequence };
        let mut finding = Finding::new(kind, Model::Cycle, time);
        finding.state = Standing::Suspected;
        finding.rank = Some(localise::class(false, true));
        // Without an alarm bit nobody says whether the machine has stopped.
        finding.severity =
            if model.modes.alarm.is_empty() { Severity::Anomaly } else { Severity::Notice };
        finding.group = first.map(|bit| bit.group.clone());
        finding.device = first.map(|bit| bit.device.clone());
        finding.signal = first.map(|bit| bit.short_name().to_owned());
        finding.address = first.and_then(|bit| bit.address.clone());
        finding.from = from.map(|state| state_name(machine.word(state)));
        finding.to = match departure {
            Departure::Transition { .. } | Departure::Start | Departure::Early => {
                Some(state_name(word))
            }
            Departure::End { .. } | Departure::Overdue => None,
        };
        finding.expected = candidates
            .iter()
            .take(CANDIDATES_AT_MOST)
            .map(|c| Expected {
                state: state_name(c.word),
                probability: c.popularity,
                limit_s: stay_s,
            })
            .collect();
        if departure == Departure::Overdue {
            finding.observed_s = Some(time.saturating_sub(here.since) as f64 / SECOND as f64);
            finding.limit_s = stay_s;
        }
        finding.path = finding.from.iter().chain(&finding.to).cloned().collect();
        finding.suspects = suspects;
        finding.id = stable_id(
            kind,
            &format!("{}/{}", shown.name, phase.name()),
            finding.from.as_deref().unwrap_or_default(),
            finding.to.as_deref().unwrap_or_default(),
            time,
        );
        let before = from.map_or(word, |state| machine.word(state));
        let signs = self.signs(region, before, seen, departure, &candidates);
        finding.message =
            message::departure(&model, region, phase, departure_text(departure), before, &finding);
        Some(Open {
            finding,
            region: Some(region as u32),
            deadline: time.saturating_add(self.alarm_within),
            known: 0,
            never_ends: false,
            signs,
        })
    }

    /// What shows of a departure: bits that came out of turn, or are awaited.
    fn signs(
        &self,
        region: usize,
        before: Word,
        word: Word,
        departure: Departure,
        candidates: &[Candidate],
    ) -> Vec<Sign> {
        let best = candidates.first().map_or(word, |candidate| candidate.word);
        let (showed, mask, values) = match departure {
            Departure::Transition { .. } => {
                (Showed::Came, out_of_turn(before, word, candidates), word)
            }
            Departure::Early => (Showed::Came, before ^ word, word),
            Departure::Start => (Showed::Came, best ^ word, word),
            Departure::Overdue | Departure::End { .. } => (Showed::Awaited, best ^ word, best),
        };
        let shown = &self.model.regions[region];
        let mut signs = Vec::new();
        for (slot, bit) in shown.slots.iter().enumerate() {
            if let Some(bit) = bit.filter(|_| mask & shown.mask(slot) != 0) {
                let value = values & shown.mask(slot) != 0;
                signs.push(Sign { showed, bit: bit as u32, value });
            }
        }
        signs
    }

    /// Mode `element`: the change itself, not the whole word. Where it comes later on a known
    /// path, what it overtook is suspected before it; else it is the one nobody expected.
    fn element_suspects(
        &self,
        region: usize,
        phase: Phase,
        from: State,
        word: Word,
        candidates: &[Candidate],
    ) -> Vec<(Word, f64)> {
        let machine = self.model.machine(region, phase);
        let independence = &self.model.independence[region][phase.index()];
        let left = machine.word(from);
        let changed = left ^ word;
        let came = self.here(region, phase).came;
        let overtaken = order::overtaken(machine, independence, from, came, word);
        let (mut suspects, came) = match overtaken {
            Some(bits) if !bits.is_empty() => {
                (bits.into_iter().map(|bit| (bit, OVERTAKEN)).collect::<Vec<_>>(), UNEXPECTED)
            }
            _ => (Vec::new(), OVERTAKEN),
        };
        suspects.push((out_of_turn(left, word, candidates), came));
        for candidate in candidates {
            let awaited = (candidate.word ^ left) & !changed;
            suspects.push((awaited, AWAITED * candidate.popularity));
        }
        suspects
    }

    /// Masks with scores as suspects, each bit once, best first.
    fn named(&self, region: usize, masks: &[(Word, f64)]) -> Vec<Suspect> {
        let mut named: Vec<(usize, f64)> = Vec::new();
        for &(mask, score) in masks {
            for bit in self.model.regions[region].bits_of(mask) {
                if named.iter().all(|(known, _)| *known != bit) {
                    named.push((bit, score));
                }
            }
        }
        named.sort_by(|a, b| b.1.total_cmp(&a.1));
        named.truncate(SUSPECTS_AT_MOST);
        named
            .into_iter()
            .map(|(bit, score)| {
                let bit = &self.model.bits[bit];
                Suspect {
                    address: bit.address.clone(),
                    signal: bit.name.clone(),
                    score: (score * 1e4).round() / 1e4,
                }
            })
            .collect()
    }

    /// Tells a finding of class 3 and waits whether an alarm follows.
    pub(super) fn tell_suspected(&mut self, mut open: Open, time: Nanoseconds) {
        let told = self.tell(open.finding.clone());
        open.finding.incident = told;
        self.watch.open.push(open.clone());
        self.watch_the_clock();
        self.count(&open.finding, time);
    }

    /// Gives a finding its incident and tells it.
    pub(super) fn tell(&mut self, mut finding: Finding) -> String {
        if finding.incident.is_empty() {
            let incident = self.watch.incident.get_or_insert_with(|| finding.id.clone());
            finding.incident.clone_from(incident);
        }
        let incident = finding.incident.clone();
        self.findings.push(finding);
        incident
    }

    /// Class 3 and 4 at the same address, over time.
    fn count(&mut self, finding: &Finding, time: Nanoseconds) {
        let Some(suspect) = finding.suspects.first() else {
            return;
        };
        let Some(bit) = self.model.bits.iter().position(|bit| bit.name == suspect.signal) else {
            return;
        };
        let parameters = &self.model.parameters;
        let addresses = self.model.regions.iter().map(|r| r.slots.iter().flatten().count()).sum();
        let rise = self.watch.rates.entry(bit as u32).or_default().found(
            self.watch.sequences,
            u64::from(parameters.rate_window),
            parameters.rate_significance,
            addresses,
        );
        if let Some(rise) = rise {
            let notice = message::rising(&self.model, bit, rise, time);
            self.findings.push(notice);
        }
    }
}

/// Of several changes in one reading the ones that were due are not out of turn.
fn out_of_turn(before: Word, word: Word, candidates: &[Candidate]) -> Word {
    let changed = before ^ word;
    let expected = candidates.iter().fold(0, |all, c| all | (c.word ^ before));
    if changed & !expected == 0 { changed } else { changed & !expected }
}

/// Section 3.6: the bits in which prediction and failure differ, each candidate's by its score.
fn word_suspects(candidates: &[Candidate], counted: Word) -> Vec<(Word, f64)> {
    candidates.iter().map(|c| (c.differing & counted, c.score / HIGHEST_SCORE)).collect()
}

fn departure_text(departure: Departure) -> message::Told {
    match departure {
        Departure::Transition { .. } => message::Told::Transition,
        Departure::End { .. } => message::Told::End,
        Departure::Start => message::Told::Start,
        Departure::Overdue => message::Told::Overdue,
        Departure::Early => message::Told::Early,
    }
}
