//! The alarm bit and the clock: what makes a class 3 a class 1, what is overdue, what never ends.

use std::sync::Arc;

use crate::cycle::localise;
use crate::cycle::message;
use crate::finding::{Severity, State as Standing};
use crate::log::Nanoseconds;

use super::report::Departure;
use super::{LOST, Monitor, NOWHERE, Open, UNLEARNED};

/// Regions named at one alarm.
const NAMED_AT_MOST: usize = 5;
/// Known transitions after which a region is back on its sequence.
const KNOWN_TO_RETURN: u8 = 2;

impl Monitor {
    /// Tells the findings of this reading. With the alarm ON they, the open ones and the regions
    /// that wait too long compete for its cause: what went wrong first is class 1, the rest 2.
    #[cold]
    pub(super) fn settle(&mut self, time: Nanoseconds, alarm_rose: bool) {
        let fresh = std::mem::take(&mut self.fresh);
        if !self.watch.alarm {
            for open in fresh {
                self.tell_suspected(open, time);
            }
            return;
        }
        if !alarm_rose && fresh.is_empty() {
            return;
        }
        let mut causes: Vec<(Nanoseconds, Open, bool)> =
            fresh.into_iter().map(|open| (open.finding.time, open, false)).collect();
        let told = std::mem::take(&mut self.watch.open);
        for (onset, region) in self.overdue(time) {
            let named = told.iter().chain(causes.iter().map(|(_, open, _)| open));
            if named.clone().all(|open| open.region != Some(region as u32)) {
                let found = self.departed(region, time, Departure::Overdue);
                causes.extend(found.map(|open| (onset, open, false)));
            }
        }
        causes.extend(told.into_iter().map(|open| (open.finding.time, open, true)));
        causes.sort_by_key(|(onset, ..)| *onset);
        causes.truncate(NAMED_AT_MOST);
        if causes.is_empty() {
            return;
        }
        for (place, (_, mut open, told)) in causes.into_iter().enumerate() {
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
        self.watch.incident = None;
        self.watch.alarm_handled = true;
        self.watch.paused = true;
        self.watch.here.fill(NOWHERE);
        self.watch.sequence_since = None;
        self.watch_the_clock();
    }

    /// Regions that have stayed longer than was ever learned, by when that began.
    fn overdue(&self, time: Nanoseconds) -> Vec<(Nanoseconds, usize)> {
        let Some(phase) = self.watch.phase else {
            return Vec::new();
        };
        let mut overdue: Vec<(Nanoseconds, usize)> = self
            .watch
            .here
            .iter()
            .enumerate()
            .filter(|(region, here)| {
                here.state != LOST
                    && here.stay != UNLEARNED
                    && !self.model.machine(*region, phase).from(here.state).is_empty()
            })
            .map(|(region, here)| (here.since.saturating_add(here.stay), region))
            .filter(|(due, _)| *due < time)
            .collect();
        overdue.sort_unstable();
        overdue
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
        let due = [opens, self.never_ends_at()];
        self.watch.next_deadline = due.into_iter().flatten().min().unwrap_or(Nanoseconds::MAX);
    }

    fn never_ends_at(&self) -> Option<Nanoseconds> {
        let since = self.watch.sequence_since.filter(|_| !self.watch.never_ends_told)?;
        Some(since.saturating_add(self.model.never_ends_after(self.watch.phase?)?))
    }

    /// No alarm came in time, or the sequence never ends; in the order they fell due.
    #[cold]
    pub(super) fn pass_deadlines(&mut self, now: Nanoseconds) {
        while self.watch.next_deadline <= now {
            let due = self.watch.next_deadline;
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
