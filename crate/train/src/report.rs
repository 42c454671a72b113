//! The quality of a dataset in numbers: `report.json`, and a summary to read. Everything is taken from the files of the
//! folder, so that merged shards report like a single run.

use crate::Result;
use crate::dataset::{Dataset, Record, Sample};
use crate::ground_truth::Log;
use crate::ground_truth::noise::{Difference, NoiseFloor, noise_floor};
use crate::judging::body_distance;
use ctsn_cloth::simulate::{Fabric, Settings};
use ctsn_rig::file::write;
use ctsn_rig::statistics::Sorted;
use ctsn_rig::{pose, vertices};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// How a figure spreads over the poses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Half of the poses lie below.
    pub median: f64,
    /// 95 % of the poses lie below.
    pub p95: f64,
    /// The greatest.
    pub max: f64,
}

/// A pose left out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOut {
    /// Clip name.
    pub clip: String,
    /// Frame within the clip.
    pub frame: usize,
    /// Why.
    pub reason: String,
}

/// Vertices inside the body in the kept poses, mixed ones too, measured anew from their files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Penetration {
    /// Vertices inside the body, all poses together.
    pub vertices: usize,
    /// Poses with such a vertex.
    pub poses: usize,
    /// Greatest depth, mm.
    pub depth: f64,
}

/// The report of a dataset.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Character file name.
    pub character: String,
    /// Garment file name.
    pub garment: String,
    /// What the cloth is made of.
    pub material: Fabric,
    /// The simulator's settings.
    pub settings: Settings,
    /// Cloth vertices.
    pub vertices: usize,
    /// Cloth triangles.
    pub triangles: usize,
    /// Joints.
    pub joints: usize,
    /// Clips.
    pub clips: usize,
    /// Poses per second.
    pub rate: f64,
    /// Frames of all clips.
    pub frames: usize,
    /// Frames kept.
    pub kept: usize,
    /// Frames not simulated yet.
    pub missing: usize,
    /// Mixed poses kept; the figures below are of these and the frames together.
    pub mixed: usize,
    /// Mixed poses left out, by reason.
    pub mixed_reasons: BTreeMap<String, usize>,
    /// Poses kept whose cloth was simulated coarsely.
    pub coarse: usize,
    /// Such poses left out, by reason.
    pub coarse_reasons: BTreeMap<String, usize>,
    /// Frames left out, by reason.
    pub reasons: BTreeMap<String, usize>,
    /// Every frame left out.
    pub left_out: Vec<LeftOut>,
    /// Seconds of processor time per pose, over all that were simulated, twins, mixed and coarse poses too.
    pub seconds: Spread,
    /// Poses by what computed them, as far as it was noted: the same pose is the same byte for byte on machines of one
    /// level only.
    pub levels: BTreeMap<String, usize>,
    /// RMS residual force of the kept poses, in mean vertex weights.
    pub residual: Spread,
    /// RMS move of the kept poses' vertices over their last iterations, mm.
    pub drift: Spread,
    /// 99th percentile of the principal stretch, of the kept poses.
    pub stretch_p99: Spread,
    /// Greatest principal stretch of the kept poses.
    pub stretch: Spread,
    /// Least signed distance to the body in a kept pose, as the simulator saw it, mm.
    pub least_distance: f64,
    /// Cloth inside the body in kept poses.
    pub penetration: Penetration,
    /// Vertices that the body pinched and the simulator moved out, in all kept poses; number of such poses.
    pub lifted: [usize; 2],
    /// Pairs of triangles that cross each other in kept poses.
    pub crossings: usize,
    /// How far the truth moves when the pose hardly does; null when it was not measured.
    pub noise_floor: Option<NoiseFloor>,
}

impl Report {
    /// The report of dataset `folder`.
    pub fn new(folder: &Path) -> Result<Self> {
        let dataset = Dataset::read(folder)?;
        let setup = &dataset.setup;
        let description = setup.description.clone();
        let log = Log::read(folder)?;
        let (kept, rejected) = (dataset.samples.len(), dataset.rejected.len());
        let frames = description.frames.iter().sum::<usize>().max(kept + rejected);
        let records = || dataset.all().map(|sample| &sample.record);
        let over = |figure: fn(&Record) -> f64| Spread::of(records().map(figure));
        let left_out = |record: &Record| LeftOut {
            clip: description.clips[record.clip].clone(),
            frame: record.frame,
            reason: record.rejected.clone().unwrap_or_default(),
        };
        let least = records().map(|record| record.distance).fold(f64::INFINITY, f64::min);
        Ok(Self {
            vertices: setup.template.len() / 3,
            triangles: setup.triangles.len() / 3,
            joints: description.joints.len(),
            clips: description.clips.len(),
            rate: description.rate,
            frames,
            kept,
            missing: frames - kept - rejected,
            mixed: dataset.mixed.len(),
            mixed_reasons: reasons(&dataset.mixed_rejected),
            coarse: dataset.coarse.len(),
            coarse_reasons: reasons(&dataset.coarse_rejected),
            reasons: reasons(&dataset.rejected),
            left_out: dataset.rejected.iter().map(left_out).collect(),
            seconds: Spread::of(log.seconds),
            levels: log.levels,
            residual: over(|record| record.residual),
            drift: over(|record| 1e3 * record.drift),
            stretch_p99: over(|record| record.stretch_p99),
            stretch: over(|record| record.stretch),
            least_distance: if least.is_finite() { 1e3 * least } else { 0.0 },
            penetration: penetration(&dataset)?,
            lifted: [records().map(|record| record.lifted).sum(), records().filter(|record| record.lifted > 0).count()],
            crossings: records().map(|record| record.crossings).sum(),
            noise_floor: noise_floor(&dataset, folder)?,
            character: description.character,
            garment: description.garment,
            material: description.material,
            settings: description.settings,
        })
    }

    /// Writes `report.json` into dataset `folder`.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(self).map_err(|error| crate::Error::Dataset(error.to_string()))?;
        write(&folder.join("report.json"), text.as_bytes())
    }
}

/// Poses left out, by reason.
fn reasons(rejected: &[Record]) -> BTreeMap<String, usize> {
    let mut reasons = BTreeMap::new();
    for reason in rejected.iter().filter_map(|record| record.rejected.as_deref()) {
        *reasons.entry(kind(reason)).or_default() += 1;
    }
    reasons
}

/// A reason without what was found in this one pose, so that poses left out for the same reason are counted together.
fn kind(reason: &str) -> String {
    reason.split(", found").next().unwrap_or(reason).to_owned()
}

fn penetration(dataset: &Dataset) -> Result<Penetration> {
    let body = body_distance(&dataset.setup)?;
    let audit = |sample: &Sample| {
        let signed = body.signed(&pose(&sample.joints), &vertices(&sample.truth));
        let inside = signed.iter().filter(|distance| **distance < 0.0);
        let depth = inside.clone().fold(0.0, |depth: f64, distance| depth.max(-1e3 * distance));
        let vertices = inside.count();
        Penetration { vertices, poses: usize::from(vertices > 0), depth }
    };
    let add = |a: Penetration, b: Penetration| Penetration {
        vertices: a.vertices + b.vertices,
        poses: a.poses + b.poses,
        depth: a.depth.max(b.depth),
    };
    Ok(dataset.all().collect::<Vec<_>>().into_par_iter().map(audit).reduce(Penetration::default, add))
}

impl Spread {
    fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let values = Sorted::new(values);
        Self { median: values.median(), p95: values.percentile(95), max: values.greatest() }
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { character, garment, vertices, triangles, joints, clips, rate, frames, kept, missing, .. } = self;
        writeln!(f, "{garment} on {character}")?;
        writeln!(f, "  material     {}", self.material)?;
        writeln!(f, "  cloth        {vertices} vertices, {triangles} triangles; {joints} joints")?;
        writeln!(f, "  frames       {frames} of {clips} clips at {rate} a second")?;
        writeln!(f, "               {kept} kept, {} left out, {missing} not simulated yet", self.left_out.len())?;
        for (reason, count) in &self.reasons {
            writeln!(f, "               {count} left out: {reason}")?;
        }
        let others =
            [("mixed poses", self.mixed, &self.mixed_reasons), ("coarse poses", self.coarse, &self.coarse_reasons)];
        for (name, kept, reasons) in others {
            let left_out: usize = reasons.values().sum();
            if kept + left_out > 0 {
                writeln!(f, "  {name:<13}{kept} kept, {left_out} left out")?;
            }
            for (reason, count) in reasons {
                writeln!(f, "               {count} left out: {reason}")?;
            }
        }
        for (level, count) in &self.levels {
            writeln!(f, "  computed by  {level}: {count} poses")?;
        }
        writeln!(f, "{:<15}{:>10}{:>10}{:>10}", "", "median", "95 %", "greatest")?;
        let rows = [
            ("seconds", self.seconds, 2),
            ("residual", self.residual, 5),
            ("drift, mm", self.drift, 4),
            ("stretch p99", self.stretch_p99, 3),
            ("stretch", self.stretch, 3),
        ];
        let known = rows.into_iter().filter(|row| row.1.max > 0.0);
        for (name, Spread { median, p95, max }, digits) in known {
            writeln!(f, "  {name:<13}{median:>10.digits$}{p95:>10.digits$}{max:>10.digits$}")?;
        }
        let Penetration { vertices, poses, depth } = self.penetration;
        writeln!(f, "  body         nearest vertex {:.2} mm in the simulation;", self.least_distance)?;
        writeln!(f, "               {vertices} vertices inside in {poses} poses, at most {depth:.2} mm deep")?;
        let [lifted, of] = self.lifted;
        writeln!(f, "               {lifted} vertices pinched by it, moved out, in {of} poses")?;
        writeln!(f, "  cloth        {} pairs of triangles cross each other", self.crossings)?;
        match &self.noise_floor {
            Some(floor) => write!(f, "{floor}"),
            None => write!(f, "  noise floor  not measured"),
        }
    }
}

impl std::fmt::Display for NoiseFloor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { degrees, pairs, left_out, .. } = self;
        writeln!(
            f,
            "  noise floor  {pairs} poses with every joint turned by {degrees}°, {left_out} left out; mean, 95 %, greatest"
        )?;
        if *pairs == 0 {
            return write!(f, "               no pair was kept: nothing to compare");
        }
        let row = |name: &str, of: &Difference| {
            let list = |values: [f64; 3]| values.map(|value| format!("{value:.2}")).join(", ");
            format!("  {name:<13}{} mm; normals {}°", list(of.distance), list(of.normal))
        };
        writeln!(f, "{}", row("truth", &self.truth))?;
        write!(f, "{}", row("skinning", &self.skinning))
    }
}
