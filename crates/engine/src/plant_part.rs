//! Some of a plant's groups as a plant of their own, and what its numbers mean in the whole one.
//!
//! Signals, devices and groups keep their order, so whatever is decided by order is decided alike.

use crate::log::SignalIndex;
use crate::plant::{Device, Plant};

/// A plant of some groups.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlantPart {
    /// Signals, devices and groups under numbers of their own.
    pub plant: Plant,
    /// By signal of the part: its number in the whole plant, ascending.
    pub signals: Vec<SignalIndex>,
    /// By device of the part: its number in the whole plant, ascending.
    pub devices: Vec<usize>,
    /// By group of the part: its number in the whole plant, ascending.
    pub groups: Vec<usize>,
}

impl PlantPart {
    /// The groups of these numbers, in the plant's order whichever they are given in.
    pub fn of(plant: &Plant, groups: &[usize]) -> Self {
        let kept = |number: &usize| groups.contains(number);
        let groups: Vec<usize> = (0..plant.groups.len()).filter(kept).collect();
        let group_in_part = places(&groups, plant.groups.len());
        let of_group = |&device: &usize| group_in_part[plant.devices[device].group].is_some();
        let devices: Vec<usize> = (0..plant.devices.len()).filter(of_group).collect();
        let device_in_part = places(&devices, plant.devices.len());
        let of_device = |&s: &SignalIndex| device_in_part[plant.signals[s as usize].device()];
        let signals: Vec<SignalIndex> = (0..plant.signals.len() as SignalIndex)
            .filter(|signal| of_device(signal).is_some())
            .collect();
        let part = Plant {
            signals: signals
                .iter()
                .map(|signal| {
                    plant.signals[*signal as usize].moved_to(of_device(signal).unwrap_or_default())
                })
                .collect(),
            devices: devices
                .iter()
                .map(|&device| Device {
                    group: group_in_part[plant.devices[device].group].unwrap_or_default(),
                    starting: plant.devices[device].starting.and_then(|whole| {
                        signals.binary_search(&whole).ok().map(|own| own as SignalIndex)
                    }),
                    ..plant.devices[device].clone()
                })
                .collect(),
            groups: groups.iter().map(|&group| plant.groups[group].clone()).collect(),
            unplaced: unplaced(plant, &signals),
        };
        Self { plant: part, signals, devices, groups }
    }

    /// The part's number of a signal of the whole plant.
    pub fn own(&self, whole: SignalIndex) -> Option<SignalIndex> {
        self.signals.binary_search(&whole).ok().map(|own| own as SignalIndex)
    }
}

/// Place of each kept number among the kept.
fn places(kept: &[usize], of: usize) -> Vec<Option<usize>> {
    let mut places = vec![None; of];
    for (place, &number) in kept.iter().enumerate() {
        places[number] = Some(place);
    }
    places
}

fn unplaced(plant: &Plant, signals: &[SignalIndex]) -> Vec<String> {
    if plant.unplaced.is_empty() {
        return Vec::new();
    }
    let symbol = |&signal: &SignalIndex| plant.signals[signal as usize].symbol();
    let kept: std::collections::HashSet<&str> = signals.iter().map(symbol).collect();
    plant.unplaced.iter().filter(|symbol| kept.contains(symbol.as_str())).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::PlantPart;
    use crate::naming::NamingRule;
    use crate::plant::Plant;
    use crate::symbols::SymbolTable;

    #[test]
    fn a_part_keeps_names_and_order() {
        let symbols = ["A-D-X", "B-D-X", "A-E-Y", "loose", "B-D-Y"].map(str::to_owned);
        let mut plant = Plant::arrange(&symbols, &SymbolTable::default(), &NamingRule::default());
        plant.devices[1].starting = Some(4);
        let part = PlantPart::of(&plant, &[1]);
        assert_eq!(part.signals, [1, 4]);
        assert_eq!(part.plant.full_name(1), "B-D-Y");
        assert_eq!(part.plant.devices[0].starting, Some(1));
        assert_eq!(part.own(4), Some(1));
        assert_eq!(part.own(0), None);
        assert!(part.plant.unplaced.is_empty());
        assert_eq!(PlantPart::of(&plant, &[2, 0]).plant.unplaced, ["loose"]);
    }
}
