//! The network's operations in WGSL, one per file, each the twin of the file of the same name in `crate/core/src/cpu`.
//! This table holds what the host must know of each: its text, bindings and `Params`. A test compares it with the WGSL.
//!
//! `NAME.VARIANT.wgsl` does what `NAME.wgsl` does, for special operands or adapters. Text that several shaders share
//! has a file of its own: `attend.edge.wgsl`, `diffuse.pull.wgsl`, and the parts of `collide` and `settle`. Rows that
//! are read as vec4 are padded with zeros to whole vec4. [n, 3] is not padded, so it can be a vertex attribute.

#![forbid(unsafe_code)]

/// How a shader uses a storage buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Reads only.
    Read,
    /// Writes, and may read.
    Write,
}

/// A field of `Params`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name, the same in WGSL.
    pub name: &'static str,
    /// Bytes before it in the buffer.
    pub offset: usize,
    /// Type in Rust: `u32`, `f32` or `[f32; 3]`.
    pub kind: &'static str,
}

/// One shader: a WGSL module with one entry point.
#[derive(Debug)]
pub struct Shader {
    /// Name of the file without `.wgsl`.
    pub name: &'static str,
    /// The texts to be joined.
    pub sources: &'static [&'static str],
    /// Fields of `Params`, the uniform buffer at binding 0.
    pub params: &'static [Field],
    /// Storage buffers, from binding 1 on.
    pub bindings: &'static [Access],
    /// Outputs of one workgroup along x and y, in the units that its dispatch counts: vertices, numbers, or vec4 and
    /// rows.
    pub tile: [u32; 2],
}

impl Shader {
    /// Name of the entry point: that of the operation.
    pub fn entry(&self) -> &'static str {
        self.name.split('.').next().unwrap_or(self.name)
    }

    /// The module's text.
    pub fn source(&self) -> String {
        self.sources.join("\n")
    }
}

macro_rules! params {
    ($($(#[$doc:meta])* $name:ident { $($field:ident: $kind:ty),* })*) => {$(
        $(#[$doc])*
        #[allow(missing_docs, reason = "the fields are explained in the WGSL")]
        #[repr(C)]
        #[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct $name {
            $(pub $field: $kind),*
        }

        impl $name {
            const FIELDS: &[Field] = &[$(Field {
                name: stringify!($field),
                offset: std::mem::offset_of!($name, $field),
                kind: stringify!($kind),
            }),*];
        }
    )*};
}

params! {
    /// `Params` of attend.wgsl.
    Attend { vertices: u32, features: u32, stride: u32, heads: u32, lanes: u32, scale: f32 }
    /// `Params` of blend.wgsl.
    Blend { numbers: u32, count: u32, stride: u32 }
    /// `Params` of body_frame.wgsl.
    BodyFrame { joints: u32, root: u32, yaw: u32 }
    /// `Params` of collide.wgsl and settle.wgsl.
    Collide {
        vertices: u32,
        seeds: u32,
        steps: u32,
        gap: f32,
        reach: f32,
        depth: f32,
        steepest: f32,
        sliver: f32,
        folded: f32,
        landmarks: u32,
        free: f32,
        elsewhere: f32,
        again: f32
    }
    /// `Params` of diffuse.wgsl.
    Diffuse { vertices: u32, own: f32, others: f32 }
    /// `Params` of features.wgsl.
    Features { mean: [f32; 3], edge_scale: f32, deviation: [f32; 3], vertices: u32 }
    /// `Params` of linear.wgsl and linear.row.wgsl.
    Linear { rows: u32, inputs: u32, outputs: u32, relu: u32 }
    /// `Params` of normals.wgsl.
    Normals { vertices: u32 }
    /// `Params` of polish.wgsl.
    Polish { vertices: u32, own: f32, others: f32, rate: f32, momentum: f32, reach: f32, gap: f32 }
    /// `Params` of pull.wgsl.
    Pull { vertices: u32, rate: f32, reach: f32, gap: f32 }
    /// `Params` of ride.wgsl.
    Ride { riders: u32, least: f32 }
    /// `Params` of skin.wgsl.
    Skin { vertices: u32, width: u32, back: u32, world: u32 }
    /// `Params` of slide.wgsl.
    Slide { vertices: u32, rate: f32 }
    /// `Params` of spread.wgsl.
    Spread { vertices: u32, follow: f32 }
    /// `Params` of surface.wgsl.
    Surface { drawn: u32 }
    /// `Params` of surround.wgsl.
    Surround { vertices: u32, width: u32, strain: f32 }
}

macro_rules! shaders {
    ($($(#[$doc:meta])* $constant:ident: $params:ident, $name:literal + [$($joined:literal),*], [$($access:ident)*], $tile:expr;)*) => {
        $(
            $(#[$doc])*
            pub static $constant: Shader = Shader {
                name: $name,
                sources: &[include_str!(concat!($name, ".wgsl")), $(include_str!(concat!($joined, ".wgsl"))),*],
                params: $params::FIELDS,
                bindings: &[$(Access::$access),*],
                tile: $tile,
            };
        )*

        /// Every shader.
        pub static ALL: &[&Shader] = &[$(&$constant),*];
    };
}

shaders! {
    /// Attention over the neighbours, gate and LayerNorm: offsets, neighbours, projected, potentials, weights ->
    /// output.
    ATTEND: Attend, "attend" + ["attend.edge", "gate"], [Read Read Read Read Read Write], [1, 1];
    /// The same without barriers, one invocation per vertex; the last buffer holds ĥ on the way.
    ATTEND_VERTEX: Attend, "attend.vertex" + ["attend.edge", "gate"], [Read Read Read Read Read Write Write], [64, 1];
    /// Σ_j w_j B_j: weights, basis, rest, share -> residual, result.
    BLEND: Blend, "blend" + [], [Read Read Read Read Write Write], [64, 1];
    /// Joints, inverse bind, standard -> transforms, pose vector.
    BODY_FRAME: BodyFrame, "body_frame" + [], [Read Read Read Write Write], [64, 1];
    /// Posed body, its normals, offsets, fans, seeds, positions -> push.
    COLLIDE: Collide, "collide" + ["collide.foot", "collide.walk", "collide.triangle"], [Read Read Read Read Read Read Write], [64, 1];
    /// V, T_C -> nodes, potentials.
    FEATURES: Features, "features" + [], [Read Read Write Write], [64, 1];
    /// x, weight, bias -> y.
    LINEAR: Linear, "linear" + [], [Read Read Read Write], [16, 32];
    /// The same for a single row.
    LINEAR_ROW: Linear, "linear.row" + [], [Read Read Read Write], [8, 1];
    /// Positions, offsets, corners -> normals.
    NORMALS: Normals, "normals" + [], [Read Read Read Write], [64, 1];
    /// Offsets, neighbours, share, facing, pulls -> moves, near, positions.
    POLISH: Polish, "polish" + ["diffuse.pull"], [Read Read Read Read Read Write Write Write], [64, 1];
    /// Offsets, neighbours, pulls -> pulls.
    DIFFUSE: Diffuse, "diffuse" + ["diffuse.pull"], [Read Read Read Write], [64, 1];
    /// Offsets, neighbours, squares, positions, what each lacks to where the body is not met -> pulls.
    PULL: Pull, "pull" + [], [Read Read Read Read Read Write], [64, 1];
    /// Corners, coordinates, positions, normals -> riders.
    RIDE: Ride, "ride" + [], [Read Read Read Read Write], [64, 1];
    /// Posed body, its normals, offsets, fans, seeds, displacement -> positions.
    SETTLE: Collide, "settle" + ["collide.foot", "collide.walk", "collide.triangle"], [Read Read Read Read Read Read Write], [64, 1];
    /// Rest, joints, weights, transforms -> positions.
    SKIN: Skin, "skin" + [], [Read Read Read Read Write], [64, 1];
    /// Offsets, neighbours, squares, share, positions, push, before -> after.
    SLIDE: Slide, "slide" + [], [Read Read Read Read Read Read Read Write], [64, 1];
    /// Offsets, neighbours, push, before -> after.
    SPREAD: Spread, "spread" + [], [Read Read Read Read Write], [64, 1];
    /// Vertex, positions, normals -> drawn positions, drawn normals.
    SURFACE: Surface, "surface" + [], [Read Read Read Write Write], [64, 1];
    /// Potentials, places, joints, weights, transforms, around -> nodes.
    SURROUND: Surround, "surround" + [], [Read Read Read Read Read Read Write], [64, 1];
}

/// The override constant of attend.wgsl: number of features it holds in workgroup memory.
pub const ROOM: &str = "room";
/// Largest value of [`ROOM`].
pub const MAX_FEATURES: usize = 2048;
/// Invocations of a workgroup of attend.wgsl.
pub const LANES: usize = 64;

#[cfg(test)]
mod tests;
