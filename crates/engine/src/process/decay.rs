//! Decay replay (Theis 2019, section III-F; DREAM): a marking that remembers when.
//!
//! Each place decays from the moment a token enters it, f(δ) = max(0, β − α·δ), and counts how
//! often one did. A *sample* is all decays, all counters and the marking at one time.

use std::ops::Range;

use super::event_log::EventLog;
use super::petri::{PetriNet, PlaceIndex, TransitionIndex};
use super::replay::TokenReplay;
use super::succession::Succession;
use crate::log::{Nanoseconds, SECOND};

/// β: the value of a place a token has just entered.
pub const FULL: f32 = 10.0;

/// No token has entered the place in this trace.
const NEVER: Nanoseconds = Nanoseconds::MIN;

/// α of each place.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Decay {
    /// α of each place, per second.
    pub rate_per_s: Vec<f32>,
}

impl Decay {
    /// α = β / mean gap between two activations of the place within a trace; places that are
    /// activated once per trace decay over the longest trace.
    pub fn fit(replay: &mut TokenReplay, log: &EventLog, traces: &[usize]) -> Self {
        let places = replay.net().places.len();
        let mut gaps = vec![(0.0f64, 0u32); places];
        let mut longest: Nanoseconds = 0;
        let mut state = DecayState::new(replay.net());
        for &trace in traces {
            let times = log.times(trace);
            let (Some(first), Some(last)) = (times.first(), times.last()) else { continue };
            longest = longest.max(last - first);
            state.restart(replay.net(), *first);
            replay.restart();
            for (&activity, &time) in log.trace(trace).iter().zip(times) {
                let moved = replay.step(activity);
                for &place in replay.touched(&moved) {
                    let before = state.activated[place as usize];
                    if before != NEVER {
                        let gap = &mut gaps[place as usize];
                        *gap = (gap.0 + (time - before) as f64, gap.1 + 1);
                    }
                }
                state.follow(replay.touched(&moved), replay.marking(), time);
            }
        }
        let rate = |over_ns: f64| {
            if over_ns > 0.0 { (f64::from(FULL) * SECOND as f64 / over_ns) as f32 } else { 0.0 }
        };
        let rate_per_s = gaps
            .iter()
            .map(
                |&(sum, count)| {
                    if sum > 0.0 { rate(sum / f64::from(count)) } else { rate(longest as f64) }
                },
            )
            .collect();
        Self { rate_per_s }
    }
}

/// A running trace: marking, last activation and counter of each place.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct DecayState {
    /// Tokens on each place.
    pub marking: Vec<u32>,
    /// When each place was last activated.
    activated: Vec<Nanoseconds>,
    /// How often each place was activated in this trace.
    counters: Vec<u32>,
    /// Time of the last event.
    time: Nanoseconds,
}

impl DecayState {
    /// At the initial marking of a net, before any event.
    pub fn new(net: &PetriNet) -> Self {
        let places = net.places.len();
        Self {
            marking: net.initial.clone(),
            activated: vec![NEVER; places],
            counters: vec![0; places],
            time: NEVER,
        }
    }

    /// A new trace opens at `time`: nothing of the last one is remembered.
    pub fn restart(&mut self, net: &PetriNet, time: Nanoseconds) {
        self.marking.copy_from_slice(&net.initial);
        self.activated.fill(NEVER);
        self.counters.fill(0);
        self.time = time;
    }

    /// Time of the last event: when a sample for the next one is taken.
    pub fn time(&self) -> Nanoseconds {
        self.time
    }

    /// How often each place was activated in this trace.
    pub fn counters(&self) -> &[u32] {
        &self.counters
    }

    /// Takes over what a replay did at one event.
    pub fn follow(&mut self, touched: &[PlaceIndex], marking: &[u32], time: Nanoseconds) {
        for &place in touched {
            self.activated[place as usize] = time;
            self.counters[place as usize] += 1;
        }
        self.marking.copy_from_slice(marking);
        self.time = time;
    }

    /// Fires silent transitions and then a visible one, as one event; for whoever plays the token
    /// game by themselves. Every transition must be enabled when its turn comes.
    pub fn fire(&mut self, net: &PetriNet, transitions: &[TransitionIndex], time: Nanoseconds) {
        let before = self.marking.clone();
        let mut entered = vec![false; before.len()];
        for &transition in transitions {
            net.fire(&mut self.marking, transition);
            for &place in &net.transitions[transition as usize].outputs {
                entered[place as usize] = true;
            }
        }
        for place in 0..before.len() {
            if entered[place] || before[place] != self.marking[place] {
                self.activated[place] = time;
                self.counters[place] += 1;
            }
        }
        self.time = time;
    }

    /// Number of features of a sample: decay, counter and marking of each place.
    pub fn features(places: usize) -> usize {
        3 * places
    }

    /// Writes the sample at time `now`. `into` holds [`DecayState::features`] numbers.
    pub fn sample(&self, decay: &Decay, now: Nanoseconds, into: &mut [f32]) {
        let places = self.marking.len();
        let (decays, rest) = into.split_at_mut(places);
        let (counters, marking) = rest.split_at_mut(places);
        for ((value, &since), &rate) in
            decays.iter_mut().zip(&self.activated).zip(&decay.rate_per_s)
        {
            let age_s = now.saturating_sub(since) as f32 / SECOND as f32;
            *value = if since == NEVER { 0.0 } else { (FULL - rate * age_s).max(0.0) };
        }
        for (value, &count) in counters.iter_mut().zip(&self.counters) {
            *value = count as f32;
        }
        for (value, &tokens) in marking.iter_mut().zip(&self.marking) {
            *value = tokens as f32;
        }
    }
}

/// One sample per event that can be foretold: the state just after the event before it, and the
/// activity that came.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Samples {
    /// Features, sample after sample.
    pub features: Vec<f32>,
    /// Activity that came.
    pub next: Vec<u32>,
    /// Trace and number of the event that came.
    pub event: Vec<(usize, usize)>,
    /// First sample of each trace, and behind the last one the number of samples.
    pub bounds: Vec<usize>,
}

impl Samples {
    /// Replays some traces. Samples are taken at the time of the event before: at the predicted
    /// event's own time they would give it away.
    pub fn take(
        replay: &mut TokenReplay,
        decay: &Decay,
        log: &EventLog,
        traces: &[usize],
        succession: Succession,
    ) -> Self {
        let width = DecayState::features(replay.net().places.len());
        let events: usize = traces.iter().map(|&trace| log.trace(trace).len()).sum();
        let mut samples = Self {
            features: vec![0.0; events * width],
            next: Vec::with_capacity(events),
            event: Vec::with_capacity(events),
            bounds: vec![0],
        };
        let mut state = DecayState::new(replay.net());
        for &trace in traces {
            let (activities, times) = (log.trace(trace), log.times(trace));
            if let Some(&first) = times.first() {
                state.restart(replay.net(), first);
            }
            replay.restart();
            for (event, (&activity, &time)) in activities.iter().zip(times).enumerate() {
                let moved = replay.step(activity);
                state.follow(replay.touched(&moved), replay.marking(), time);
                let Some(next) = succession.next(log, trace, event) else { break };
                let row = samples.next.len() * width;
                state.sample(decay, time, &mut samples.features[row..row + width]);
                samples.next.push(log.trace(next.0)[next.1]);
                samples.event.push(next);
            }
            samples.bounds.push(samples.next.len());
        }
        samples.features.truncate(samples.next.len() * width);
        samples
    }

    /// Features of one sample.
    pub fn width(&self) -> usize {
        if self.next.is_empty() { 0 } else { self.features.len() / self.next.len() }
    }

    /// The features of some samples.
    pub fn rows(&self, samples: Range<usize>) -> &[f32] {
        let width = self.width();
        &self.features[samples.start * width..samples.end * width]
    }
}
