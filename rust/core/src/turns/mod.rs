//! What outputs do over a turn of the drive.
//!
//! One set of samples per driveline serves all its outputs. It follows from the driveline alone, so
//! that results do not depend on the other drivelines of a batch.

pub(crate) mod panels;
pub(crate) mod rows;
pub(crate) mod rule;

pub use rows::Rows;
