//! The events of the learning logs, and where they are found: by group, by state, by run.

use crate::log::{Nanoseconds, SECOND, SignalIndex};
use crate::plant::Plant;
use crate::signal_state::states::{StateId, States};

/// One event of the learning logs.
#[derive(Debug, Clone, Copy)]
pub struct Happening {
    /// When.
    pub time: Nanoseconds,
    /// The signal that changed.
    pub signal: SignalIndex,
    /// The state entered.
    pub state: StateId,
    /// Run it belongs to: logs, and the stretches between gaps, each begin a new one.
    pub run: u32,
    /// True where this is no event, but its device's state is in doubt after a gap.
    pub doubtful: bool,
}

/// One event of a group, as a voter passes it on the way back.
#[derive(Clone, Copy)]
pub(super) struct Passed {
    pub(super) time: Nanoseconds,
    pub(super) state: StateId,
    pub(super) run: u32,
}

/// The happenings of a plant, indexed.
pub struct Happenings<'a> {
    pub(super) happenings: &'a [Happening],
    pub(super) plant: &'a Plant,
    pub(super) states: &'a States,
    pub(super) resolution_s: f64,
    /// Per signal.
    group_of: Vec<u32>,
    /// Events of each group, and the place of each happening among its group's.
    by_group: Vec<Vec<Passed>>,
    place: Vec<u32>,
    /// Happenings by state, their times, and where those of each state begin.
    of_state: Vec<u32>,
    times: Vec<Nanoseconds>,
    first_of: Vec<u32>,
    /// By run: its first happening.
    first_of_run: Vec<u32>,
}

impl<'a> Happenings<'a> {
    /// Indexes the happenings of a plant.
    pub fn of(
        happenings: &'a [Happening],
        plant: &'a Plant,
        states: &'a States,
        resolution: Nanoseconds,
    ) -> Self {
        let group_of: Vec<u32> =
            plant.signals.iter().map(|s| plant.devices[s.device()].group as u32).collect();
        let mut sizes = vec![0usize; plant.groups.len()];
        for happening in happenings {
            sizes[group_of[happening.signal as usize] as usize] += 1;
        }
        let mut by_group: Vec<Vec<Passed>> = sizes.into_iter().map(Vec::with_capacity).collect();
        let mut place = Vec::with_capacity(happenings.len());
        let mut last_of = vec![0u32; states.len() + 1];
        let mut first_of_run = Vec::new();
        for (index, happening) in (0..).zip(happenings) {
            let Happening { time, signal, state, run, .. } = *happening;
            let group = &mut by_group[group_of[signal as usize] as usize];
            place.push(group.len() as u32);
            group.push(Passed { time, state, run });
            last_of[state as usize + 1] += 1;
            if first_of_run.len() <= run as usize {
                first_of_run.resize(run as usize + 1, index);
            }
        }
        for state in 1..last_of.len() {
            last_of[state] += last_of[state - 1];
        }
        let first_of = last_of.clone();
        let mut of_state = vec![0u32; happenings.len()];
        let mut times = vec![0; happenings.len()];
        for (index, happening) in (0..).zip(happenings) {
            let at = &mut last_of[happening.state as usize];
            of_state[*at as usize] = index;
            times[*at as usize] = happening.time;
            *at += 1;
        }
        let resolution_s = resolution as f64 / SECOND as f64;
        Self {
            happenings,
            plant,
            states,
            resolution_s,
            group_of,
            by_group,
            place,
            of_state,
            times,
            first_of,
            first_of_run,
        }
    }

    /// Happenings that entered a state, ascending, and their times.
    pub(super) fn entries(&self, state: StateId) -> (&[u32], &[Nanoseconds]) {
        let state = state as usize;
        let range = self.first_of[state] as usize..self.first_of[state + 1] as usize;
        (&self.of_state[range.clone()], &self.times[range])
    }

    /// The first happening of a run.
    pub(super) fn start_of(&self, run: u32) -> u32 {
        self.first_of_run[run as usize]
    }

    /// The events of a happening's group, and its place among them.
    pub(super) fn around(&self, index: u32) -> (&[Passed], usize) {
        let group = self.group_of[self.happenings[index as usize].signal as usize];
        (&self.by_group[group as usize], self.place[index as usize] as usize)
    }
}
