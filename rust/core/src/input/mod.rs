//! The input of a run: drivelines, drive angles and loads.

pub mod drivelines;
pub mod samples;
pub mod sweep;
pub(crate) mod table;

pub use drivelines::Drivelines;
pub use samples::{Angles, Load, Samples, Source};
pub use sweep::Sweep;
