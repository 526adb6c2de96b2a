//! The physics of one sample: geometry, frames, joints, chains, transmissions, moments, forces and phasing. No
//! slices, no threads.

pub mod as_built;
pub(crate) mod bearings;
pub mod chain;
pub mod common_phases;
pub(crate) mod cross;
pub(crate) mod derivatives;
pub(crate) mod double_angle;
pub(crate) mod exact;
pub(crate) mod extremes;
pub(crate) mod forces;
pub(crate) mod frame;
pub mod general;
pub mod geometry;
pub mod joint;
pub(crate) mod moment;
pub mod motion;
pub mod phasing;
pub(crate) mod phasing_search;
pub mod transmission;
pub(crate) mod turning;
