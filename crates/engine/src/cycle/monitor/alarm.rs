//! The alarm bit and the clock: what makes a class 3 a class 1, what is overdue, what never ends.

use std::sync::Arc;

use crate::cycle::lanes::LOST;
use crate::cycle::localise;
use crate::cycle::message;
use crate::finding::{Severity, State as Standing};
use crate::log::{Nanoseconds, SECOND};

use super::report::Departure;
use super::{Here, Monitor, NOWHERE, Open};

/// A machine stops within this time of what made it stop, but for what was under way.
const AFTER_THE_CAUSE: Nanoseconds = SECOND;
/// Instances that tell how soon a change may come, and the share of the shortest that is too soon.
const EARLY_EVIDENCE: u64 = 10;
const EARLY_SHARE: f64 = 0.8;

/// The manual bit follows the key a scan or two later, so what has no alarm is held back for a
/// moment.
const HELD_FOR: Nanoseconds = SECOND / 2;

/// Mean positions closer than this are one.
const TOLD_APART: f64 = 0.75;

/// How near a cause is to the stop: seen to go wrong just then, awaited since then, long before.
const NEAR: u8 = 0;
const AWAITED: u8 = 1;
const FAR: u8 = 2;

/// What may have made the machine stop.
struct Cause {
    near: u8,
    order: f64,
    open: Open,
    told: bool,
}

/// Regions named at one alarm.
const NAMED_AT_MOST: usize = 5;
/// Known transitions after which a region is back on its sequence.
const KNOWN_TO_RETURN: u8 = 2;

impl Monitor {
    /// Tells the findings of this reading. With the alarm ON they, the open ones and the regions
    /// that wait too long compete for its cause: what went wrong first is class 1, the rest 2.
    #[cold]
    pub(super) fn settle(&mut self, time: Nanoseconds, alarm_rose: bool) {
        let mut fresh = std::mem::take(&mut self.fresh);
        if !self.watch.alarm {
            self.watch.held.extend(fresh.into_iter().map(|open| (time, open)));
            self.watch_the_clock();
            return;
        }
        fresh.extend(std::mem::take(&mut self.watch.held).into_iter().map(|(_, open)| open));
        if !alarm_rose && fresh.is_empty() {
            return;
        }
        // The machine goes on for a moment after its cause; what is older, and whose region has
        // moved on since, has been got over.
        let stopped = self.watch.last_change.min(time).saturating_sub(AFTER_THE_CAUSE);
        let recent =
            |open: &Open| if open.finding.time >= stopped || open.known == 0 { NEAR } else { FAR };
        let told = std::mem::take(&mut self.watch.open);
        let mut causes: Vec<Cause> = Vec::new();
        for (open, told) in
            fresh.into_iter().map(|o| (o, false)).chain(told.into_iter().map(|o| (o, true)))
        {
            causes.push(Cause { near: recent(&open), order: open.finding.time as f64, open, told });
        }
        for (since, region) in self.early(stopped) {
            let found = self.departed(region, time, Departure::Early);
            let order = since as f64;
            causes.extend(found.map(|open| Cause { near: NEAR, order, open, told: false }));
        }
        for (position, region) in self.overdue(time) {
            let found = self.departed(region, time, Departure::Overdue);
            let cause = |open| Cause { near: AWAITED, order: position, open, told: false };
            causes.extend(found.map(cause));
        }
        causes.sort_by(|a, b| a.near.cmp(&b.near).then(a.order.total_cmp(&b.order)));
        // What was told of a region already is told on; else one finding a region.
        let mut named = std::collections::BTreeSet::new();
        for cause in causes.iter().filter(|cause| cause.told) {
            named.extend(cause.open.region);
        }
        causes.retain(|cause| cause.told || cause.open.region.is_none_or(|r| named.insert(r)));
        causes.truncate(NAMED_AT_MOST);
        if causes.is_empty() {
            return;
        }
        if let Some(seen) = self.known_stop(&causes) {
            self.tell_known_stop(causes, seen, time);
            self.stand_still();
            return;
        }
        for (place, Cause { mut open, told, .. }) in causes.into_iter().enumerate() {
            let finding = &mut open.finding;
            finding.rank = Some(localise::class(true, place == 0));
            finding.severity = if place == 0 { Severity::Fault } else { Severity::Notice };
            finding.state = Standing::Confirmed;
            if told {
                finding.time = time;
                finding.message = message::alarm(&finding.message);
            }
            self.tell(open.finding);
        }
        self.stand_still();
    }

    /// How often learning saw a stop like this one; `None` where it is a failure, or the first
    /// cause is not the only one seen just then.
    fn known_stop(&mut self, causes: &[Cause]) -> Option<u64> {
        let first = causes.first()?;
        if let Some(stops) = &mut self.stops_seen {
            stops.push(first.open.signs.clone());
        }
        let known_from = u64::from(self.model.parameters.known_stops);
        let seen = |cause: &Cause| self.model.stops.known(&cause.open.signs, known_from);
        let near = causes.iter().filter(|cause| cause.near == NEAR);
        near.map(seen).fold(seen(first), |all, one| Some(all?.min(one?)))
    }

    /// A stop that is no failure is told as what has no alarm: class 3.
    fn tell_known_stop(&mut self, causes: Vec<Cause>, seen: u64, time: Nanoseconds) {
        for (place, Cause { mut open, told, .. }) in causes.into_iter().enumerate() {
            if place > 0 && !told {
                continue;
            }
            let finding = &mut open.finding;
            finding.rank = Some(localise::class(false, place == 0));
            finding.severity = Severity::Notice;
            finding.state = Standing::Returned;
            finding.time = if told { time } else { finding.time };
            finding.message = message::known_stop(&finding.message, seen);
            self.tell(open.finding);
        }
    }

    /// The alarm has been explained: the machine is watched again once it is over.
    fn stand_still(&mut self) {
        self.watch.incident = None;
        self.watch.alarm_handled = true;
        self.watch.paused = true;
        self.watch.here.fill(NOWHERE);
        self.watch.sequence_since = None;
        self.watch_the_clock();
    }

    /// Regions that wait longer than they ever did, be it since their own last change or since
    /// anything at all changed; what usually comes first stands first.
    ///
    /// Places that lie closer than readings tell apart go by how much longer the region has waited
    /// than it ever did.
    fn overdue(&self, time: Nanoseconds) -> Vec<(f64, usize)> {
        let Some(phase) = self.watch.phase else {
            return Vec::new();
        };
        let quiet = time.saturating_sub(self.watch.last_change);
        let mut overdue: Vec<(f64, usize, f64)> = Vec::new();
        for region in 0..self.watch.here.len() {
            if self.watch.here[region].state == LOST {
                continue;
            }
            let here = self.here(region, phase);
            let outlook = self.model.machine(region, phase).outlook(here.state, here.came);
            if !outlook.goes_on() {
                continue;
            }
            let waited = time.saturating_sub(here.since);
            let stayed = waited > outlook.stay;
            let due: Vec<(f64, u64)> = outlook
                .then
                .iter()
                .filter(|then| stayed || quiet > then.longest_quiet)
                .filter_map(|then| then.due(self.watch.position))
                .collect();
            let count: u64 = due.iter().map(|(_, count)| count).sum();
            let sum: f64 = due.iter().map(|(position, count)| position * *count as f64).sum();
            if count > 0 {
                let beyond = waited as f64 / outlook.stay.max(1) as f64;
                overdue.push((sum / count as f64, region, beyond));
            }
        }
        overdue.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let first = overdue.first().map_or(0.0, |first| first.0);
        let ties = overdue.partition_point(|each| each.0 - first < TOLD_APART);
        overdue[..ties].sort_by(|a, b| b.2.total_cmp(&a.2));
        // The order is what counts from here on.
        (0..).zip(overdue).map(|(order, (_, region, _))| (f64::from(order), region)).collect()
    }

    /// Regions whose latest change is a known one that never came so soon.
    fn early(&self, since: Nanoseconds) -> Vec<(Nanoseconds, usize)> {
        let Some(phase) = self.watch.phase else {
            return Vec::new();
        };
        let is_early = |region: usize, here: &Here| {
            let (state, came, entered) = here.before;
            let took = here.since.saturating_sub(entered) as f64;
            here.state != LOST
                && state != LOST
                && self.model.machine(region, phase).then(state, came).iter().any(|then| {
                    then.to == here.state
                        && then.count >= EARLY_EVIDENCE
                        && took < EARLY_SHARE * then.shortest as f64
                })
        };
        (0..self.watch.here.len())
            .map(|region| (region, self.here(region, phase)))
            .filter(|(region, here)| here.since >= since && is_early(*region, here))
            .map(|(region, here)| (here.since, region))
            .collect()
    }

    /// A region with an open finding takes a known transition.
    #[cold]
    pub(super) fn known_step(&mut self, region: usize, time: Nanoseconds) {
        for open in &mut self.watch.open {
            if open.region == Some(region as u32) && !open.never_ends {
                open.known += 1;
            }
        }
        self.close(time, |open| open.known >= KNOWN_TO_RETURN);
    }

    /// The sequence has ended: what is back on known words has returned.
    pub(super) fn sequence_over(&mut self, time: Nanoseconds) {
        let here = self.watch.here.clone();
        let followed = |region: u32| here[region as usize].state != LOST;
        self.close(time, |open| open.never_ends || open.region.is_some_and(followed));
    }

    fn close(&mut self, time: Nanoseconds, returned: impl Fn(&Open) -> bool) {
        if !self.watch.open.iter().any(&returned) {
            return;
        }
        let (back, open) = std::mem::take(&mut self.watch.open).into_iter().partition(returned);
        self.watch.open = open;
        let back: Vec<Open> = back;
        for Open { mut finding, .. } in back {
            finding.state = Standing::Returned;
            finding.time = time;
            finding.message = message::returned(&finding.message);
            self.tell(finding);
        }
        if self.watch.open.is_empty() {
            self.watch.incident = None;
        }
        self.watch_the_clock();
    }

    /// Sets the next time at which something is due without a change.
    pub(super) fn watch_the_clock(&mut self) {
        let opens = self.watch.open.iter().map(|open| open.deadline).min();
        let held = self.watch.held.first().map(|(time, _)| time.saturating_add(HELD_FOR));
        let due = [opens, held, self.never_ends_at()];
        self.watch.next_deadline = due.into_iter().flatten().min().unwrap_or(Nanoseconds::MAX);
    }

    fn never_ends_at(&self) -> Option<Nanoseconds> {
        // While the alarm says that the machine stands, nobody expects an end.
        let running = !self.watch.never_ends_told && !self.watch.alarm;
        let since = self.watch.sequence_since.filter(|_| running)?;
        Some(since.saturating_add(self.model.never_ends_after(self.watch.phase?)?))
    }

    /// No alarm came in time, or the sequence never ends; in the order they fell due.
    #[cold]
    pub(super) fn pass_deadlines(&mut self, now: Nanoseconds) {
        while self.watch.next_deadline <= now {
            let due = self.watch.next_deadline;
            self.tell_held(due);
            if self.never_ends_at() == Some(due) {
                self.watch.never_ends_told = true;
                self.never_ends(due);
            } else {
                let (over, open) = std::mem::take(&mut self.watch.open)
                    .into_iter()
                    .partition::<Vec<_>, _>(|open| open.deadline <= due);
                self.watch.open = open;
                for Open { mut finding, .. } in over {
                    finding.state = Standing::Confirmed;
                    finding.time = due;
                    self.tell(finding);
                }
                if self.watch.open.is_empty() {
                    self.watch.incident = None;
                }
            }
            self.watch_the_clock();
        }
    }

    /// Tells what was held back by now.
    pub(super) fn tell_held(&mut self, now: Nanoseconds) {
        let due = |time: Nanoseconds| time.saturating_add(HELD_FOR) <= now;
        while self.watch.held.first().is_some_and(|(time, _)| due(*time)) {
            let (time, open) = self.watch.held.remove(0);
            self.tell_suspected(open, time);
        }
    }

    /// The running sequence takes longer than any learned one: the region that waits longest
    /// beyond its time is named.
    fn never_ends(&mut self, due: Nanoseconds) {
        let Some(&(_, region)) = self.overdue(due).first() else {
            return;
        };
        let model = Arc::clone(&self.model);
        let Some(phase) = self.watch.phase else {
            return;
        };
        let since = self.watch.sequence_since.unwrap_or(due);
        if let Some(mut open) = self.departed(region, due, Departure::Overdue) {
            open.never_ends = true;
            open.finding.severity = Severity::Anomaly;
            open.finding.message = message::never_ends(
                phase,
                due.saturating_sub(since),
                model.longest[phase.index()],
                &open.finding,
            );
            self.tell_suspected(open, due);
        }
    }
}
