//! The Markov chains of a plant: one per device over all its signal-states, one per group over
//! the signal-states of its devices' starting signals (Ghosh 2016, section 2.3.1).

use serde::{Deserialize, Serialize};

use crate::log::SignalIndex;
use crate::plant::Plant;

/// Number of a chain: devices first, in the plant's order, then groups.
pub type ChainIndex = usize;

/// What a chain describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ChainKind {
    /// One device.
    Device,
    /// The starting signals of a group's devices.
    Group,
}

/// Which chains a signal's events belong to.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Chains {
    devices: usize,
    /// Per signal: its device's chain.
    device_of_signal: Vec<u32>,
    /// Per signal: its group's chain where it is a starting signal, else `NO_CHAIN`.
    group_chain_of_signal: Vec<u32>,
    /// Per chain: its group.
    group_of_chain: Vec<u32>,
}

/// In tables of chains by signal: this signal has none.
pub const NO_CHAIN: u32 = u32::MAX;

impl Chains {
    /// The chains of a plant whose starting signals are known.
    pub fn of(plant: &Plant) -> Self {
        let devices = plant.devices.len();
        let mut chains = Self {
            devices,
            device_of_signal: plant.signals.iter().map(|s| s.device() as u32).collect(),
            group_chain_of_signal: vec![NO_CHAIN; plant.signals.len()],
            group_of_chain: plant.devices.iter().map(|d| d.group as u32).collect(),
        };
        chains.group_of_chain.extend(0..plant.groups.len() as u32);
        for device in &plant.devices {
            if let Some(starting) = device.starting {
                chains.group_chain_of_signal[starting as usize] = (devices + device.group) as u32;
            }
        }
        chains
    }

    /// Number of chains.
    pub fn len(&self) -> usize {
        self.group_of_chain.len()
    }

    /// True where the plant has no device.
    pub fn is_empty(&self) -> bool {
        self.group_of_chain.is_empty()
    }

    /// Device or group.
    pub fn kind(&self, chain: ChainIndex) -> ChainKind {
        if chain < self.devices { ChainKind::Device } else { ChainKind::Group }
    }

    /// The device's chain of a signal.
    #[inline]
    pub fn device_chain(&self, signal: SignalIndex) -> ChainIndex {
        self.device_of_signal[signal as usize] as usize
    }

    /// The group's chain of a signal, where the signal stands for its device.
    #[inline]
    pub fn group_chain(&self, signal: SignalIndex) -> Option<ChainIndex> {
        let chain = self.group_chain_of_signal[signal as usize];
        (chain != NO_CHAIN).then_some(chain as usize)
    }

    /// The chain of a group.
    pub fn chain_of_group(&self, group: usize) -> ChainIndex {
        self.devices + group
    }

    /// The group a chain belongs to.
    #[inline]
    pub fn group_of(&self, chain: ChainIndex) -> usize {
        self.group_of_chain[chain] as usize
    }

    /// The device of a chain; `None` for a group's.
    pub fn device(&self, chain: ChainIndex) -> Option<usize> {
        (chain < self.devices).then_some(chain)
    }
}
