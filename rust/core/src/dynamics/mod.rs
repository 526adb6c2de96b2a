//! Torsional vibration of drivelines with compliant shafts, whose drive is held at constant speed or
//! free: the periodic orbit, its stability, natural frequencies, and the equations in time.

mod balance;
mod batch;
mod coexisting;
mod continuation;
mod coupling;
mod gauss;
mod instant;
mod lanes;
pub mod lateral;
mod modes;
mod motion_equation;
mod newton;
mod orbit;
mod periodic;
mod pool;
mod rigid_piece;
mod search;
mod shooting;
mod side_by_side;
mod system;

pub use batch::{OF_DRIVE, Runs, multipliers_of_batch, orbits_of_batch, steady_of_batch};
pub use coexisting::{coexisting_of_batch, coexisting_record};
pub use coupling::Coupling;
pub use instant::{AtDrive, Instant};
pub use modes::{CriticalSpeeds, Mode};
pub use orbit::Failure;
pub use system::{Drive, ShaftEnds, TorqueHarmonic, TorsionalSystem};
