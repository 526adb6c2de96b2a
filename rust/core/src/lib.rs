#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod error;
pub mod input;
pub mod mechanics;
pub mod number;
pub mod plan;
pub mod run;
mod sincos;

pub use error::{Error, Result};
pub use input::{Angles, Drivelines, Load, Samples, Source, Sweep};
pub use mechanics::chain::Equivalent;
pub use mechanics::geometry::{Geometry, Vector};
pub use mechanics::joint::Joint;
pub use mechanics::phasing::optimal_phases;
pub use mechanics::transmission::{General, Ideal, Motion, MotionGradient, Transmission};
pub use number::{DoubleDouble, Precision};
pub use plan::{End, Output, Per, Plan, Reduction, Request, Route, Row};
pub use run::execution::{Execution, Planes};
pub use run::explain::Call;
pub use run::fold::FoldedDriveline;
pub use run::level::{self, Level};
pub use run::phases::optimal_phases_of_batch;
pub use run::threads::uses_threads;
