//! Transition rules as an Arrow table: `rules.parquet` (Ghosh 2016, Table 2), one row per
//! transition and time cluster.
//!
//! The first thirteen columns are the published contract; those after them are what a monitor
//! needs to judge as it did when the model was learned.

use std::sync::Arc;

use arrow_array::builder::{Float64Builder, Int64Builder, StringBuilder};
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use hashbrown::HashMap;

use runglight_engine::plant::Plant;
use runglight_engine::signal_state::chains::{ChainIndex, ChainKind};
use runglight_engine::signal_state::enabling::Trigger;
use runglight_engine::signal_state::model::NominalModel;
use runglight_engine::signal_state::rules::Rule;
use runglight_engine::signal_state::states::{NO_STATE, StateId, StateNames, States};
use runglight_engine::timing::{Clusters, TimeCluster};

const TEXT: [&str; 7] = ["model", "group", "device", "current", "next", "trigger", "trigger_times"];
const WHOLE: [&str; 7] =
    ["count", "cluster", "position", "uncounted", "sequence", "cluster_instances", "odd_at_start"];

/// Column names in order; text, whole numbers and the rest floats.
const COLUMNS: [&str; 31] = [
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
    "odd_at_start",
];

/// What follows from other columns: written for those who read the table, not read back.
const FOLLOWING: [&str; 6] = [
    "early_limit_s",
    "late_limit_s",
    "trigger_average_s",
    "trigger_minimum_s",
    "trigger_maximum_s",
    "trigger_late_limit_s",
];

/// True for the columns that [`from_batches`] needs.
pub fn is_read_back(column: &str) -> bool {
    !FOLLOWING.contains(&column)
}

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
        Cell::Whole(Some(i64::from(rule.count))),
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
        Cell::Whole(Some(i64::from(rule.uncounted))),
        Cell::Whole(Some(i64::from(rule.sequence))),
        Cell::Real(Some(rule.dispersion.into())),
        Cell::Whole(cluster.map(|(_, c)| i64::from(c.instances))),
        of(|c| c.deviation_s.into()),
        of(|c| c.early_scale_s.into()),
        of(|c| c.late_scale_s.into()),
        of(|c| c.tail_gini.into()),
        of(|c| c.dispersion.into()),
        Cell::Whole(Some(i64::from(rule.odd_at_start))),
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

/// Reads rules back, a batch at a time; `None` where a row does not fit the plant or a column is missing.
pub fn from_batches(
    batches: impl IntoIterator<Item = Result<RecordBatch, ArrowError>>,
    plant: &Plant,
    states: &mut States,
) -> Option<Vec<Rule>> {
    let mut names = Names::of(plant);
    let mut rules: Vec<Rule> = Vec::new();
    // Clusters of the last rule, which may still get more.
    let mut clusters: Vec<TimeCluster> = Vec::new();
    let close = |rules: &mut Vec<Rule>, clusters: &mut Vec<TimeCluster>| {
        if let Some(rule) = rules.last_mut() {
            rule.clusters = clusters.as_slice().into();
        }
        clusters.clear();
    };
    for batch in batches {
        let batch = batch.ok()?;
        let table = Table::of(&batch)?;
        for row in 0..batch.num_rows() {
            let (chain, current, next) = table.transition(row, &mut names, states)?;
            let cluster = table.cluster(row)?;
            match rules.last_mut() {
                Some(last)
                    if last.chain == chain && last.current == current && last.next == next =>
                {
                    clusters.extend(cluster);
                }
                _ => {
                    close(&mut rules, &mut clusters);
                    clusters.extend(cluster);
                    rules.push(Rule {
                        chain,
                        current,
                        next,
                        count: small(table.count, row)?,
                        uncounted: small(table.uncounted, row)?,
                        odd_at_start: small(table.odd_at_start, row)?,
                        probability: real(table.probability, row)?,
                        sequence: small(table.sequence, row)?,
                        position: small(table.position, row)?,
                        dispersion: single(table.dispersion, row)?,
                        clusters: Clusters::default(),
                        trigger: table.trigger(row, &names, states)?.map(Box::new),
                    });
                }
            }
        }
    }
    close(&mut rules, &mut clusters);
    Some(rules)
}

/// Chains and states by name.
struct Names<'a> {
    states: StateNames<'a>,
    groups: HashMap<&'a str, ChainIndex>,
    devices: HashMap<(&'a str, &'a str), ChainIndex>,
    /// The states of the last row by their names, `next` and `current`: a state's rules lie side by
    /// side, and mostly behind the one that led there.
    last: [(String, StateId); 2],
}

impl<'a> Names<'a> {
    fn of(plant: &'a Plant) -> Self {
        let group = |index: usize| plant.groups[index].name.as_str();
        let devices = plant.devices.iter().map(|device| (group(device.group), &*device.name));
        let first = plant.devices.len();
        Self {
            states: StateNames::of(plant),
            groups: (0..plant.groups.len()).map(|index| (group(index), first + index)).collect(),
            devices: devices.zip(0..).collect(),
            last: [(String::new(), NO_STATE), (String::new(), NO_STATE)],
        }
    }

    fn state(&self, name: &str, states: &mut States) -> Option<StateId> {
        let (signal, value) = self.states.parse(name)?;
        Some(states.intern(signal, value))
    }

    /// Both states of a row.
    fn both(
        &mut self,
        [current, next]: [&str; 2],
        states: &mut States,
    ) -> Option<(StateId, StateId)> {
        let known = self.last.iter().find(|(name, state)| *state != NO_STATE && name == current);
        let ids = match known {
            Some(&(_, state)) => [self.state(next, states)?, state],
            None => {
                let current = self.state(current, states)?;
                [self.state(next, states)?, current]
            }
        };
        for ((last, name), id) in self.last.iter_mut().zip([next, current]).zip(ids) {
            if last.1 != id {
                name.clone_into(&mut last.0);
                last.1 = id;
            }
        }
        Some((ids[1], ids[0]))
    }
}

/// The columns of a batch that are read back.
struct Table<'a> {
    model: &'a StringArray,
    group: &'a StringArray,
    device: &'a StringArray,
    current: &'a StringArray,
    next: &'a StringArray,
    count: &'a Int64Array,
    uncounted: &'a Int64Array,
    probability: &'a Float64Array,
    sequence: &'a Int64Array,
    position: &'a Int64Array,
    dispersion: &'a Float64Array,
    trigger: &'a StringArray,
    trigger_times: &'a StringArray,
    cluster: &'a Int64Array,
    instances: &'a Int64Array,
    average_s: &'a Float64Array,
    minimum_s: &'a Float64Array,
    maximum_s: &'a Float64Array,
    time_probability: &'a Float64Array,
    deviation_s: &'a Float64Array,
    late_scale_s: &'a Float64Array,
    early_scale_s: &'a Float64Array,
    tail_gini: &'a Float64Array,
    cluster_dispersion: &'a Float64Array,
    odd_at_start: &'a Int64Array,
}

fn text(column: &StringArray, row: usize) -> Option<&str> {
    column.is_valid(row).then(|| column.value(row))
}

fn whole(column: &Int64Array, row: usize) -> Option<i64> {
    column.is_valid(row).then(|| column.value(row))
}

fn real(column: &Float64Array, row: usize) -> Option<f64> {
    column.is_valid(row).then(|| column.value(row))
}

fn small(column: &Int64Array, row: usize) -> Option<u32> {
    u32::try_from(whole(column, row)?).ok()
}

fn single(column: &Float64Array, row: usize) -> Option<f32> {
    real(column, row).map(|number| number as f32)
}

impl<'a> Table<'a> {
    fn of(batch: &'a RecordBatch) -> Option<Self> {
        let texts = |name: &str| batch.column_by_name(name)?.as_string_opt::<i32>();
        let wholes = |name: &str| batch.column_by_name(name)?.as_primitive_opt::<Int64Type>();
        let reals = |name: &str| batch.column_by_name(name)?.as_primitive_opt::<Float64Type>();
        Some(Self {
            model: texts("model")?,
            group: texts("group")?,
            device: texts("device")?,
            current: texts("current")?,
            next: texts("next")?,
            count: wholes("count")?,
            uncounted: wholes("uncounted")?,
            probability: reals("transition_probability")?,
            sequence: wholes("sequence")?,
            position: wholes("position")?,
            dispersion: reals("dispersion")?,
            trigger: texts("trigger")?,
            trigger_times: texts("trigger_times")?,
            cluster: wholes("cluster")?,
            instances: wholes("cluster_instances")?,
            average_s: reals("average_s")?,
            minimum_s: reals("minimum_s")?,
            maximum_s: reals("maximum_s")?,
            time_probability: reals("time_probability")?,
            deviation_s: reals("deviation_s")?,
            late_scale_s: reals("late_scale_s")?,
            early_scale_s: reals("early_scale_s")?,
            tail_gini: reals("tail_gini")?,
            cluster_dispersion: reals("cluster_dispersion")?,
            // Models from before it was told apart took all of a start for odd.
            odd_at_start: wholes("odd_at_start").or_else(|| wholes("uncounted"))?,
        })
    }

    fn transition(
        &self,
        row: usize,
        names: &mut Names<'_>,
        states: &mut States,
    ) -> Option<(ChainIndex, StateId, StateId)> {
        let group = text(self.group, row)?;
        let chain = match text(self.model, row)? {
            "device" => *names.devices.get(&(group, text(self.device, row)?))?,
            "group" => *names.groups.get(group)?,
            _ => return None,
        };
        let (current, next) =
            names.both([text(self.current, row)?, text(self.next, row)?], states)?;
        Some((chain, current, next))
    }

    /// Outer `None`: what is there cannot be read.
    fn trigger(
        &self,
        row: usize,
        names: &Names<'_>,
        states: &mut States,
    ) -> Option<Option<Trigger>> {
        let Some(name) = text(self.trigger, row) else { return Some(None) };
        let mut enabling = [NO_STATE; 2];
        for (place, name) in enabling.iter_mut().zip(name.split(BOTH)) {
            *place = names.state(name, states)?;
        }
        let clusters = serde_json::from_str(text(self.trigger_times, row)?).ok()?;
        Some(Some(Trigger { states: enabling, clusters }))
    }

    /// Outer `None`: what is there cannot be read.
    fn cluster(&self, row: usize) -> Option<Option<TimeCluster>> {
        if whole(self.cluster, row).is_none() {
            return Some(None);
        }
        Some(Some(TimeCluster {
            instances: small(self.instances, row)?,
            average_s: real(self.average_s, row)?,
            minimum_s: real(self.minimum_s, row)?,
            maximum_s: real(self.maximum_s, row)?,
            probability: real(self.time_probability, row)?,
            deviation_s: single(self.deviation_s, row)?,
            late_scale_s: single(self.late_scale_s, row)?,
            early_scale_s: single(self.early_scale_s, row)?,
            tail_gini: single(self.tail_gini, row)?,
            dispersion: single(self.cluster_dispersion, row)?,
        }))
    }
}
