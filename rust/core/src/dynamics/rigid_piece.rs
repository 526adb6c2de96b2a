//! Rigid pieces: the joints and rigid shafts that follow one angle.

use std::f64::consts::TAU;

use crate::mechanics::chain::{Transfer, shaft_turn};
use crate::mechanics::joint::Joint;
use crate::mechanics::transmission::Ideal;
use crate::number::elementary::atan2;
use crate::number::trig;

/// The joints and rigid shafts between the output end of one compliant shaft and the input end of
/// the next. Together they are one equivalent joint `F` with an inertia that varies with the angle
/// of the piece.
#[derive(Clone, Debug)]
pub(super) struct RigidPiece {
    /// `arg A` of the map `w → A w + B w̄` from the drive to the piece, if all shafts are rigid.
    /// Without it the piece would begin at a wrong angle.
    pub(super) offset: f64,
    /// The same without the phase of the piece's own shaft: the angle of harmonic torques on it.
    pub(super) pin: f64,
    /// Bends of the joints, twists and phases of the shafts behind them, in rad.
    geometry: [Vec<f64>; 3],
    /// The inertia that turns with the piece's angle itself.
    pub(super) own_inertia: f64,
    pub(super) followers: Vec<Follower>,
    pub(super) harmonics: Vec<Harmonic>,
}

/// A torque that varies with the angle of a shaft end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Harmonic {
    /// The follower to which the end belongs; none for the piece's first shaft.
    pub(super) follower: Option<usize>,
    /// How often it repeats in a turn of the shaft.
    pub(super) order: f64,
    /// Torque in N m at the angle 0 of the shaft, and a quarter of a period later.
    pub(super) parts: [f64; 2],
}

/// The shaft behind a joint of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follower {
    /// How it follows the piece.
    pub(super) ideal: Ideal,
    /// `arg A` from the drive to the piece and from there to the shaft, less that from the drive to
    /// the shaft.
    pub(super) offset: f64,
    /// `arg A` from the drive to the shaft, without its own phase.
    pub(super) pin: f64,
    /// The inertia fixed to it.
    pub(super) inertia: f64,
}

/// Motion of a piece at one angle. Derivatives are with respect to the piece's angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct PieceMotion {
    /// Angle of the piece's output minus the piece's angle, both without the mean of rigid shafts,
    /// in rad.
    pub(super) angle_error: f64,
    /// First derivative of the output's angle.
    pub(super) ratio: f64,
    /// Second derivative.
    pub(super) ratio_slope: f64,
    /// The inertia as it acts on the piece's angle, in kg m².
    pub(super) inertia: f64,
    /// Its first derivative.
    pub(super) inertia_slope: f64,
    /// Its second derivative.
    pub(super) inertia_curvature: f64,
    /// The harmonic torques as they act on the piece's angle, in N m.
    pub(super) torque: f64,
}

impl RigidPiece {
    /// A piece from the bends of its joints, the twists and phases of the shafts behind each of
    /// them but the last of the driveline, the inertia of its first shaft and those of the shafts
    /// behind its joints. The map from the drive is continued to the end of the piece; the piece
    /// before it has its first shaft as its last one.
    pub(super) fn new(
        from_drive: &mut Transfer,
        before: Option<&Self>,
        geometry: [Vec<f64>; 3],
        own_inertia: f64,
        inertias: &[f64],
    ) -> Self {
        let offset = argument(from_drive);
        let [bends, twists, phases] = &geometry;
        let mut from_piece = Transfer::default();
        let follower = |(j, (&bend, &inertia)): (usize, (&f64, &f64))| {
            let joint = Joint::with_error_terms(bend);
            from_drive.pass_joint(&joint);
            let pin = argument(from_drive);
            from_piece.pass_joint(&joint);
            let excess = offset + argument(&from_piece) - argument(from_drive);
            if let (Some(&twist), Some(&phase)) = (twists.get(j), phases.get(j)) {
                let turn = shaft_turn(phase, twist);
                from_drive.pass_shaft(turn);
                from_piece.pass_shaft(turn);
            }
            Follower {
                ideal: Ideal::of_chain(&bends[..=j], &twists[..j], &phases[..j]),
                offset: excess - TAU * (excess / TAU).round(),
                pin,
                inertia,
            }
        };
        let followers = bends.iter().zip(inertias).enumerate().map(follower).collect();
        let pin =
            before.map_or(0.0, |piece| piece.followers.last().map_or(piece.pin, |own| own.pin));
        Self { offset, pin, geometry, own_inertia, followers, harmonics: vec![] }
    }

    /// The piece with this share of every bend and of every harmonic torque.
    pub(super) fn bent(
        &self,
        share: f64,
        from_drive: &mut Transfer,
        before: Option<&Self>,
    ) -> Self {
        let [bends, twists, phases] = self.geometry.clone();
        let bends = bends.iter().map(|bend| share * bend).collect();
        let inertias: Vec<f64> = self.followers.iter().map(|follower| follower.inertia).collect();
        let mut bent =
            Self::new(from_drive, before, [bends, twists, phases], self.own_inertia, &inertias);
        let scaled = |own: &Harmonic| Harmonic { parts: own.parts.map(|x| share * x), ..*own };
        bent.harmonics = self.harmonics.iter().map(scaled).collect();
        bent
    }

    /// Whether nothing turns with the piece.
    pub(super) fn has_no_inertia(&self) -> bool {
        self.own_inertia == 0.0 && self.followers.iter().all(|follower| follower.inertia == 0.0)
    }

    /// The motion at an angle of the piece in rad.
    pub(super) fn motion(&self, angle: f64) -> PieceMotion {
        let mut found = PieceMotion {
            angle_error: 0.0,
            ratio: 1.0,
            ratio_slope: 0.0,
            inertia: self.own_inertia,
            inertia_slope: 0.0,
            inertia_curvature: 0.0,
            torque: self.torque_of(None, angle - self.offset + self.pin),
        };
        let last = self.followers.len().wrapping_sub(1);
        for (i, follower) in self.followers.iter().enumerate() {
            let &Follower { ideal, offset, inertia, .. } = follower;
            if inertia == 0.0 && i != last && !self.turns_at(i) {
                continue;
            }
            let motion = ideal.motion(angle);
            let (r, a, j) = (motion.speed_ratio, motion.acceleration_ratio, motion.jerk_ratio);
            // The kinetic energy of the follower is ½ J r² times the square of the piece's speed.
            found.inertia += inertia * r * r;
            found.inertia_slope += 2.0 * inertia * r * a;
            found.inertia_curvature += 2.0 * inertia * (a * a + r * j);
            let pin = angle - self.offset + motion.angle_error + offset + follower.pin;
            found.torque += r * self.torque_of(Some(i), pin);
            if i == last {
                found.angle_error = motion.angle_error + offset;
                (found.ratio, found.ratio_slope) = (r, a);
            }
        }
        found
    }

    /// Whether a harmonic torque acts on a follower.
    pub(super) fn turns_at(&self, follower: usize) -> bool {
        self.harmonics.iter().any(|harmonic| harmonic.follower == Some(follower))
    }

    /// The harmonic torque on a shaft of the piece at its angle, in N m.
    fn torque_of(&self, follower: Option<usize>, angle: f64) -> f64 {
        let own = self.harmonics.iter().filter(|harmonic| harmonic.follower == follower);
        let at = |&Harmonic { order, parts: [cosine, sine], .. }: &Harmonic| {
            let (s, c) = trig::sin_cos(order * angle);
            cosine * c + sine * s
        };
        own.map(at).sum()
    }

    /// Angle error, speed ratio and its slope of every shaft behind a joint of the piece.
    pub(super) fn followers(&self, angle: f64) -> impl Iterator<Item = [f64; 3]> {
        self.followers.iter().map(move |follower| {
            let motion = follower.ideal.motion(angle);
            [motion.angle_error + follower.offset, motion.speed_ratio, motion.acceleration_ratio]
        })
    }
}

/// `arg A` of a map.
fn argument(transfer: &Transfer) -> f64 {
    atan2(transfer.a.im.value(), transfer.a.re.value())
}
