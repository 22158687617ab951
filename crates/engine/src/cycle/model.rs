//! What was learned: regions, mode bits, and an automaton per region and phase.

use serde::{Deserialize, Serialize};

use crate::log::{Nanoseconds, SECOND};

use super::image::{Phase, Wiring};
use super::machine::{Machine, Node, State, Then, Transition};
use super::order::Independence;
use super::parameters::CycleParameters;
use super::regions::{BITS_AT_MOST, Bit, Modes, Region, Word};
use super::stops::{Sign, Stops};

/// Version of `cycles.json`.
pub const CYCLE_FORMAT: u32 = 2;

/// The cycle machine of a plant.
#[derive(Debug, Clone)]
pub struct CycleModel {
    /// Every boolean signal of the logs.
    pub bits: Vec<Bit>,
    /// As configured, or as proposed.
    pub regions: Vec<Region>,
    /// What the machine is about.
    pub modes: Modes,
    /// How it was learned and is watched.
    pub parameters: CycleParameters,
    /// Sequences learned from, work and set-up.
    pub kept: [u64; 2],
    /// Sequences cleaning left out.
    pub left_out: [u64; 2],
    /// The longest kept sequence, work and set-up.
    pub longest: [Nanoseconds; 2],
    /// Per region, work and set-up.
    pub machines: Vec<[Machine; 2]>,
    /// Per region, work and set-up: which changes come in either order.
    pub independence: Vec<[Independence; 2]>,
    /// Stops of the learned logs that were no failure.
    pub stops: Stops,
    /// Bits to regions and modes.
    pub wiring: Wiring,
}

/// Why a text is no cycle machine.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CycleFileError {
    /// Another version.
    #[error("format {found}, this version reads format {CYCLE_FORMAT}")]
    Version {
        /// Version found.
        found: u64,
    },
    /// Something in it does not fit.
    #[error("{0}")]
    Damaged(String),
}

#[derive(Serialize, Deserialize)]
struct Layout {
    format: Option<u64>,
}

/// `cycles.json`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    format: u32,
    parameters: CycleParameters,
    modes: Modes,
    bits: Vec<Bit>,
    sequences: [WrittenPhase; 2],
    regions: Vec<WrittenRegion>,
    stops: Vec<WrittenStop>,
}

#[derive(Serialize, Deserialize)]
struct WrittenStop {
    signs: Vec<Sign>,
    count: u64,
}

#[derive(Serialize, Deserialize)]
struct WrittenPhase {
    kept: u64,
    left_out: u64,
    longest_ns: Nanoseconds,
}

#[derive(Serialize, Deserialize)]
struct WrittenRegion {
    name: String,
    slots: Vec<Option<usize>>,
    work: WrittenMachine,
    setup: WrittenMachine,
}

#[derive(Serialize, Deserialize)]
struct WrittenMachine {
    states: Vec<WrittenState>,
    transitions: Vec<Transition>,
}

#[derive(Serialize, Deserialize)]
struct WrittenState {
    word: String,
    initial: u64,
    r#final: u64,
    longest_first_stay: Nanoseconds,
    then: Vec<Then>,
}

impl CycleModel {
    /// Puts a model together.
    #[expect(clippy::too_many_arguments, reason = "one place that names every part")]
    pub fn assemble(
        bits: Vec<Bit>,
        regions: Vec<Region>,
        modes: Modes,
        parameters: CycleParameters,
        kept: [u64; 2],
        left_out: [u64; 2],
        longest: [Nanoseconds; 2],
        machines: Vec<[Machine; 2]>,
    ) -> Self {
        let wiring = Wiring::new(bits.len(), &regions, &modes);
        let independence = machines
            .iter()
            .map(|of| [Independence::of(&of[0]), Independence::of(&of[1])])
            .collect();
        Self {
            bits,
            regions,
            modes,
            parameters,
            kept,
            left_out,
            longest,
            machines,
            independence,
            stops: Stops::default(),
            wiring,
        }
    }

    /// The automaton of a region in a phase.
    #[inline]
    pub fn machine(&self, region: usize, phase: Phase) -> &Machine {
        &self.machines[region][phase.index()]
    }

    /// A region by its name.
    pub fn find_region(&self, name: &str) -> Option<usize> {
        self.regions.iter().position(|region| region.name == name)
    }

    /// After how long a sequence of a phase never ends.
    pub fn never_ends_after(&self, phase: Phase) -> Option<Nanoseconds> {
        let longest = self.longest[phase.index()];
        let limit = longest as f64 * self.parameters.never_ends_factor;
        (longest > 0).then_some((limit as i64).max(SECOND))
    }

    /// Text of `cycles.json`.
    pub fn to_json(&self) -> String {
        let machine = |region: &Region, machine: &Machine| WrittenMachine {
            states: machine
                .nodes
                .iter()
                .map(|node| WrittenState {
                    word: region.hex(node.word),
                    initial: node.initial,
                    r#final: node.last,
                    longest_first_stay: node.longest_first_stay,
                    then: node.then.clone(),
                })
                .collect(),
            transitions: machine.transitions.clone(),
        };
        let written = Written {
            format: CYCLE_FORMAT,
            parameters: self.parameters.clone(),
            modes: self.modes.clone(),
            bits: self.bits.clone(),
            sequences: Phase::ALL.map(|phase| WrittenPhase {
                kept: self.kept[phase.index()],
                left_out: self.left_out[phase.index()],
                longest_ns: self.longest[phase.index()],
            }),
            regions: self
                .regions
                .iter()
                .zip(&self.machines)
                .map(|(region, machines)| WrittenRegion {
                    name: region.name.clone(),
                    slots: region.slots.clone(),
                    work: machine(region, &machines[0]),
                    setup: machine(region, &machines[1]),
                })
                .collect(),
            stops: self
                .stops
                .iter()
                .map(|(signs, count)| WrittenStop { signs: signs.to_vec(), count })
                .collect(),
        };
        serde_json::to_string(&written).unwrap_or_default()
    }

    /// Reads `cycles.json`; every index is checked.
    ///
    /// # Errors
    /// Another version, or anything that does not fit.
    pub fn from_json(text: &[u8]) -> Result<Self, CycleFileError> {
        let damaged = |problem: &str| CycleFileError::Damaged(problem.to_owned());
        let layout: Layout = serde_json::from_slice(text).map_err(|_| damaged("no JSON"))?;
        let found = layout.format.ok_or_else(|| damaged("it names no format"))?;
        if found != u64::from(CYCLE_FORMAT) {
            return Err(CycleFileError::Version { found });
        }
        let written: Written =
            serde_json::from_slice(text).map_err(|e| CycleFileError::Damaged(e.to_string()))?;
        written.parameters.validate().map_err(|e| CycleFileError::Damaged(e.to_string()))?;
        let bits = written.bits.len();
        let known = |bit: usize| bit < bits;
        if !written.modes.all().all(|mode| known(mode.bit)) {
            return Err(damaged("a mode names a bit that is not there"));
        }
        let mut machines = Vec::new();
        let mut regions = Vec::new();
        for region in written.regions {
            if region.slots.is_empty()
                || region.slots.len() > BITS_AT_MOST
                || !region.slots.iter().flatten().all(|&bit| known(bit))
            {
                return Err(damaged("a region names a bit that is not there"));
            }
            let width = region.slots.len();
            machines.push([
                read_machine(region.work, width).ok_or_else(|| damaged("a state or transition"))?,
                read_machine(region.setup, width)
                    .ok_or_else(|| damaged("a state or transition"))?,
            ]);
            regions.push(Region { name: region.name, slots: region.slots });
        }
        let of = |get: fn(&WrittenPhase) -> u64| {
            [get(&written.sequences[0]), get(&written.sequences[1])]
        };
        let longest = [written.sequences[0].longest_ns, written.sequences[1].longest_ns];
        let mut stops = Stops::default();
        for stop in written.stops {
            if !stop.signs.iter().all(|sign| known(sign.bit as usize)) {
                return Err(damaged("a stop names a bit that is not there"));
            }
            stops.add(stop.signs, stop.count);
        }
        let model = Self::assemble(
            written.bits,
            regions,
            written.modes,
            written.parameters,
            of(|phase| phase.kept),
            of(|phase| phase.left_out),
            longest,
            machines,
        );
        Ok(Self { stops, ..model })
    }

    /// Changes with the model; a saved monitor state fits only its own.
    pub fn fingerprint(&self) -> u64 {
        xxhash_rust::xxh3::xxh3_64(self.to_json().as_bytes())
    }
}

fn read_machine(written: WrittenMachine, width: usize) -> Option<Machine> {
    let mut nodes = Vec::new();
    for state in &written.states {
        let word = Word::from_str_radix(&state.word, 16).ok()?;
        if width < BITS_AT_MOST && word >> width != 0 {
            return None;
        }
        nodes.push(Node {
            word,
            initial: state.initial,
            last: state.r#final,
            longest_first_stay: state.longest_first_stay,
            then: state.then.clone(),
        });
    }
    let known = |state: State| (state as usize) < nodes.len();
    let then_known = |then: &[Then]| then.iter().all(|then| known(then.to) && then.count > 0);
    let whole = written
        .transitions
        .iter()
        .all(|t| known(t.from) && known(t.to) && t.weight > 0 && then_known(&t.then))
        && nodes.iter().all(|node| then_known(&node.then));
    whole.then(|| Machine::assemble(nodes, written.transitions))
}
