#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod atan;
pub mod batch;
mod block;
pub mod chain;
mod chunk;
mod column;
pub mod error;
pub mod explain;
mod extremes;
mod fold;
pub mod geometry;
pub mod joint;
mod kernel;
pub mod level;
mod long_sweep;
mod moment;
mod out;
pub mod pair;
pub mod phasing;
mod pins;
pub mod plan;
pub mod real;
mod reduce;
pub mod reduction;
mod ripple;
mod rotations;
pub mod samples;
mod scratch;
pub mod sweep;
pub mod trig;

pub use batch::{Constants, Execution, Planes, Precision};
pub use chain::Equivalent;
pub use error::{Error, Result};
pub use explain::Call;
pub use geometry::{Geometry, Vector};
pub use joint::Joint;
pub use level::Level;
pub use pair::Pair;
pub use plan::{End, Output, Plan, Request};
pub use reduction::Reduction;
pub use samples::{Angles, Drivelines, Load, Samples, Source};
pub use sweep::Sweep;
