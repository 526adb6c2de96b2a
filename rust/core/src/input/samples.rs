//! The samples of a run: drivelines, angles and loads, each broadcast over them.

use crate::input::drivelines::Drivelines;
use crate::input::sweep::Sweep;

/// A flat array broadcast over the samples: sample `(i_0, i_1, …)` holds element `Σ i_k stride_k`.
#[derive(Clone, Debug)]
pub struct Source<'a> {
    /// The elements.
    pub data: &'a [f64],
    /// One stride in elements per axis of the samples.
    pub strides: &'a [usize],
}

/// The drive angles of the samples.
#[derive(Clone, Debug)]
pub enum Angles<'a> {
    /// In rad.
    Array(Source<'a>),
    /// A uniform sweep along the last axis.
    Sweep(Sweep),
}

/// The load on a driveline; torque in N·m, speed in rad/s, acceleration in rad/s², inertias in
/// kg·m² with the shaft they belong to.
#[derive(Clone, Debug)]
pub struct Load<'a> {
    /// The torque at the end that the plan names.
    pub torque: Source<'a>,
    /// Speed of the drive.
    pub speed: Source<'a>,
    /// Acceleration of the drive.
    pub acceleration: Source<'a>,
    /// Inertia of each shaft that the plan counts.
    pub inertias: Vec<(usize, Source<'a>)>,
}

/// Everything that one run reads: the shape of the samples and what each sample sees.
#[derive(Clone, Debug)]
pub struct Samples<'a> {
    /// Shape of the samples.
    pub shape: &'a [usize],
    /// The drivelines.
    pub lines: Drivelines<'a>,
    /// Strides of the samples over the drivelines.
    pub line_strides: &'a [usize],
    /// The drive angles.
    pub angle: Angles<'a>,
    /// The load, if the plan carries one.
    pub load: Option<Load<'a>>,
}
