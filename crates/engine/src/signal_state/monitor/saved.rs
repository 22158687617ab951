//! A monitor's state: saved compactly, and gone on from.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::saved_state;
use crate::signal_state::identity::FindingId;
use crate::signal_state::lanes::Counters;
use crate::signal_state::model::NominalModel;

use super::watch::Watch;
use super::{Monitor, MonitorError};

/// What [`Monitor::save`] writes.
#[derive(Serialize, Deserialize)]
struct Saved {
    version: u32,
    fingerprint: u64,
    watch: Watch,
    counters: Counters,
}

const STATE_VERSION: u32 = 5;

impl Monitor {
    /// Everything needed to go on later, compactly.
    pub fn save(&self) -> Vec<u8> {
        let mut watch = self.watch.clone();
        for incident in watch.incidents.iter_mut().flatten() {
            incident.id = FindingId::Told(incident.id.text(self.teller()));
        }
        let saved = Saved {
            version: STATE_VERSION,
            fingerprint: self.model.fingerprint(),
            watch,
            counters: self.lanes.counters(),
        };
        saved_state::sealed(&saved)
    }

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// Damaged bytes, another version, or the state of another model.
    pub fn restore(model: Arc<NominalModel>, bytes: &[u8]) -> Result<Self, MonitorError> {
        let body = saved_state::unsealed(bytes).ok_or(MonitorError::Damaged)?;
        let saved: Saved = postcard::from_bytes(body).map_err(|_| MonitorError::Damaged)?;
        if saved.version != STATE_VERSION {
            return Err(MonitorError::Damaged);
        }
        if saved.fingerprint != model.fingerprint() {
            return Err(MonitorError::OtherModel);
        }
        let mut monitor = Self::new(model);
        monitor.watch = saved.watch;
        if !monitor.lanes.set_counters(&saved.counters) {
            return Err(MonitorError::Damaged);
        }
        Ok(monitor)
    }
}
