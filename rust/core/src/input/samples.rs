//! The samples of a run: drivelines, angles and loads, each broadcast to the shape of the samples.

use crate::input::drivelines::Drivelines;
use crate::input::sweep::Sweep;

/// A flat array broadcast to the samples: sample `(i_0, i_1, …)` holds element `Σ i_k stride_k`.
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
    /// The same as sums of a double and an error term. The error terms lie as the doubles do.
    Sums(Source<'a>, &'a [f64]),
    /// A uniform sweep along the last axis.
    Sweep(Sweep),
}

/// The load on a driveline: torque in N·m, speed in rad/s, acceleration in rad/s², and inertias in
/// kg·m², each with the number of its shaft.
#[derive(Clone, Debug)]
pub struct Load<'a> {
    /// The torque at the end given in the plan's request.
    pub torque: Source<'a>,
    /// The speed of shaft 0.
    pub speed: Source<'a>,
    /// The acceleration of shaft 0.
    pub acceleration: Source<'a>,
    /// The inertia of each shaft in the request's `inertias`.
    pub inertias: Vec<(usize, Source<'a>)>,
}

/// The complete input of one run.
#[derive(Clone, Debug)]
pub struct Samples<'a> {
    /// Shape of the samples.
    pub shape: &'a [usize],
    /// The drivelines.
    pub lines: Drivelines<'a>,
    /// One stride per axis of the samples, in drivelines.
    pub line_strides: &'a [usize],
    /// The drive angles.
    pub angle: Angles<'a>,
    /// The load; required if the plan has one.
    pub load: Option<Load<'a>>,
}
