//! Laying the rules of a model out in lanes.

use std::sync::Arc;

use crate::log::{Nanoseconds, SECOND};
use crate::signal_state::chains::ChainKind;
use crate::signal_state::model::NominalModel;
use crate::signal_state::parameters::Timing;
use crate::signal_state::rules::Rule;
use crate::signal_state::states::{NO_STATE, StateId};
use crate::timing::TimeCluster;
use crate::timing::limits::Accepted;

use super::checked::{self, Checks};
use super::counted::Seen;
use super::sides::{Side, Sides};
use super::within::Within;
use super::{Band, INLINE, Lane, Lanes, NEVER, NONE, NOWHERE, Starting, Traits, UNUSED};

/// What does not change while watching.
#[derive(Debug)]
pub(super) struct Layout {
    /// By rule.
    pub(super) lane_of: Vec<u32>,
    /// By lane.
    pub(super) rule_of: Vec<u32>,
    /// By lane: number of its bands.
    pub(super) bands: Vec<u16>,
    /// States of which something must know when they were entered, ascending: theirs are the first
    /// sides with something on them.
    pub(super) tracked: Vec<StateId>,
    /// Per group: its rules, as their lanes lie.
    pub(super) checks: Vec<Checks>,
}

impl Layout {
    /// The place of the side of a state that is tracked.
    pub(super) fn place(&self, state: StateId) -> Option<usize> {
        self.tracked.binary_search(&state).ok().map(|number| number + 1)
    }
}

impl Lanes {
    /// Fresh lanes: nothing counted.
    pub fn of(model: &NominalModel) -> Self {
        let states = model.states.len();
        let mut layout = Layout {
            lane_of: vec![NONE; model.rules.len()],
            rule_of: Vec::new(),
            bands: Vec::new(),
            tracked: tracked(model),
            checks: Vec::new(),
        };
        let mut sides = Sides::new();
        let mut lanes = first_lanes(model);
        lanes.reserve_exact(further_lanes(model));
        for &state in &layout.tracked {
            side_of(&mut sides, &mut lanes[state as usize]);
        }
        let mut more = Vec::new();
        let mut bands = Vec::new();
        let mut from = Vec::with_capacity(lanes.capacity() - states);
        for index in most_frequent_first(model) {
            let rule = &model.rules[index as usize];
            let kind = model.kind(rule.chain);
            let first = rule.next as usize;
            let at = if kind == ChainKind::Device && lanes[first].current == NOWHERE {
                first
            } else {
                let place = from.len() as u32;
                side_of(&mut sides, &mut lanes[first]).add_further(kind, place);
                from.push(rule.current);
                lanes.push(UNUSED);
                lanes.len() - 1
            };
            layout.lane_of[index as usize] = at as u32;
            cut(model, rule, &model.accepted(index as usize), &mut bands);
            let lane = &mut lanes[at];
            lane.current = rule.current;
            for (within, band) in lane.within.iter_mut().zip(&bands) {
                *within = Band::from(band).within;
            }
            if let Some(others) = bands.get(INLINE..).filter(|others| !others.is_empty()) {
                let side = side_of(&mut sides, lane);
                (side.more, side.bands) = (more.len() as u32, others.len() as u32);
                more.extend(others.iter().map(Band::from));
                lane.side |= Traits::MORE;
            }
            if let Some(trigger) = &rule.trigger {
                let place = |state| layout.place(state).map_or(NONE, |place| place as u32);
                side_of(&mut sides, lane).due = trigger.states.map(place);
                lane.side |= Traits::WAITS;
            }
        }
        layout.finish(lanes.len(), model);
        let starting = starting(model, &lanes, &sides.0, &from);
        let untimed = vec![0; lanes.len()];
        more.shrink_to_fit();
        Self {
            lanes,
            states,
            from: from.into(),
            more,
            entered: vec![NEVER; sides.0.len()],
            starting: starting.into(),
            sides: sides.0.into(),
            untimed,
            times_groups: model.times(ChainKind::Group),
            layout: Arc::new(layout),
        }
    }
}

impl Layout {
    fn finish(&mut self, lanes: usize, model: &NominalModel) {
        self.checks = checked::of_groups(model, &self.lane_of);
        self.rule_of = vec![NONE; lanes];
        self.bands = vec![0; lanes];
        for (rule, &lane) in self.lane_of.iter().enumerate() {
            self.rule_of[lane as usize] = rule as u32;
            self.bands[lane as usize] = model.rules[rule].judged().len() as u16;
        }
    }
}

/// The side of a lane, made where it has none of its own.
fn side_of<'a>(sides: &'a mut Sides, lane: &mut Lane) -> &'a mut Side {
    if lane.place_of_side() == 0 {
        lane.side |= sides.add() << Traits::BITS;
    }
    &mut sides.0[lane.place_of_side()]
}

/// One lane per state, before any rule has it.
fn first_lanes(model: &NominalModel) -> Vec<Lane> {
    let lane = |state| {
        let signal = model.states.signal_value(state).0;
        let starting = model.chains.group_chain(signal).is_some();
        Lane { side: if starting { Traits::STARTING } else { 0 }, ..UNUSED }
    };
    (0..model.states.len() as StateId).map(lane).collect()
}

/// By device chain, as its starting signal goes off and as it goes on: the lanes of the group.
fn starting(
    model: &NominalModel,
    lanes: &[Lane],
    sides: &[Side],
    from: &[StateId],
) -> Vec<Starting> {
    let mut starting =
        vec![Starting { first: NOWHERE, start: 0, end: 0 }; 2 * model.plant.devices.len()];
    for signal in 0..model.plant.signals.len() as StateId {
        if model.chains.group_chain(signal).is_none() {
            continue;
        }
        for state in [2 * signal, 2 * signal + 1] {
            let place = 2 * model.chains.device_chain(signal) + state as usize % 2;
            let side = &sides[lanes[state as usize].place_of_side()];
            if let Some(&first) =
                from.get(side.group as usize..side.end as usize).and_then(<[_]>::first)
            {
                starting[place] = Starting { first, start: side.group, end: side.end };
            }
        }
    }
    starting
}

/// How many rules will find the first lane of their state taken.
fn further_lanes(model: &NominalModel) -> usize {
    let mut entered = vec![false; model.states.len()];
    let device = |rule: &&Rule| model.kind(rule.chain) == ChainKind::Device;
    for rule in model.rules.iter().filter(device) {
        entered[rule.next as usize] = true;
    }
    model.rules.len() - entered.iter().filter(|&&entered| entered).count()
}

/// Rules by the state they lead to, the device's before the group's; the most frequent gets the
/// state's own line.
fn most_frequent_first(model: &NominalModel) -> Vec<u32> {
    let mut order: Vec<u32> = (0..model.rules.len() as u32).collect();
    order.sort_by_key(|&rule| {
        let rule = &model.rules[rule as usize];
        (rule.next, model.kind(rule.chain) == ChainKind::Group, std::cmp::Reverse(rule.count))
    });
    order
}

/// The states whose entries something must know, ascending.
fn tracked(model: &NominalModel) -> Vec<StateId> {
    let of = |rule: &Rule| {
        let states = rule.trigger.as_ref().map(|trigger| trigger.states);
        states.map(|[one, other]| [one, other, rule.next])
    };
    let mut tracked: Vec<StateId> =
        model.rules.iter().filter_map(of).flatten().filter(|&state| state != NO_STATE).collect();
    tracked.sort_unstable();
    tracked.dedup();
    tracked.shrink_to_fit();
    tracked
}

/// The accepted times of a rule's clusters, cut so that they do not overlap.
fn cut(model: &NominalModel, rule: &Rule, accepted: &[Accepted], into: &mut Vec<Cut>) {
    let clusters = rule.judged();
    into.clear();
    into.extend((0..clusters.len()).map(|i| match accepted.get(i) {
        Some(accepted) => {
            Cut { early: nanoseconds(accepted.early_s), late: nanoseconds(accepted.late_s) }
        }
        None => Cut { early: 0, late: Nanoseconds::MAX },
    }));
    let cut = into.as_mut_slice();
    for i in 1..cut.len() {
        let middle = |centre: fn(&TimeCluster) -> f64| {
            nanoseconds(0.5 * (centre(&clusters[i - 1]) + centre(&clusters[i])))
        };
        let boundary = match model.parameters.timing {
            // "The maximum transition time instance that is most similar to the query transition
            // time" decides (section 2.6), even where it then calls the time late.
            Timing::Plat => middle(|cluster| cluster.maximum_s),
            // Where two overlap, the nearer average has it; nothing accepted is lost.
            Timing::Adaptive if cut[i].early <= cut[i - 1].late => {
                middle(|cluster| cluster.average_s).clamp(cut[i].early, cut[i - 1].late)
            }
            Timing::Adaptive => continue,
        };
        cut[i - 1].late = cut[i - 1].late.min(boundary);
        cut[i].early = boundary.saturating_add(1);
    }
    // Nothing is earlier than at once.
    if let Some(first) = cut.first_mut()
        && first.early <= 0
    {
        first.early = Nanoseconds::MIN;
    }
}

/// The accepted times of one cluster.
struct Cut {
    early: Nanoseconds,
    late: Nanoseconds,
}

impl From<&Cut> for Band {
    fn from(cut: &Cut) -> Self {
        Self { within: Within::new(cut.early, cut.late), seen: Seen::default() }
    }
}

fn nanoseconds(seconds: f64) -> Nanoseconds {
    // A saturating cast: an endless limit is the largest time.
    (seconds * SECOND as f64).round() as Nanoseconds
}
