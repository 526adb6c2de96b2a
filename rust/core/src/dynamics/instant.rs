//! One instant of any motion, for integration in time: the drive turns at any speed.

use crate::dynamics::motion_equation::MotionEquation;
use crate::dynamics::system::TorsionalSystem;

/// The state of a system at one instant, and what loads it.
#[derive(Clone, Copy, Debug)]
pub struct Instant<'a> {
    /// Drive angle in rad.
    pub drive_angle: f64,
    /// Speed of the drive in rad/s.
    pub drive_speed: f64,
    /// Braking torque on the last shaft in N m; the viscous load is added to it.
    pub load_torque: f64,
    /// Angles of the output ends of the compliant shafts, relative to the drive angle and to the
    /// constant offsets of the joints before them, in rad.
    pub errors: &'a [f64],
    /// Their speeds in rad/s.
    pub speeds: &'a [f64],
}

/// Loads that the drive moves directly.
#[derive(Clone, Copy, Debug)]
pub struct AtDrive {
    /// The torque in N m that keeps the speed of the drive constant, beside harmonic torques.
    pub torque: f64,
    /// The inertia in kg m² of the shafts before the first compliant one.
    pub inertia: f64,
}

impl TorsionalSystem {
    /// Fills in the accelerations of the output ends of the compliant shafts in rad/s².
    pub fn accelerations(&self, instant: Instant<'_>, out: &mut [f64]) -> AtDrive {
        let (mut equation, slopes) = self.in_time(instant);
        equation.accelerations(instant.drive_angle, instant.errors, &slopes, out);
        let [torque, inertia] = equation.at_drive(instant.drive_speed, 0.0);
        AtDrive { torque, inertia }
    }

    /// Fills in, for `n + 1` shafts, the angles of all shaft ends relative to the drive in rad
    /// (`n + 1`, 2), their speeds in rad/s (`n + 1`, 2) and the torques of the compliant shafts in
    /// N m.
    pub fn motion(&self, instant: Instant<'_>, out: &mut [f64]) {
        let (mut equation, slopes) = self.in_time(instant);
        let Instant { drive_angle: angle, errors, .. } = instant;
        let (ends, mut pieces) = (2 * self.shafts(), vec![]);
        out[2 * ends..].copy_from_slice(equation.torques(angle, errors, &slopes));
        let unaccelerated = vec![0.0; self.compliant()];
        equation.pieces(angle, [errors, &slopes, &unaccelerated], &mut pieces);
        self.shaft_ends(&pieces, |end, [error, speed, _]| {
            (out[end], out[ends + end]) = (error, speed);
        });
    }

    /// Fills in angles and speeds, as in [`Instant`], of shafts that move as if they were rigid and
    /// twisted by their static torques, at the drive angle 0. The drive speed is in rad/s, the load
    /// torque in N m.
    pub fn rigid_state(
        &self,
        drive_speed: f64,
        load_torque: f64,
        errors: &mut [f64],
        speeds: &mut [f64],
    ) {
        let mut accelerations = vec![0.0; self.compliant()];
        let equation = MotionEquation::in_time(self, drive_speed, load_torque);
        equation.rigid(0.0, [errors, speeds, &mut accelerations]);
        for slope in speeds {
            *slope += 1.0;
        }
    }

    /// The equations with the time as the independent variable, and the slopes that belong to the
    /// speeds.
    fn in_time(&self, instant: Instant<'_>) -> (MotionEquation<'_>, Vec<f64>) {
        let equation = MotionEquation::in_time(self, instant.drive_speed, instant.load_torque);
        (equation, instant.speeds.iter().map(|speed| speed - 1.0).collect())
    }
}
