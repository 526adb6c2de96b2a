//! What outputs do over a turn of the drive.
//!
//! One set of samples per driveline serves all its outputs. It follows from the driveline alone, so
//! that results do not depend on the other drivelines of a batch.

mod driven;
mod each_row;
pub mod orders;
mod panels;
pub mod peaks;
pub mod rows;
mod rule;

use crate::error::Result;
use crate::number::Precision;
use crate::plan::steps::Plan;
use driven::Driven;
use rows::Rows;

pub(crate) use panels::Integrands;

/// A plan and the rows for which its outputs are turned, at equal rights with how it is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Turns<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// The drivelines and loads.
    pub rows: &'a Rows<'a>,
    /// The arithmetic.
    pub precision: Precision,
}

impl<'a> Turns<'a> {
    /// Turns a plan with its default arithmetic.
    pub fn new(plan: &'a Plan, rows: &'a Rows<'a>) -> Self {
        Self { plan, rows, precision: plan.precision(None, false) }
    }

    /// The planes at drive angles of some rows, the same number in each.
    fn values(&self, rows: &[usize], angles: &[f64]) -> Result<Vec<f64>> {
        self.rows.gathered(rows, self.plan.joint_count).run(self.plan, self.precision, angles)
    }

    /// The values of one row, at angles of the last shaft if these are what the turn is over.
    fn values_at(&self, driven: Option<&Driven>, row: usize, angles: &[f64]) -> Result<Vec<f64>> {
        match driven {
            Some(driven) => self.values(&[row], &driven.to_drive(self.rows, row, angles)?),
            None => self.values(&[row], angles),
        }
    }
}
