//! What a user may set of learning and watching; the `[signal_state]` table of `runglight.toml`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// How transition times are learned and judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Timing {
    /// Ghosh 2016 as published.
    Plat,
    /// Exact clusters, limits from their own spread, alarms within a budget.
    Adaptive,
}

/// Parameters of the signal-state models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Parameters {
    /// `plat` or `adaptive`.
    pub timing: Timing,
    /// Alarms per day the user will bear from a healthy machine.
    pub false_alarms_per_day: f64,
    /// `plat`: initial number of time clusters.
    pub k: usize,
    /// `plat`: parameter ε of the relative gap.
    pub epsilon: f64,
    /// `plat`: instances that span less are one cluster.
    pub single_cluster_span_s: f64,
    /// `plat`: clusters with nearer means merge.
    pub merge_distance_s: f64,
    /// `plat`: clusters with no more support are dropped.
    pub minimum_support: f64,
    /// `plat`: one allowance over the maximum time instead of 1.5, 3 and 4 s.
    pub allowance_s: Option<f64>,
    /// A path off the known transitions may return within this time.
    pub return_within_s: f64,
    /// A group without an event for this long has stopped.
    pub stall_after_s: f64,
    /// Take the stall time from the longest nominal pause × 1.5 instead of `stall_after_s`.
    pub stall_learned: bool,
    /// Group cycles between two checks of probabilities and average times.
    pub check_every: u32,
    /// Smallest change of a probability, or relative change of an average time, worth a finding.
    pub significant_change: f64,
    /// Time between scans; events closer have no order. From the log where not set.
    pub scan_interval_s: Option<f64>,
    /// Starting signal by device (`Group-Device` → signal name).
    pub starting: BTreeMap<String, String>,
    /// How names split into group, device and signal.
    pub naming: String,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            timing: Timing::Adaptive,
            false_alarms_per_day: 1.0,
            k: 5,
            epsilon: 20.0,
            single_cluster_span_s: 3.0,
            merge_distance_s: 3.0,
            minimum_support: 0.08,
            allowance_s: None,
            return_within_s: 60.0,
            stall_after_s: 180.0,
            stall_learned: false,
            check_every: 30,
            significant_change: 0.15,
            scan_interval_s: None,
            starting: BTreeMap::new(),
            naming: "{group}-{device}-{signal}".to_owned(),
        }
    }
}

/// A parameter nobody can learn with.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("parameter {name} is {value}; expected {expected}")]
pub struct ParameterError {
    /// Its key.
    pub name: &'static str,
    /// What was given.
    pub value: f64,
    /// What may be given.
    pub expected: &'static str,
}

impl Parameters {
    /// Checks ranges.
    ///
    /// # Errors
    /// The first parameter out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let positive = "a number above 0";
        let checks = [
            ("false_alarms_per_day", self.false_alarms_per_day, positive, 0.0),
            ("epsilon", self.epsilon, positive, 0.0),
            ("return_within_s", self.return_within_s, positive, 0.0),
            ("stall_after_s", self.stall_after_s, positive, 0.0),
            ("significant_change", self.significant_change, positive, 0.0),
            ("k", self.k as f64, "a whole number of at least 2", 1.0),
            ("check_every", f64::from(self.check_every), "a whole number of at least 1", 0.0),
            ("single_cluster_span_s", self.single_cluster_span_s, "0 or more seconds", -1e-300),
            ("merge_distance_s", self.merge_distance_s, "0 or more seconds", -1e-300),
            ("minimum_support", self.minimum_support, "a share from 0 to below 1", -1e-300),
            ("allowance_s", self.allowance_s.unwrap_or(1.0), positive, 0.0),
            ("scan_interval_s", self.scan_interval_s.unwrap_or(1.0), positive, 0.0),
        ];
        for (name, value, expected, above) in checks {
            if !value.is_finite() || value <= above {
                return Err(ParameterError { name, value, expected });
            }
        }
        if self.minimum_support >= 1.0 {
            return Err(ParameterError {
                name: "minimum_support",
                value: self.minimum_support,
                expected: "a share from 0 to below 1",
            });
        }
        Ok(())
    }
}
