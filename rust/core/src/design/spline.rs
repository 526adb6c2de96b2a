//! Splines that slide under load: their axial force, and what it does to the next shafts.
//!
//! A spline that carries a torque `T` at the pitch radius `r` presses with `T/r` on its flanks, and
//! so slides only under the axial force `F = μ T/r`. While shaft `i` becomes longer, it pulls like a
//! rod in tension: with `F u_i` on what holds it upstream and with `−F u_i` on what holds it
//! downstream. The joints transmit this force to the next shafts, which are inclined by the bends:
//! `F cos β` acts along such a shaft and `F sin β` across it, in the plane of the bend.

use crate::design::records::fill_records;
use crate::error::Result;
use crate::input::Drivelines;
use crate::input::batch::{check_shaft, check_shafts};
use crate::mechanics::geometry::Vector;
use crate::number::trig;
use crate::run::execution::Execution;

/// A spline on one shaft of drivelines with the same bearings.
#[derive(Clone, Debug)]
pub struct Spline {
    joints: usize,
    shaft: usize,
    /// The number of bearings.
    bearings: usize,
    /// The shafts beside the sliding one, or why the forces of bearings are not determinate.
    held: std::result::Result<Vec<Held>, String>,
}

/// A shaft beside the sliding one, and its two bearings.
#[derive(Clone, Copy, Debug)]
struct Held {
    shaft: usize,
    bearings: [usize; 2],
    /// Whether it is the one upstream.
    upstream: bool,
}

/// The axial force of a loaded spline while its shaft becomes longer. While it becomes shorter,
/// vectors have the opposite sign.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineForce {
    /// The force along the shaft in N, as a magnitude.
    pub axial: f64,
    /// The force on what holds the shaft upstream in N; that downstream is the opposite.
    pub upstream: Vector,
    /// Part of it along the shaft that bears it upstream: the shaft before, or for shaft 0 the
    /// shaft itself.
    pub upstream_axial: f64,
    /// Part of it across that shaft.
    pub upstream_transverse: f64,
    /// The same downstream.
    pub downstream_axial: f64,
    /// Part of it across that shaft.
    pub downstream_transverse: f64,
}

impl Spline {
    /// The number of components of [`SplineForce`].
    pub const COUNT: usize = 8;

    /// On `shaft` of drivelines with `joints` joints and with bearings on these shafts.
    ///
    /// # Errors
    /// A shaft that does not exist.
    pub fn new(joints: usize, shaft: usize, bearings: &[usize]) -> Result<Self> {
        check_shaft(joints, shaft)?;
        check_shafts(joints, bearings)?;
        let held = Held::beside(joints, shaft, bearings);
        Ok(Self { joints, shaft, bearings: bearings.len(), held })
    }

    /// Why the forces of the bearings are not determinate, if they are not: two of them must carry
    /// each shaft beside the sliding one.
    pub fn undetermined(&self) -> Option<&str> {
        self.held.as_ref().err().map(String::as_str)
    }

    /// The number of numbers in a record: those of [`SplineForce`], and three for each bearing.
    pub fn record(&self) -> usize {
        Self::COUNT + 3 * self.bearings
    }

    /// The force in the driveline with this number under a torque in N·m, with this friction and
    /// pitch radius in m.
    pub fn force(&self, lines: &Drivelines<'_>, line: usize, load: [f64; 3]) -> SplineForce {
        let [torque, friction, radius] = load;
        let axial = friction * torque.abs() / radius;
        let (bends, ..) = lines.chain(self.joints, line);
        let before = self.shaft.checked_sub(1).map_or(0.0, |joint| bends[joint]);
        let behind = bends.get(self.shaft).copied().unwrap_or(0.0);
        let [(up_sine, up_cosine), (down_sine, down_cosine)] = [before, behind].map(trig::sin_cos);
        SplineForce {
            axial,
            upstream: self.direction(lines, line, self.shaft) * axial,
            upstream_axial: axial * up_cosine,
            upstream_transverse: axial * up_sine,
            downstream_axial: axial * down_cosine,
            downstream_transverse: axial * down_sine,
        }
    }

    /// The force that each bearing must give its shaft against that of the spline: the parts across
    /// the shafts that hold the sliding one. Bearings of other shafts give nothing, and thrust is
    /// not part of it. All are zero if they are not determinate.
    pub fn bearing_forces(
        &self,
        lines: &Drivelines<'_>,
        line: usize,
        force: &SplineForce,
    ) -> Vec<Vector> {
        let mut found = vec![Vector::zeros(); self.bearings];
        for held in self.held.iter().flatten() {
            let along = self.direction(lines, line, held.shaft);
            let on_it = if held.upstream { force.upstream } else { -force.upstream };
            let across = on_it - along * on_it.dot(&along);
            let joint = if held.upstream {
                lines.lengths[line * (self.joints + 1) + held.shaft]
            } else {
                0.0
            };
            let [a, b] =
                held.bearings.map(|bearing| lines.positions[line * self.bearings + bearing]);
            let [first, second] = held.bearings;
            found[first] = across * -((b - joint) / (b - a));
            found[second] = across * -((a - joint) / (a - b));
        }
        found
    }

    fn direction(&self, lines: &Drivelines<'_>, line: usize, shaft: usize) -> Vector {
        let first = 3 * (line * (self.joints + 1) + shaft);
        Vector::from_column_slice(&lines.directions[first..first + 3])
    }
}

impl Held {
    /// The shafts beside the sliding one.
    ///
    /// # Errors
    /// The reason why the forces of bearings are not determinate.
    fn beside(
        joints: usize,
        shaft: usize,
        bearings: &[usize],
    ) -> std::result::Result<Vec<Self>, String> {
        if bearings.is_empty() {
            return Err("the driveline has no bearings".to_owned());
        }
        let upstream = shaft.checked_sub(1).map(|shaft| (shaft, true));
        let downstream = (shaft < joints).then_some((shaft + 1, false));
        let held = |(shaft, upstream)| {
            let own: Vec<usize> = (0..bearings.len()).filter(|&i| bearings[i] == shaft).collect();
            let [a, b] = own[..] else {
                let count = own.len();
                let plural = if count == 1 { "" } else { "s" };
                return Err(format!(
                    "shaft {shaft} has {count} bearing{plural}; two bear the part across it"
                ));
            };
            Ok(Self { shaft, bearings: [a, b], upstream })
        };
        upstream.into_iter().chain(downstream).map(held).collect()
    }
}

/// The forces in drivelines of a batch, given by their numbers, under loads of torque, friction and
/// radius, as records of [`Spline::record`] numbers: the fields of [`SplineForce`], then the forces
/// of the bearings.
pub fn splines_of_batch(
    spline: &Spline,
    lines: &Drivelines<'_>,
    numbers: &[usize],
    loads: [&[f64]; 3],
    out: &mut [f64],
    execution: Execution<'_>,
) {
    fill_records(spline.record(), out, execution, |i, record| {
        let line = numbers[i];
        let force = spline.force(lines, line, loads.map(|load| load[i]));
        let (own, of_bearings) = record.split_at_mut(Spline::COUNT);
        own.copy_from_slice(&[
            force.axial,
            force.upstream.x,
            force.upstream.y,
            force.upstream.z,
            force.upstream_axial,
            force.upstream_transverse,
            force.downstream_axial,
            force.downstream_transverse,
        ]);
        let found = spline.bearing_forces(lines, line, &force);
        for (out, force) in of_bearings.chunks_mut(3).zip(found) {
            out.copy_from_slice(force.as_slice());
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::geometry::Geometry;

    #[test]
    fn bearings_balance_the_parts_across() {
        let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.5], [3.0, 0.3]];
        let geometry =
            Geometry::from_points(&points.map(|[x, y]| Vector::new(x, y, 0.1 * x * y)), &[0.3])
                .unwrap();
        let directions: Vec<f64> =
            geometry.directions.iter().flat_map(Vector::iter).copied().collect();
        let lines = Drivelines {
            bends: &geometry.bends,
            twists: &geometry.twists,
            phases: &geometry.phases,
            directions: &directions,
            lengths: &[1.0, 1.1, 1.2],
            positions: &[0.3, 0.8, 0.2, 0.9],
            ..Drivelines::default()
        };
        let spline = Spline::new(2, 1, &[0, 0, 2, 2]).unwrap();
        assert_eq!(spline.undetermined(), None);
        let force = spline.force(&lines, 0, [-800.0, 0.1, 0.02]);
        assert!((force.axial - 4000.0).abs() < 1e-9);
        let found = spline.bearing_forces(&lines, 0, &force);
        let ends = [(0, 1.0, force.upstream, [0, 1]), (2, 0.0, -force.upstream, [2, 3])];
        let sizes = [force.upstream_transverse, force.downstream_transverse];
        for ((shaft, joint, on_it, [i, j]), size) in ends.into_iter().zip(sizes) {
            let along = geometry.directions[shaft];
            let across = on_it - along * on_it.dot(&along);
            assert!((across.norm() - size).abs() < 1e-9);
            // Forces and moments about the joint.
            assert!((across + found[i] + found[j]).norm() < 1e-9);
            let arm = |bearing: usize| lines.positions[bearing] - joint;
            assert!((found[i] * arm(i) + found[j] * arm(j)).norm() < 1e-9);
        }
    }

    #[test]
    fn two_bearings_bear_the_part_across() {
        let refused = |bearings: &[usize]| {
            Spline::new(2, 1, bearings).unwrap().undetermined().unwrap().to_owned()
        };
        assert_eq!(refused(&[]), "the driveline has no bearings");
        assert_eq!(refused(&[2, 2]), "shaft 0 has 0 bearings; two bear the part across it");
        assert_eq!(refused(&[0, 2, 0]), "shaft 2 has 1 bearing; two bear the part across it");
        assert_eq!(Spline::new(2, 0, &[1, 1]).unwrap().undetermined(), None);
        let error = Spline::new(2, 3, &[]).unwrap_err().to_string();
        assert_eq!(error, "shaft is 3; there are 3");
    }
}
