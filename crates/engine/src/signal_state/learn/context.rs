//! What learning a group by itself must know of the plant and of the whole log.

use serde::{Deserialize, Serialize};

use crate::log::{Nanoseconds, SignalIndex};
use crate::naming::NamingRule;
use crate::plant::Plant;
use crate::saved_state;
use crate::signal_state::order::ScanOrder;
use crate::signal_state::parameters::{Parameters, Timing};
use crate::symbols::SymbolTable;

use super::reading::Run;
use super::survey::Survey;
use super::{LearnError, clock, starting};

/// Made once of the whole survey; every place that learns a group has a copy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Context {
    pub(super) plant: Plant,
    pub(super) parameters: Parameters,
    pub(super) runs: Vec<Run>,
    pub(super) resolution: Nanoseconds,
    pub(super) scan_window: Nanoseconds,
    pub(super) duration: Nanoseconds,
    /// By signal: its place among events of one time, where rows do not tell theirs.
    pub(super) rank: Vec<u32>,
    /// By group.
    rows: Vec<u64>,
}

impl Context {
    /// Places every signal of a log in its device and group, as [`super::learn`] does.
    ///
    /// # Errors
    /// A log without rows, a parameter out of range, an unknown starting signal, a naming rule that
    /// is none.
    pub fn of(
        survey: &Survey,
        table: &SymbolTable,
        parameters: &Parameters,
    ) -> Result<Self, LearnError> {
        parameters.validate()?;
        let rule = NamingRule::parse(&parameters.naming)?;
        let surveyed = survey.signals();
        if surveyed.is_empty() {
            return Err(LearnError::NoEvents);
        }
        let symbols: Vec<String> = surveyed.iter().map(|s| s.symbol.clone()).collect();
        let mut plant = Plant::arrange(&symbols, table, &rule);
        let mut rows = vec![0; plant.groups.len()];
        for (signal, surveyed) in plant.signals.iter_mut().zip(&surveyed) {
            signal.word |= surveyed.word;
            rows[plant.devices[signal.device()].group] += surveyed.rows;
        }
        starting::set_chosen(&mut plant, parameters)?;
        let rank = match parameters.timing {
            Timing::Adaptive => ScanOrder::of(&plant).into_ranks(),
            Timing::Plat => surveyed.iter().map(|surveyed| surveyed.by_name).collect(),
        };
        Ok(Self {
            plant,
            parameters: parameters.clone(),
            runs: survey.runs(),
            resolution: survey.phases().resolution(parameters),
            scan_window: clock::scan_window(&[], parameters),
            duration: survey.duration(),
            rank,
            rows,
        })
    }

    /// Everything, compactly.
    pub fn save(&self) -> Vec<u8> {
        saved_state::sealed(self)
    }

    /// From what was saved; `None` where it is damaged or of another version.
    pub fn restore(bytes: &[u8]) -> Option<Self> {
        postcard::from_bytes(saved_state::unsealed(bytes)?).ok()
    }

    /// Names of the groups; learning speaks of them by number.
    pub fn groups(&self) -> impl Iterator<Item = &str> {
        self.plant.groups.iter().map(|group| group.name.as_str())
    }

    /// Rows of each group.
    pub fn rows(&self) -> &[u64] {
        &self.rows
    }

    /// Signals, and the number of each one's group.
    pub fn signals(&self) -> impl Iterator<Item = (&str, usize)> {
        let group = |device: usize| self.plant.devices[device].group;
        self.plant.signals.iter().map(move |s| (s.symbol(), group(s.device())))
    }

    /// True where the place of rows of one time matters: `plat` takes them as they come.
    pub(super) fn keeps_places(&self) -> bool {
        self.parameters.timing == Timing::Plat
    }

    /// The place of a signal's events among those of one time.
    pub(super) fn rank(&self, signal: SignalIndex) -> i64 {
        i64::from(self.rank[signal as usize])
    }
}
