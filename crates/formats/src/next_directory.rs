//! A trained network on disk: a directory with `next.json` and `network.safetensors`.
//!
//! Written beside its place and renamed when complete. What is damaged, of another version or
//! trained for another net is refused.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use runglight_engine::process::decay::Decay;
use runglight_engine::process::network::{Layer, Network};
use runglight_engine::process::next_activity::{NextActivity, Predictor, Scaling};
use runglight_engine::process::petri::PetriNet;

use crate::staged::{self, checksum, write_synced};

/// Version of the directory's layout.
pub const NEXT_FORMAT: u64 = 1;

const DESCRIPTION: &str = "next.json";
const NETWORK: &str = "network.safetensors";
const OWN: [&str; 2] = [DESCRIPTION, NETWORK];

/// Why a network cannot be read or written.
#[derive(Debug, Error)]
pub enum NextError {
    /// There is none.
    #[error("{}: there is no trained network here (no next.json); train one with 'runglight predict train LOG --net NET -o {}'", path.display(), path.display())]
    Missing {
        /// The path given.
        path: PathBuf,
    },
    /// The layout is of another version.
    #[error("{}: the network has format {found}, this version reads format {NEXT_FORMAT}; train it anew", path.display())]
    Version {
        /// The path given.
        path: PathBuf,
        /// Version found.
        found: u64,
    },
    /// Something in it does not fit.
    #[error("{}: the network is damaged ({problem}); restore it from a copy or train it anew", path.display())]
    Damaged {
        /// The path given.
        path: PathBuf,
        /// What does not fit.
        problem: String,
    },
    /// It was trained with another net.
    #[error("{}: the network was trained for another net than {}; give the net it was trained with, or train it anew", path.display(), net.display())]
    AnotherNet {
        /// The path given.
        path: PathBuf,
        /// Name of the net given.
        net: PathBuf,
    },
    /// The place is taken by something else.
    #[error("{}: already exists and is no trained network; choose another name or remove it", path.display())]
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

/// What is told of a network besides what it takes to ask it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Training {
    /// When, ISO 8601.
    pub created: String,
    /// From which log.
    pub source: Vec<String>,
    /// Settings of the training, as the trainer names them.
    pub settings: Value,
    /// How changes become activities and traces, as the miner names it.
    pub events: Value,
}

#[derive(Serialize, Deserialize)]
struct Description {
    format: u64,
    #[serde(flatten)]
    training: Training,
    net_fingerprint: String,
    network_checksum: String,
    activities: Vec<String>,
    decay: Decay,
    scaling: Scaling,
}

/// Tells nets apart by what the token game sees of them: labels, arcs and markings. Names of
/// places and of the net itself do not count.
pub fn fingerprint(net: &PetriNet) -> String {
    let mut text = format!("{:?}|{:?}|{}", net.initial, net.last, net.places.len());
    for transition in &net.transitions {
        text += &format!("|{:?}", (&transition.label, &transition.inputs, &transition.outputs));
    }
    checksum(text.as_bytes())
}

/// Writes a trained network, replacing an older one of that name.
///
/// # Errors
/// The place is taken by something else, or the file system refuses.
pub fn save(
    next: &NextActivity,
    net: &PetriNet,
    training: &Training,
    path: &Path,
) -> Result<(), NextError> {
    if path.exists() && !path.join(DESCRIPTION).is_file() && !staged::is_empty_directory(path) {
        return Err(NextError::Taken { path: path.to_owned() });
    }
    let write = |staging: &Path| {
        let network = tensors(next.network())?;
        let description = Description {
            format: NEXT_FORMAT,
            training: training.clone(),
            net_fingerprint: fingerprint(net),
            network_checksum: checksum(&network),
            activities: next.activities().to_vec(),
            decay: next.decay().clone(),
            scaling: next.scaling().clone(),
        };
        write_synced(&staging.join(NETWORK), &network)?;
        let text = serde_json::to_vec_pretty(&description).map_err(io::Error::other)?;
        write_synced(&staging.join(DESCRIPTION), &text)
    };
    staged::replace(path, &OWN, write).map_err(|source| NextError::Io {
        path: path.to_owned(),
        action: "write the network",
        source,
    })
}

fn tensors(network: &Network) -> io::Result<Vec<u8>> {
    let mut parts: BTreeMap<String, (Vec<usize>, Vec<u8>)> = BTreeMap::new();
    let bytes = |values: &[f32]| values.iter().flat_map(|value| value.to_le_bytes()).collect();
    for (index, layer) in network.layers().iter().enumerate() {
        let shape = vec![layer.inputs, layer.outputs];
        parts.insert(format!("layer{index}.weights"), (shape, bytes(&layer.weights)));
        parts.insert(format!("layer{index}.bias"), (vec![layer.outputs], bytes(&layer.bias)));
    }
    let views = parts.iter().map(|(name, (shape, bytes))| {
        TensorView::new(Dtype::F32, shape.clone(), bytes).map(|view| (name, view))
    });
    let views: Vec<_> = views.collect::<Result<_, _>>().map_err(io::Error::other)?;
    safetensors::serialize(views, None).map_err(io::Error::other)
}

/// Reads a trained network, and what is told of its training. `net` is the net it is asked with,
/// and where that is from.
///
/// # Errors
/// No network there, another version, another net, or anything that does not fit.
pub fn load(path: &Path, net: (&PetriNet, &Path)) -> Result<(NextActivity, Training), NextError> {
    let damaged = |problem: String| NextError::Damaged { path: path.to_owned(), problem };
    let text = read(path, DESCRIPTION)?;
    let value: Value =
        serde_json::from_slice(&text).map_err(|_| damaged("next.json is not JSON".to_owned()))?;
    let found = value.get("format").and_then(Value::as_u64);
    let found = found.ok_or_else(|| damaged("next.json names no format".to_owned()))?;
    if found != NEXT_FORMAT {
        return Err(NextError::Version { path: path.to_owned(), found });
    }
    let description: Description =
        serde_json::from_value(value).map_err(|error| damaged(format!("next.json: {error}")))?;
    let bytes = read(path, NETWORK)?;
    if checksum(&bytes) != description.network_checksum {
        return Err(damaged(format!("{NETWORK} is not the file that next.json describes")));
    }
    if fingerprint(net.0) != description.net_fingerprint {
        return Err(NextError::AnotherNet { path: path.to_owned(), net: net.1.to_owned() });
    }
    let network = network(&bytes).ok_or_else(|| damaged(format!("{NETWORK} is no network")))?;
    let places = net.0.places.len();
    let Description { activities, decay, scaling, training, .. } = description;
    NextActivity::new(activities, decay, scaling, network)
        .filter(|next| next.decay().rate_per_s.len() == places)
        .map(|next| (next, training))
        .ok_or_else(|| damaged("its parts are not of one size".to_owned()))
}

fn read(path: &Path, name: &str) -> Result<Vec<u8>, NextError> {
    fs::read(path.join(name)).map_err(|source| match source.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory if name == DESCRIPTION => {
            NextError::Missing { path: path.to_owned() }
        }
        io::ErrorKind::NotFound => {
            NextError::Damaged { path: path.to_owned(), problem: format!("{name} is missing") }
        }
        _ => NextError::Io { path: path.join(name), action: "read", source },
    })
}

fn network(bytes: &[u8]) -> Option<Network> {
    let tensors = SafeTensors::deserialize(bytes).ok()?;
    let values = |name: String| {
        let tensor = tensors.tensor(&name).ok()?;
        let numbers = tensor
            .data()
            .chunks_exact(4)
            .map(|four| <[u8; 4]>::try_from(four).map(f32::from_le_bytes).unwrap_or(f32::NAN));
        let numbers: Vec<f32> = numbers.collect();
        let sound = tensor.dtype() == Dtype::F32 && numbers.iter().all(|value| value.is_finite());
        sound.then(|| (tensor.shape().to_vec(), numbers))
    };
    let mut layers = Vec::new();
    while let Some((shape, weights)) = values(format!("layer{}.weights", layers.len())) {
        let &[inputs, outputs] = shape.as_slice() else { return None };
        let (_, bias) = values(format!("layer{}.bias", layers.len()))?;
        layers.push(Layer::new(inputs, outputs, weights, bias)?);
    }
    Network::new(layers)
}
