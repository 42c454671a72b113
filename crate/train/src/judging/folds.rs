//! Whether a prediction keeps the folds of the truth. Distances do not tell: the mean of two folded cloths is smooth,
//! and nearer to either than they are to one another. A ratio of 1 is as folded as the truth; above 1 is noise, no
//! quality.
//! docs/network.md §7.

use super::judge::vertex_normals;
use crate::Result;
use crate::dataset::Setup;
use crate::smoother::Smoother;
use ctsn_cloth::simulate::{Elastic, Hinge};
use ctsn_core::topology::Graph;
use ctsn_rig::mesh::Edges;
use ctsn_rig::{numbers, vertices};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Steps of smoothing that part the bands: what ten take away is finer than four to six edges, what forty leave is
/// coarser than about ten.
const BANDS: [usize; 2] = [10, 40];

/// How the folds of predictions compare with those of the truth, over frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FoldErrors {
    /// Mean angle between neighbouring triangles, less that of the garment as it was cut; over the truth's.
    pub bending: f64,
    /// Root mean square over the inner vertices of the way along the normal to the mean of the neighbours, in mean edge
    /// lengths; over the truth's.
    pub curvature: f64,
    /// Root mean square along the normal of what ten steps of smoothing take away; over the truth's.
    pub fine: f64,
    /// Correlation of that with the truth's: whether the folds are where they should be.
    pub correlation: f64,
    /// E_dist of what 40 steps of smoothing leave, of what 10 leave beyond it, and of what 10 take away, metres.
    pub bands: [f64; 3],
    /// Mean over the edges of `|l - l_cut| / l_cut`: lengths beside those of the garment as it was cut.
    pub strain: f64,
    /// Mean over the area of `| ‖F_u‖ - 1 |` along warp and weft.
    pub stretch: f64,
    /// Mean over the area of `|F_u · F_v|` of the two.
    pub shear: f64,
    /// Elastic energy and what the cloth hangs higher than the truth, over the truth's elastic energy.
    pub energy: f64,
}

/// Figures of one state of a cloth.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// Radians.
    bending: f64,
    curvature: f64,
    /// Metres.
    fine: f64,
    strain: f64,
    stretch: f64,
    shear: f64,
    /// Joules.
    elastic: f64,
    weight: f64,
}

/// One frame: the prediction, the truth, and how they go together.
#[derive(Clone, Copy, Debug)]
pub struct FrameFolds {
    predicted: State,
    truth: State,
    correlation: f64,
    bands: [f64; 3],
}

/// How much a cloth bends.
pub(crate) struct Bending {
    hinges: Vec<Hinge>,
    /// Angle of each hinge in the garment as it was cut, radians.
    cut: Vec<f64>,
}

impl Bending {
    /// Of the cloth with these hinges, cut to the positions `cut` [n].
    pub fn new(elastic: &Elastic, cut: &[DVec3]) -> Self {
        let cut = elastic.hinges.iter().map(|hinge| hinge.angle(cut)).collect();
        Self { hinges: elastic.hinges.clone(), cut }
    }

    /// Mean angle between neighbouring triangles at the positions `x` [n], less that of the garment as it was cut,
    /// radians.
    pub fn of(&self, x: &[DVec3]) -> f64 {
        let bend = |(hinge, cut): (&Hinge, &f64)| {
            let turned = (hinge.angle(x) - cut).abs();
            turned.min(std::f64::consts::TAU - turned)
        };
        self.hinges.iter().zip(&self.cut).map(bend).sum::<f64>() / self.cut.len().max(1) as f64
    }
}

/// What folds are measured with.
pub(super) struct FoldJudge {
    elastic: Elastic,
    bending: Bending,
    /// Each edge with its length in the garment as it was cut, metres.
    edges: Vec<([usize; 2], f64)>,
    mean_edge: f64,
    rings: Graph<Vec<u32>>,
    is_inner: Vec<bool>,
    smoother: Smoother,
    triangles: Vec<u32>,
}

/// A state with its bands, coarse to fine [3][n], and the finest along the normal [n].
struct Measured {
    state: State,
    bands: [Vec<DVec3>; 3],
    along: Vec<f64>,
}

impl FoldJudge {
    /// Of the cloth of `setup`.
    pub fn new(setup: &Setup) -> Result<Self> {
        let cut = vertices(&setup.garment);
        let elastic = setup.elastic()?;
        let found = Edges::new(setup.triangles.as_chunks().0);
        let ends = found.iter().map(|(edge, _)| edge.map(|i| i as usize));
        let edges: Vec<_> = ends.map(|[i, j]| ([i, j], cut[i].distance(cut[j]))).collect();
        let mut is_inner = vec![true; cut.len()];
        found.boundary().for_each(|(edge, _)| edge.iter().for_each(|i| is_inner[*i as usize] = false));
        Ok(Self {
            bending: Bending::new(&elastic, &cut),
            elastic,
            mean_edge: edges.iter().map(|(_, length)| length).sum::<f64>() / edges.len().max(1) as f64,
            edges,
            rings: Graph::new(cut.len(), &setup.triangles),
            is_inner,
            smoother: Smoother::new(cut.len(), &setup.triangles),
            triangles: setup.triangles.clone(),
        })
    }

    /// Predicted and true positions [n] of one pose.
    pub fn frame(&self, predicted: &[DVec3], truth: &[DVec3]) -> FrameFolds {
        let [predicted, truth] = [predicted, truth].map(|x| self.measure(x));
        let product = |a: &Measured, b: &Measured| a.along.iter().zip(&b.along).map(|(a, b)| a * b).sum::<f64>();
        let powers = (product(&predicted, &predicted) * product(&truth, &truth)).sqrt();
        let distance = |band: usize| {
            let pairs = predicted.bands[band].iter().zip(&truth.bands[band]);
            pairs.map(|(a, b)| a.distance(*b)).sum::<f64>() / truth.bands[band].len().max(1) as f64
        };
        FrameFolds {
            correlation: if powers > 0.0 { product(&predicted, &truth) / powers } else { 0.0 },
            bands: std::array::from_fn(distance),
            predicted: predicted.state,
            truth: truth.state,
        }
    }

    fn measure(&self, x: &[DVec3]) -> Measured {
        let positions = numbers(x);
        let [ten, forty] = BANDS.map(|steps| vertices(&self.smoother.smooth(&positions, steps)));
        let less = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| *a - *b).collect::<Vec<_>>();
        let bands = [forty.clone(), less(&ten, &forty), less(x, &ten)];
        let normals = vertex_normals(x, &self.triangles);
        let inner = || self.is_inner.iter().enumerate().filter(|(_, inner)| **inner).map(|(i, _)| i);
        let along: Vec<f64> = inner().map(|i| bands[2][i].dot(normals[i])).collect();
        let bulge = |i: usize| {
            let ring = self.rings.of(i);
            let mean = ring.iter().map(|j| x[*j as usize]).sum::<DVec3>() / ring.len().max(1) as f64;
            (mean - x[i]).dot(normals[i]) / self.mean_edge
        };
        let curvature = root_mean_square(inner().map(bulge));
        let fine = root_mean_square(along.iter().copied());
        Measured { state: State { curvature, fine, ..self.elasticity(x) }, bands, along }
    }

    /// Bending, strain and energy.
    fn elasticity(&self, x: &[DVec3]) -> State {
        let strain = |([i, j], length): &([usize; 2], f64)| (x[*i].distance(x[*j]) / length - 1.0).abs();
        let (mut stretch, mut shear, mut area) = (0.0, 0.0, 0.0);
        for triangle in &self.elastic.triangles {
            let [u, v] = triangle.deformation(x);
            stretch += triangle.area * 0.5 * ((u.length() - 1.0).abs() + (v.length() - 1.0).abs());
            shear += triangle.area * u.dot(v).abs();
            area += triangle.area;
        }
        let mut gradient = vec![DVec3::ZERO; x.len()];
        State {
            bending: self.bending.of(x),
            strain: self.edges.iter().map(strain).sum::<f64>() / self.edges.len().max(1) as f64,
            stretch: stretch / area,
            shear: shear / area,
            elastic: self.elastic.stretch(x, &mut gradient) + self.elastic.bend(x, &mut gradient),
            weight: self.elastic.weigh(x, &mut gradient),
            ..State::default()
        }
    }
}

impl FoldErrors {
    /// Over `frames`; ratios are of the means over them.
    pub(super) fn over(frames: &[FrameFolds]) -> Self {
        let count = frames.len().max(1) as f64;
        let mean = |part: &dyn Fn(&FrameFolds) -> f64| frames.iter().map(part).sum::<f64>() / count;
        let ratio = |part: fn(&State) -> f64| {
            let truth = mean(&|frame| part(&frame.truth));
            if truth > 0.0 { mean(&|frame| part(&frame.predicted)) / truth } else { 0.0 }
        };
        let elastic = mean(&|frame| frame.truth.elastic);
        let rise = mean(&|frame| frame.predicted.elastic + frame.predicted.weight - frame.truth.weight);
        Self {
            bending: ratio(|state| state.bending),
            curvature: ratio(|state| state.curvature),
            fine: ratio(|state| state.fine),
            correlation: mean(&|frame| frame.correlation),
            bands: std::array::from_fn(|band| mean(&|frame| frame.bands[band])),
            strain: mean(&|frame| frame.predicted.strain),
            stretch: mean(&|frame| frame.predicted.stretch),
            shear: mean(&|frame| frame.predicted.shear),
            energy: if elastic > 0.0 { rise / elastic } else { 0.0 },
        }
    }
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value * value, count + 1));
    (sum / f64::from(count.max(1))).sqrt()
}
