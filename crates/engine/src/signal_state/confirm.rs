//! An operator confirms an alarm path: it becomes part of the device's model
//! (Ghosh 2016, section 2.6, Figure 12).

use thiserror::Error;

use crate::finding::{Finding, Kind};
use crate::timing::Clusters;

use super::chains::ChainIndex;
use super::learn::set_probabilities;
use super::model::NominalModel;
use super::rules::{Rule, row_of};
use super::states::{StateId, StateNames};

/// Why a finding cannot be folded in.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ConfirmError {
    /// A finding that is no path.
    #[error(
        "finding {id} is a '{kind}': only unknown transitions and alarm paths can become part of the model"
    )]
    NoPath {
        /// Its id.
        id: String,
        /// Its kind.
        kind: String,
    },
    /// A finding of another plant.
    #[error("finding {id} belongs to another model: it has no {what}")]
    OtherPlant {
        /// Its id.
        id: String,
        /// What the model lacks.
        what: String,
    },
    /// A part of a model.
    #[error("a part of a model cannot be changed by itself; confirm finding {id} on the whole one")]
    Part {
        /// The finding's id.
        id: String,
    },
}

impl NominalModel {
    /// The model with a finding's path folded in, and how many of its transitions were new. They
    /// are allowed from now on, but are no evidence of what is usual: their times are not judged.
    ///
    /// # Errors
    /// A finding without a path, or of another plant.
    pub fn confirm(&self, finding: &Finding) -> Result<(Self, usize), ConfirmError> {
        if !matches!(finding.kind, Kind::Transition | Kind::AlarmPath) || finding.path.len() < 2 {
            let kind = serde_json::to_string(&finding.kind).unwrap_or_default();
            let kind = kind.trim_matches('"').to_owned();
            return Err(ConfirmError::NoPath { id: finding.id.clone(), kind });
        }
        if self.is_part() {
            return Err(ConfirmError::Part { id: finding.id.clone() });
        }
        let other = |what: String| ConfirmError::OtherPlant { id: finding.id.clone(), what };
        let group = finding.group.as_deref().unwrap_or_default();
        let device = (finding.model == crate::finding::Model::Device)
            .then(|| finding.device.as_deref().unwrap_or_default());
        let chain = self
            .find_chain(group, device)
            .ok_or_else(|| other(format!("device '{group}-{}'", device.unwrap_or_default())))?;
        let names = StateNames::of(&self.plant);
        let mut states = self.states.clone();
        let mut path = Vec::with_capacity(finding.path.len());
        for name in &finding.path {
            let (signal, value) =
                names.parse(name).ok_or_else(|| other(format!("signal-state '{name}'")))?;
            path.push(states.intern(signal, value));
        }
        let mut rules = self.rules.clone();
        let new = add_path(self, &mut rules, chain, &path);
        set_probabilities(&mut rules, &self.chains);
        let model = Self::assemble(
            self.plant.clone(),
            states,
            rules,
            self.learned.clone(),
            self.parameters.clone(),
        );
        Ok((model, new))
    }
}

fn add_path(
    model: &NominalModel,
    rules: &mut Vec<Rule>,
    chain: ChainIndex,
    path: &[StateId],
) -> usize {
    let mut sequence = rules.iter().map(|rule| rule.sequence.saturating_add(1)).max().unwrap_or(0);
    let mut position =
        rules.iter().filter(|r| r.chain == chain).map(|r| r.position + 1).max().unwrap_or(0);
    let before = rules.len();
    for step in path.windows(2) {
        let known = rules.iter().any(|rule| {
            row_of(rule.current, model.kind(rule.chain)) == row_of(step[0], model.kind(chain))
                && rule.next == step[1]
        });
        if known {
            continue;
        }
        rules.push(Rule {
            chain,
            current: step[0],
            next: step[1],
            count: 1,
            uncounted: 1,
            odd_at_start: 0,
            probability: 0.0,
            sequence,
            position,
            dispersion: 1.0,
            clusters: Clusters::default(),
            trigger: None,
        });
        sequence = sequence.saturating_add(1);
        position += 1;
    }
    rules.len() - before
}
