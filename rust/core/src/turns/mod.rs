//! Outputs over a turn of the drive.
//!
//! One set of samples per driveline serves all its outputs. It follows from the driveline alone, so
//! that results do not depend on the other drivelines of a batch.

pub mod free_drive;
pub mod orders;
mod panels;
pub mod peaks;
pub mod rows;
mod rule;

use crate::error::Result;
use crate::number::Precision;
use crate::plan::output::Output;
use crate::plan::request::{Axes, Request};
use crate::plan::steps::Plan;
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
        if driven.is_none() {
            return self.values(&[row], angles);
        }
        let gathered = self.rows.gathered(&[row], self.plan.joint_count);
        let [angles, error_terms] = gathered.drive_angles(self.plan.joint_count, angles)?;
        gathered.run_at_sums(self.plan, self.precision, &angles, Some(&error_terms))
    }
}

/// The plan that turns drive angles into angles of the last shaft.
struct Driven(Plan);

impl Driven {
    /// The plan for drivelines with these largest bends.
    fn new(largest_bends: &[f64]) -> Result<Self> {
        let plan = Plan::new(&Request {
            largest_bends,
            outputs: &[Output::Angle],
            shafts: &[largest_bends.len()],
            joints: &[],
            load: None,
            inertias: &[],
            bearings: None,
            as_built: false,
            axes: Axes::Space,
        });
        plan.map(Self)
    }

    /// The angles of the last shaft at drive angles of one row.
    fn of_drive(&self, rows: &Rows<'_>, row: usize, angles: &[f64]) -> Result<Vec<f64>> {
        let Self(plan) = self;
        rows.gathered(&[row], plan.joint_count).run(plan, Precision::DoubleDouble, angles)
    }
}
