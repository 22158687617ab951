//! What a transition seldom waits for: a partner of its trigger that was the later of the two only
//! a few times, or never yet.
//!
//! Nearly always one time explains the transition; a few instances came late. A state that all of
//! them met at that very time before is what they waited for, unless chance would offer as much or
//! another instance contradicts.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use crate::log::{Nanoseconds, SECOND};
use crate::signal_state::states::{NO_STATE, StateId};
use crate::timing::TimeCluster;

use super::delays::{self, Wait};
use super::partner::LEFT_EXPLAINED;
use super::{Delayed, EXPLAINED, Entry, Happenings, INSTANCES_AT_LEAST, Trigger};

/// The usual time holds at least this share of the instances.
const USUAL: f64 = 2.0 / 3.0;
/// A time is as usual as those seen so far within so many resolutions of them, or this share of
/// how far they spread.
const BEYOND_RESOLUTIONS: f64 = 2.0;
const BEYOND_SHARE: f64 = 0.5;
/// So many later times that agree are a second usual time.
const STEADY: u32 = 3;
/// A partner that an instance contradicts must explain so many more.
const EXPLAINED_PER_CONTRADICTION: usize = 20;
/// Share of the instances that may lack a fresh entry of the partner, besides one of each run.
const NOT_FRESH: f64 = 0.02;
/// So many partners may chance offer, in a search and of one that sisters have.
const BY_CHANCE: f64 = 0.01;
const BY_CHANCE_OF_SISTERS: f64 = 0.3;

/// The usual time of a transition since its trigger, and the instances that came later.
pub struct Usual<'a> {
    index: Happenings<'a>,
    instances: &'a [Entry],
    next: StateId,
    trigger: StateId,
    waits: Vec<Wait>,
    /// From the trigger; infinite where it was not fresh.
    delays: Vec<f64>,
    usually: Usually,
    odd: Vec<usize>,
}

/// A transition held against the later of its trigger and a partner.
pub struct Joined {
    /// The partner.
    pub partner: StateId,
    delays: Vec<f64>,
    /// Odd instances that came at the usual time after the partner.
    explained: usize,
    /// Other odd instances.
    left: usize,
    contradicted: usize,
    fresh: bool,
    /// True where the partner is entered once for every time the transition happens.
    pub alternates: bool,
    /// How probable it is that an unrelated state explains as many.
    chance: f64,
    /// How far those are from the average, in all.
    off_s: f64,
}

/// True where most times are usual and others are later, not at one other time.
pub fn has_odd(clusters: &[TimeCluster], resolution_s: f64) -> bool {
    Usually::of(clusters, resolution_s)
        .is_some_and(|usually| usually.odd(clusters).next().is_some())
}

/// The time that most instances take.
#[derive(Clone, Copy)]
struct Usually {
    least_s: f64,
    greatest_s: f64,
    average_s: f64,
}

impl Usually {
    fn of(clusters: &[TimeCluster], resolution_s: f64) -> Option<Self> {
        let usual = clusters.iter().find(|cluster| cluster.probability >= USUAL)?;
        let spread_s = usual.maximum_s - usual.minimum_s;
        let beyond_s = (BEYOND_RESOLUTIONS * resolution_s).max(BEYOND_SHARE * spread_s);
        Some(Self {
            least_s: usual.minimum_s - beyond_s,
            greatest_s: usual.maximum_s + beyond_s,
            average_s: usual.average_s,
        })
    }

    /// Clusters of later times that are no second usual time.
    fn odd(self, clusters: &[TimeCluster]) -> impl Iterator<Item = &TimeCluster> {
        let width_s = self.greatest_s - self.least_s;
        let is_steady = move |cluster: &TimeCluster| {
            cluster.instances >= STEADY && cluster.maximum_s - cluster.minimum_s <= width_s
        };
        clusters
            .iter()
            .filter(move |cluster| cluster.minimum_s > self.greatest_s && !is_steady(cluster))
    }

    fn holds(self, delay_s: f64) -> bool {
        (self.least_s..=self.greatest_s).contains(&delay_s)
    }
}

impl<'a> Usual<'a> {
    /// Of a transition from `current` to `next`, whose times are `clusters`: delays from its
    /// trigger, or times since the device's own last event. `None` where most of them are not one
    /// time, or it has a partner.
    pub fn of(
        index: Happenings<'a>,
        instances: &'a [Entry],
        (current, next): (StateId, StateId),
        trigger: Option<&Trigger>,
        clusters: &[TimeCluster],
    ) -> Option<Self> {
        let [trigger, partner] = trigger.map_or([current, NO_STATE], |trigger| trigger.states);
        if partner != NO_STATE || instances.len() < INSTANCES_AT_LEAST {
            return None;
        }
        let usually = Usually::of(clusters, index.resolution_s)?;
        let waits = delays::waits(index, instances, next);
        let delays = each(index, &waits, [trigger, NO_STATE]);
        let odd = |delay: f64| {
            usually.odd(clusters).any(|c| (c.minimum_s..=c.maximum_s).contains(&delay))
        };
        let odd = (0..delays.len()).filter(|&at| odd(delays[at])).collect();
        Some(Self { index, instances, next, trigger, waits, delays, usually, odd })
    }

    /// The trigger with a partner that explains most of the odd instances.
    pub fn partner(&self) -> Option<Delayed> {
        let mut met = self.met_by_odd();
        let enough = (LEFT_EXPLAINED * self.odd.len() as f64).ceil() as usize;
        met.retain(|_, times| *times >= enough.max(1));
        let joined = met.into_keys().map(|state| self.joined(state));
        let offered = self.offered() as f64;
        let joined =
            joined.filter(|joined| joined.is_sound() && joined.chance * offered <= BY_CHANCE);
        let best = joined.min_by(Joined::by_merit)?;
        Some(self.with(best))
    }

    /// States met at the usual time before odd instances, and how many met each.
    pub fn met_by_odd(&self) -> BTreeMap<StateId, usize> {
        let mut met = BTreeMap::new();
        for &at in &self.odd {
            for state in self.met(&self.instances[at]) {
                *met.entry(state).or_default() += 1;
            }
        }
        met
    }

    /// States met at the usual time before an instance, each once.
    fn met(&self, instance: &Entry) -> Vec<StateId> {
        let &Entry { time, place, .. } = instance;
        let earliest = time - nanoseconds(self.usually.greatest_s);
        let latest = time - nanoseconds(self.usually.least_s.max(0.0));
        let happenings = self.index.happenings;
        let start = happenings.partition_point(|other| other.time < earliest);
        let near = happenings[start..].iter().zip(start..);
        let near = near.take_while(|(other, _)| other.time <= latest);
        // Of one instant, only an input is known to be a cause, and of an output only.
        let is_output = self.index.is_output;
        let may_enable =
            |state: StateId| !is_output[state as usize] && is_output[self.next as usize];
        let others = near.filter(|&(other, at)| {
            at != place as usize
                && other.state != self.next
                && other.state != self.trigger
                && (other.time < time || may_enable(other.state))
        });
        let mut states: Vec<StateId> = others.map(|(other, _)| other.state).collect();
        states.sort_unstable();
        states.dedup();
        states
    }

    /// So many events were met while the shortest of the odd instances lasted.
    fn offered(&self) -> usize {
        let shortest = self.odd.iter().min_by(|&&a, &&b| self.delays[a].total_cmp(&self.delays[b]));
        shortest.map_or(0, |&at| {
            let Entry { time, place, .. } = self.instances[at];
            let since = time - nanoseconds(self.delays[at]);
            let first = self.index.happenings.partition_point(|other| other.time <= since);
            (place as usize).saturating_sub(first)
        })
    }

    /// Holds the instances against the later of the trigger and a partner.
    pub fn joined(&self, partner: StateId) -> Joined {
        let delays = each(self.index, &self.waits, [self.trigger, partner]);
        let (mut explained, mut contradicted, mut stale) = (0, 0, 0);
        let (mut chance, mut off_s) = (1.0, 0.0);
        let width = self.usually.greatest_s - self.usually.least_s.max(0.0);
        let mut odd = self.odd.iter().copied().peekable();
        for (at, (&alone, &joined)) in self.delays.iter().zip(&delays).enumerate() {
            let is_odd = odd.next_if_eq(&at).is_some();
            if joined == alone {
                continue;
            }
            if joined.is_infinite() {
                stale += 1;
            } else if !self.usually.holds(joined) {
                contradicted += 1;
            } else if is_odd {
                explained += 1;
                chance *= (width / alone).min(1.0);
                off_s += (joined - self.usually.average_s).abs();
            }
        }
        let left = self.odd.len() - explained;
        // Any of them could have been those that are left.
        for chosen in 0..left.min(explained) {
            chance *= (self.odd.len() - chosen) as f64 / (chosen + 1) as f64;
        }
        let fresh = delays.iter().filter(|delay| delay.is_finite()).count();
        let n = delays.len() as f64;
        let may_lack = self.index.run_starts.len() as f64 + NOT_FRESH * n;
        let fresh = f64::from(stale) <= may_lack && fresh as f64 >= EXPLAINED * n;
        let others = delays::not_once(self.index, &self.waits, partner);
        let alternates = others <= self.index.run_starts.len();
        Joined { partner, delays, explained, left, contradicted, fresh, alternates, chance, off_s }
    }

    /// The trigger with a partner.
    pub fn with(&self, joined: Joined) -> Delayed {
        let mut delays = joined.delays;
        delays.retain(|delay| delay.is_finite());
        delays.sort_unstable_by(f64::total_cmp);
        Delayed { states: [self.trigger, joined.partner], delays }
    }
}

impl Joined {
    /// Which of two explains more, or as many more closely, comes first.
    pub fn by_merit(&self, other: &Self) -> Ordering {
        other.explained.cmp(&self.explained).then(self.off_s.total_cmp(&other.off_s))
    }

    /// True where no instance contradicts, but for a very few.
    pub fn is_sound(&self) -> bool {
        self.fresh && self.contradicted * EXPLAINED_PER_CONTRADICTION <= self.explained
    }

    /// True where odd instances show what sisters show.
    pub fn is_shown(&self) -> bool {
        let odd = (self.explained + self.left) as f64;
        self.is_sound()
            && self.explained > 0
            && self.explained as f64 >= LEFT_EXPLAINED * odd
            && self.chance <= BY_CHANCE_OF_SISTERS
    }
}

/// Delays of each instance; infinite where there was no fresh one.
fn each(index: Happenings<'_>, waits: &[Wait], states: [StateId; 2]) -> Vec<f64> {
    let delays = delays::of_each(index, waits, states).into_iter();
    delays.map(|delay| delay.unwrap_or(f64::INFINITY)).collect()
}

fn nanoseconds(seconds: f64) -> Nanoseconds {
    (seconds * SECOND as f64).round() as Nanoseconds
}
