//! What a study compares: the network in its sizes and with parts left out, plain skinning, and the forms of two older
//! methods.

use crate::dataset::Setup;
use crate::training::{Architecture, Part, Variant, initial};
use crate::{Result, dataset::Sample};
use ctsn_core::Streams;
use ctsn_core::model::HostModel;

/// Widths of PBNS's pose MLP (Bertiche et al. 2021): four layers of 32, so 32 basis matrices.
const PBNS: [usize; 4] = [32; 4];

/// One way to predict.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Plain skinning with the weights of the nearest body vertex.
    Nearest,
    /// Plain skinning with the weights that training starts from: `W_C^I`, smoothed.
    Skinning,
    /// The network, or what an ablation leaves of it.
    Network(Architecture, Variant),
    /// PBNS's network: an MLP of the pose weighs basis matrices, their sum is added to the garment at rest, and LBS
    /// with smoothed `W_C^I` follows. PBNS itself trains without data; here it learns from the same data as the others.
    /// Its MLP ends without ReLU, as ours does.
    Pbns,
    /// [`super::deepsd`].
    Deepsd,
}

/// One row of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Name of its files.
    pub name: String,
    /// What tables call it.
    pub title: String,
    /// What it is.
    pub method: Method,
}

/// A table of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Table {
    /// Plain skinning, PBNS-form, DeePSD-form and the network
    Comparison,
    /// The network without some of its parts, (b) to (e) of the paper
    Ablation,
    /// m and k of the paper, with bytes
    Sizes,
    /// Error against operations over L, F, m, k
    Front,
}

impl Table {
    /// All of them, in the paper's order.
    pub const ALL: [Self; 4] = [Self::Comparison, Self::Ablation, Self::Sizes, Self::Front];

    /// Its rows.
    pub fn entries(self) -> Vec<Entry> {
        let entry = |name: &str, title: &str, method| Entry { name: name.to_owned(), title: title.to_owned(), method };
        let whole = Architecture::default();
        let without = |parts: &[Part]| Method::Network(whole, Variant::without(parts));
        match self {
            Self::Comparison => vec![
                entry("skinning-nearest", "plain skinning, nearest vertex", Method::Nearest),
                entry("skinning", "plain skinning, smoothed W_C^I", Method::Skinning),
                entry("pbns", "PBNS-form, supervised", Method::Pbns),
                entry("deepsd", "DeePSD-form", Method::Deepsd),
                sized(whole, "network"),
            ],
            Self::Ablation => vec![
                entry("skinning", "(b) smoothed W_C^I alone", Method::Skinning),
                entry("no-mesh", "(c) skeleton stream, trained weights", without(&[Part::Mesh])),
                sized(whole, "(d) whole network"),
                entry("no-weights", "(e) both streams, smoothed W_C^I", without(&[Part::Weights])),
                entry("no-skeleton", "mesh stream, trained weights", without(&[Part::Skeleton])),
            ],
            Self::Sizes => [(5, 64), (32, 128), (100, 256)]
                .map(|(embedding, basis)| {
                    sized(Architecture { embedding, basis, ..whole }, &format!("m = {embedding}, k = {basis}"))
                })
                .into(),
            Self::Front => front(whole),
        }
    }
}

/// The sizes that are tried: layers and features at the default m and k, then m and k at the default layers and
/// features.
fn front(whole: Architecture) -> Vec<Entry> {
    let depths = [(1, 32), (1, 64), (2, 32), (2, 64), (2, 128), (3, 64)];
    let depths = depths.map(|(layers, features)| Architecture { layers, features, ..whole });
    let bases = [(5, 64), (16, 32), (32, 32), (32, 64), (32, 128), (100, 256)];
    let bases = bases.map(|(embedding, basis)| Architecture { embedding, basis, ..whole });
    depths.into_iter().chain(bases).map(|architecture| sized(architecture, "")).collect()
}

/// The whole network in one size, which is also its title where `title` is empty.
fn sized(architecture: Architecture, title: &str) -> Entry {
    let Architecture { embedding, basis, layers, features, .. } = architecture;
    let name = format!("L{layers}-F{features}-m{embedding}-k{basis}");
    let title =
        if title.is_empty() { format!("L {layers}, F {features}, m {embedding}, k {basis}") } else { title.to_owned() };
    Entry { name, title, method: Method::Network(architecture, Variant::FULL) }
}

impl Method {
    /// The streams that run in a prediction.
    pub fn streams(self) -> Streams {
        match self {
            Self::Nearest => Streams::None,
            Self::Network(_, variant) if variant.mesh => Streams::Both,
            _ => Streams::Skeleton,
        }
    }

    /// The parts of the network that learn.
    pub fn variant(self) -> Variant {
        match self {
            Self::Network(_, variant) => variant,
            Self::Nearest | Self::Skinning => Variant { skeleton: false, mesh: false, weights: false },
            Self::Pbns => Variant { skeleton: true, mesh: false, weights: false },
            Self::Deepsd => Variant { skeleton: true, mesh: false, weights: true },
        }
    }

    /// The model before training.
    pub fn initial(self, setup: &Setup, train: &[&Sample], seed: u64) -> Result<HostModel> {
        let architecture = match self {
            Self::Network(architecture, _) => architecture,
            Self::Pbns => Architecture { embedding: PBNS[3], ..Architecture::default() },
            _ => Architecture::default(),
        };
        let variant = self.variant();
        let mut model = initial(setup, train, variant.sizes(architecture), seed)?;
        if self == Self::Pbns {
            let inputs = 12 * model.sizes.joints;
            let mut rng = fastrand::Rng::with_seed(seed);
            model.embedding = crate::training::mlp(&[&[inputs], &PBNS[..]].concat(), &mut rng);
        }
        variant.silence(&mut model);
        Ok(model)
    }
}

/// Every entry of `tables`, each once: several tables show the same training.
pub fn entries(tables: &[Table]) -> Vec<Entry> {
    let mut all: Vec<Entry> = Vec::new();
    for entry in tables.iter().flat_map(|table| table.entries()) {
        if !all.iter().any(|known| known.name == entry.name) {
            all.push(entry);
        }
    }
    // Those without training first: a study that cannot work says so early.
    all.sort_by_key(|entry| !matches!(entry.method, Method::Nearest | Method::Skinning));
    all
}
