//! Names for numbers: what findings are told with.

use crate::finding::{Expected, Finding, Kind, Model};
use crate::log::{Nanoseconds, SignalIndex};

use super::chains::{ChainIndex, ChainKind};
use super::model::NominalModel;
use super::rules::row_of;
use super::states::{StateId, full_state_name};

/// Knows the names of a model's states, and of those first met while watching.
#[derive(Debug, Clone, Copy)]
pub struct Teller<'a> {
    /// The model.
    pub model: &'a NominalModel,
    /// Values of words nobody learned, numbered after the model's states.
    pub further: &'a [(SignalIndex, i64)],
}

impl<'a> Teller<'a> {
    /// Knows the states of the model only.
    pub fn of(model: &'a NominalModel) -> Self {
        Self { model, further: &[] }
    }

    /// Signal and value of a state.
    pub fn signal_value(self, state: StateId) -> (SignalIndex, i64) {
        match (state as usize).checked_sub(self.model.states.len()) {
            None => self.model.states.signal_value(state),
            Some(further) => self.further[further],
        }
    }

    /// `Group1-Device2-Signal2_ON`.
    pub fn state_name(self, state: StateId) -> String {
        let (signal, value) = self.signal_value(state);
        full_state_name(&self.model.plant, signal, value)
    }

    /// `Group1/Device2`, as ids are made of it.
    pub fn place_name(self, chain: ChainIndex) -> String {
        let model = self.model;
        format!("{}/{}", model.group_name(chain), model.device_name(chain).unwrap_or(""))
    }

    /// Expected successors of a state, most probable first.
    pub fn expected_from(self, state: StateId, kind: ChainKind) -> Vec<Expected> {
        let rules = self.model.table.row(row_of(state, kind));
        rules
            .map(|rule| Expected {
                state: self.state_name(self.model.rules[rule].next),
                probability: self.model.rules[rule].probability,
                limit_s: self.model.latest_s(rule),
            })
            .collect()
    }

    /// A finding of a kind at a chain, its state's signal filled in.
    pub fn at(self, kind: Kind, chain: ChainIndex, state: StateId, time: Nanoseconds) -> Finding {
        let plant = &self.model.plant;
        let index = self.signal_value(state).0;
        let signal = &plant.signals[index as usize];
        let model = match self.model.kind(chain) {
            ChainKind::Device => Model::Device,
            ChainKind::Group => Model::Group,
        };
        Finding {
            group: Some(self.model.group_name(chain).to_owned()),
            device: Some(plant.device_of(index).name.clone()),
            signal: Some(signal.name().to_owned()),
            address: signal.address().map(str::to_owned),
            to: Some(self.state_name(state)),
            ..Finding::new(kind, model, time)
        }
    }
}
