//! The torque's own stiffness: how the moments of the joints change where points of a driveline move.

use nalgebra::{Complex, DMatrix};

use crate::dynamics::lateral::equations::{BandEquations, Nodes};
use crate::dynamics::lateral::rate::Rate;
use crate::dynamics::lateral::system::{LateralShaft, LateralSystem, pair_across};
use crate::error::{Error, Result};
use crate::mechanics::geometry::Vector;
use crate::number::elementary::turn;

type C = Complex<f64>;

/// The moved distance, relative to the shortest shaft, at which the error of the differences equals
/// that of rounding.
const STEP: f64 = 1e-5;

/// What the moments of the joints do, at a drive torque of 1 N m, where points of a driveline with
/// straight shafts move.
///
/// The points are ends of shafts that can move, each with two components across its shaft. At the
/// drive angle `α` the forces on them are `(mean + Re(turning e^{2iα})) d` for displacements `d`.
#[derive(Clone, Debug)]
pub struct TorqueStiffness {
    /// In N/m per N m.
    pub mean: DMatrix<f64>,
    /// In N/m per N m.
    pub turning: DMatrix<C>,
}

/// Where the drive torque acts and how the yokes are set.
#[derive(Clone, Copy, Debug)]
pub struct Yokes<'a> {
    /// The unit normal of the first bend.
    pub normal: Vector,
    /// The phase of each intermediate shaft in rad.
    pub phases: &'a [f64],
}

impl LateralSystem {
    /// The torque's own stiffness, by central differences; its error is about `1e-9` of
    /// `1/length²`.
    ///
    /// # Errors
    /// A number of phases that does not fit.
    pub fn torque_stiffness(&self, yokes: Yokes<'_>) -> Result<TorqueStiffness> {
        let needed = self.joints().saturating_sub(1);
        if yokes.phases.len() != needed {
            let problem = format!("has {} values for {needed} shafts", yokes.phases.len());
            return Err(Error::new("phases", &[], problem));
        }
        let rows = self.movable();
        let mut points = vec![Vector::zeros()];
        for (u, length) in self.directions.iter().zip(&self.lengths) {
            points.push(points[points.len() - 1] + u * *length);
        }
        let step = STEP * self.lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let samples = self.samples();
        let size = rows.len();
        let mut mean = DMatrix::zeros(size, size);
        let mut turning = DMatrix::zeros(size, size);
        for (column, &(point, direction)) in rows.iter().enumerate() {
            let [ahead, behind] = [step, -step].map(|by| {
                let mut moved = points.clone();
                moved[point] += direction * by;
                moved
            });
            for sample in 0..samples {
                let angle = std::f64::consts::TAU * sample as f64 / samples as f64;
                let [ahead, behind] =
                    [&ahead, &behind].map(|points| self.point_forces(points, yokes, angle));
                let back = turn(-2.0 * angle);
                for (row, &(point, direction)) in rows.iter().enumerate() {
                    let slope = direction.dot(&(ahead[point] - behind[point]))
                        / (2.0 * step * samples as f64);
                    mean[(row, column)] += slope;
                    turning[(row, column)] += back * (2.0 * slope);
                }
            }
        }
        Ok(TorqueStiffness { mean, turning })
    }

    /// The largest drive torque in N m at which a vibration does not maintain itself at a speed in
    /// rad/s: above it the turning part of the torque's stiffness exceeds what holds the points at
    /// order 1. What the mean part does is left out.
    ///
    /// At the limit `x = H A x̄` with the compliance `H` of the points at order 1 and half of the
    /// turning part as `A`.
    pub fn largest_stable_torque(&self, stiffness: &TorqueStiffness, speed: f64) -> f64 {
        let rows = self.movable();
        if rows.is_empty() {
            return f64::INFINITY;
        }
        let layout = Nodes::new(self, false);
        let at = Rate::of_order(1.0, speed);
        let mut equations = BandEquations::default();
        equations.assemble(&layout, at, at.omega);
        equations.factor();
        let mut compliance = DMatrix::zeros(rows.len(), rows.len());
        for (column, &(point, direction)) in rows.iter().enumerate() {
            equations.without_forces();
            let (shaft, end) = self.carrier(point);
            if let Some(place) = layout.at_node(shaft, end) {
                equations.add_force(&layout, shaft, place, direction);
            }
            equations.solve();
            for (row, &(point, direction)) in rows.iter().enumerate() {
                let (shaft, end) = self.carrier(point);
                let moved = equations.displacement_at(&layout, at, shaft, end);
                compliance[(row, column)] =
                    moved[0] * direction[0] + moved[1] * direction[1] + moved[2] * direction[2];
            }
        }
        let gain = compliance * &stiffness.turning * C::from(0.5);
        let squared = &gain * gain.conjugate();
        // As a real matrix it has the same eigenvalues and their conjugates.
        let size = squared.nrows();
        let real = DMatrix::from_fn(2 * size, 2 * size, |i, j| {
            let own: C = squared[(i % size, j % size)];
            match (i < size, j < size) {
                (true, false) => -own.im,
                (false, true) => own.im,
                _ => own.re,
            }
        });
        if real.iter().any(|x| !x.is_finite()) {
            // Without damping nothing holds the points at a resonance.
            return 0.0;
        }
        let found = real.complex_eigenvalues();
        let largest = found.iter().map(C::norm_sqr).fold(0.0, f64::max);
        largest.sqrt().sqrt().recip()
    }

    /// How many drive angles of a turn show all that joints do.
    fn samples(&self) -> usize {
        let cosines: f64 = self.directions.windows(2).map(|pair| pair[0].dot(&pair[1])).product();
        2 * (16 + (20.0 / cosines).ceil() as usize)
    }

    /// The shaft that carries a point with its own end there, and that does not slide, and the
    /// position of that end.
    fn carrier(&self, point: usize) -> (usize, f64) {
        let Some(joint) = point.checked_sub(1) else { return (0, 0.0) };
        let Some(&sliding) = self.sliding.get(joint) else { return (joint, self.lengths[joint]) };
        if sliding == joint { (joint + 1, 0.0) } else { (joint, self.lengths[joint]) }
    }

    /// Points that can move, each with two directions.
    fn movable(&self) -> Vec<(usize, Vector)> {
        let held = |shaft: usize| self.shafts.get(shaft) == Some(&LateralShaft::Held);
        (0..=self.shafts.len())
            .filter(|&point| !held(point) && !point.checked_sub(1).is_some_and(held))
            .flat_map(|point| self.pairs[self.carrier(point).0].map(|direction| (point, direction)))
            .collect()
    }

    /// The forces of the joints' moments on all points, with straight shafts between these, at a
    /// drive torque of 1 N m.
    fn point_forces(&self, points: &[Vector], yokes: Yokes<'_>, angle: f64) -> Vec<Vector> {
        let shafts: Vec<Vector> = points.windows(2).map(|ends| ends[1] - ends[0]).collect();
        let directions: Vec<Vector> = shafts.iter().map(Vector::normalize).collect();
        // The pin of the drive keeps its direction, whatever the bends.
        let u = directions[0];
        let [level, aside] = pair_across(u, yokes.normal.cross(&self.directions[0]));
        let turned = turn(angle);
        let mut pin = level * turned.re + aside * turned.im;
        let mut torque = 1.0;
        let mut moments = vec![Vector::zeros()];
        for (joint, pair) in directions.windows(2).enumerate() {
            let driven = pair[1].cross(&pin).normalize();
            let normal = pin.cross(&driven);
            let along = torque / pair[0].dot(&normal);
            moments.push(normal * along);
            torque = along * pair[1].dot(&normal);
            if let Some(&phase) = yokes.phases.get(joint) {
                let turned = turn(phase);
                pin = driven * turned.re + pair[1].cross(&driven) * turned.im;
            }
        }
        moments.push(Vector::zeros());
        let mut forces = vec![Vector::zeros(); points.len()];
        for (shaft, u) in directions.iter().enumerate() {
            // A point turns the shaft before it one way and the shaft behind it the other way.
            let couple = (moments[shaft] - moments[shaft + 1]).cross(u) / shafts[shaft].norm();
            forces[shaft] -= couple;
            forces[shaft + 1] += couple;
        }
        forces
    }
}
