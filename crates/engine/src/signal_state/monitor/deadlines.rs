//! What falls due while time goes on: paths that have not returned, groups that have stopped.

use crate::log::Nanoseconds;
use crate::signal_state::states::NO_STATE;

use super::Monitor;

impl Monitor {
    /// After a gap, a group that was moving before it is given its time to stall anew: a machine
    /// that stopped unseen would otherwise never be told.
    pub(super) fn resume_clocks(&mut self, time: Nanoseconds) {
        let watch = &mut self.watch;
        for (group, clock) in watch.clocks.iter_mut().enumerate() {
            let stalled = watch.group_stalled[group].is_some();
            if !clock.runs && !stalled && clock.state != NO_STATE {
                (clock.last, clock.runs) = (time, true);
                let deadline = time.saturating_add(self.stall_after[group]);
                watch.next_deadline = watch.next_deadline.min(deadline);
            }
        }
    }

    /// Paths that did not return in time, and groups that have stopped, in the order they fell due.
    pub(super) fn pass_deadlines(&mut self, now: Nanoseconds) {
        if now < self.watch.next_deadline {
            return;
        }
        loop {
            let path = self.watch.open.iter().map(|open| open.deadline).min();
            let clocks = self.watch.clocks.iter().zip(&self.stall_after).enumerate();
            let stall = clocks
                .filter(|(_, (clock, _))| clock.runs)
                .map(|(group, (clock, after))| (clock.last.saturating_add(*after), group))
                .min();
            match (path, stall) {
                (Some(due), later) if due <= now && later.is_none_or(|(t, _)| due <= t) => {
                    self.confirm_path(due);
                }
                (_, Some((due, group))) if due <= now => self.report_stall(group, due),
                (path, stall) => {
                    let next = [path, stall.map(|(due, _)| due)];
                    self.watch.next_deadline =
                        next.into_iter().flatten().min().unwrap_or(Nanoseconds::MAX);
                    return;
                }
            }
        }
    }
}
