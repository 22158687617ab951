//! Where every device and group stood when something first went wrong (Ghosh 2016, section 2.6:
//! "the device hash table and group hash table are saved … for the first identified transition
//! error to identify the complete control process state").

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::finding::{Finding, time_text};
use crate::log::Nanoseconds;

use super::chains::ChainIndex;
use super::model::NominalModel;

/// State of one device or group.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Standing {
    /// Signal-state in full.
    pub state: String,
    /// Since when, ISO 8601 UTC.
    pub since: String,
}

/// State of the whole plant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Named by the finding it was made with.
    pub id: String,
    /// The finding.
    pub finding: String,
    /// When it was made, ISO 8601 UTC.
    pub time: String,
    /// By `Group-Device`; devices that have not moved yet are left out.
    pub devices: BTreeMap<String, Standing>,
    /// By group.
    pub groups: BTreeMap<String, Standing>,
}

impl Snapshot {
    /// Asks every chain where it stands.
    pub fn of(
        model: &NominalModel,
        finding: &Finding,
        standing: impl Fn(ChainIndex) -> Option<(String, Nanoseconds)>,
    ) -> Self {
        let mut snapshot = Self {
            id: format!("s{}", finding.id),
            finding: finding.id.clone(),
            time: time_text(finding.time),
            devices: BTreeMap::new(),
            groups: BTreeMap::new(),
        };
        for chain in 0..model.chains.len() {
            let Some((state, since)) = standing(chain) else {
                continue;
            };
            let standing = Standing { state, since: time_text(since) };
            match model.chains.device(chain) {
                Some(device) => snapshot.devices.insert(model.plant.device_name(device), standing),
                None => snapshot.groups.insert(model.group_name(chain).to_owned(), standing),
            };
        }
        snapshot
    }
}
