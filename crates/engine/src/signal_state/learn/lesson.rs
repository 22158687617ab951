//! What one group teaches, learned from its rows alone.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::log::{ChangeLog, Nanoseconds, SignalIndex};
use crate::plant_part::PlantPart;
use crate::saved_state;
use crate::signal_state::chains::ChainIndex;
use crate::signal_state::enabling::Trigger;
use crate::signal_state::order::ScanOrder;
use crate::signal_state::parameters::Timing;
use crate::signal_state::rules::Rule;
use crate::signal_state::states::{StateId, States};
use crate::timing::Clusters;

use super::context::Context;
use super::reading::{self, Source};
use super::starting;
use super::teach::teach;

/// Why rows cannot be learned from.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum LessonError {
    /// Columns of different length, or a number that is none of the group's.
    #[error("row {row} of group '{group}' is no row of this group; give each group its own rows")]
    Stranger {
        /// Row of the group, counted from 1.
        row: usize,
        /// The group.
        group: String,
    },
    /// A row older than the one before it.
    #[error(
        "row {row} of group '{group}' is older than the row before it; sort a group's rows by time"
    )]
    Order {
        /// Row of the group, counted from 1.
        row: usize,
        /// The group.
        group: String,
    },
    /// A group that is not there.
    #[error("there is no group number {group}; the plant has {groups}")]
    Group {
        /// Number given.
        group: usize,
        /// Number of groups.
        groups: usize,
    },
}

/// When something first happened: time, and place among what happened then.
pub(super) type First = (Nanoseconds, i64);

/// A rule of a group, under the numbers of the group's own plant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct LearnedRule {
    pub(super) first: First,
    pub(super) chain: ChainIndex,
    pub(super) current: StateId,
    pub(super) next: StateId,
    pub(super) count: u32,
    pub(super) uncounted: u32,
    pub(super) odd_at_start: u32,
    pub(super) probability: f64,
    pub(super) position: u32,
    pub(super) dispersion: f32,
    pub(super) clusters: Clusters,
    pub(super) trigger: Option<([StateId; 2], Clusters)>,
}

impl LearnedRule {
    fn of(rule: Rule, first: First) -> Self {
        Self {
            first,
            chain: rule.chain,
            current: rule.current,
            next: rule.next,
            count: rule.count,
            uncounted: rule.uncounted,
            odd_at_start: rule.odd_at_start,
            probability: rule.probability,
            position: rule.position,
            dispersion: rule.dispersion,
            clusters: rule.clusters,
            trigger: rule.trigger.map(|trigger| {
                let Trigger { states, clusters } = *trigger;
                (states, clusters)
            }),
        }
    }
}

/// What one group teaches.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lesson {
    pub(super) group: usize,
    pub(super) events: u64,
    pub(super) longest_pause: Nanoseconds,
    pub(super) group_start: StateId,
    /// By device.
    pub(super) starting: Vec<Option<SignalIndex>>,
    /// Values of words beyond 0 and 1, and when each was first seen.
    pub(super) further: Vec<(SignalIndex, i64, First)>,
    /// In the order of first appearance.
    pub(super) rules: Vec<LearnedRule>,
}

impl Lesson {
    /// Everything, compactly.
    pub fn save(&self) -> Vec<u8> {
        saved_state::sealed(self)
    }

    /// From what was saved; `None` where it is damaged or of another version.
    pub fn restore(bytes: &[u8]) -> Option<Self> {
        postcard::from_bytes(saved_state::unsealed(bytes)?).ok()
    }
}

/// Gathers the rows of one group, in time order, and learns from them.
#[derive(Debug)]
pub struct Learner {
    context: Arc<Context>,
    group: usize,
    part: PlantPart,
    log: ChangeLog,
    /// Places of the rows among those of one time, where that matters and is told.
    places: Vec<i64>,
}

impl Learner {
    /// A learner of one group, by number.
    ///
    /// # Errors
    /// A group that is not there.
    pub fn new(context: Arc<Context>, group: usize) -> Result<Self, LessonError> {
        let groups = context.plant.groups.len();
        if group >= groups {
            return Err(LessonError::Group { group, groups });
        }
        let part = PlantPart::of(&context.plant, &[group]);
        let signals = part.plant.signals.iter().map(|signal| signal.symbol().to_owned()).collect();
        let log = ChangeLog { signals, ..ChangeLog::default() };
        Ok(Self { context, group, part, log, places: Vec::new() })
    }

    /// The number of its group.
    pub fn group(&self) -> usize {
        self.group
    }

    /// Takes rows in time order: time, number of the signal in the whole plant, value, and the
    /// place among rows of one time, where it is told (of all rows, or of none).
    ///
    /// # Errors
    /// A row of another group, or older than the one before it.
    pub fn add(
        &mut self,
        rows: impl Iterator<Item = (Nanoseconds, SignalIndex, i64, Option<i64>)>,
    ) -> Result<(), LessonError> {
        let name = || self.context.plant.groups[self.group].name.clone();
        let mut newest = self.log.time.last().copied().unwrap_or(Nanoseconds::MIN);
        for (time, signal, value, place) in rows {
            let row = self.log.len() + 1;
            if time < newest {
                return Err(LessonError::Order { row, group: name() });
            }
            newest = time;
            let own = self.part.own(signal);
            let own = own.ok_or_else(|| LessonError::Stranger { row, group: name() })?;
            self.log.time.push(time);
            self.log.signal.push(own);
            self.log.value.push(value);
            if let Some(place) = place.filter(|_| self.context.keeps_places()) {
                self.places.push(place);
            }
        }
        Ok(())
    }

    /// Learns from all rows.
    pub fn learn(self) -> Lesson {
        let Self { context, group, mut part, log, places } = self;
        let parameters = &context.parameters;
        let plant = &mut part.plant;
        let order = (parameters.timing == Timing::Adaptive).then(|| ScanOrder::of(plant));
        let mut states = States::new(plant.signals.len());
        let numbers: Vec<SignalIndex> = (0..plant.signals.len() as SignalIndex).collect();
        let source = Source { log: &log, runs: &context.runs, numbers: &numbers };
        let events = reading::read_events(&[source], plant, &mut states, order.as_ref());
        drop(log);
        starting::set_first(plant, &events.first);
        // The only group's.
        let happenings = &events.groups[0].happenings;
        let first = |event: usize| {
            let happening = &happenings[event];
            let place = events.rows.get(event).and_then(|&row| places.get(row as usize)).copied();
            let (signal, _) = states.signal_value(happening.state);
            let rank = || context.rank(part.signals[signal as usize]);
            (happening.time, place.unwrap_or_else(rank))
        };
        let mut seen = vec![None; states.further().len()];
        for (event, happening) in happenings.iter().enumerate() {
            let beyond = (happening.state as usize).checked_sub(2 * plant.signals.len());
            if let Some(beyond) = beyond {
                seen[beyond].get_or_insert_with(|| first(event));
            }
        }
        let taught = teach(&events, plant, &states, parameters, context.resolution);
        let further = states.further().iter().zip(seen);
        let rules = taught.rules.into_iter().zip(&taught.first);
        Lesson {
            group,
            events: u64::from(events.number),
            longest_pause: taught.longest_pause[0],
            group_start: taught.group_start[0],
            starting: plant.devices.iter().map(|device| device.starting).collect(),
            further: further
                .map(|(&(signal, value), first)| (signal, value, first.unwrap_or_default()))
                .collect(),
            rules: rules
                .into_iter()
                .map(|(rule, at)| LearnedRule::of(rule, first(*at as usize)))
                .collect(),
        }
    }
}
