//! The equations of [`motion_equation`](super::motion_equation) for several runs side by side, at
//! given mean speeds of the drive, with their derivatives.
#![allow(clippy::needless_range_loop, reason = "as in the kernels")]

use std::ops::Range;

use crate::dynamics::gauss::{COLLOCATION, STAGES};
use crate::dynamics::lanes::{LANES, Lanes, Pack, ZERO, all, make_room};
use crate::dynamics::newton::{EquationRow, Equations, Newton};
use crate::dynamics::rigid_piece::Harmonic;
use crate::dynamics::system::{Drive, Spring, TorsionalSystem};
use crate::mechanics::chain::Equivalent;
use crate::mechanics::joint::{self, JointConstants};
use crate::number::atan::Atan;
use crate::number::reduction;
use crate::number::trig;

/// The equations of several runs.
#[derive(Debug, Default)]
pub(super) struct RunsSideBySide {
    pub(super) pieces: Vec<Piece>,
    pub(super) followers: Vec<FollowerPack>,
    pub(super) springs: Vec<SpringPack>,
    load_torque: Pack,
    load_damping: Pack,
    /// Whether the drive is free.
    pub(super) free: bool,
    /// A free drive: its mean torque as the preload and its slope as the damping.
    drive: SpringPack,
    /// Half turns of the drive in a period.
    half_turns: usize,
    square: Pack,
    motions: Vec<PieceMotionPack>,
    pub(super) torques: Vec<Pack>,
    /// The twists, and their rates relative to the drive's mean speed.
    pub(super) twists: Vec<Pack>,
    pub(super) rates: Vec<Pack>,
    /// The largest torque of every compliant shaft.
    largest: Vec<Pack>,
}

/// A rigid piece of every run.
#[derive(Debug)]
pub(super) struct Piece {
    pub(super) offset: Pack,
    pin: Pack,
    own_inertia: Pack,
    pub(super) followers: Range<usize>,
    harmonics: Vec<HarmonicPack>,
}

/// A harmonic torque of every run.
#[derive(Debug)]
struct HarmonicPack {
    /// As of [`Harmonic`].
    follower: Option<usize>,
    order: f64,
    parts: [Pack; 2],
}

/// The shaft behind a joint of a piece.
#[derive(Clone, Debug, Default)]
pub(super) struct FollowerPack {
    cos: Pack,
    cos2: Pack,
    sin2: Pack,
    versine: Pack,
    inverse_cos: Pack,
    turn_cos: Pack,
    turn_sin: Pack,
    pub(super) offset: Pack,
    pin: Pack,
    inertia: Pack,
    /// Whether it moves nothing, in every run: neither an inertia nor what is behind the piece nor a
    /// harmonic torque.
    idle: bool,
}

/// A compliant shaft in a range of twists, with its damping times the speed of the drive.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SpringPack {
    pub(super) stiffness: Pack,
    pub(super) preload: Pack,
    pub(super) damping: Pack,
}

impl SpringPack {
    /// Takes the law of a range of twists in a lane.
    fn enter(&mut self, l: usize, spring: &Spring, range: usize, speed: f64) {
        let branch = spring.law.in_range(range);
        (self.stiffness[l], self.preload[l]) = (branch.stiffness, branch.preload);
        self.damping[l] = spring.damping * branch.damping * speed;
    }
}

/// As of the rigid piece of one run.
#[derive(Clone, Copy, Debug, Default)]
struct PieceMotionPack {
    angle_error: Pack,
    ratio: Pack,
    ratio_slope: Pack,
    inertia: Pack,
    inertia_slope: Pack,
    inertia_curvature: Pack,
}

impl HarmonicPack {
    /// The torque in a lane at the angle of its shaft, and its slope.
    #[inline(always)]
    fn at(&self, l: usize, angle: f64) -> [f64; 2] {
        let (s, c) = trig::sin_cos_reduced::<f64>(reduction::reduce(self.order * angle));
        let [cosine, sine] = [self.parts[0][l], self.parts[1][l]];
        [cosine.mul_add(c, sine * s), self.order * sine.mul_add(c, -(cosine * s))]
    }
}

impl FollowerPack {
    /// Angle of the shaft minus that of the piece, both without the mean of rigid shafts, speed
    /// ratio and its first two derivatives in a lane, from sine and cosine of the piece's angle.
    #[inline(always)]
    fn motion(&self, l: usize, s: f64, c: f64) -> [f64; 4] {
        let (turn_cos, turn_sin) = (self.turn_cos[l], self.turn_sin[l]);
        let (s, c) = (s.mul_add(turn_cos, c * turn_sin), c.mul_add(turn_cos, -(s * turn_sin)));
        let joint = JointConstants {
            cos: self.cos[l],
            cos2: self.cos2[l],
            sin2: self.sin2[l],
            versine: self.versine[l],
            inverse_exsecant: 0.0,
        };
        let (tangent, (ratio, slope)) = joint::motion(&joint, s, c);
        let error = f64::atan_any(tangent, 1.0) + self.offset[l];
        // The ratio r is cos β/D with D = s² + cos² β c². With t = −D′/D its derivatives are t r and
        // (2 t² − D″/D) r. Only derivatives of the equations need the second one.
        let share = 2.0 * self.sin2[l] * self.inverse_cos[l] * ratio;
        let t = share * s * c;
        let curvature = share.mul_add(s.mul_add(s, -(c * c)), 2.0 * t * t);
        [error, ratio, slope, curvature * ratio]
    }

    /// Its angle error alone.
    #[inline(always)]
    pub(super) fn angle_error(&self, lanes: Lanes, [sines, cosines]: &[Pack; 2]) -> Pack {
        let mut found = ZERO;
        for l in lanes.each() {
            let [error, ..] = self.motion(l, sines[l], cosines[l]);
            found[l] = error;
        }
        found
    }
}

/// Sines and cosines of the angle of a piece, from the drive angle and from its error.
#[inline(always)]
pub(super) fn sines(lanes: Lanes, angle: f64, offset: &Pack, error: &Pack) -> [Pack; 2] {
    let (mut sines, mut cosines) = (ZERO, ZERO);
    for l in lanes.each() {
        let reduced = reduction::reduce(angle + offset[l] + error[l]);
        let (s, c) = trig::sin_cos_reduced::<f64>(reduced);
        (sines[l], cosines[l]) = (s, c);
    }
    [sines, cosines]
}

impl RunsSideBySide {
    /// Takes the equations of runs: systems of the same shape, and speeds. The last one also fills
    /// the lanes that are left.
    pub(super) fn load(&mut self, runs: &[(&TorsionalSystem, f64)]) {
        let run = |l: usize| runs[l.min(runs.len() - 1)];
        let (first, _) = run(0);
        let m = first.compliant();
        (self.free, self.half_turns) = (first.is_free(), first.half_turns);
        self.pieces.clear();
        self.followers.clear();
        for (p, piece) in first.pieces.iter().enumerate() {
            let start = self.followers.len();
            self.followers.resize(start + piece.followers.len(), FollowerPack::default());
            let (mut offset, mut pin, mut own_inertia) = (ZERO, ZERO, ZERO);
            for l in 0..LANES {
                let own = &run(l).0.pieces[p];
                (offset[l], pin[l], own_inertia[l]) = (own.offset, own.pin, own.own_inertia);
                for (place, of) in self.followers[start..].iter_mut().zip(&own.followers) {
                    let Equivalent { joint, turn_cos, turn_sin } = of.ideal.equivalent();
                    (place.cos[l], place.cos2[l]) = (joint.cos, joint.cos2);
                    (place.sin2[l], place.versine[l]) = (joint.sin2, joint.versine);
                    place.inverse_cos[l] = 1.0 / joint.cos;
                    (place.turn_cos[l], place.turn_sin[l]) = (*turn_cos, *turn_sin);
                    (place.offset[l], place.inertia[l]) = (of.offset, of.inertia);
                    place.pin[l] = of.pin;
                }
            }
            if let [others @ .., _] = &mut self.followers[start..] {
                for (i, follower) in others.iter_mut().enumerate() {
                    follower.idle = follower.inertia == ZERO && !piece.turns_at(i);
                }
            }
            let followers = start..self.followers.len();
            let harmonic = |(i, &Harmonic { follower, order, .. }): (usize, &Harmonic)| {
                let mut parts = [ZERO; 2];
                for l in 0..LANES {
                    let own = &run(l).0.pieces[p].harmonics[i];
                    (parts[0][l], parts[1][l]) = (own.parts[0], own.parts[1]);
                }
                HarmonicPack { follower, order, parts }
            };
            let harmonics = piece.harmonics.iter().enumerate().map(harmonic).collect();
            self.pieces.push(Piece { offset, pin, own_inertia, followers, harmonics });
        }
        self.motions.resize(m + 1, PieceMotionPack::default());
        make_room(&mut self.torques, m);
        make_room(&mut self.rates, m);
        make_room(&mut self.twists, m);
        self.largest.clear();
        make_room(&mut self.largest, m);
        self.springs.resize(m, SpringPack::default());
        for l in 0..LANES {
            let (system, speed) = run(l);
            self.load_torque[l] = system.load_torque;
            self.load_damping[l] = system.load_damping * speed;
            self.square[l] = speed * speed;
            self.drive.damping[l] = match system.drive {
                Drive::Held => 0.0,
                Drive::Free { slope } => slope * speed,
            };
            let load = system.static_load(speed);
            for (place, spring) in self.springs.iter_mut().zip(&system.springs) {
                place.enter(l, spring, spring.law.range_at(load), speed);
            }
        }
    }

    /// Takes the law of a range of twists of a compliant shaft in every lane.
    pub(super) fn enter(&mut self, s: usize, spring: &Spring, range: usize, speed: f64) {
        (0..LANES).for_each(|l| self.springs[s].enter(l, spring, range, speed));
    }

    /// Lets the torque of a free drive fall with its slope by so much more, in N m.
    pub(super) fn govern(&mut self, torque: f64) {
        (0..LANES).for_each(|l| self.drive.damping[l] += torque);
    }

    /// The number of unknown angles.
    pub(super) fn unknowns(&self) -> usize {
        self.springs.len() + usize::from(self.free)
    }

    /// The orbits on meshes of so many intervals if every shaft were rigid and turned by its static
    /// torque.
    #[inline(always)]
    pub(super) fn rigid(&self, lanes: Lanes, newton: &mut Newton, intervals: usize) {
        let (m, free) = (self.unknowns(), usize::from(self.free));
        newton.half_turns = self.half_turns;
        make_room(&mut newton.states, 2 * m * intervals);
        make_room(&mut newton.accelerations, STAGES * m * intervals);
        let width = newton.width(intervals);
        let mut load = ZERO;
        for l in lanes.each() {
            load[l] = self.load_damping[l] + self.load_torque[l];
        }
        newton.mean_torque = load;
        for point in 0..intervals * (1 + STAGES) {
            let (k, stage) = (point / (1 + STAGES), (point % (1 + STAGES)).checked_sub(1));
            let node = stage.map_or(0.0, |i| COLLOCATION.nodes[i]);
            let angle = width * (k as f64 + node);
            let (mut error, mut slope, mut curve) = (ZERO, all(1.0), ZERO);
            for s in 0..self.springs.len() {
                let piece = &self.pieces[s];
                let [sines, cosines] = sines(lanes, angle, &piece.offset, &error);
                let last = self.followers[piece.followers.clone()].last();
                for l in lanes.each() {
                    let spring = &self.springs[s];
                    error[l] -= (load[l] - spring.preload[l]) / spring.stiffness[l];
                }
                if let Some(follower) = last {
                    for l in lanes.each() {
                        let [own, r, a, _] = follower.motion(l, sines[l], cosines[l]);
                        error[l] += own;
                        curve[l] = r.mul_add(curve[l], a * slope[l] * slope[l]);
                        slope[l] *= r;
                    }
                }
                if let Some(i) = stage {
                    newton.accelerations[(k * STAGES + i) * m + s + free] = curve;
                } else {
                    newton.states[2 * k * m + s + free] = error;
                    for l in lanes.each() {
                        newton.states[(2 * k + 1) * m + s + free][l] = slope[l] - 1.0;
                    }
                }
            }
            if self.free && stage.is_none() {
                (newton.states[2 * k * m], newton.states[(2 * k + 1) * m]) = (ZERO, ZERO);
            } else if let (true, Some(i)) = (self.free, stage) {
                newton.accelerations[(k * STAGES + i) * m] = ZERO;
            }
        }
    }

    /// Finds the motion of every piece and the torque of every compliant shaft.
    #[inline(always)]
    pub(super) fn prepare(&mut self, lanes: Lanes, angle: f64, y: &[Pack], v: &[Pack]) {
        let free = usize::from(self.free);
        for (p, piece) in self.pieces.iter().enumerate() {
            let error = if p + free == 0 { &ZERO } else { &y[p + free - 1] };
            let mut found = PieceMotionPack {
                ratio: all(1.0),
                inertia: piece.own_inertia,
                ..PieceMotionPack::default()
            };
            let [sines, cosines] = sines(lanes, angle, &piece.offset, error);
            for follower in &self.followers[piece.followers.clone()] {
                if follower.idle {
                    continue;
                }
                for l in lanes.each() {
                    let [error, r, a, j] = follower.motion(l, sines[l], cosines[l]);
                    // The kinetic energy of the follower is ½ J r² times the square of the piece's
                    // speed.
                    let inertia = follower.inertia[l];
                    let double = 2.0 * inertia;
                    found.inertia[l] = (inertia * r).mul_add(r, found.inertia[l]);
                    found.inertia_slope[l] = (double * r).mul_add(a, found.inertia_slope[l]);
                    let curvature = a.mul_add(a, r * j);
                    found.inertia_curvature[l] =
                        double.mul_add(curvature, found.inertia_curvature[l]);
                    found.angle_error[l] = error;
                    (found.ratio[l], found.ratio_slope[l]) = (r, a);
                }
            }
            self.motions[p] = found;
        }
        for (s, spring) in self.springs.iter().enumerate() {
            let (before, slope) =
                if s + free == 0 { (ZERO, ZERO) } else { (y[s + free - 1], v[s + free - 1]) };
            let (own, own_slope) = (y[s + free], v[s + free]);
            let PieceMotionPack { angle_error, ratio, .. } = self.motions[s];
            let (mut torque, mut twists, mut rates) = (ZERO, ZERO, ZERO);
            for l in lanes.each() {
                let twist = before[l] + angle_error[l] - own[l];
                let rate = ratio[l].mul_add(1.0 + slope[l], -1.0) - own_slope[l];
                (twists[l], rates[l]) = (twist, rate);
                let varying = spring.damping[l].mul_add(rate, spring.preload[l]);
                torque[l] = spring.stiffness[l].mul_add(twist, varying);
            }
            self.torques[s] = torque;
            (self.twists[s], self.rates[s]) = (twists, rates);
        }
    }

    /// Takes the harmonic torques, as they act on the angles of the pieces, out of the equations.
    #[inline(always)]
    fn subtract_harmonics(&self, lanes: Lanes, angle: f64, y: &[Pack], rows: &mut [EquationRow]) {
        let first = usize::from(!self.free);
        for ((piece, error), row) in self.pieces[first..].iter().zip(y).zip(rows) {
            if piece.harmonics.is_empty() {
                continue;
            }
            let [sines, cosines] = sines(lanes, angle, &piece.offset, error);
            let (mut torques, mut slopes) = (ZERO, ZERO);
            for harmonic in &piece.harmonics {
                let (mut pins, mut ratios, mut ratio_slopes) = (ZERO, all(1.0), ZERO);
                if let Some(f) = harmonic.follower {
                    let follower = &self.followers[piece.followers.start + f];
                    for l in lanes.each() {
                        let [own, r, a, _] = follower.motion(l, sines[l], cosines[l]);
                        pins[l] = angle + error[l] + own + follower.pin[l];
                        (ratios[l], ratio_slopes[l]) = (r, a);
                    }
                } else {
                    for l in lanes.each() {
                        pins[l] = angle + piece.pin[l] + error[l];
                    }
                }
                for l in lanes.each() {
                    let [torque, slope] = harmonic.at(l, pins[l]);
                    // Its power is the torque times the speed of the shaft.
                    torques[l] += ratios[l] * torque;
                    slopes[l] += ratio_slopes[l].mul_add(torque, ratios[l] * ratios[l] * slope);
                }
            }
            for l in lanes.each() {
                row.residual[l] -= torques[l];
                row.by_angle[1][l] -= slopes[l];
            }
        }
    }

    /// The speed ratio of a piece in the first lane.
    pub(super) fn ratio(&self, piece: usize) -> f64 {
        self.motions[piece].ratio[0]
    }

    /// Adds the power that dampings and load take at these slopes, relative to the drive's speed.
    /// Torques that depend on angles do no work over a turn.
    #[inline(always)]
    pub(super) fn add_losses(&self, lanes: Lanes, v: &[Pack], sum: &mut Pack) {
        let ratio = self.motions[self.pieces.len() - 1].ratio;
        let (first, last) = (v[0], v[v.len() - 1]);
        for l in lanes.each() {
            let speed = ratio[l] * (1.0 + last[l]);
            let of_drive = self.drive.damping[l] * first[l] * first[l];
            sum[l] += self.load_torque[l] + self.load_damping[l] * speed * speed + of_drive;
        }
        for (spring, rate) in self.springs.iter().zip(&self.rates) {
            for l in lanes.each() {
                sum[l] = (spring.damping[l] * rate[l]).mul_add(rate[l], sum[l]);
            }
        }
    }
}

impl Equations for RunsSideBySide {
    #[inline(always)]
    fn unit(&mut self, lanes: Lanes) -> Pack {
        let mut least = all(f64::INFINITY);
        for (spring, torque) in self.springs.iter().zip(&mut self.largest) {
            for l in lanes.each() {
                let twist = torque[l] / spring.stiffness[l];
                least[l] = if twist < least[l] { twist } else { least[l] };
                torque[l] = 0.0;
            }
        }
        least
    }

    fn is_free(&self) -> bool {
        self.free
    }

    fn set_mean_torque(&mut self, torque: &Pack) {
        self.drive.preload = *torque;
    }

    #[inline(always)]
    fn rows(
        &mut self,
        lanes: Lanes,
        angle: f64,
        [y, v, a]: [&[Pack]; 3],
        rows: &mut [EquationRow],
    ) {
        self.prepare(lanes, angle, y, v);
        let first = usize::from(!self.free);
        for (u, row) in rows.iter_mut().enumerate() {
            let p = u + first;
            // The torque that enters the piece: of the shaft before it or of the drive.
            let (spring, torque) = if let Some(s) = p.checked_sub(1) {
                (&self.springs[s], self.torques[s])
            } else {
                let mut torque = ZERO;
                for l in lanes.each() {
                    torque[l] = (-self.drive.damping[l]).mul_add(v[u][l], self.drive.preload[l]);
                }
                (&self.drive, torque)
            };
            // Copies, which the compiler knows to be apart. No derivative by an unknown before the
            // first one counts, so what is before that is all the same.
            let (before, spring) = (self.motions[p.saturating_sub(1)], *spring);
            let own = self.motions[p];
            let (slope, acceleration) = (v[u], a[u]);
            let slope_before = if u == 0 { ZERO } else { v[u - 1] };
            // The torque that leaves the piece, and its derivatives by this unknown and the next:
            // what the next shaft or the load does.
            let next = self.springs.get(p).copied();
            let (behind, next_stiffness, next_damping) = if let Some(next) = next {
                (self.torques[p], next.stiffness, next.damping)
            } else {
                let mut load = ZERO;
                for l in lanes.each() {
                    let speed = own.ratio[l] * (1.0 + slope[l]);
                    load[l] = self.load_damping[l].mul_add(speed, self.load_torque[l]);
                }
                (load, ZERO, self.load_damping)
            };
            let coupled = if next.is_some() { -1.0 } else { 0.0 };
            let square = self.square;
            let mut most = if p > 0 { self.largest[p - 1] } else { ZERO };
            let mut found = EquationRow::default();
            for l in lanes.each() {
                let rate = 1.0 + slope[l];
                let (ratio, ratio_slope) = (own.ratio[l], own.ratio_slope[l]);
                let (inertia, by) = (own.inertia[l], own.inertia_slope[l]);
                let half = 0.5 * rate * rate;
                let inertial = inertia.mul_add(acceleration[l], by * half);
                let inertial_by_angle =
                    by.mul_add(acceleration[l], own.inertia_curvature[l] * half);
                let by_angle =
                    next_stiffness[l].mul_add(ratio, next_damping[l] * ratio_slope * rate);
                let damping = spring.damping[l];
                most[l] = if torque[l].abs() > most[l] { torque[l].abs() } else { most[l] };
                found.residual[l] =
                    ratio.mul_add(behind[l], square[l].mul_add(inertial, -torque[l]));
                found.by_acceleration[l] = square[l] * inertia;
                found.by_slope[0][l] = -damping * before.ratio[l];
                found.by_slope[1][l] =
                    (ratio * ratio).mul_add(next_damping[l], square[l].mul_add(by * rate, damping));
                found.by_slope[2][l] = coupled * ratio * next_damping[l];
                found.by_angle[0][l] = -spring.stiffness[l].mul_add(
                    before.ratio[l],
                    damping * before.ratio_slope[l] * (1.0 + slope_before[l]),
                );
                found.by_angle[1][l] = ratio.mul_add(
                    by_angle,
                    ratio_slope.mul_add(
                        behind[l],
                        square[l].mul_add(inertial_by_angle, spring.stiffness[l]),
                    ),
                );
                found.by_angle[2][l] = coupled * ratio * next_stiffness[l];
            }
            *row = found;
            if let Some(s) = p.checked_sub(1) {
                self.largest[s] = most;
            }
        }
        self.subtract_harmonics(lanes, angle, y, rows);
    }
}
