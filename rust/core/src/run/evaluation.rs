//! Evaluating a plan: the public functions.

use crate::error::Result;
use crate::input::table::Table;
use crate::input::{Angles, Drivelines, Samples, Source};
use crate::mechanics::geometry::{Geometry, Vector};
use crate::number::Precision;
use crate::number::double_double::DoubleDouble;
use crate::plan::forces::ForceStep;
use crate::plan::reduction::Reduction;
use crate::plan::steps::Plan;
use crate::run::block::GROUP;
use crate::run::execution::{Execution, Planes};
use crate::run::fold::FoldedDriveline;
use crate::run::scratch::CHUNK;
use crate::run::threads::{BLOCK, Run};

impl Plan {
    /// Evaluates the plan at every sample into `planes`, [`Plan::planes`] in number.
    ///
    /// `folded` is the result of [`Plan::fold`] for the only driveline of the samples, if it is
    /// known.
    ///
    /// # Errors
    /// Arrays whose lengths do not fit together, a plan with a load without one in the samples.
    pub fn run(
        &self,
        samples: &Samples<'_>,
        folded: Option<&FoldedDriveline>,
        precision: Precision,
        planes: Planes<'_, '_>,
        execution: Execution<'_>,
    ) -> Result<()> {
        self.check_lines(&samples.lines)?;
        let table = Table::new(self.joint_count, self.load.is_some(), samples)?;
        let run = Run { plan: self, table: &table, folded, execution };
        match (self.computed_in(precision), planes) {
            #[cfg(feature = "single")]
            (Precision::Single, Planes::Single(planes)) => run.fill::<f32, f32>(planes),
            #[cfg(feature = "single")]
            (Precision::Single, Planes::Double(planes)) => run.fill::<f32, f64>(planes),
            #[cfg(feature = "single")]
            (Precision::Double, Planes::Single(planes)) => run.fill::<f64, f32>(planes),
            #[cfg(feature = "single")]
            (Precision::DoubleDouble, Planes::Single(planes)) => {
                run.fill::<DoubleDouble, f32>(planes)
            }
            (Precision::DoubleDouble, Planes::Double(planes)) => {
                run.fill::<DoubleDouble, f64>(planes)
            }
            (_, Planes::Double(planes)) => run.fill::<f64, f64>(planes),
        }
    }

    /// Evaluates the plan and reduces the last axis of the samples. There must be
    /// [`Reduction::results`] planes, each with one element per row.
    ///
    /// # Errors
    /// As for [`Plan::run`].
    pub fn reduce(
        &self,
        samples: &Samples<'_>,
        folded: Option<&FoldedDriveline>,
        precision: Precision,
        reduction: Reduction,
        planes: &mut [&mut [f64]],
        execution: Execution<'_>,
    ) -> Result<()> {
        self.check_lines(&samples.lines)?;
        let table = Table::by_rows(self.joint_count, self.load.is_some(), samples)?;
        let run = Run { plan: self, table: &table, folded, execution };
        match self.computed_in(precision) {
            #[cfg(feature = "single")]
            Precision::Single => run.reduce::<f32>(reduction, planes),
            Precision::DoubleDouble => run.reduce::<DoubleDouble>(reduction, planes),
            _ => run.reduce::<f64>(reduction, planes),
        }
    }

    /// An upper bound on the bytes that a run allocates besides its results: folded drivelines and
    /// one chunk of each result per thread, and the partial results of a reduction. `folded` says
    /// whether the only driveline was folded before.
    pub fn scratch_bytes(
        &self,
        samples: &Samples<'_>,
        folded: bool,
        reduction: Option<Reduction>,
        threads: usize,
    ) -> usize {
        let lanes = match samples.line_strides.last() {
            _ if folded => 1,
            Some(0) => GROUP,
            _ => CHUNK,
        };
        let of_joint = 928 * lanes + if samples.load.is_some() { 64 * CHUNK } else { 0 };
        let of_joint = of_joint + if self.is_as_built() { 192 * CHUNK } else { 0 };
        let of_planes = (16 * CHUNK).saturating_mul(self.planes);
        let of_forces = |forces: &ForceStep| 48 * lanes * forces.terms() + 96 * CHUNK;
        let of_forces = self.forces.as_ref().map_or(0, of_forces);
        let of_thread = (self.joint_count + 1).saturating_mul(of_joint).saturating_add(of_planes);
        let of_thread = of_thread.saturating_add(of_forces);
        let parts = match (reduction, samples.shape.split_last()) {
            (Some(_), Some((&length, rows))) if length > 0 => {
                let rows = rows.iter().fold(1_usize, |rows, &n| rows.saturating_mul(n));
                rows.saturating_mul(length.div_ceil(BLOCK))
            }
            _ => 0,
        };
        let of_parts = parts.saturating_mul(24 * self.planes);
        of_thread.saturating_mul(threads).saturating_add(of_parts)
    }

    /// Evaluates a plan without a load for one driveline at angles in rad; returns one vector per
    /// plane.
    ///
    /// # Errors
    /// As for [`Plan::run`].
    ///
    /// ```
    /// use cardan::{Axes, Geometry, Output, Plan, Request};
    ///
    /// let joint = Geometry::from_bends(&[0.5], &[], &[])?;
    /// let plan = Plan::new(&Request {
    ///     largest_bends: &joint.bends,
    ///     outputs: &[Output::SpeedRatio],
    ///     shafts: &[1],
    ///     joints: &[],
    ///     load: None,
    ///     inertias: &[],
    ///     bearings: None,
    ///     as_built: false,
    ///     axes: Axes::Space,
    /// })?;
    /// let ratio = &plan.evaluate(&joint, &[0.0])?[0];
    /// assert!((ratio[0] - 1.0 / 0.5_f64.cos()).abs() < 1e-15);
    /// # Ok::<(), cardan::Error>(())
    /// ```
    pub fn evaluate(&self, line: &Geometry, angle: &[f64]) -> Result<Vec<Vec<f64>>> {
        let flat = |vectors: &[Vector]| -> Vec<f64> {
            vectors.iter().flat_map(|v| v.iter().copied()).collect()
        };
        let (directions, normals) = (flat(&line.directions), flat(&line.normals));
        let samples = Samples {
            shape: &[angle.len()],
            lines: Drivelines {
                bends: &line.bends,
                twists: &line.twists,
                phases: &line.phases,
                directions: &directions,
                normals: &normals,
                ..Drivelines::default()
            },
            line_strides: &[0],
            angle: Angles::Array(Source { data: angle, strides: &[1] }),
            load: None,
        };
        let mut planes = vec![vec![0.0; angle.len()]; self.planes];
        let mut views: Vec<&mut [f64]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
        let planes_to_fill = Planes::Double(&mut views);
        self.run(&samples, None, Precision::Double, planes_to_fill, Execution::default())?;
        Ok(planes)
    }
}
