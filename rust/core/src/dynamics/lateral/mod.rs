//! Lateral vibration of shafts on elastic bearings: shafts that are rigid or bend, excited by the
//! moments of ideal joints and by unbalances at steady speeds.

mod band;
mod bearing;
mod check;
mod described;
mod equations;
mod largest;
mod modes;
mod rate;
mod response;
mod span;
mod system;
mod torque;

pub use bearing::ElasticBearing;
pub use described::{Described, Numbers};
pub use largest::largest_lengths;
pub use modes::LateralMode;
pub use response::LateralRuns;
pub use system::{
    Attached, BendingShaft, LateralShaft, LateralSystem, PointMass, RigidShaft, Unbalance,
};
pub use torque::{TorqueStiffness, Yokes};

pub use nalgebra::Complex;
