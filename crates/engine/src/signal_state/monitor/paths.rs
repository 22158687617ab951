//! Alarm paths: off the known transitions, and perhaps back (Ghosh 2016, section 2.6, Figure 12).

use crate::finding::{Finding, Kind, Severity, State, stable_id};
use crate::log::Nanoseconds;
use crate::signal_state::chains::ChainIndex;
use crate::signal_state::message;
use crate::signal_state::states::StateId;

use super::{KNOWN_TO_RETURN, Monitor, OFFERS_AT_MOST, PATH_AT_MOST};

impl Monitor {
    /// A known transition while off the path: perhaps the device is back.
    pub(super) fn known_step(&mut self, chain: ChainIndex, state: StateId, time: Nanoseconds) {
        let Some(index) = self.watch.open.iter().position(|open| open.chain == chain) else {
            self.watch.here[chain].return_to_path();
            return;
        };
        let open = &mut self.watch.open[index];
        open.known += 1;
        if open.known < KNOWN_TO_RETURN {
            if open.path.len() < PATH_AT_MOST {
                open.path.push(state);
            }
            return;
        }
        let open = self.watch.open.remove(index);
        self.watch.here[chain].return_to_path();
        // The known steps are no part of the alarm path.
        let path = &open.path[..open.path.len() - usize::from(open.known) + 1];
        let names: Vec<String> = path.iter().map(|&s| self.teller().state_name(s)).collect();
        let mut returned = open.finding;
        returned.state = State::Returned;
        returned.time = time;
        returned.path = names;
        returned.message = message::returned(&returned);
        self.records.push(returned.clone().into());
        self.offer(returned, chain);
    }

    /// Offers the path of an alarm for confirmation, each path once.
    pub(super) fn offer(&mut self, returned: Finding, chain: ChainIndex) {
        if returned.severity == Severity::Notice {
            return;
        }
        let names = returned.path.join(" → ");
        let hash = xxhash_rust::xxh3::xxh3_64(names.as_bytes());
        if self.watch.offered.contains(&hash) || self.watch.offered.len() >= OFFERS_AT_MOST {
            return;
        }
        self.watch.offered.push(hash);
        let mut offer = returned;
        offer.kind = Kind::AlarmPath;
        offer.severity = Severity::Notice;
        offer.id = stable_id(offer.kind, &self.teller().place_name(chain), &names, "", offer.time);
        offer.to = offer.path.last().cloned();
        offer.snapshot_id = None;
        offer.suspects.clear();
        offer.message = message::alarm_path(&offer);
        self.records.push(offer.into());
    }

    /// Another unknown transition while off the path: the path grows, no new finding.
    pub(super) fn unknown_step(&mut self, chain: ChainIndex, state: StateId) {
        if let Some(open) = self.watch.open.iter_mut().find(|open| open.chain == chain) {
            open.known = 0;
            if open.path.len() < PATH_AT_MOST {
                open.path.push(state);
            }
        }
    }

    pub(super) fn confirm_path(&mut self, due: Nanoseconds) {
        let Some(index) = self.watch.open.iter().position(|open| open.deadline == due) else {
            return;
        };
        let open = self.watch.open.remove(index);
        self.watch.here[open.chain].return_to_path();
        let mut finding = open.finding;
        finding.state = State::Confirmed;
        finding.time = due;
        finding.path = open.path.iter().map(|&s| self.teller().state_name(s)).collect();
        finding.message = message::not_returned(&finding, self.model.parameters.return_within_s);
        self.records.push(finding.into());
    }
}
