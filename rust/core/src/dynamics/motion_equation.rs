//! Lagrange's equations of the unknown angles, with the drive angle as the independent variable.
//!
//! Unknown `s` turns by `θ_s = α + κ_s + y_s`, with the drive angle `α = Ω t` and the offset `κ_s`
//! of the piece. Primes of `I` and `ρ` are derivatives by the angle of the
//! piece, dots by time:
//!
//! `I_s θ̈_s + ½ I_s′ θ̇_s² = T_s − ρ_s T_{s+1}`,
//! `T_s = c_s (F_{s−1}(θ_{s−1}) − θ_s) + d_s (ρ_{s−1} θ̇_{s−1} − θ̇_s)`,
//!
//! and behind the last unknown the load `T_L + b_L ρ_s θ̇_s` (derived here from Lagrange's
//! equations of the second kind). A harmonic torque `T` at a shaft end that turns `ρ` times as fast
//! as the piece adds `ρ T`. A free drive is one more unknown, with the number 0 and the torque
//! `T_0 − s (θ̇_0 − Ω)` before it.

use crate::dynamics::rigid_piece::PieceMotion;
use crate::dynamics::system::{Drive, PieceState, TorsionalSystem};

/// The equations at one speed of the drive.
pub(super) struct MotionEquation<'a> {
    pub(super) system: &'a TorsionalSystem,
    /// Speed of the drive in rad/s; 1 rad/s if the independent variable is the time.
    pub(super) speed: f64,
    /// Derivative of the drive angle by the independent variable.
    drive_slope: f64,
    /// Constant braking torque on the last shaft in N m.
    load_torque: f64,
    /// The slope of the torque of a drive whose angle is an unknown, and its mean in N m.
    drive: Option<[f64; 2]>,
    motions: Vec<PieceMotion>,
    torques: Vec<f64>,
    /// Torques that constant loss factors add, which do not follow from one angle.
    pub(super) added: Vec<f64>,
}

impl<'a> MotionEquation<'a> {
    /// The mean torque in N m is that of a free drive.
    pub(super) fn new(system: &'a TorsionalSystem, speed: f64, mean_torque: f64) -> Self {
        let size = system.springs.len();
        let drive = match system.drive {
            Drive::Held => None,
            Drive::Free { slope } => Some([slope, mean_torque]),
        };
        Self {
            system,
            speed,
            drive_slope: 1.0,
            load_torque: system.load_torque,
            drive,
            motions: Vec::with_capacity(size + 1),
            torques: vec![0.0; size],
            added: vec![0.0; size],
        }
    }

    /// The equations with the time in s as the independent variable, at one instant: the drive turns
    /// at this speed in rad/s, and the load is this torque in N m. The slopes of the unknowns, those
    /// behind compliant shafts, are then `θ̇_s − 1 rad/s`.
    pub(super) fn in_time(system: &'a TorsionalSystem, drive_slope: f64, load_torque: f64) -> Self {
        Self { drive_slope, load_torque, drive: None, ..Self::new(system, 1.0, 0.0) }
    }

    /// Error, slope and curvature of a piece's angle.
    fn of_piece(&self, piece: usize, [y, v, a]: [&[f64]; 3]) -> [f64; 3] {
        match (piece + usize::from(self.drive.is_some())).checked_sub(1) {
            None => [0.0, self.drive_slope, 0.0],
            Some(u) => [y[u], 1.0 + v[u], a.get(u).copied().unwrap_or_default()],
        }
    }

    /// The unknowns if every shaft were rigid and turned by its static torque.
    pub(super) fn rigid(&self, angle: f64, [y, v, a]: [&mut [f64]; 3]) {
        let load = self.load(self.drive_slope);
        let (mut error, mut slope, mut curve) = (0.0, self.drive_slope, 0.0);
        for (s, spring) in self.system.springs.iter().enumerate() {
            let piece = &self.system.pieces[s];
            let motion = piece.motion(angle + piece.offset + error);
            error += motion.angle_error - spring.law.twist(load);
            curve = motion.ratio * curve + motion.ratio_slope * slope * slope;
            slope *= motion.ratio;
            (y[s], v[s], a[s]) = (error, slope - 1.0, curve);
        }
    }

    /// Finds the motion of every piece and the torque of every compliant shaft.
    fn prepare(&mut self, angle: f64, y: &[f64], v: &[f64]) {
        let system = self.system;
        self.motions.clear();
        for (p, piece) in system.pieces.iter().enumerate() {
            let [error, ..] = self.of_piece(p, [y, v, &[]]);
            self.motions.push(piece.motion(angle + piece.offset + error));
        }
        for (s, spring) in system.springs.iter().enumerate() {
            let [before, slope, _] = self.of_piece(s, [y, v, &[]]);
            let [own, own_slope, _] = self.of_piece(s + 1, [y, v, &[]]);
            let motion = &self.motions[s];
            let twist = before + motion.angle_error - own;
            let rate = self.speed * (motion.ratio * slope - own_slope);
            self.torques[s] = spring.torque(twist, rate) + self.added[s];
        }
    }

    /// The torque of every compliant shaft at a drive angle, from the unknowns and their slopes.
    pub(super) fn torques(&mut self, angle: f64, y: &[f64], v: &[f64]) -> &[f64] {
        self.prepare(angle, y, v);
        &self.torques
    }

    /// The torques at the drive angle at which the equations were last evaluated.
    pub(super) fn last_torques(&self) -> &[f64] {
        &self.torques
    }

    /// The second derivatives of the unknowns at a drive angle, from the unknowns and their slopes.
    pub(super) fn accelerations(&mut self, angle: f64, y: &[f64], v: &[f64], out: &mut [f64]) {
        self.prepare(angle, y, v);
        let square = self.speed * self.speed;
        let first = usize::from(self.drive.is_none());
        for (u, acceleration) in out.iter_mut().enumerate() {
            let p = u + first;
            let own = &self.motions[p];
            let slope = 1.0 + v[u];
            let before = match (p.checked_sub(1), self.drive) {
                (Some(s), _) => self.torques[s],
                (None, Some([fall, mean])) => mean - fall * self.speed * v[u],
                (None, None) => 0.0,
            };
            let behind =
                self.torques.get(p).copied().unwrap_or_else(|| self.load(own.ratio * slope));
            let torque = before - own.ratio * behind + own.torque;
            let inertial = torque - 0.5 * square * own.inertia_slope * slope * slope;
            *acceleration = inertial / (square * own.inertia);
        }
    }

    /// The torque of the load, from the derivative of the last shaft's angle.
    fn load(&self, slope: f64) -> f64 {
        self.load_torque + self.system.load_damping * self.speed * slope
    }

    /// Load of the drive: the torque in N m that gives it an acceleration, beside harmonic
    /// torques, and the inertia in kg m² of the shafts before the first compliant one, at the angle
    /// of the last evaluation. The slope of its angle and the second derivative are given.
    pub(super) fn at_drive(&self, slope: f64, curvature: f64) -> [f64; 2] {
        let PieceMotion { ratio, inertia, inertia_slope, torque, .. } = self.motions[0];
        let rate = self.speed * slope;
        let varying = 0.5 * inertia_slope * rate * rate - torque;
        let accelerating = inertia * self.speed * self.speed * curvature;
        [ratio * self.torques[0] + varying + accelerating, inertia]
    }

    /// The state of every piece, for the motion of shaft ends.
    pub(super) fn pieces(&self, angle: f64, state: [&[f64]; 3], out: &mut Vec<PieceState>) {
        out.clear();
        out.extend(self.system.pieces.iter().enumerate().map(|(p, piece)| {
            let [error, slope, curvature] = self.of_piece(p, state);
            PieceState { angle: angle + piece.offset + error, error, slope, curvature }
        }));
    }
}
