//! The nominal model on disk: a directory with `manifest.json`, `rules.parquet` and,
//! where the machine has mode bits, `cycles.json`.
//!
//! It is written beside its place and renamed when complete, so no reader ever sees half a model.
//! The manifest holds checksums of the others: what was damaged or mixed is refused.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use parquet::arrow::ArrowWriter;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use runglight_engine::cycle::model::CycleModel;
use runglight_engine::log::SignalIndex;
use runglight_engine::plant::{Device, Group, Plant, Signal};
use runglight_engine::signal_state::model::{Learned, NominalModel};
use runglight_engine::signal_state::parameters::Parameters;
use runglight_engine::signal_state::states::States;

use crate::rules_table;
use crate::staged::{self, checksum, write_synced};

/// Version of the directory's layout.
pub const MODEL_FORMAT: u32 = 1;

const MANIFEST: &str = "manifest.json";
const RULES: &str = "rules.parquet";
const CYCLES: &str = "cycles.json";
/// Files that belong to the model itself; others in the directory are kept when it is replaced.
const OWN: [&str; 3] = [MANIFEST, RULES, CYCLES];

/// Why a model cannot be read or written.
#[derive(Debug, Error)]
pub enum ModelError {
    /// There is no such directory, or it holds no model.
    #[error("{}: there is no model here (no manifest.json); learn one with 'runglight learn LOG -o {}'", path.display(), path.display())]
    Missing {
        /// The path given.
        path: PathBuf,
    },
    /// The layout is of another version.
    #[error("{}: the model has format {found}, this version reads format {MODEL_FORMAT}; learn it anew from its logs", path.display())]
    Version {
        /// The path given.
        path: PathBuf,
        /// Version found.
        found: u64,
    },
    /// Something in it does not fit.
    #[error("{}: the model is damaged ({problem}); restore it from a copy or learn it anew from its logs", path.display())]
    Damaged {
        /// The path given.
        path: PathBuf,
        /// What does not fit.
        problem: String,
    },
    /// The place is taken by something else.
    #[error("{}: already exists and is no model; choose another name or remove it", path.display())]
    Taken {
        /// The path given.
        path: PathBuf,
    },
    /// The file system refused.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The path.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// What the system said.
        source: io::Error,
    },
}

/// Where a model comes from.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// When it was learned, ISO 8601 UTC.
    pub created: String,
    /// Names of the logs it was learned from.
    pub source: Vec<String>,
}

/// As much of a manifest as every layout has.
#[derive(Deserialize)]
struct Layout {
    format: Option<u64>,
}

#[derive(Serialize, Deserialize)]
struct Manifest {
    format: u32,
    created: String,
    source: Vec<String>,
    parameters: Parameters,
    learned: Learned,
    /// Checksum of `rules.parquet`, xxh3 in hexadecimal.
    rules_checksum: String,
    rules: usize,
    /// Checksum of `cycles.json`, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    cycles_checksum: Option<String>,
    /// Values of words beyond 0 and 1, in the order of their state numbers.
    word_states: Vec<(SignalIndex, i64)>,
    signals: Vec<Signal>,
    devices: Vec<Device>,
    groups: Vec<Group>,
    unplaced: Vec<String>,
}

/// Writes a model, replacing an older one of that name.
///
/// # Errors
/// The place is taken by something that is no model, or the file system refuses.
pub fn save(
    model: &NominalModel,
    cycle: Option<&CycleModel>,
    provenance: &Provenance,
    path: &Path,
) -> Result<(), ModelError> {
    if path.exists() && !path.join(MANIFEST).is_file() && !staged::is_empty_directory(path) {
        return Err(ModelError::Taken { path: path.to_owned() });
    }
    staged::replace(path, &OWN, |staging| write_files(model, cycle, provenance, staging)).map_err(
        |source| ModelError::Io { path: path.to_owned(), action: "write the model", source },
    )
}

fn write_files(
    model: &NominalModel,
    cycle: Option<&CycleModel>,
    provenance: &Provenance,
    into: &Path,
) -> io::Result<()> {
    let batch = rules_table::to_batch(model);
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(parquet::basic::ZstdLevel::default()))
        .build();
    let mut bytes = Vec::new();
    let mut writer = ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties))
        .map_err(io::Error::other)?;
    writer.write(&batch).map_err(io::Error::other)?;
    writer.close().map_err(io::Error::other)?;
    write_synced(&into.join(RULES), &bytes)?;
    let cycles = cycle.map(|cycle| cycle.to_json().into_bytes());
    if let Some(cycles) = &cycles {
        write_synced(&into.join(CYCLES), cycles)?;
    }
    let manifest = Manifest {
        format: MODEL_FORMAT,
        created: provenance.created.clone(),
        source: provenance.source.clone(),
        parameters: model.parameters.clone(),
        learned: model.learned.clone(),
        rules_checksum: checksum(&bytes),
        rules: model.rules.len(),
        cycles_checksum: cycles.as_deref().map(checksum),
        word_states: model.states.further().to_vec(),
        signals: model.plant.signals.clone(),
        devices: model.plant.devices.clone(),
        groups: model.plant.groups.clone(),
        unplaced: model.plant.unplaced.clone(),
    };
    let text = serde_json::to_vec_pretty(&manifest).map_err(io::Error::other)?;
    write_synced(&into.join(MANIFEST), &text)
}

/// Reads a model.
///
/// # Errors
/// No model there, another version, or anything that does not fit.
pub fn load(path: &Path) -> Result<(NominalModel, Option<CycleModel>, Provenance), ModelError> {
    let damaged = |problem: String| ModelError::Damaged { path: path.to_owned(), problem };
    let read = |name: &str| {
        fs::read(path.join(name)).map_err(|source| match source.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory if name == MANIFEST => {
                ModelError::Missing { path: path.to_owned() }
            }
            io::ErrorKind::NotFound => damaged(format!("{name} is missing")),
            _ => ModelError::Io { path: path.join(name), action: "read", source },
        })
    };
    let text = read(MANIFEST)?;
    let manifest = read_manifest(&text, path)?;
    drop(text);
    let mut plant = Plant {
        signals: manifest.signals,
        devices: manifest.devices,
        groups: manifest.groups,
        unplaced: manifest.unplaced,
    };
    plant.signals.shrink_to_fit();
    check_plant(&plant, &manifest.word_states, &manifest.learned)
        .map_err(|problem| damaged(problem.to_owned()))?;
    manifest
        .parameters
        .validate()
        .map_err(|_| damaged("a parameter is out of range".to_owned()))?;
    let bytes = read(RULES)?;
    if checksum(&bytes) != manifest.rules_checksum {
        return Err(damaged(
            "rules.parquet is not the one the manifest was written with".to_owned(),
        ));
    }
    let cycle = match &manifest.cycles_checksum {
        Some(expected) => {
            let bytes = read(CYCLES)?;
            if checksum(&bytes) != *expected {
                return Err(damaged(
                    "cycles.json is not the one the manifest was written with".to_owned(),
                ));
            }
            let cycle = CycleModel::from_json(&bytes)
                .map_err(|error| damaged(format!("cycles.json: {error}")))?;
            Some(cycle)
        }
        None => None,
    };
    let mut states = States::new(plant.signals.len());
    for &(signal, value) in &manifest.word_states {
        states.intern(signal, value);
    }
    let rules = ParquetRecordBatchReaderBuilder::try_new(bytes::Bytes::from(bytes))
        .and_then(|builder| {
            let columns = builder.schema().fields().iter().enumerate();
            let needed = columns.filter(|(_, field)| rules_table::is_read_back(field.name()));
            let needed = needed.map(|(index, _)| index).collect::<Vec<_>>();
            let mask = ProjectionMask::roots(builder.parquet_schema(), needed);
            builder.with_projection(mask).build()
        })
        .ok()
        .and_then(|batches| rules_table::from_batches(batches, &plant, &mut states))
        .filter(|rules| rules.len() == manifest.rules)
        .ok_or_else(|| damaged("rules.parquet does not fit the manifest".to_owned()))?;
    let model = NominalModel::assemble(plant, states, rules, manifest.learned, manifest.parameters);
    Ok((model, cycle, Provenance { created: manifest.created, source: manifest.source }))
}

/// A manifest of this layout. An older one is named as such before anything else is wrong with it.
fn read_manifest(text: &[u8], path: &Path) -> Result<Manifest, ModelError> {
    let damaged = |problem: String| ModelError::Damaged { path: path.to_owned(), problem };
    let read = serde_json::from_slice::<Manifest>(text);
    if let Ok(manifest) = read
        && manifest.format == MODEL_FORMAT
    {
        return Ok(manifest);
    }
    let layout: Layout = serde_json::from_slice(text)
        .map_err(|_| damaged("manifest.json is not JSON".to_owned()))?;
    let found = layout.format.ok_or_else(|| damaged("manifest.json names no format".to_owned()))?;
    if found != u64::from(MODEL_FORMAT) {
        return Err(ModelError::Version { path: path.to_owned(), found });
    }
    serde_json::from_slice(text).map_err(|error| damaged(format!("manifest.json: {error}")))
}

/// Every index the engine will follow must lead somewhere.
fn check_plant(
    plant: &Plant,
    word_states: &[(SignalIndex, i64)],
    learned: &Learned,
) -> Result<(), &'static str> {
    let signals = plant.signals.len();
    let signal_ok = |s: SignalIndex| (s as usize) < signals;
    if plant.signals.iter().any(|s| s.device() >= plant.devices.len()) {
        return Err("a signal names a device that is not there");
    }
    if plant.devices.iter().any(|d| {
        d.group >= plant.groups.len() || d.starting.is_some_and(|starting| !signal_ok(starting))
    }) {
        return Err("a device names a group or signal that is not there");
    }
    if word_states.iter().any(|&(signal, _)| !signal_ok(signal)) {
        return Err("a word state names a signal that is not there");
    }
    if learned.group_start.len() != plant.groups.len()
        || learned.longest_pause.len() != plant.groups.len()
    {
        return Err("the number of groups does not fit");
    }
    Ok(())
}
