//! The rules as the hot loop wants them: small, flat, with their counters beside them.
//!
//! An event touches one [`Lane`] and one [`Band`] of the state it leaves. Everything else a rule
//! knows stays in the model until something departs from it.

use crate::log::{Nanoseconds, SECOND};
use crate::timing::TimeCluster;
use crate::timing::limits::Accepted;

use super::enabling::Trigger;
use super::model::NominalModel;
use super::parameters::Timing;
use super::rules::Rule;
use super::states::{NO_STATE, StateId};

/// One rule.
#[derive(Debug, Clone, Copy)]
pub struct Lane {
    /// The state it leads to.
    pub next: StateId,
    /// Times it was taken since the last check.
    pub count: u32,
    first_band: u32,
    bands: u16,
    waits: bool,
}

/// Accepted times of one cluster of a rule, and what was seen of it since the last check. The
/// bands of a rule do not overlap; the band is the cluster.
#[derive(Debug, Clone, Copy)]
pub struct Band {
    early: Nanoseconds,
    late: Nanoseconds,
    /// Sum of the times.
    pub sum: Nanoseconds,
    /// Number of the times.
    pub count: u32,
}

/// Lanes and bands of a model, by rule.
#[derive(Debug, Clone)]
pub struct Lanes {
    lanes: Vec<Lane>,
    bands: Vec<Band>,
    /// Per rule that waits for another event: the states that enable it. Sorted by rule.
    triggers: Vec<(u32, [StateId; 2])>,
    /// Bit per state: something must know when it was entered.
    tracked: Vec<u64>,
}

impl Lanes {
    /// Fresh lanes: nothing counted.
    pub fn of(model: &NominalModel) -> Self {
        let mut lanes = Self {
            lanes: Vec::with_capacity(model.rules.len()),
            bands: Vec::new(),
            triggers: Vec::new(),
            tracked: vec![0; model.states.len().div_ceil(64)],
        };
        for (index, rule) in model.rules.iter().enumerate() {
            let first_band = lanes.bands.len() as u32;
            bands(model, rule, &model.accepted(index), &mut lanes.bands);
            lanes.lanes.push(Lane {
                next: rule.next,
                count: 0,
                first_band,
                bands: (lanes.bands.len() - first_band as usize) as u16,
                waits: rule.trigger.is_some(),
            });
            if let Some(trigger) = &rule.trigger {
                lanes.triggers.push((index as u32, trigger.states));
                for state in trigger.states().chain([rule.next]) {
                    lanes.tracked[state as usize / 64] |= 1 << (state % 64);
                }
            }
        }
        lanes
    }

    /// True where something must know when the state was entered.
    #[inline]
    pub fn tracks(&self, state: StateId) -> bool {
        self.tracked.get(state as usize / 64).is_some_and(|bits| bits >> (state % 64) & 1 == 1)
    }

    /// The rule among `row` that leads to `next`.
    #[inline]
    pub fn find(&self, row: std::ops::Range<usize>, next: StateId) -> Option<usize> {
        row.into_iter().find(|&rule| self.lanes[rule].next == next)
    }

    /// Reads a rule's lane and first band, so that they are at hand when their turn comes.
    #[inline]
    pub fn touch(&self, rule: usize) -> Nanoseconds {
        let lane = self.lanes.get(rule);
        let band = lane.and_then(|lane| self.bands.get(lane.first_band as usize));
        band.map_or(0, |band| band.late)
    }

    /// True where the rule's time runs from another event.
    #[inline]
    pub fn waits(&self, rule: usize) -> bool {
        self.lanes[rule].waits
    }

    /// The states that enable a rule that waits.
    pub fn trigger(&self, rule: usize) -> [StateId; 2] {
        self.triggers
            .binary_search_by_key(&(rule as u32), |(rule, _)| *rule)
            .map_or([NO_STATE; 2], |at| self.triggers[at].1)
    }

    /// Counts a transition whose time is accepted; false, and nothing counted, where it is not.
    #[inline]
    pub fn take(&mut self, rule: usize, time: Nanoseconds) -> bool {
        let lane = &mut self.lanes[rule];
        if lane.bands == 0 {
            lane.count += 1;
            return true;
        }
        let first = lane.first_band as usize;
        for band in &mut self.bands[first..first + lane.bands as usize] {
            if time >= band.early && time <= band.late {
                lane.count += 1;
                band.count += 1;
                band.sum += time;
                return true;
            }
        }
        false
    }

    /// Counts a transition whose time means nothing.
    pub fn take_untimed(&mut self, rule: usize) {
        self.lanes[rule].count += 1;
    }

    /// The lane of a rule.
    pub fn lane(&self, rule: usize) -> &Lane {
        &self.lanes[rule]
    }

    /// The bands of a rule.
    pub fn bands(&self, rule: usize) -> &[Band] {
        let lane = &self.lanes[rule];
        let first = lane.first_band as usize;
        &self.bands[first..first + lane.bands as usize]
    }

    /// Starts a rule's counters anew.
    pub fn reset(&mut self, rule: usize) {
        let lane = &mut self.lanes[rule];
        lane.count = 0;
        let first = lane.first_band as usize;
        for band in &mut self.bands[first..first + lane.bands as usize] {
            (band.count, band.sum) = (0, 0);
        }
    }

    /// All counters, to be saved.
    pub fn counters(&self) -> Counters {
        Counters {
            lanes: self.lanes.iter().map(|lane| lane.count).collect(),
            bands: self.bands.iter().map(|band| (band.count, band.sum)).collect(),
        }
    }

    /// Sets all counters; false where they are not of these lanes.
    pub fn set_counters(&mut self, counters: &Counters) -> bool {
        if counters.lanes.len() != self.lanes.len() || counters.bands.len() != self.bands.len() {
            return false;
        }
        for (lane, &count) in self.lanes.iter_mut().zip(&counters.lanes) {
            lane.count = count;
        }
        for (band, &(count, sum)) in self.bands.iter_mut().zip(&counters.bands) {
            (band.count, band.sum) = (count, sum);
        }
        true
    }
}

/// The counters of [`Lanes`].
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Counters {
    lanes: Vec<u32>,
    bands: Vec<(u32, Nanoseconds)>,
}

/// The accepted times of a rule's clusters as bands that do not overlap.
fn bands(model: &NominalModel, rule: &Rule, accepted: &[Accepted], into: &mut Vec<Band>) {
    let clusters = rule.judged();
    let start = into.len();
    for i in 0..clusters.len() {
        let (early, late) = match accepted.get(i) {
            Some(accepted) => (nanoseconds(accepted.early_s), nanoseconds(accepted.late_s)),
            None => (0, Nanoseconds::MAX),
        };
        into.push(Band { early, late, sum: 0, count: 0 });
    }
    let cut = &mut into[start..];
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
        entered: &[Nanoseconds],
        before: Nanoseconds,
        own: Nanoseconds,
    ) -> Option<Nanoseconds> {
        let [one, other] = states;
        let first = *entered.get(one as usize)?;
        let second = if other == NO_STATE { first } else { *entered.get(other as usize)? };
        let (older, later) = (first.min(second), first.max(second));
        (older >= before && older != Nanoseconds::MIN && later >= own).then_some(later)
    }
}
