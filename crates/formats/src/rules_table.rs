//! Transition rules as an Arrow table: `rules.parquet` (Ghosh 2016, Table 2), one row per
//! transition and time cluster.
//!
//! The first thirteen columns are the published contract; those after them are what a monitor
//! needs to judge as it did when the model was learned.

use std::sync::Arc;

use arrow_array::builder::{Float64Builder, Int64Builder, StringBuilder};
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef, RecordBatch};
use arrow_schema::{DataType, Field, Schema, SchemaRef};

use runglight_engine::plant::Plant;
use runglight_engine::signal_state::chains::ChainKind;
use runglight_engine::signal_state::enabling::Trigger;
use runglight_engine::signal_state::model::NominalModel;
use runglight_engine::signal_state::rules::Rule;
use runglight_engine::signal_state::states::{NO_STATE, StateNames, States};
use runglight_engine::timing::TimeCluster;

const TEXT: [&str; 7] = ["model", "group", "device", "current", "next", "trigger", "trigger_times"];
const WHOLE: [&str; 6] =
    ["count", "cluster", "position", "uncounted", "sequence", "cluster_instances"];

/// Column names in order; text, whole numbers and the rest floats.
const COLUMNS: [&str; 30] = [
    "model",
    "group",
    "device",
    "current",
    "next",
    "count",
    "transition_probability",
    "cluster",
    "average_s",
    "minimum_s",
    "maximum_s",
    "time_probability",
    "position",
    "early_limit_s",
    "late_limit_s",
    "trigger",
    "trigger_average_s",
    "trigger_minimum_s",
    "trigger_maximum_s",
    "trigger_late_limit_s",
    "trigger_times",
    "uncounted",
    "sequence",
    "dispersion",
    "cluster_instances",
    "deviation_s",
    "early_scale_s",
    "late_scale_s",
    "tail_gini",
    "cluster_dispersion",
];

/// Between the two states of a join: the delay runs from the later of them.
const BOTH: &str = " & ";

/// Schema of the table.
pub fn schema() -> SchemaRef {
    let field = |name: &&str| {
        let data_type = if TEXT.contains(name) {
            DataType::Utf8
        } else if WHOLE.contains(name) {
            DataType::Int64
        } else {
            DataType::Float64
        };
        Field::new(*name, data_type, true)
    };
    Arc::new(Schema::new(COLUMNS.iter().map(field).collect::<Vec<_>>()))
}

/// One column while it is filled.
enum Column {
    Text(StringBuilder),
    Whole(Int64Builder),
    Real(Float64Builder),
}

enum Cell<'a> {
    Text(Option<&'a str>),
    Whole(Option<i64>),
    Real(Option<f64>),
}

impl Column {
    fn of(data_type: &DataType) -> Self {
        match data_type {
            DataType::Utf8 => Self::Text(StringBuilder::new()),
            DataType::Int64 => Self::Whole(Int64Builder::new()),
            _ => Self::Real(Float64Builder::new()),
        }
    }

    fn push(&mut self, cell: &Cell<'_>) {
        match (self, cell) {
            (Self::Text(column), Cell::Text(text)) => column.append_option(*text),
            (Self::Whole(column), Cell::Whole(number)) => column.append_option(*number),
            (Self::Real(column), Cell::Real(number)) => column.append_option(*number),
            (Self::Text(column), _) => column.append_null(),
            (Self::Whole(column), _) => column.append_null(),
            (Self::Real(column), _) => column.append_null(),
        }
    }

    fn finish(self) -> ArrayRef {
        match self {
            Self::Text(mut column) => Arc::new(column.finish()),
            Self::Whole(mut column) => Arc::new(column.finish()),
            Self::Real(mut column) => Arc::new(column.finish()),
        }
    }
}

/// The rules of a model, devices first, each chain in the order of first appearance.
pub fn to_batch(model: &NominalModel) -> RecordBatch {
    let schema = schema();
    let mut columns: Vec<Column> =
        schema.fields().iter().map(|field| Column::of(field.data_type())).collect();
    for rule in model.rules_in_order() {
        if rule.clusters.is_empty() {
            push_row(&mut columns, model, rule, None);
        }
        for cluster in rule.clusters.iter().enumerate() {
            push_row(&mut columns, model, rule, Some(cluster));
        }
    }
    let columns = columns.into_iter().map(Column::finish).collect();
    RecordBatch::try_new(Arc::clone(&schema), columns)
        .unwrap_or_else(|_| RecordBatch::new_empty(schema))
}

fn push_row(
    columns: &mut [Column],
    model: &NominalModel,
    rule: &Rule,
    cluster: Option<(usize, &TimeCluster)>,
) {
    // Where another event enables the transition, the limits are on the delay from that.
    let all_limits = model.limits_of(rule);
    let own = cluster.filter(|_| rule.trigger.is_none());
    let limits = own.and_then(|(index, _)| all_limits.get(index));
    let trigger = rule.trigger.as_ref();
    let trigger_name = trigger_name(model, rule);
    let trigger_times = trigger.and_then(|t| serde_json::to_string(&t.clusters).ok());
    let slowest = trigger.and_then(|t| t.clusters.last());
    let trigger_limit =
        trigger.and_then(|_| all_limits.last()).map(|limit| limit.1).filter(|l| l.is_finite());
    let kind = match model.kind(rule.chain) {
        ChainKind::Device => "device",
        ChainKind::Group => "group",
    };
    let (current, next) = (model.state_name(rule.current), model.state_name(rule.next));
    let of = |value: fn(&TimeCluster) -> f64| Cell::Real(cluster.map(|(_, c)| value(c)));
    let finite = |limit: f64| limit.is_finite().then_some(limit);
    let cells = [
        Cell::Text(Some(kind)),
        Cell::Text(Some(model.group_name(rule.chain))),
        Cell::Text(model.device_name(rule.chain)),
        Cell::Text(Some(&current)),
        Cell::Text(Some(&next)),
        Cell::Whole(Some(rule.count as i64)),
        Cell::Real(Some(rule.probability)),
        Cell::Whole(cluster.map(|(index, _)| index as i64)),
        of(|c| c.average_s),
        of(|c| c.minimum_s),
        of(|c| c.maximum_s),
        of(|c| c.probability),
        Cell::Whole(Some(i64::from(rule.position))),
        Cell::Real(limits.and_then(|limit| finite(limit.0))),
        Cell::Real(limits.and_then(|limit| finite(limit.1))),
        Cell::Text(trigger_name.as_deref()),
        Cell::Real(slowest.map(|c| c.average_s)),
        Cell::Real(slowest.map(|c| c.minimum_s)),
        Cell::Real(slowest.map(|c| c.maximum_s)),
        Cell::Real(trigger_limit),
        Cell::Text(trigger_times.as_deref()),
        Cell::Whole(Some(rule.uncounted as i64)),
        Cell::Whole(Some(rule.sequence as i64)),
        Cell::Real(Some(rule.dispersion)),
        Cell::Whole(cluster.map(|(_, c)| c.instances as i64)),
        of(|c| c.deviation_s),
        of(|c| c.early_scale_s),
        of(|c| c.late_scale_s),
        of(|c| c.tail_gini),
        of(|c| c.dispersion),
    ];
    for (column, cell) in columns.iter_mut().zip(&cells) {
        column.push(cell);
    }
}

/// The states that enable a rule, joined by ` & ` where it waits for the later of two.
pub fn trigger_name(model: &NominalModel, rule: &Rule) -> Option<String> {
    let names = rule.trigger.as_ref()?.states().map(|state| model.state_name(state));
    Some(names.collect::<Vec<_>>().join(BOTH))
}

/// Reads rules back; `None` where a row does not fit the plant or a column is missing.
pub fn from_batches(
    batches: &[RecordBatch],
    plant: &Plant,
    states: &mut States,
) -> Option<Vec<Rule>> {
    let names = StateNames::of(plant);
    let mut rules: Vec<Rule> = Vec::new();
    for batch in batches {
        let table = Table { batch };
        for row in 0..batch.num_rows() {
            let rule = table.rule(row, plant, &names, states)?;
            match rules.last_mut() {
                Some(last)
                    if last.chain == rule.chain
                        && last.current == rule.current
                        && last.next == rule.next =>
                {
                    last.clusters.extend(rule.clusters);
                }
                _ => rules.push(rule),
            }
        }
    }
    Some(rules)
}

struct Table<'a> {
    batch: &'a RecordBatch,
}

impl Table<'_> {
    fn text(&self, name: &str, row: usize) -> Option<&str> {
        let column = self.batch.column_by_name(name)?.as_string_opt::<i32>()?;
        column.is_valid(row).then(|| column.value(row))
    }

    fn whole(&self, name: &str, row: usize) -> Option<i64> {
        let column = self.batch.column_by_name(name)?.as_primitive_opt::<Int64Type>()?;
        column.is_valid(row).then(|| column.value(row))
    }

    fn real(&self, name: &str, row: usize) -> Option<f64> {
        let column = self.batch.column_by_name(name)?.as_primitive_opt::<Float64Type>()?;
        column.is_valid(row).then(|| column.value(row))
    }

    fn count(&self, name: &str, row: usize) -> Option<u64> {
        u64::try_from(self.whole(name, row)?).ok()
    }

    fn rule(
        &self,
        row: usize,
        plant: &Plant,
        names: &StateNames,
        states: &mut States,
    ) -> Option<Rule> {
        let group = self.text("group", row)?;
        let chain = match self.text("model", row)? {
            "device" => plant.find_device(group, self.text("device", row)?)?,
            "group" => plant.devices.len() + plant.find_group(group)?,
            _ => return None,
        };
        let mut state = |column: &str| {
            let (signal, value) = names.parse(self.text(column, row)?)?;
            Some(states.intern(signal, value))
        };
        let (current, next) = (state("current")?, state("next")?);
        let trigger = match self.text("trigger", row) {
            None => None,
            Some(name) => {
                let mut enabling = [NO_STATE; 2];
                for (place, name) in enabling.iter_mut().zip(name.split(BOTH)) {
                    let (signal, value) = names.parse(name)?;
                    *place = states.intern(signal, value);
                }
                let clusters = serde_json::from_str(self.text("trigger_times", row)?).ok()?;
                Some(Trigger { states: enabling, clusters })
            }
        };
        let clusters = match self.whole("cluster", row) {
            None => Vec::new(),
            Some(_) => vec![TimeCluster {
                instances: self.count("cluster_instances", row)?,
                average_s: self.real("average_s", row)?,
                minimum_s: self.real("minimum_s", row)?,
                maximum_s: self.real("maximum_s", row)?,
                probability: self.real("time_probability", row)?,
                deviation_s: self.real("deviation_s", row)?,
                late_scale_s: self.real("late_scale_s", row)?,
                early_scale_s: self.real("early_scale_s", row)?,
                tail_gini: self.real("tail_gini", row)?,
                dispersion: self.real("cluster_dispersion", row)?,
            }],
        };
        Some(Rule {
            chain,
            current,
            next,
            count: self.count("count", row)?,
            uncounted: self.count("uncounted", row)?,
            probability: self.real("transition_probability", row)?,
            sequence: self.count("sequence", row)?,
            position: u32::try_from(self.whole("position", row)?).ok()?,
            dispersion: self.real("dispersion", row)?,
            clusters,
            trigger,
        })
    }
}
