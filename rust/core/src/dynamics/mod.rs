//! Torsional vibration of drivelines with compliant shafts: the periodic orbit at constant drive
//! speed, its stability, natural frequencies, and the equations in time.

mod batch;
mod coexisting;
mod continuation;
mod gauss;
mod instant;
mod lanes;
mod modes;
mod motion_equation;
mod newton;
mod orbit;
mod periodic;
mod pool;
mod rigid_piece;
mod search;
mod side_by_side;
mod system;

pub use batch::{Runs, multipliers_of_batch, orbits_of_batch, steady_of_batch};
pub use coexisting::{coexisting_of_batch, coexisting_record};
pub use instant::{AtDrive, Instant};
pub use orbit::Failure;
pub use system::{ShaftEnds, TorsionalSystem};
