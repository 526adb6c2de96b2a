//! Batches of drivelines as flat arrays.

use crate::error::{Error, Result};
use crate::input::batch::check_length;
use crate::mechanics::as_built::DEVIATIONS;
use crate::mechanics::exact::Chains;
use crate::mechanics::geometry::{Vector, check_count};

/// A batch of drivelines with the same number `n` of joints, as flat arrays in C order.
#[derive(Clone, Copy, Debug, Default)]
pub struct Drivelines<'a> {
    /// Bend of each joint in rad, `(…, n)`.
    pub bends: &'a [f64],
    /// Twist of each intermediate shaft in rad, `(…, n − 1)`.
    pub twists: &'a [f64],
    /// Phase of each intermediate shaft in rad, `(…, n − 1)`.
    pub phases: &'a [f64],
    /// Unit vector along each shaft, `(…, n + 1, 3)`.
    pub directions: &'a [f64],
    /// Unit normal of each bend plane, `(…, n, 3)`.
    pub normals: &'a [f64],
    /// Length of each shaft, `(…, n + 1)`, in m; only forces need it.
    pub lengths: &'a [f64],
    /// Distance of each bearing from the upstream end of its shaft, in m.
    pub positions: &'a [f64],
    /// Deviations of driving yoke, cross and driven yoke of each joint in rad, `(…, n, 3)`; empty
    /// if all joints are ideal.
    pub deviations: &'a [f64],
}

impl<'a> Drivelines<'a> {
    /// The names of the arrays, in the order of the fields.
    pub const NAMES: [&'static str; 8] = [
        "bends",
        "twists",
        "phases",
        "directions",
        "normals",
        "lengths",
        "positions",
        "deviations",
    ];

    /// The drivelines with these arrays, in the order of the fields.
    pub fn from_arrays(arrays: [&'a [f64]; 8]) -> Self {
        let [bends, twists, phases, directions, normals, lengths, positions, deviations] = arrays;
        Self { bends, twists, phases, directions, normals, lengths, positions, deviations }
    }

    /// The arrays, in the order of the fields.
    pub fn arrays(&self) -> [&'a [f64]; 8] {
        let Self { bends, twists, phases, directions, normals, lengths, positions, deviations } =
            *self;
        [bends, twists, phases, directions, normals, lengths, positions, deviations]
    }

    /// Checks that the arrays fit together; returns the number of drivelines.
    pub(crate) fn check(&self, n: usize) -> Result<usize> {
        let count = self.bends.len().checked_div(n).unwrap_or(0);
        self.check_geometry(n, count)?;
        if !self.deviations.is_empty() {
            check_length("deviations", self.deviations.len(), count, n * DEVIATIONS)?;
        }
        if count == 0 {
            return Err(Error::new("bends", &[], "has no driveline"));
        }
        Ok(count)
    }

    /// Checks the arrays that every driveline has, for `count` drivelines of `n` joints.
    pub(crate) fn check_geometry(&self, n: usize, count: usize) -> Result<()> {
        check_count("bends", n)?;
        for (name, array, each) in [
            ("bends", self.bends, n),
            ("twists", self.twists, n - 1),
            ("phases", self.phases, n - 1),
            ("directions", self.directions, 3 * (n + 1)),
            ("normals", self.normals, 3 * n),
        ] {
            check_length(name, array.len(), count, each)?;
        }
        Ok(())
    }

    /// Bends, twists and phases of the driveline with this number; all have `joints` joints.
    pub(crate) fn chain(&self, joints: usize, line: usize) -> (&[f64], &[f64], &[f64]) {
        let part = |array: &'a [f64], each: usize| &array[line * each..][..each];
        let between = joints - 1;
        (part(self.bends, joints), part(self.twists, between), part(self.phases, between))
    }

    /// Direction of shaft 0 and normal of the first bend plane, from which drive angles count, of
    /// the driveline with this number; all have `joints` joints.
    pub fn column(&self, joints: usize, line: usize) -> [Vector; 2] {
        let first =
            |array: &[f64], each: usize| Vector::from_column_slice(&array[3 * each * line..][..3]);
        [first(self.directions, joints + 1), first(self.normals, joints)]
    }

    /// The joints and intermediate shafts of the drivelines, `joints` each.
    pub(crate) fn chains(&self, joints: usize) -> Chains<'_> {
        Chains { joints, bends: self.bends, twists: self.twists, phases: self.phases }
    }

    /// The largest bend of each of the `joints` over the batch, in rad. Zero means that the joint
    /// is straight in every driveline.
    pub fn largest_bends(&self, joints: usize) -> Vec<f64> {
        let mut largest = vec![0.0_f64; joints];
        for line in self.bends.chunks_exact(joints) {
            for (largest, &bend) in largest.iter_mut().zip(line) {
                *largest = largest.max(bend);
            }
        }
        largest
    }
}
