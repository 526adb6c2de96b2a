//! The oracle of torsional vibration: the equations in time, joint by joint, and their integration.
//!
//! Each joint turns its driven shaft by `tan ψ = tan φ/cos β`; no joints are folded. Half a turn of the
//! drive is integrated by the extrapolation of the midpoint rule (W. B. Gragg, 1965; R. Bulirsch and
//! J. Stoer, 1966), and the periodic orbit is corrected by Newton's method on the state at its start.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::space::solved;
use crate::wide::Wide;

/// A driveline with compliant shafts.
#[derive(Clone, Debug)]
pub(crate) struct VibratingDriveline {
    pub(crate) bends: Vec<f64>,
    pub(crate) twists: Vec<f64>,
    pub(crate) phases: Vec<f64>,
    /// At the input end and the output end of each shaft.
    pub(crate) inertias: Vec<f64>,
    pub(crate) stiffnesses: Vec<f64>,
    pub(crate) dampings: Vec<f64>,
    /// Constant torque, and torque per speed.
    pub(crate) load: [f64; 2],
}

/// A shaft end that follows the angle of the piece to which it belongs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EndAngle {
    piece: usize,
    angle: f64,
    /// The derivative of its angle by that of the piece, and the second one.
    ratio: f64,
    slope: f64,
}

/// A driveline at an instant.
#[derive(Clone, Debug, Default)]
pub(crate) struct VibrationInstant {
    pub(crate) ends: Vec<EndAngle>,
    /// Of the compliant shafts.
    pub(crate) torques: Vec<f64>,
    /// Of each piece, and its derivative by the angle.
    inertias: Vec<[f64; 2]>,
    /// Of each piece: the ratio behind its last joint.
    exits: Vec<f64>,
}

impl VibrationInstant {
    /// The torque that keeps the speed of the drive.
    pub(crate) fn drive_torque(&self, speed: f64) -> f64 {
        self.exits[0] * self.torques[0] + 0.5 * self.inertias[0][1] * speed * speed
    }
}

/// Angles of the drive and of the output ends of compliant shafts, then their speeds. Those of the
/// ends are relative to the drive: the extrapolation multiplies what is rounded by about 100.
pub(crate) type VibrationState = Vec<f64>;

/// Angles and speeds of the pieces, the first the drive's, of a state.
pub(crate) fn motion_of_pieces(state: &[f64]) -> [Vec<f64>; 2] {
    let (angles, speeds) = state.split_at(state.len() / 2);
    [angles, speeds].map(|of| {
        let ends = of[1..].iter().map(|relative| of[0] + relative);
        std::iter::once(of[0]).chain(ends).collect()
    })
}

impl VibratingDriveline {
    pub(crate) fn unknowns(&self) -> usize {
        self.stiffnesses.iter().filter(|c| c.is_finite()).count()
    }

    /// From the angles of the pieces, the first the drive's, and their speeds.
    pub(crate) fn at(&self, angles: &[f64], speeds: &[f64]) -> VibrationInstant {
        let mut found = VibrationInstant::default();
        let mut end = EndAngle { piece: 0, angle: angles[0], ratio: 1.0, slope: 0.0 };
        let mut own = [0.0; 2];
        let mut carry = |end: EndAngle, inertia: f64, own: &mut [f64; 2]| {
            own[0] += inertia * end.ratio * end.ratio;
            own[1] += 2.0 * inertia * end.ratio * end.slope;
            found.ends.push(end);
        };
        for (shaft, &stiffness) in self.stiffnesses.iter().enumerate() {
            carry(end, self.inertias[2 * shaft], &mut own);
            if stiffness.is_finite() {
                let piece = end.piece + 1;
                let twist = end.angle - angles[piece];
                let rate = end.ratio * speeds[end.piece] - speeds[piece];
                found.torques.push(stiffness * twist + self.dampings[shaft] * rate);
                found.inertias.push(std::mem::take(&mut own));
                found.exits.push(end.ratio);
                end = EndAngle { piece, angle: angles[piece], ratio: 1.0, slope: 0.0 };
            }
            carry(end, self.inertias[2 * shaft + 1], &mut own);
            if let Some(&bend) = self.bends.get(shaft) {
                end = behind_joint(end, bend);
                if let (Some(phase), Some(twist)) = (self.phases.get(shaft), self.twists.get(shaft))
                {
                    end.angle += phase - twist + FRAC_PI_2;
                }
            }
        }
        found.inertias.push(own);
        found.exits.push(end.ratio);
        found
    }

    /// The accelerations of the pieces at constant speed of the drive.
    pub(crate) fn accelerations(&self, at: &VibrationInstant, speeds: &[f64]) -> Vec<f64> {
        let last = at.torques.len();
        let behind = |piece: usize| match at.torques.get(piece) {
            Some(torque) => *torque,
            None => self.load[0] + self.load[1] * at.exits[last] * speeds[last],
        };
        let piece = |piece: usize| {
            let [inertia, slope] = at.inertias[piece];
            let driving = at.torques[piece - 1] - at.exits[piece] * behind(piece);
            (driving - 0.5 * slope * speeds[piece] * speeds[piece]) / inertia
        };
        std::iter::once(0.0).chain((1..=last).map(piece)).collect()
    }

    /// Of each shaft end: the mean over a turn by which it is ahead of the drive if all turns slowly,
    /// and that of each piece.
    pub(crate) fn leads(&self) -> (Vec<f64>, Vec<f64>) {
        const SAMPLES: usize = 1024;
        let pieces = self.unknowns() + 1;
        let still = vec![0.0; pieces];
        let (mut of_ends, mut of_pieces) = (vec![0.0; self.inertias.len()], vec![0.0; pieces]);
        for i in 0..SAMPLES {
            let angle = TAU * i as f64 / SAMPLES as f64;
            // Without twist a piece begins where the shaft before it ends; one after the other.
            let mut angles = vec![angle; pieces];
            for _ in 1..pieces {
                for ends in self.at(&angles, &still).ends.chunks(2) {
                    if ends[1].piece > ends[0].piece {
                        angles[ends[1].piece] = ends[0].angle;
                    }
                }
            }
            for (sum, end) in of_ends.iter_mut().zip(&self.at(&angles, &still).ends) {
                *sum += (end.angle - angle) / SAMPLES as f64;
            }
            for (sum, own) in of_pieces.iter_mut().zip(&angles) {
                *sum += (own - angle) / SAMPLES as f64;
            }
        }
        (of_ends, of_pieces)
    }

    /// Derivatives of a state by time.
    fn rates(&self, state: &[f64]) -> VibrationState {
        let [angles, speeds] = motion_of_pieces(state);
        let at = self.at(&angles, &speeds);
        let rates = state[state.len() / 2..].iter().copied();
        rates.chain(self.accelerations(&at, &speeds)).collect()
    }

    /// The state after a time, in so many steps.
    pub(crate) fn after(&self, state: &[f64], time: f64, steps: usize) -> VibrationState {
        let width = time / steps as f64;
        (0..steps).fold(state.to_vec(), |state, _| self.extrapolated(&state, width))
    }

    /// One step: the midpoint rule with 2, 4, … 16 parts, extrapolated to none.
    fn extrapolated(&self, state: &[f64], width: f64) -> VibrationState {
        const RULES: usize = 8;
        let plus = |a: &[f64], b: &[f64], factor: f64| -> VibrationState {
            a.iter().zip(b).map(|(a, b)| b.mul_add(factor, *a)).collect()
        };
        let start = self.rates(state);
        let parts = |rule: usize| 2.0 * (rule + 1) as f64;
        // The last row of Neville's table, finest rule first.
        let mut table: Vec<VibrationState> = vec![];
        for rule in 0..RULES {
            let part = width / parts(rule);
            let (mut before, mut now) = (state.to_vec(), plus(state, &start, part));
            for _ in 1..2 * (rule + 1) {
                let next = plus(&before, &self.rates(&now), 2.0 * part);
                before = std::mem::replace(&mut now, next);
            }
            // Changes, so that few digits are lost.
            let mut row = vec![plus(&now, state, -1.0)];
            for (order, coarse) in table.iter().enumerate() {
                let gain = (parts(rule) / parts(rule - order - 1)).powi(2) - 1.0;
                let fine = &row[order];
                row.push(plus(fine, &plus(fine, coarse, -1.0), 1.0 / gain));
            }
            table = row;
        }
        plus(state, &table[RULES - 1], 1.0)
    }

    /// The map of half a turn of the drive on the unknowns and their speeds, by differences, and the
    /// state corrected by one step of Newton's method.
    pub(crate) fn closed(
        &self,
        state: &[f64],
        time: f64,
        steps: usize,
    ) -> (Vec<Vec<f64>>, VibrationState) {
        const STEP: f64 = 1e-3;
        let pieces = state.len() / 2;
        let unknown: Vec<usize> = (1..pieces).chain(pieces + 1..2 * pieces).collect();
        let speed = state[pieces];
        let map = |state: &[f64]| -> Vec<f64> {
            let after = self.after(state, time, steps);
            unknown.iter().map(|&i| after[i]).collect()
        };
        let column = |&i: &usize| -> Vec<f64> {
            let step = if i < pieces { STEP } else { STEP * speed };
            let at = |count: f64| {
                let mut moved = state.to_vec();
                moved[i] += count * step;
                map(&moved)
            };
            let [near, opposite, far, beyond] = [1.0, -1.0, 2.0, -2.0].map(at);
            let slope =
                |k: usize| (8.0 * (near[k] - opposite[k]) - (far[k] - beyond[k])) / (12.0 * step);
            (0..unknown.len()).map(slope).collect()
        };
        let columns: Vec<Vec<f64>> = unknown.iter().map(column).collect();
        let after = map(state);
        let defect = |k: usize| after[k] - state[unknown[k]];
        let row = |k: usize| -> Vec<Wide> {
            let entry = |c: usize| Wide::from(f64::from(u8::from(k == c)) - columns[c][k]);
            (0..unknown.len()).map(entry).chain([Wide::from(defect(k))]).collect()
        };
        let change = &solved((0..unknown.len()).map(row).collect())[0];
        let mut corrected = state.to_vec();
        for (&i, change) in unknown.iter().zip(change) {
            corrected[i] += change.high;
        }
        (columns, corrected)
    }
}

impl EndAngle {
    /// Angle, speed and acceleration, from the speeds and accelerations of the pieces.
    pub(crate) fn motion(&self, speeds: &[f64], accelerations: &[f64]) -> [f64; 3] {
        let speed = speeds[self.piece];
        let acceleration = self.ratio * accelerations[self.piece] + self.slope * speed * speed;
        [self.angle, self.ratio * speed, acceleration]
    }
}

/// The shaft end behind a joint with this bend.
fn behind_joint(end: EndAngle, bend: f64) -> EndAngle {
    let ((s, c), (sin, cos)) = (end.angle.sin_cos(), bend.sin_cos());
    let across = 1.0 - sin * sin * c * c;
    let versine = 2.0 * (0.5 * bend).sin().powi(2);
    let (ratio, slope) = (cos / across, -2.0 * cos * sin * sin * s * c / (across * across));
    EndAngle {
        piece: end.piece,
        angle: end.angle + (versine * s * c).atan2(cos * c * c + s * s),
        ratio: ratio * end.ratio,
        slope: slope * end.ratio * end.ratio + ratio * end.slope,
    }
}
