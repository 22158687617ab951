//! The image of the bits as rows come in: words of regions, and what the mode bits say.

use serde::{Deserialize, Serialize};

use super::regions::{Modes, Region, Word};

/// What the machine is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// The work-complete bit is set: the machine does its work.
    Work,
    /// It is not: the machine is set up.
    Setup,
}

impl Phase {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Work, Self::Setup];

    /// Place in an array of both.
    pub fn index(self) -> usize {
        self as usize
    }

    /// As a user says it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Work => "work",
            Self::Setup => "set-up",
        }
    }
}

/// Which words and modes each bit goes into.
#[derive(Debug, Clone)]
pub struct Wiring {
    starts: Vec<u32>,
    places: Vec<(u32, Word)>,
    roles: Vec<u8>,
    modes: Modes,
}

impl Wiring {
    /// Wires bits to regions and modes.
    pub fn new(bits: usize, regions: &[Region], modes: &Modes) -> Self {
        let mut of_bit: Vec<Vec<(u32, Word)>> = vec![Vec::new(); bits];
        for (number, region) in (0..).zip(regions) {
            for (slot, bit) in region.slots.iter().enumerate() {
                if let Some(bit) = *bit {
                    of_bit[bit].push((number, region.mask(slot)));
                }
            }
        }
        let mut starts = vec![0];
        for places in &of_bit {
            starts.push(starts[starts.len() - 1] + places.len() as u32);
        }
        let mut roles = vec![0; bits];
        for mode in modes.all() {
            roles[mode.bit] = 1;
        }
        Self { starts, places: of_bit.concat(), roles, modes: modes.clone() }
    }
}

/// Values of all bits, and the words they make. A bit not seen yet is OFF.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Image {
    values: Vec<bool>,
    /// By region.
    pub words: Vec<Word>,
    /// Regions whose word has changed since the last look.
    pub dirty: Vec<u32>,
    /// What the mode bits say.
    pub mode: Mode,
    mode_changed: bool,
}

/// What the mode bits say.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mode {
    /// Work, set-up, or neither.
    pub phase: Option<Phase>,
    /// Moved by hand.
    pub manual: bool,
    /// Stopped with an alarm.
    pub alarm: bool,
}

impl Image {
    /// All bits OFF.
    pub fn new(bits: usize, regions: usize) -> Self {
        Self {
            values: vec![false; bits],
            words: vec![0; regions],
            dirty: Vec::new(),
            mode: Mode::default(),
            mode_changed: true,
        }
    }

    /// A row: a bit has a value.
    #[inline]
    pub fn set(&mut self, wiring: &Wiring, bit: u32, value: bool) {
        let bit = bit as usize;
        if std::mem::replace(&mut self.values[bit], value) == value {
            return;
        }
        let range = wiring.starts[bit] as usize..wiring.starts[bit + 1] as usize;
        for &(region, mask) in &wiring.places[range] {
            self.words[region as usize] ^= mask;
            if self.dirty.last() != Some(&region) {
                self.dirty.push(region);
            }
        }
        self.mode_changed |= wiring.roles[bit] != 0;
    }

    /// A whole scan has been taken in: true where the mode bits may say something else now.
    #[inline]
    pub fn complete(&mut self, wiring: &Wiring) -> bool {
        if self.dirty.len() > 1 {
            self.dirty.sort_unstable();
            self.dirty.dedup();
        }
        if !std::mem::take(&mut self.mode_changed) {
            return false;
        }
        let says = |mode: &super::regions::ModeBit| self.values[mode.bit] == mode.active;
        let modes = &wiring.modes;
        let phase = if says(&modes.work_complete) {
            Some(Phase::Work)
        } else {
            modes.setup.as_ref().is_none_or(says).then_some(Phase::Setup)
        };
        self.mode = Mode {
            phase,
            manual: modes.manual.iter().any(says),
            alarm: modes.alarm.iter().any(says),
        };
        true
    }
}
