//! Torsional vibration of drivelines with compliant shafts: the periodic orbit at constant drive
//! speed, its stability, and natural frequencies.

mod batch;
mod gauss;
mod modes;
mod motion_equation;
mod orbit;
mod periodic;
mod rigid_piece;
mod search;
mod system;

pub use batch::{Runs, multipliers_of_batch, orbits_of_batch, steady_of_batch};
pub use orbit::Failure;
pub use system::{ShaftEnds, TorsionalSystem};
