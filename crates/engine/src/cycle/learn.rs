//! Learning the cycle machine from fault-free logs (section 3.3 and 3.4).

use std::borrow::Borrow;
use std::collections::HashMap;

use thiserror::Error;

use crate::log::ChangeLog;
use crate::plant::Plant;

use super::auto;
use super::image::{Phase, Wiring};
use super::machine::Machine;
use super::model::CycleModel;
use super::parameters::{CycleParameters, ModeSpec, RegionSpecs};
use super::regions::Directory;
use super::sequences::Sequences;

/// Why no cycle machine can be learned.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CycleError {
    /// `[modes]` does not say which bit tells work from set-up.
    #[error("[modes] work_complete is missing: name the bit that is ON while the machine works")]
    NoWorkComplete,
    /// A bit that no log has.
    #[error("{wanted_by}: no log has a signal '{bit}'; give an address or name of the logs")]
    UnknownBit {
        /// As written.
        bit: String,
        /// The key it stands at.
        wanted_by: String,
    },
    /// A range that is none.
    #[error(
        "{wanted_by}: '{range}' names no bits of the logs; expected a range like I0.0-I7.7, 'I8-I20 by byte', or a list"
    )]
    Range {
        /// As written.
        range: String,
        /// The key it stands at.
        wanted_by: String,
    },
    /// A region that fits no word.
    #[error(
        "[regions] {region} has {bits} bits; expected 1 to 128: split it, or write 'by byte' behind it"
    )]
    Width {
        /// Its name.
        region: String,
        /// Bits counted.
        bits: usize,
    },
    /// A parameter out of range.
    #[error("[cycle] {name} is {value}; expected {expected}")]
    Parameter {
        /// Its key.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What may be given.
        expected: &'static str,
    },
    /// Nothing is left after cleaning.
    #[error(
        "no whole cycle to learn: {found} sequences between edges of {work_complete}, and after leaving out the first, the last and those beside manual or alarm none is left; give a longer log"
    )]
    NoCycles {
        /// Sequences found.
        found: u64,
        /// The bit.
        work_complete: String,
    },
}

/// Learns from one or more logs, each a run of its own.
///
/// # Errors
/// A bit or range the logs do not have, a parameter out of range, or no whole cycle.
pub fn learn<L: Borrow<ChangeLog>>(
    logs: &[L],
    plant: &Plant,
    modes: &ModeSpec,
    regions: &RegionSpecs,
    parameters: &CycleParameters,
) -> Result<CycleModel, CycleError> {
    parameters.validate()?;
    let directory = Directory::of(plant);
    let modes = directory.modes(modes)?;
    let bits = directory.bits();
    let number_of: HashMap<&str, u32> =
        (0..).zip(bits).map(|(number, bit)| (bit.symbol.as_str(), number)).collect();
    let maps: Vec<Vec<Option<u32>>> = logs
        .iter()
        .map(|log| {
            let log: &ChangeLog = log.borrow();
            log.signals.iter().map(|symbol| number_of.get(symbol.as_str()).copied()).collect()
        })
        .collect();
    let regions = if regions.is_empty() {
        let logs: Vec<&ChangeLog> = logs.iter().map(Borrow::borrow).collect();
        auto::propose(&logs, &maps, &directory, &modes, parameters)
    } else {
        directory.regions(regions)?
    };
    let wiring = Wiring::new(bits.len(), &regions, &modes);
    let mut sequences = Sequences::default();
    for (log, map) in logs.iter().zip(&maps) {
        sequences.read(log.borrow(), map, bits.len(), regions.len(), &wiring);
    }
    if sequences.kept == [0, 0] {
        return Err(CycleError::NoCycles {
            found: sequences.left_out.iter().sum(),
            work_complete: bits[modes.work_complete.bit].symbol.clone(),
        });
    }
    let machines = sequences
        .by_region
        .iter()
        .map(|of_region| {
            Phase::ALL.map(|phase| Machine::of(of_region.iter().filter(|s| s.phase == phase)))
        })
        .collect();
    Ok(CycleModel::assemble(
        bits.to_vec(),
        regions,
        modes,
        parameters.clone(),
        sequences.kept,
        sequences.left_out,
        sequences.longest,
        machines,
    ))
}
