//! The rules as the hot loop wants them: filed by the state they lead to, one cache line each,
//! with their limits and counters in it.
//!
//! The state a row leads to says where its [`Lane`] lies, whatever its device did before. So the
//! lanes of coming rows can be fetched ahead of their turn, and an event that takes the most
//! frequent transition into its state touches one line. Everything else a rule knows stays in the
//! model until something departs from it.

use std::sync::Arc;

use crate::log::{Nanoseconds, SECOND};
use crate::timing::TimeCluster;
use crate::timing::limits::Accepted;

use super::chains::{ChainIndex, ChainKind};
use super::enabling::Trigger;
use super::model::NominalModel;
use super::parameters::Timing;
use super::rules::Rule;
use super::states::{NO_STATE, StateId};

/// A state not entered since the start or a gap.
pub const NEVER: Nanoseconds = Nanoseconds::MIN;
/// No lane, no trigger.
const NONE: u32 = u32::MAX;

/// What was seen of one cluster of a rule since the last check.
#[derive(Debug, Clone, Copy, Default)]
pub struct Seen {
    /// Sum of the times.
    pub sum: Nanoseconds,
    /// Number of the times.
    pub count: u32,
}

/// Accepted times of one cluster of a rule. The bands of a rule do not overlap; the band is the
/// cluster.
#[derive(Debug, Clone, Copy)]
struct Band {
    early: Nanoseconds,
    late: Nanoseconds,
    seen: Seen,
}

impl Band {
    #[inline]
    fn take(&mut self, time: Nanoseconds) -> bool {
        let within = time >= self.early && time <= self.late;
        if within {
            self.seen.count += 1;
            self.seen.sum += time;
        }
        within
    }
}

/// One rule; the first lane of a state also keeps when the state was entered. 64 bytes.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Lane {
    /// The state it leads from.
    current: StateId,
    /// Place of its links to other lanes into the same state.
    links: u32,
    /// The device of the state it leads to.
    device: u32,
    /// Times it was taken since the last check.
    count: u32,
    entered: Nanoseconds,
    /// Its first band.
    early: Nanoseconds,
    late: Nanoseconds,
    sum: Nanoseconds,
    seen: u32,
    /// Place of its trigger.
    trigger: u32,
    /// Place of its further bands, and how many bands it has in all.
    more: u32,
    bands: u16,
    /// True where the state is one of its device's starting signal.
    starting: bool,
}

/// Other lanes into the same state.
#[derive(Debug, Clone, Copy)]
struct Links {
    /// The next lane of the same chain.
    further: u32,
    /// From the first lane of a state: the first lane of the group's chain.
    group: u32,
}

/// No rule leads here.
const UNUSED: Lane = Lane {
    current: NO_STATE,
    links: NONE,
    device: NONE,
    count: 0,
    entered: NEVER,
    early: Nanoseconds::MIN,
    late: Nanoseconds::MAX,
    sum: 0,
    seen: 0,
    trigger: NONE,
    more: 0,
    bands: 0,
    starting: false,
};

/// What is known of a state by its number alone.
#[derive(Debug, Clone, Copy)]
pub struct Entered {
    /// When it was entered before.
    pub before: Nanoseconds,
    /// Its device.
    pub device: ChainIndex,
    /// True where it is one of its device's starting signal.
    pub starting: bool,
}

/// One rule as the periodic checks come to it: twice its number, and one more where it is the
/// first of several out of its state.
#[derive(Debug, Clone, Copy)]
pub struct Checked(u32);

impl Checked {
    /// The rule.
    pub fn rule(self) -> usize {
        self.0 as usize / 2
    }

    /// True where it is the first of several out of its state.
    pub fn branches(self) -> bool {
        self.0 % 2 == 1
    }
}

/// What all monitors of a model share.
#[derive(Debug)]
struct Layout {
    /// Per rule: its lane; and back.
    lane_of: Vec<u32>,
    rule_of: Vec<u32>,
    links: Vec<Links>,
    /// The states that enable rules which wait for another event.
    triggers: Vec<[StateId; 2]>,
    /// States of which something must know when they were entered, sorted.
    tracked: Vec<StateId>,
    /// Per group: its rules in the order of the complete transition sequence.
    checked: Vec<Vec<Checked>>,
}

/// Lanes of a model: the first of every state, in their order, then the others.
#[derive(Debug, Clone)]
pub struct Lanes {
    lanes: Vec<Lane>,
    states: usize,
    /// Bands that are not the first of their rule.
    more: Vec<Band>,
    layout: Arc<Layout>,
}

impl Layout {
    /// The links of a lane, made where it has none.
    fn links_of(&mut self, lane: &mut Lane) -> &mut Links {
        if lane.links == NONE {
            lane.links = self.links.len() as u32;
            self.links.push(Links { further: NONE, group: NONE });
        }
        &mut self.links[lane.links as usize]
    }
}

impl Lanes {
    /// Fresh lanes: nothing counted.
    pub fn of(model: &NominalModel) -> Self {
        let states = model.states.len();
        let mut layout = Layout {
            lane_of: vec![NONE; model.rules.len()],
            rule_of: Vec::new(),
            links: Vec::new(),
            triggers: Vec::new(),
            tracked: Vec::new(),
            checked: checked(model),
        };
        let mut lanes: Vec<Lane> = (0..states as StateId)
            .map(|state| {
                let signal = model.states.signal_value(state).0;
                Lane {
                    device: model.chains.device_chain(signal) as u32,
                    starting: model.chains.group_chain(signal).is_some(),
                    ..UNUSED
                }
            })
            .collect();
        let mut more = Vec::new();
        // The most frequent into a state first: it gets the state's own line.
        let mut order: Vec<u32> = (0..model.rules.len() as u32).collect();
        order.sort_by_key(|&rule| {
            let rule = &model.rules[rule as usize];
            (rule.next, model.kind(rule.chain) == ChainKind::Group, std::cmp::Reverse(rule.count))
        });
        let mut bands = Vec::new();
        let mut last: Option<(StateId, ChainKind, usize)> = None;
        for index in order {
            let rule = &model.rules[index as usize];
            let kind = model.kind(rule.chain);
            let first = rule.next as usize;
            let at = match last {
                _ if kind == ChainKind::Device && lanes[first].current == NO_STATE => first,
                Some((state, of, before)) if state == rule.next && of == kind => {
                    let new = lanes.len() as u32;
                    layout.links_of(&mut lanes[before]).further = new;
                    lanes.len()
                }
                _ => {
                    let new = lanes.len() as u32;
                    layout.links_of(&mut lanes[first]).group = new;
                    lanes.len()
                }
            };
            if at == lanes.len() {
                lanes.push(UNUSED);
            }
            last = Some((rule.next, kind, at));
            layout.lane_of[index as usize] = at as u32;
            bands.clear();
            cut_bands(model, rule, &model.accepted(index as usize), &mut bands);
            let lane = &mut lanes[at];
            lane.current = rule.current;
            lane.bands = bands.len() as u16;
            lane.more = more.len() as u32;
            if let Some((first, others)) = bands.split_first() {
                (lane.early, lane.late) = (first.early, first.late);
                more.extend_from_slice(others);
            }
            if let Some(trigger) = &rule.trigger {
                lane.trigger = layout.triggers.len() as u32;
                layout.triggers.push(trigger.states);
                layout.tracked.extend(trigger.states().chain([rule.next]));
            }
        }
        lanes.shrink_to_fit();
        layout.rule_of = vec![NONE; lanes.len()];
        for (rule, &lane) in (0..).zip(&layout.lane_of) {
            layout.rule_of[lane as usize] = rule;
        }
        more.shrink_to_fit();
        layout.tracked.sort_unstable();
        layout.tracked.dedup();
        layout.tracked.shrink_to_fit();
        layout.links.shrink_to_fit();
        layout.triggers.shrink_to_fit();
        Self { lanes, states, more, layout: Arc::new(layout) }
    }

    /// Reads the lane of a state, so that it is at hand when its turn comes.
    #[inline]
    pub fn touch(&self, state: usize) -> u32 {
        self.lanes.get(state).map_or(0, |lane| lane.count)
    }

    /// Reads what the lane of a state leads on to; the lane is at hand.
    #[inline]
    pub fn touch_further(&self, state: usize) -> u32 {
        let Some(lane) = self.lanes.get(state) else { return 0 };
        let mut touched = 0;
        if lane.bands > 1 {
            touched ^= self.more.get(lane.more as usize).map_or(0, |band| band.seen.count);
        }
        if lane.starting
            && let Some(links) = self.layout.links.get(lane.links as usize)
        {
            touched ^= self.touch(links.group as usize);
        }
        touched
    }

    /// Keeps that a state was entered. `None` for a state nobody learned: nothing waits for it.
    #[inline]
    pub fn enter(&mut self, state: StateId, time: Nanoseconds) -> Option<Entered> {
        if state as usize >= self.states {
            return None;
        }
        let lane = &mut self.lanes[state as usize];
        Some(Entered {
            before: std::mem::replace(&mut lane.entered, time),
            device: lane.device as ChainIndex,
            starting: lane.starting,
        })
    }

    /// Sight was lost: as if no state had ever been entered.
    pub fn forget_entries(&mut self) {
        for lane in &mut self.lanes[..self.states] {
            lane.entered = NEVER;
        }
    }

    /// The lane of a chain's rule between two states.
    #[inline]
    pub fn find(&self, kind: ChainKind, current: StateId, next: StateId) -> Option<usize> {
        if next as usize >= self.states {
            return None;
        }
        let first = &self.lanes[next as usize];
        if kind == ChainKind::Device && first.current == current {
            return Some(next as usize);
        }
        let links = self.layout.links.get(first.links as usize)?;
        let mut at = if kind == ChainKind::Device { links.further } else { links.group };
        loop {
            let lane = self.lanes.get(at as usize)?;
            if lane.current == current {
                return Some(at as usize);
            }
            at = self.layout.links.get(lane.links as usize)?.further;
        }
    }

    /// True where the lane's time runs from another event.
    #[inline]
    pub fn waits(&self, lane: usize) -> bool {
        self.lanes[lane].trigger != NONE
    }

    /// Since when a lane that waits was due, see [`Trigger::due`].
    #[inline]
    pub fn due(&self, lane: usize, before: Nanoseconds, own: Nanoseconds) -> Option<Nanoseconds> {
        let states = *self.layout.triggers.get(self.lanes[lane].trigger as usize)?;
        Trigger::due(states, |state| self.lanes[state as usize].entered, before, own)
    }

    /// Counts a transition whose time is accepted; false, and nothing counted, where it is not.
    #[inline]
    pub fn take(&mut self, lane: usize, time: Nanoseconds) -> bool {
        let lane = &mut self.lanes[lane];
        if time >= lane.early && time <= lane.late {
            lane.seen += 1;
            lane.sum = lane.sum.wrapping_add(time);
        } else {
            let first = lane.more as usize;
            let others = usize::from(lane.bands.saturating_sub(1));
            if !self.more[first..first + others].iter_mut().any(|band| band.take(time)) {
                return false;
            }
        }
        lane.count += 1;
        true
    }

    /// Counts a transition whose time means nothing.
    pub fn take_untimed(&mut self, lane: usize) {
        self.lanes[lane].count += 1;
    }

    /// The rule of a lane.
    pub fn rule(&self, lane: usize) -> usize {
        self.layout.rule_of[lane] as usize
    }

    /// How often a rule was taken since the last check.
    pub fn count(&self, rule: usize) -> u32 {
        self.lane(rule).count
    }

    /// What was seen of the clusters of a rule since the last check.
    pub fn seen(&self, rule: usize) -> impl Iterator<Item = Seen> + Clone + '_ {
        let lane = self.lane(rule);
        let first = Seen { sum: lane.sum, count: lane.seen };
        let others = &self.more[others(lane)];
        (lane.bands > 0).then_some(first).into_iter().chain(others.iter().map(|band| band.seen))
    }

    /// The rules of a group, causes first.
    pub fn checked(&self, group: usize) -> &[Checked] {
        self.layout.checked.get(group).map_or(&[], Vec::as_slice)
    }

    /// Starts the counters of a group's rules anew.
    pub fn reset(&mut self, group: usize) {
        let layout = Arc::clone(&self.layout);
        for checked in layout.checked.get(group).into_iter().flatten() {
            let lane = &mut self.lanes[layout.lane_of[checked.rule()] as usize];
            (lane.count, lane.seen, lane.sum) = (0, 0, 0);
            for band in &mut self.more[others(lane)] {
                band.seen = Seen::default();
            }
        }
    }

    /// All counters and times, to be saved.
    pub fn counters(&self) -> Counters {
        let rules = 0..self.layout.lane_of.len();
        Counters {
            lanes: rules.clone().map(|rule| self.count(rule)).collect(),
            bands: rules.flat_map(|rule| self.seen(rule)).map(|s| (s.count, s.sum)).collect(),
            entered: self
                .layout
                .tracked
                .iter()
                .map(|&state| (state, self.lanes[state as usize].entered))
                .filter(|&(_, entered)| entered != NEVER)
                .collect(),
        }
    }

    /// Sets all counters and times; false where they are not of these lanes.
    pub fn set_counters(&mut self, counters: &Counters) -> bool {
        if counters.lanes.len() != self.layout.lane_of.len() {
            return false;
        }
        let mut bands = counters.bands.iter();
        for (&at, &count) in self.layout.lane_of.iter().zip(&counters.lanes) {
            let lane = &mut self.lanes[at as usize];
            lane.count = count;
            if lane.bands > 0 {
                let Some(&(count, sum)) = bands.next() else { return false };
                (lane.seen, lane.sum) = (count, sum);
            }
            for band in &mut self.more[others(lane)] {
                let Some(&(count, sum)) = bands.next() else { return false };
                band.seen = Seen { count, sum };
            }
        }
        for &(state, entered) in &counters.entered {
            match self.lanes[..self.states].get_mut(state as usize) {
                Some(lane) => lane.entered = entered,
                None => return false,
            }
        }
        bands.next().is_none()
    }

    fn lane(&self, rule: usize) -> &Lane {
        &self.lanes[self.layout.lane_of[rule] as usize]
    }
}

/// Where the further bands of a lane lie.
fn others(lane: &Lane) -> std::ops::Range<usize> {
    let first = lane.more as usize;
    first..first + usize::from(lane.bands.saturating_sub(1))
}

/// What changes in [`Lanes`].
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Counters {
    /// Per rule.
    lanes: Vec<u32>,
    /// Per cluster of each rule.
    bands: Vec<(u32, Nanoseconds)>,
    /// When states were entered of which something must know.
    entered: Vec<(StateId, Nanoseconds)>,
}

/// The rules of each group in the order of the complete transition sequence.
fn checked(model: &NominalModel) -> Vec<Vec<Checked>> {
    let mut groups: Vec<Vec<Checked>> = vec![Vec::new(); model.plant.groups.len()];
    for (index, rule) in model.rules.iter().enumerate() {
        let row = model.table.row(super::rules::row_of(rule.current, model.kind(rule.chain)));
        let first = row.clone().min_by_key(|&other| model.rules[other].sequence);
        groups[model.chains.group_of(rule.chain)]
            .push(Checked(2 * index as u32 + u32::from(row.len() > 1 && first == Some(index))));
    }
    for group in &mut groups {
        group.sort_by_key(|checked| model.rules[checked.rule()].sequence);
        group.shrink_to_fit();
    }
    groups
}

/// The accepted times of a rule's clusters as bands that do not overlap.
fn cut_bands(model: &NominalModel, rule: &Rule, accepted: &[Accepted], into: &mut Vec<Band>) {
    let clusters = rule.judged();
    for i in 0..clusters.len() {
        let (early, late) = match accepted.get(i) {
            Some(accepted) => (nanoseconds(accepted.early_s), nanoseconds(accepted.late_s)),
            None => (0, Nanoseconds::MAX),
        };
        into.push(Band { early, late, seen: Seen::default() });
    }
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

fn nanoseconds(seconds: f64) -> Nanoseconds {
    // A saturating cast: an endless limit is the largest time.
    (seconds * SECOND as f64).round() as Nanoseconds
}

impl Trigger {
    /// Since when the transition was due: the later of the enabling states. `None` where the
    /// device was not waiting for it: one of them has not been entered afresh since the device
    /// last did the same (`before`), or the device's own last event (`own`) is the later.
    #[inline]
    pub fn due(
        states: [StateId; 2],
        entered: impl Fn(StateId) -> Nanoseconds,
        before: Nanoseconds,
        own: Nanoseconds,
    ) -> Option<Nanoseconds> {
        let [one, other] = states;
        let first = entered(one);
        let second = if other == NO_STATE { first } else { entered(other) };
        let (older, later) = (first.min(second), first.max(second));
        (older >= before && older != Nanoseconds::MIN && later >= own).then_some(later)
    }
}
