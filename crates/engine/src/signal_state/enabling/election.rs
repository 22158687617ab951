//! One transition looks for what it waits for: who votes, and what each voter sees.

use crate::log::Nanoseconds;
use crate::signal_state::states::StateId;

use super::entries::Entry;
use super::happenings::{Happening, Happenings};
use super::meetings::VOTERS;

/// Events of the group a voter looks back over.
pub(super) const LOOK_BACK: usize = 48;

/// One transition looks for what it waits for.
pub(super) struct Election<'a> {
    /// Its instances, in the order they happened.
    pub(super) instances: &'a [Entry],
    /// The states it leads from and to.
    pub(super) current: StateId,
    pub(super) next: StateId,
    /// Delays that agree within this are steady, in seconds.
    pub(super) steady: f64,
    /// Those that agree within this differ by no more than scans do.
    pub(super) close: f64,
}

impl Election<'_> {
    /// How many instances vote.
    pub(super) fn voters(&self) -> usize {
        self.instances.len().min(VOTERS)
    }

    /// A voter's instance, each at another place of a long log.
    pub(super) fn instance(&self, voter: usize) -> &Entry {
        &self.instances[voter * self.instances.len() / self.voters()]
    }

    pub(super) fn look<'h>(&self, index: Happenings<'h>, voter: usize) -> Look<'h> {
        let &Entry { time, took, place, .. } = self.instance(voter);
        let (earlier, later) = index.happenings.split_at(place as usize);
        // Of the same time, but later in the file: the order inside a scan means nothing.
        let together = later[1..].iter().take_while(|other| other.time == time).count();
        Look {
            now: time,
            since: time - took,
            together: &later[1..=together],
            earlier: &earlier[earlier.len().saturating_sub(LOOK_BACK)..],
        }
    }
}

/// What a voter sees.
pub(super) struct Look<'a> {
    pub(super) now: Nanoseconds,
    /// Its device's own last event.
    pub(super) since: Nanoseconds,
    /// What else happened at its time, but is written later.
    pub(super) together: &'a [Happening],
    /// What is written before it, some of which may have been before its device's last event.
    pub(super) earlier: &'a [Happening],
}

impl<'a> Look<'a> {
    /// States at these distances in nanoseconds.
    pub(super) fn within(
        self,
        distances: &std::ops::RangeInclusive<u64>,
    ) -> impl Iterator<Item = StateId> + 'a {
        let latest = self.now.saturating_sub_unsigned(*distances.start());
        let earliest = self.now.saturating_sub_unsigned(*distances.end()).max(self.since);
        let start = self.earlier.partition_point(|other| other.time < earliest);
        let near = self.earlier[start..].iter().take_while(move |other| other.time <= latest);
        let together = self.together.iter().take_while(move |other| other.time <= latest);
        near.chain(together).map(|other| other.state)
    }
}
