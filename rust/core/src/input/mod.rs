//! The input of a run: drivelines, drive angles and loads.

pub mod batch;
pub mod broadcast;
pub mod drivelines;
pub mod samples;
pub mod sweep;
pub(crate) mod table;

pub use batch::Batch;
pub use broadcast::strides;
pub use drivelines::Drivelines;
pub use samples::{Angles, Load, Samples, Source};
pub use sweep::Sweep;
