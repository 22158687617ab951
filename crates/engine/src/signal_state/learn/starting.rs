//! The signal that stands for its device in the group's chain.

use crate::log::SignalIndex;
use crate::plant::Plant;
use crate::signal_state::parameters::Parameters;

use super::LearnError;

/// The signal of each device's first event stands for it, where nobody chose another.
pub(super) fn set_first(plant: &mut Plant, first: &[Option<SignalIndex>]) {
    for (device, &first) in plant.devices.iter_mut().zip(first) {
        device.starting = device.starting.or(first);
    }
}

/// The signals the user chose.
pub(super) fn set_chosen(plant: &mut Plant, parameters: &Parameters) -> Result<(), LearnError> {
    for (name, signal) in &parameters.starting {
        let error = |problem: &str| LearnError::Starting {
            device: name.clone(),
            signal: signal.clone(),
            problem: problem.to_owned(),
        };
        let device = (0..plant.devices.len())
            .find(|&d| plant.device_name(d) == *name || plant.devices[d].name == *name)
            .ok_or_else(|| error("the logs hold no such device; give it as Group-Device"))?;
        let index = (0..plant.signals.len() as SignalIndex)
            .find(|&s| {
                let candidate = &plant.signals[s as usize];
                candidate.device() == device && candidate.name() == *signal
            })
            .ok_or_else(|| error("the device has no such signal"))?;
        plant.devices[device].starting = Some(index);
    }
    Ok(())
}
