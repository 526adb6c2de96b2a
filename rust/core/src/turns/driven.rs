//! The drive angles that belong to angles of the last shaft.
//!
//! A chain takes the direction `w = e^{iα}` of the drive's pin to `A w + B w̄`. With `q = B/A` the
//! mean-synchronous angle of the last shaft is `α + arg(1 + q e^{−2iα})` (from Thoma 4). Its inverse
//! has the same form with `−q`. That is the same chain with its drive a quarter turn ahead, because
//! `i w` goes to `i (A w − B w̄)`. A straight joint before the chain turns the drive so. The inverse
//! is therefore a driveline like any other, and nothing is iterated.

use crate::error::Result;
use crate::number::Precision;
use crate::plan::output::Output;
use crate::plan::request::{Axes, Request};
use crate::plan::steps::Plan;
use crate::turns::rows::Rows;

/// The plans that turn drive angles into angles of the last shaft, and the other way round.
pub(crate) struct Driven {
    forth: Plan,
    back: Plan,
}

impl Driven {
    /// The plans for drivelines with these largest bends.
    pub(crate) fn new(largest_bends: &[f64]) -> Result<Self> {
        let of = |bends: &[f64]| {
            Plan::new(&Request {
                largest_bends: bends,
                outputs: &[Output::Angle],
                shafts: &[bends.len()],
                joints: &[],
                load: None,
                inertias: &[],
                bearings: None,
                as_built: false,
                axes: Axes::Space,
            })
        };
        Ok(Self { forth: of(largest_bends)?, back: of(&[&[0.0], largest_bends].concat())? })
    }

    /// The angles of the last shaft at drive angles of one row.
    pub(crate) fn of_drive(&self, rows: &Rows<'_>, row: usize, angles: &[f64]) -> Result<Vec<f64>> {
        let joints = self.forth.joint_count;
        rows.gathered(&[row], joints).run(&self.forth, Precision::DoubleDouble, angles)
    }

    /// The drive angles at angles of the last shaft of one row.
    pub(crate) fn to_drive(&self, rows: &Rows<'_>, row: usize, angles: &[f64]) -> Result<Vec<f64>> {
        let joints = self.forth.joint_count;
        rows.gathered(&[row], joints).behind_straight_joint().run(
            &self.back,
            Precision::DoubleDouble,
            angles,
        )
    }
}
