//! What lanes have counted since the last check: asked for, reset, saved and set again.

use std::sync::Arc;

use prefetch_index::prefetch_index;

use crate::log::Nanoseconds;
use crate::signal_state::states::StateId;

use super::checked::{Checked, Checks};
use super::{INLINE, Lanes, NEVER, Traits};

/// What was seen of one cluster of a rule since the last check.
#[derive(Debug, Clone, Copy, Default)]
pub struct Seen {
    /// Sum of the times.
    pub sum: Nanoseconds,
    /// Number of the times.
    pub count: u32,
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

impl Lanes {
    /// Fetches what was counted of the rules out of a state, `of` being the first of several.
    pub fn fetch_row(&self, checks: &Checks, of: &Checked) {
        for leaving in checks.row(of) {
            prefetch_index(&self.lanes, leaving.lane as usize);
            prefetch_index(&self.untimed, leaving.lane as usize);
        }
    }

    /// Fetches what was counted of a rule and is not in its lane.
    pub fn fetch_further(&self, of: &Checked) {
        let lane = &self.lanes[of.lane as usize];
        if lane.has(Traits::MORE) {
            prefetch_index(&self.sides, lane.place_of_side());
        }
    }

    /// True where what was counted of a rule's times is steady beyond doubt.
    pub fn are_steady_times(&self, checks: &Checks, of: &Checked) -> bool {
        checks.are_steady_times(of, self.seen_on(of.lane as usize))
    }

    /// True where what was counted of the rules out of a state is steady beyond doubt, `of` being
    /// the first of several.
    pub fn are_steady_shares(&self, checks: &Checks, of: &Checked) -> bool {
        checks.are_steady_shares(of, |lane| self.count_on(lane))
    }

    /// How often a rule was taken since the last check.
    pub fn count(&self, rule: usize) -> u32 {
        self.count_on(self.layout.lane_of[rule] as usize)
    }

    fn count_on(&self, at: usize) -> u32 {
        let [one, other] = self.lanes[at].seen;
        let further: u32 = self.further(at).iter().map(|band| band.seen.count).sum();
        one + other + further + self.untimed[at]
    }

    /// What was seen of the clusters of a rule since the last check.
    pub fn seen(&self, rule: usize) -> impl Iterator<Item = Seen> + Clone + '_ {
        self.seen_on(self.layout.lane_of[rule] as usize)
    }

    fn seen_on(&self, at: usize) -> impl Iterator<Item = Seen> + Clone + '_ {
        let lane = &self.lanes[at];
        let bands = usize::from(self.layout.bands[at]).min(INLINE);
        (0..bands)
            .map(|band| Seen { sum: lane.sum[band], count: lane.seen[band] })
            .chain(self.further(at).iter().map(|band| band.seen))
    }

    /// The rules of a group, as their lanes lie.
    pub fn checks(&self, group: usize) -> &Checks {
        &self.layout.checks[group]
    }

    /// Starts the counters of a group's rules anew.
    pub fn reset(&mut self, group: usize) {
        let layout = Arc::clone(&self.layout);
        for checked in layout.checks[group].rules() {
            let at = checked.lane as usize;
            let lane = &mut self.lanes[at];
            // What was not counted is not written.
            if lane.seen != [0; INLINE] {
                (lane.seen, lane.sum) = ([0; INLINE], [0; INLINE]);
            }
            if lane.has(Traits::MORE) {
                let others = self.others(at);
                for band in &mut self.more[others] {
                    band.seen = Seen::default();
                }
            }
            self.untimed[at] = 0;
        }
    }

    /// All counters and times, to be saved.
    pub fn counters(&self) -> Counters {
        let rules = 0..self.layout.lane_of.len();
        let entered = self.entered.iter().copied().skip(1);
        let entered = self.layout.tracked.iter().copied().zip(entered);
        Counters {
            lanes: rules.clone().map(|rule| self.count(rule)).collect(),
            bands: rules.flat_map(|rule| self.seen(rule)).map(|s| (s.count, s.sum)).collect(),
            entered: entered.filter(|&(_, entered)| entered != NEVER).collect(),
        }
    }

    /// Sets all counters and times; false where they are not of these lanes.
    pub fn set_counters(&mut self, counters: &Counters) -> bool {
        let layout = Arc::clone(&self.layout);
        if counters.lanes.len() != layout.lane_of.len() {
            return false;
        }
        let mut saved = counters.bands.iter();
        for (&at, &count) in layout.lane_of.iter().zip(&counters.lanes) {
            let others = self.others(at as usize);
            let lane = &mut self.lanes[at as usize];
            let bands = usize::from(layout.bands[at as usize]).min(INLINE);
            let mut timed = 0u32;
            for band in 0..bands {
                let Some(&(count, sum)) = saved.next() else { return false };
                (lane.seen[band], lane.sum[band]) = (count, sum);
                timed = timed.saturating_add(count);
            }
            for band in &mut self.more[others] {
                let Some(&(count, sum)) = saved.next() else { return false };
                band.seen = Seen { count, sum };
                timed = timed.saturating_add(count);
            }
            let Some(untimed) = count.checked_sub(timed) else { return false };
            if bands == 0 {
                lane.seen[0] = untimed;
            } else {
                self.untimed[at as usize] = untimed;
            }
        }
        for &(state, entered) in &counters.entered {
            match layout.place(state) {
                Some(place) => self.entered[place] = entered,
                None => return false,
            }
        }
        saved.next().is_none()
    }
}
