//! Learning the cycle machine from fault-free logs (section 3.3 and 3.4).

use std::borrow::Borrow;
use std::collections::HashMap;
use std::sync::Arc;

use thiserror::Error;

use crate::log::ChangeLog;
use crate::plant::Plant;
use crate::signal_state::events::Row;

use super::auto;
use super::image::{Phase, Wiring};
use super::machine::Machine;
use super::model::CycleModel;
use super::monitor::Monitor;
use super::parameters::{CycleParameters, ModeSpec, RegionSpecs};
use super::regions::Directory;
use super::sequences::Sequences;
use super::stops::Stops;

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
    let model = CycleModel::assemble(
        bits.to_vec(),
        regions,
        modes,
        parameters.clone(),
        sequences.kept,
        sequences.left_out,
        sequences.longest,
        machines,
    );
    Ok(with_stops(model, logs, &maps))
}

/// Explains the alarms of the learned logs as watching would, and counts what their causes showed.
fn with_stops<L: Borrow<ChangeLog>>(
    model: CycleModel,
    logs: &[L],
    maps: &[Vec<Option<u32>>],
) -> CycleModel {
    if model.parameters.known_stops == 0 || model.modes.alarm.is_empty() {
        return model;
    }
    let model = Arc::new(model);
    let mut stops = Stops::default();
    for (log, map) in logs.iter().zip(maps) {
        stops_of(&model, log.borrow(), map, &mut stops);
    }
    CycleModel { stops, ..Arc::unwrap_or_clone(model) }
}

fn stops_of(model: &Arc<CycleModel>, log: &ChangeLog, map: &[Option<u32>], stops: &mut Stops) {
    let mut monitor = Monitor::of_learning(Arc::clone(model));
    let mut gaps = log.gaps.iter().peekable();
    let rows = log.time.iter().zip(&log.signal).zip(&log.value);
    for ((&time, &signal), &value) in rows {
        while let Some(gap) = gaps.next_if(|gap| time >= gap.end) {
            monitor.gap(gap.start, gap.end);
        }
        if let Some(bit) = map[signal as usize] {
            // Rows of a log are in order.
            let _ = monitor.observe(&[Row { time, signal: bit, value }]);
        }
    }
    monitor.finish();
    for signs in monitor.stops_seen() {
        stops.count(signs);
    }
}
