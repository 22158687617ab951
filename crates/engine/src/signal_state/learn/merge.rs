//! What all groups teach, put together: the model that one machine would have learned of the log.

use thiserror::Error;

use crate::plant_part::PlantPart;
use crate::signal_state::enabling::Trigger;
use crate::signal_state::model::{Learned, NominalModel};
use crate::signal_state::rules::Rule;
use crate::signal_state::states::{NO_STATE, StateId, States};

use super::LearnError;
use super::context::Context;
use super::lesson::{First, LearnedRule, Lesson};

/// Why lessons make no model.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MergeError {
    /// A group that nobody learned.
    #[error("nobody learned group '{group}'; a model needs a lesson of every group")]
    Missing {
        /// Its name.
        group: String,
    },
    /// A lesson that does not fit.
    #[error("a lesson of group number {group} is one too many, or of another plant")]
    Stranger {
        /// Its number.
        group: usize,
    },
    /// There is nothing in them.
    #[error(transparent)]
    Learn(#[from] LearnError),
}

/// Puts the lessons of all groups together, whatever their order.
///
/// # Errors
/// A group with no lesson, or two; lessons without any event.
pub fn merge(context: &Context, lessons: Vec<Lesson>) -> Result<NominalModel, MergeError> {
    let mut plant = context.plant.clone();
    let groups = plant.groups.len();
    let mut of_group: Vec<Option<Lesson>> = (0..groups).map(|_| None).collect();
    for lesson in lessons {
        let group = lesson.group;
        match of_group.get_mut(group) {
            Some(place @ None) => *place = Some(lesson),
            _ => return Err(MergeError::Stranger { group }),
        }
    }
    let mut taught = Vec::with_capacity(groups);
    for (group, lesson) in of_group.into_iter().enumerate() {
        let name = || plant.groups[group].name.clone();
        let lesson = lesson.ok_or_else(|| MergeError::Missing { group: name() })?;
        let part = PlantPart::of(&plant, &[group]);
        if !fits(&lesson, &part) {
            return Err(MergeError::Stranger { group });
        }
        taught.push((lesson, part));
    }
    if taught.iter().all(|(lesson, _)| lesson.events == 0) {
        return Err(LearnError::NoEvents.into());
    }
    let states = all_states(&taught, plant.signals.len());
    for (lesson, part) in &taught {
        for (&device, starting) in part.devices.iter().zip(&lesson.starting) {
            let whole = starting.map(|own| part.signals[own as usize]);
            plant.devices[device].starting = whole;
        }
    }
    let numbered =
        |(lesson, part): &(Lesson, PlantPart), state| whole(&states, lesson, part, state);
    let learned = Learned {
        events: taught.iter().map(|(lesson, _)| lesson.events).sum(),
        duration: context.duration,
        resolution: context.resolution,
        scan_window: context.scan_window,
        longest_pause: taught.iter().map(|(lesson, _)| lesson.longest_pause).collect(),
        group_start: taught.iter().map(|of| numbered(of, of.0.group_start)).collect(),
    };
    let devices = plant.devices.len();
    let mut rules: Vec<(First, Rule)> = Vec::new();
    for (group, of) in taught.iter().enumerate() {
        let chain = |own: usize| of.1.devices.get(own).copied().unwrap_or(devices + group);
        let number = |state| numbered(of, state);
        let own = of.0.rules.iter();
        rules.extend(own.map(|rule| (rule.first, renumbered(rule, chain(rule.chain), number))));
    }
    // Those of one time and place are of one signal, so of one group, and in its order already.
    rules.sort_by_key(|(first, _)| *first);
    let rules = (0..).zip(rules).map(|(sequence, (_, rule))| Rule { sequence, ..rule }).collect();
    Ok(NominalModel::assemble(plant, states, rules, learned, context.parameters.clone()))
}

/// Every number a lesson holds must lead somewhere.
fn fits(lesson: &Lesson, part: &PlantPart) -> bool {
    let signals = part.signals.len();
    let signal_ok = |signal: u32| (signal as usize) < signals;
    let states = 2 * signals + lesson.further.len();
    let state_ok = |state: StateId| state == NO_STATE || (state as usize) < states;
    let rule_ok = |rule: &LearnedRule| {
        let trigger = rule.trigger.iter().flat_map(|(states, _)| states);
        rule.chain <= part.devices.len()
            && rule.current != NO_STATE
            && rule.next != NO_STATE
            && [rule.current, rule.next].iter().chain(trigger).all(|&state| state_ok(state))
    };
    lesson.starting.len() == part.devices.len()
        && lesson.starting.iter().flatten().all(|&signal| signal_ok(signal))
        && lesson.further.iter().all(|&(signal, ..)| signal_ok(signal))
        && state_ok(lesson.group_start)
        && lesson.rules.iter().all(rule_ok)
}

/// The states of all groups, numbered in the order in which they were first seen.
fn all_states(taught: &[(Lesson, PlantPart)], signals: usize) -> States {
    let further = |(lesson, part): &(Lesson, PlantPart)| -> Vec<_> {
        let of_part = lesson.further.iter();
        of_part.map(|&(own, value, first)| (first, part.signals[own as usize], value)).collect()
    };
    let mut further: Vec<_> = taught.iter().flat_map(further).collect();
    further.sort_by_key(|&(first, ..)| first);
    let mut states = States::new(signals);
    for (_, signal, value) in further {
        states.intern(signal, value);
    }
    states
}

/// A state's number in the whole plant.
fn whole(states: &States, lesson: &Lesson, part: &PlantPart, state: StateId) -> StateId {
    if state == NO_STATE {
        return NO_STATE;
    }
    let beyond = (state as usize).checked_sub(2 * part.signals.len());
    let (own, value) = match beyond.and_then(|beyond| lesson.further.get(beyond)) {
        Some(&(own, value, _)) => (own, value),
        None => (state / 2, i64::from(state % 2)),
    };
    states.find(part.signals[own as usize], value).unwrap_or(NO_STATE)
}

fn renumbered(rule: &LearnedRule, chain: usize, number: impl Fn(StateId) -> StateId) -> Rule {
    Rule {
        chain,
        current: number(rule.current),
        next: number(rule.next),
        count: rule.count,
        uncounted: rule.uncounted,
        odd_at_start: rule.odd_at_start,
        probability: rule.probability,
        sequence: 0,
        position: rule.position,
        dispersion: rule.dispersion,
        clusters: rule.clusters.clone(),
        trigger: rule.trigger.as_ref().map(|(states, clusters)| {
            let states = states.map(&number);
            Box::new(Trigger { states, clusters: clusters.clone() })
        }),
    }
}
