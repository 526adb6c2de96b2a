#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod batch;
pub mod chain;
mod chunk;
pub mod error;
mod fold;
pub mod geometry;
pub mod joint;
mod kernel;
pub mod level;
mod moment;
pub mod phasing;
pub mod plan;
pub mod samples;
pub mod trig;

pub use batch::Execution;
pub use chain::{Equivalent, Transfer};
pub use error::{Error, Result};
pub use geometry::{Geometry, Vector};
pub use joint::Joint;
pub use level::Level;
pub use plan::{End, Output, Plan, Request};
pub use samples::{Drivelines, Load, Samples, Source};
