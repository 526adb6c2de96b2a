#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! | module | contents |
//! | --- | --- |
//! | [`number`] | number types, their storage, range reduction, elementary functions |
//! | [`mechanics`] | the physics of one sample: geometry, joints, chains, moments, phasing |
//! | [`input`] | drivelines, drive angles or a sweep, and loads, broadcast over the samples |
//! | [`plan`] | the requested outputs, the steps that compute them, and their routes |
//! | `sincos` | sines and cosines of arrays of angles and of sweeps |
//! | [`run`] | threads, blocks, chunks, loops over slices, and reductions |
//! | [`turns`] | what outputs do over a turn of the drive |
//! | [`wear`] | friction and fatigue of the pins, from means over a turn |
//! | [`design`] | closed forms of drivelines and shafts: excitations, steering, splines, tubes |
//! | [`judge`] | ranks of figures against limits, the figures of a machine in all states |
//! | [`dynamics`] | torsional vibration of compliant shafts, lateral vibration on elastic bearings |
//! | [`measured`] | the motion of a measured drive: integral and derivatives of its speed |
//! | [`error`] | errors in the input, with argument, position and rule |
//!
//! Each module uses only those above it in the table, and [`error`].
#![forbid(unsafe_code)]
// Tests compare with the platform's functions.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod design;
pub mod dynamics;
pub mod error;
pub mod input;
pub mod judge;
pub mod measured;
pub mod mechanics;
pub mod number;
pub mod plan;
pub mod run;
mod sincos;
pub mod turns;
pub mod wear;

pub use design::{Excitations, Spline, SplineForce, Steering, Tube};
pub use dynamics::{ShaftEnds, TorsionalSystem};
pub use error::{Error, Problem, Result, Rule};
pub use input::batch::{check_bearings, check_length, check_shaft};
pub use input::broadcast::unravel;
pub use input::{Angles, Batch, Drivelines, Load, Samples, Source, Sweep, strides};
pub use mechanics::as_built::check_deviations;
pub use mechanics::chain::Equivalent;
pub use mechanics::common_phases::States;
pub use mechanics::general::General;
pub use mechanics::geometry::{Geometry, MOST_JOINTS, Vector, lengths};
pub use mechanics::joint::Joint;
pub use mechanics::motion::{Motion, MotionGradient};
pub use mechanics::phasing::optimal_phases;
pub use mechanics::transmission::{Ideal, Transmission};
pub use number::{DoubleDouble, Precision};
pub use plan::{Axes, End, Output, Per, Plan, Reduction, Request, Route, Row};
pub use run::common_phases::common_phases_of_batch;
pub use run::driven::drive_angles;
pub use run::equivalents::{FIGURES, equivalents_of_batch};
pub use run::execution::{Execution, Planes};
pub use run::explain::Call;
pub use run::fold::FoldedDriveline;
pub use run::frames::frames_of_batch;
pub use run::gradient::{Counts, Differentiated, Spread, SpreadAngles, SpreadLoad, Wanted};
pub use run::level::{self, Level};
pub use run::phases::optimal_phases_of_batch;
pub use run::q_derivatives::{Parameters, q_derivatives};
pub use run::threads::uses_threads;
pub use turns::Turns;
pub use turns::free_drive::{FreeDrive, free_drives, least_drive_inertias};
pub use turns::orders::Orders;
pub use turns::peaks::{Peak, Sought};
pub use turns::rows::Rows;
pub use wear::life::{SMALLEST_BEND, hours};
pub use wear::pins::{Wear, pin_means};
