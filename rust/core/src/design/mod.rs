//! Closed forms of design: one answer per driveline or shaft, over batches on several threads.

pub mod excitations;
pub(crate) mod records;
pub mod spline;
pub mod steering;
pub mod tube;

pub use excitations::{Excitations, excitations_of_batch};
pub use spline::{Spline, SplineForce, splines_of_batch};
pub use steering::{Steering, steering_of_batch};
pub use tube::Tube;
