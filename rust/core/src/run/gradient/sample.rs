//! One sample: the outputs at a drive angle, and how each of them changes.
//!
//! With the equivalent joint's `cos β = e`, `sin a = s` and `cos a = c` of its input angle `a`,
//! `z = q u` and `ψ = 1/(e c + i s)`, the formulas of [`crate::mechanics::transmission`] become
//!
//! `ρ = (1 − z)/(1 + z) = (e − i sin² β s c)/(e² c² + s²)`, `u/(1 + z)² = ((1 + e)/2)² ψ² = W`.
//!
//! The speed ratio is `Re ρ`, the acceleration ratio `Im ρ²`, the jerk ratio `Re 2ρ(1 − ρ²)`; they
//! change by the real parts of `−2W dq`, `4iWρ dq` and `4W(3ρ² − 1) dq`, the angle error by that of
//! `−i (1 + e)/2 (c − i s) ψ dq`. Nothing cancels for steep bends.

use nalgebra::Complex;

use crate::mechanics::cross::Cross;
use crate::mechanics::geometry::Vector;
use crate::mechanics::moment::Pose;
use crate::number::dual::Dual;
use crate::number::elementary::{atan, atan2, hypot, norm};
use crate::number::trig;
use crate::plan::forces::ForceStep;
use crate::plan::output::{self, Needs, OfCross};
use crate::plan::{Axes, End, Output};
use crate::run::gradient::forces::{self, Supports};
use crate::run::gradient::line::{LineConstants, PoseConstants, ShaftConstants, Sums};

/// Smaller sines of bends count as this one where a derivative is divided by them.
const SMALLEST_SINE: f64 = 1e-150;

/// The load of one sample.
#[derive(Clone)]
pub(super) struct LoadAt {
    pub(super) end: End,
    pub(super) torque: f64,
    pub(super) speed: f64,
    pub(super) acceleration: f64,
    /// One per shaft.
    pub(super) inertias: Vec<f64>,
}

/// The motion of one shaft and its derivatives by `q`.
struct ShaftAt {
    error: f64,
    ratio: f64,
    /// The speed ratio less 1.
    deviation: f64,
    acceleration: f64,
    jerk: f64,
    /// The derivative of the jerk ratio by the drive angle.
    snap: f64,
    by_q: [Complex<f64>; 4],
}

impl ShaftAt {
    fn new(constants: &ShaftConstants, (sine, cosine): (f64, f64)) -> Self {
        let ShaftConstants { cosine: e, sine2, versine, mean, turn: [turn_cos, turn_sin] } =
            *constants;
        let s = sine.mul_add(turn_cos, cosine * turn_sin);
        let c = cosine.mul_add(turn_cos, -(sine * turn_sin));
        let norm = (e * c).mul_add(e * c, s * s);
        let rho = Complex::new(e, -sine2 * s * c) / norm;
        let psi = Complex::new(e * c, -s) / norm;
        let (i, one) = (Complex::new(0.0, 1.0), Complex::new(1.0, 0.0));
        let square = rho * rho;
        // 1 − ρ², without a difference.
        let rest = psi * psi * -sine2;
        let w = psi * psi * (mean * mean);
        Self {
            error: atan2(versine * s * c, (e * c).mul_add(c, s * s)),
            ratio: rho.re,
            deviation: versine * (e * c).mul_add(c, -(s * s)) / norm,
            acceleration: square.im,
            jerk: (rho * rest * 2.0).re,
            snap: -((one - square * 3.0) * rest * 2.0).im,
            by_q: [
                -i * Complex::new(c, -s) * psi * mean,
                w * -2.0,
                i * w * rho * 4.0,
                w * (square * 3.0 - one) * 4.0,
            ],
        }
    }
}

/// Data common to the samples of a run.
#[derive(Clone, Copy)]
pub(super) struct Common<'a> {
    /// The forces that are wanted.
    pub(super) forces: Option<&'a ForceStep>,
    /// The axes of moments.
    pub(super) axes: Axes,
    /// Whether the angle of the last shaft is held, not that of the drive.
    pub(super) driven: bool,
}

/// The state of a driveline at one drive angle.
pub(super) struct LineAt<'a> {
    common: Common<'a>,
    line: &'a LineConstants<'a>,
    load: Option<&'a LoadAt>,
    angle: f64,
    shafts: Vec<ShaftAt>,
    /// Sine and cosine of the input angle of each joint.
    pins: Vec<(f64, f64)>,
    /// Power over the drive's speed, on its way into each shaft and out of the last.
    power: Vec<f64>,
    forces: Supports,
}

/// How a value changes with what the outputs of one sample depend on.
#[derive(Default)]
pub(super) struct Pull {
    angle: f64,
    power: Vec<f64>,
    ratio: Vec<f64>,
    acceleration: Vec<f64>,
    forces: Supports,
}

impl Pull {
    pub(super) fn new(joints: usize, forces: Option<&ForceStep>) -> Self {
        let zeros = || vec![0.0; joints + 2];
        let balances = forces.map_or(0, |step| step.balances.len());
        let forces = vec![[Vector::zeros(); 2]; balances];
        Self { angle: 0.0, power: zeros(), ratio: zeros(), acceleration: zeros(), forces }
    }
}

impl<'a> LineAt<'a> {
    pub(super) fn new(
        common: Common<'a>,
        line: &'a LineConstants<'a>,
        load: Option<&'a LoadAt>,
        angle: f64,
    ) -> Self {
        let turned = trig::sin_cos(angle);
        let shafts: Vec<_> =
            line.shafts.iter().map(|constants| ShaftAt::new(constants, turned)).collect();
        let w = Complex::new(turned.1, turned.0);
        let pin = |pose: &PoseConstants| {
            let [a, b] = pose.map;
            let pin = a * w + b * w.conj();
            let pin = pin / norm(pin);
            (pin.im, pin.re)
        };
        let pins = line.poses.iter().map(pin).collect();
        let (power, forces) = (vec![], vec![]);
        let mut sample = Self { common, line, load, angle, shafts, pins, power, forces };
        sample.power = load.map_or_else(Vec::new, |load| sample.powers(load));
        let solve = |step| forces::solve(step, line, |shaft| sample.support(shaft).0);
        sample.forces = common.forces.map_or_else(Vec::new, solve);
        sample
    }

    fn powers(&self, load: &LoadAt) -> Vec<f64> {
        let n = self.shafts.len();
        let mut power = vec![0.0; n + 1];
        match load.end {
            End::Drive => {
                power[0] = load.torque;
                for i in 0..n {
                    power[i + 1] = power[i] - self.absorbed(load, i);
                }
            }
            End::Output => {
                power[n] = load.torque * self.shafts[n - 1].ratio;
                for i in (0..n).rev() {
                    power[i] = power[i + 1] + self.absorbed(load, i);
                }
            }
        }
        power
    }

    /// The power over the drive's speed that the inertia of a shaft absorbs.
    fn absorbed(&self, load: &LoadAt, shaft: usize) -> f64 {
        let ShaftAt { ratio, acceleration, .. } = self.shafts[shaft];
        let turning = load.speed.powi(2).mul_add(acceleration, load.acceleration * ratio);
        load.inertias[shaft] * turning * ratio
    }

    /// The torsion of a joint's driving shaft.
    fn torsion(&self, joint: usize) -> f64 {
        self.power[joint + 1] / self.shafts[joint].ratio
    }

    fn pull_torsion(&self, joint: usize, weight: f64, pull: &mut Pull) {
        let ratio = self.shafts[joint].ratio;
        pull.power[joint + 1] += weight / ratio;
        pull.ratio[joint] -= weight * self.torsion(joint) / ratio;
    }

    /// Adds what a weighted output of a shaft or joint contributes to the value and to its
    /// derivatives. [`LineAt::settle`] completes them. Scalars have a weight in the first component.
    pub(super) fn pull(
        &self,
        output: Output,
        item: usize,
        weight: Vector,
        pull: &mut Pull,
        sums: &mut Sums,
    ) {
        match output {
            Output::Angle | Output::AngleError => {
                let ShaftAt { error, ratio, deviation, by_q, .. } = &self.shafts[item];
                let with_drive = output == Output::Angle;
                let (drive, slope) =
                    if with_drive { (self.angle, ratio) } else { (0.0, deviation) };
                sums.value += weight.x * (drive + error);
                sums.q[item] += by_q[0] * weight.x;
                pull.angle += weight.x * slope;
            }
            Output::SpeedRatio => {
                sums.value += weight.x * self.shafts[item].ratio;
                pull.ratio[item] += weight.x;
            }
            Output::AccelerationRatio => {
                sums.value += weight.x * self.shafts[item].acceleration;
                pull.acceleration[item] += weight.x;
            }
            Output::JerkRatio => {
                let ShaftAt { jerk, snap, by_q, .. } = &self.shafts[item];
                sums.value += weight.x * jerk;
                sums.q[item] += by_q[3] * weight.x;
                pull.angle += weight.x * snap;
            }
            Output::Torque => {
                let ratio = self.shafts[item].ratio;
                let torque = self.power[item] / ratio;
                sums.value += weight.x * torque;
                pull.power[item] += weight.x / ratio;
                pull.ratio[item] -= weight.x * torque / ratio;
            }
            Output::Moment if self.common.axes == Axes::Shaft => {
                self.pull_turning_moment(item, weight, pull, sums);
            }
            Output::SupportMoment if self.common.axes == Axes::Shaft => {
                self.pull_turning_support(item, weight, pull, sums);
            }
            Output::Moment => {
                sums.value += weight.dot(&self.moment(item));
                self.pull_moment(item, weight, pull, sums);
            }
            Output::SupportMoment => {
                sums.value += weight.dot(&self.support(item).0);
                self.pull_support(item, weight, pull, sums);
            }
            Output::DrivingPin | Output::DrivenPin => {
                self.pull_pin(output, item, weight, pull, sums);
            }
            Output::JointForce | Output::BearingForce => {
                let of = (output.row().per, item);
                let target = self.common.forces.and_then(|step| step.target(of));
                if let Some(force) = target.and_then(|target| target.force) {
                    sums.value += weight.dot(&forces::of(&self.forces, force));
                    forces::pull(&mut pull.forces, force, weight);
                }
            }
            _ => self.pull_scalar(output, item, weight.x, pull, sums),
        }
    }

    /// Tilts and rates of the cross and the magnitudes of moments, as functions of torsion or speed
    /// ratio, bend and input angle.
    fn pull_scalar(
        &self,
        output: Output,
        item: usize,
        weight: f64,
        pull: &mut Pull,
        sums: &mut Sums,
    ) {
        let PoseConstants { cosine: e, sine: sigma, tangent, .. } = self.line.poses[item];
        let (s, c) = self.pins[item];
        // The value over what it is proportional to, its derivative by the bend, and that by the
        // input angle over tan β.
        let [value, by_bend, by_turn] = match output {
            Output::TiltDriving => {
                let norm = (sigma * s).mul_add(sigma * s, e * e);
                [atan(tangent * s), s / norm, c * e * e / norm]
            }
            Output::TiltDriven => {
                let root = hypot(e * c, s);
                [atan2(sigma * c, root), e * c / root, -e * s / root]
            }
            Output::BendingDriving => [tangent * s.abs(), s.abs() / (e * e), c * sign(s)],
            Output::BendingDriven => {
                let stretch = (tangent * s).mul_add(tangent * s, 1.0).sqrt();
                let by_bend =
                    c.abs() * e.mul_add(stretch, sigma * s * s * tangent / (e * e * stretch));
                let by_turn =
                    e * (c.abs() * tangent * tangent * s * c / stretch - s * sign(c) * stretch);
                [sigma * c.abs() * stretch, by_bend, by_turn]
            }
            Output::SwingDriving => swing_driving([e, sigma], s, c),
            Output::SwingDriven => swing_driven([e, sigma], s, c),
            Output::PinMoment => pin_moment([e, tangent], s, c),
            _ => by_formula(output, [sigma, e], [s, c]),
        };
        let scale = match output.row().needs {
            Needs::Cross(OfCross::Tilt) => weight,
            Needs::Cross(_) => {
                pull.ratio[item] += weight * value;
                weight * self.shafts[item].ratio
            }
            _ => {
                let torsion = self.torsion(item);
                self.pull_torsion(item, weight * sign(torsion) * value, pull);
                weight * torsion.abs()
            }
        };
        sums.value += scale * value;
        sums.bends[item] += scale * by_bend;
        self.pull_turn(item, scale * by_turn, pull, sums);
    }

    /// `a = c e_in + s m`, or `b = (c cos β m − s e_out)/√D` with `D = s² + c² cos² β`. The second
    /// turns about the driven shaft by `cos β/D` of the input angle.
    fn pull_pin(
        &self,
        output: Output,
        item: usize,
        weight: Vector,
        pull: &mut Pull,
        sums: &mut Sums,
    ) {
        let PoseConstants { cosine: e, sine: sigma, axis, inward, normal, .. } =
            self.line.poses[item];
        let (s, c) = self.pins[item];
        let (pin, by_angle) = if output == Output::DrivingPin {
            (inward * c + normal * s, normal * c - inward * s)
        } else {
            let (driven, outward) = (axis * e + inward * sigma, inward * e - axis * sigma);
            let square = (e * c).mul_add(e * c, s * s);
            let root = square.sqrt();
            let (along, turned) =
                (weight.dot(&driven) / root, (outward * (e * c) + normal * s) / -root);
            let slope = sigma * c * weight.dot(&turned) / square;
            sums.bends[item] += s * (along + slope);
            // What a turn of the plane changes beyond a turn of the input angle.
            sums.plane[item] -= e * e * c * (along + slope);
            ((normal * (e * c) - outward * s) / root, turned * (e / square))
        };
        let change = weight.dot(&by_angle);
        sums.value += weight.dot(&pin);
        sums.frames[item] += pin.cross(&weight);
        sums.pins[item] += change;
        let ShaftAt { ratio, by_q, .. } = &self.shafts[item];
        sums.q[item] += by_q[0] * change;
        pull.angle += change * ratio;
    }

    /// The moment over the torsion, and its part across the driving shaft over `tan β`.
    fn unit_moment(&self, joint: usize) -> (Vector, Vector) {
        let PoseConstants { tangent, axis, inward, normal, .. } = self.line.poses[joint];
        let (s, c) = self.pins[joint];
        let across = inward * (s * s) - normal * (s * c);
        (axis + across * tangent, across)
    }

    /// `D [u + tan β s (s e_in − c m)]` on the driven shaft.
    fn moment(&self, joint: usize) -> Vector {
        self.unit_moment(joint).0 * self.torsion(joint)
    }

    fn pull_moment(&self, item: usize, weight: Vector, pull: &mut Pull, sums: &mut Sums) {
        let PoseConstants { cosine, axis, inward, normal, .. } = self.line.poses[item];
        let (s, c) = self.pins[item];
        let torsion = self.torsion(item);
        let (unit, across) = self.unit_moment(item);
        self.pull_torsion(item, weight.dot(&unit), pull);
        sums.bends[item] += torsion * weight.dot(&across) / (cosine * cosine);
        let turned = inward * (2.0 * s * c) - normal * ((c - s) * (c + s));
        self.pull_turn(item, torsion * weight.dot(&turned), pull, sums);
        // A turn about the shaft moves only the part across it.
        sums.frames[item] += (unit * torsion).cross(&weight);
        sums.plane[item] += torsion * weight.dot(&axis.cross(&across));
    }

    /// The support moment of a shaft: the moment of the joint behind it, minus that of the joint
    /// before it, across the shaft; then the whole difference.
    fn support(&self, item: usize) -> (Vector, Vector) {
        let axis = self.line.axis(item);
        let mut difference = Vector::zeros();
        if item < self.line.poses.len() {
            difference += self.moment(item);
        }
        if item > 0 {
            difference -= self.moment(item - 1);
        }
        (difference - axis * axis.dot(&difference), difference)
    }

    fn pull_support(&self, item: usize, weight: Vector, pull: &mut Pull, sums: &mut Sums) {
        let axis = self.line.axis(item);
        let along = weight.dot(&axis);
        let across = weight - axis * along;
        if item < self.line.poses.len() {
            self.pull_moment(item, across, pull, sums);
        }
        if item > 0 {
            self.pull_moment(item - 1, -across, pull, sums);
        }
        // The shaft's own direction, by which the part across it changes.
        let (_, difference) = self.support(item);
        let by_axis = -(difference * along + weight * axis.dot(&difference));
        sums.frames[item] += axis.cross(&by_axis);
    }

    /// A change with the input angle of a joint, divided by `tan β`.
    fn pull_turn(&self, joint: usize, weight: f64, pull: &mut Pull, sums: &mut Sums) {
        let ShaftAt { ratio, by_q, .. } = &self.shafts[joint];
        let change = weight * self.line.poses[joint].tangent;
        sums.turn[joint] += weight;
        sums.q[joint] += by_q[0] * change;
        pull.angle += change * ratio;
    }

    /// `(T, 0, T tan ψ₂)` with the torque `T` that enters the driven shaft (Thoma 5), in its axes.
    fn pull_turning_moment(&self, item: usize, weight: Vector, pull: &mut Pull, sums: &mut Sums) {
        let torque = self.power[item + 1] / self.shafts[item + 1].ratio;
        sums.value += weight.x * torque;
        self.pull_entering(item, weight.x, pull);
        self.pull_driven_bending(item, weight.z, pull, sums);
    }

    /// The support moment in axes with y along the input-side pin, from which the output-side pin
    /// differs by the phase.
    fn pull_turning_support(&self, item: usize, weight: Vector, pull: &mut Pull, sums: &mut Sums) {
        if item > 0 {
            self.pull_driven_bending(item - 1, -weight.z, pull, sums);
        }
        if item < self.line.poses.len() {
            let (sine, cosine) =
                if item > 0 { trig::sin_cos(self.line.phases[item - 1]) } else { (0.0, 1.0) };
            let along = weight.y.mul_add(sine, -(weight.z * cosine));
            let bending = self.pull_driving_bending(item, along, pull, sums);
            if item > 0 {
                sums.phases[item - 1] += bending * weight.y.mul_add(cosine, weight.z * sine);
            }
        }
    }

    /// The torque that enters a joint's driven shaft.
    fn pull_entering(&self, joint: usize, weight: f64, pull: &mut Pull) {
        let (power, ratio) = (self.power[joint + 1], self.shafts[joint + 1].ratio);
        pull.power[joint + 1] += weight / ratio;
        pull.ratio[joint + 1] -= weight * power / (ratio * ratio);
    }

    /// `T tan ψ₂` of a joint, `tan ψ₂ = sin β c/√(s² + c² cos² β)`.
    fn pull_driven_bending(&self, joint: usize, weight: f64, pull: &mut Pull, sums: &mut Sums) {
        let PoseConstants { cosine: e, sine: sigma, .. } = self.line.poses[joint];
        let (s, c) = self.pins[joint];
        let torque = self.power[joint + 1] / self.shafts[joint + 1].ratio;
        let square = (e * c).mul_add(e * c, s * s);
        let root = square.sqrt();
        let tangent = sigma * c / root;
        sums.value += weight * torque * tangent;
        self.pull_entering(joint, weight * tangent, pull);
        // (1 + tan² ψ₂) dψ₂ with 1 + tan² ψ₂ = 1/(s² + c² cos² β).
        let scale = weight * torque * e / (square * root);
        sums.bends[joint] += scale * c;
        self.pull_turn(joint, -scale * s, pull, sums);
    }

    /// `D tan ψ₁` of a joint, `tan ψ₁ = tan β s`, which is returned.
    fn pull_driving_bending(
        &self,
        joint: usize,
        weight: f64,
        pull: &mut Pull,
        sums: &mut Sums,
    ) -> f64 {
        let PoseConstants { cosine, tangent, .. } = self.line.poses[joint];
        let (s, c) = self.pins[joint];
        let torsion = self.torsion(joint);
        let bending = torsion * tangent * s;
        sums.value += weight * bending;
        self.pull_torsion(joint, weight * tangent * s, pull);
        sums.bends[joint] += weight * torsion * s / (cosine * cosine);
        self.pull_turn(joint, weight * torsion * c, pull, sums);
        bending
    }

    /// Passes changes of forces on to the moments that cause them.
    fn settle_forces(&self, step: &ForceStep, pull: &mut Pull, sums: &mut Sums) {
        for (i, balance) in step.balances.iter().enumerate().rev() {
            let (support, _) = self.support(balance.shaft);
            let (forces, pulled) = (&self.forces, &mut pull.forces);
            let weight = forces::pull_balance(self.line, balance, forces, support, pulled, sums, i);
            self.pull_support(balance.shaft, weight, pull, sums);
        }
    }

    /// Passes changes of forces, power, speed and acceleration ratios on to the sums, and clears
    /// them.
    pub(super) fn settle(&self, pull: &mut Pull, sums: &mut Sums) {
        if let Some(step) = self.common.forces {
            self.settle_forces(step, pull, sums);
        }
        if let Some(load) = self.load {
            let n = self.shafts.len();
            let absorb = |i: usize, weight: f64, pull: &mut Pull, sums: &mut Sums| {
                let ShaftAt { ratio, acceleration, .. } = self.shafts[i];
                let (inertia, square) = (load.inertias[i], load.speed.powi(2));
                let turning = square.mul_add(acceleration, load.acceleration * ratio);
                sums.inertias[i] += weight * turning * ratio;
                pull.acceleration[i] += weight * inertia * square * ratio;
                pull.ratio[i] += weight * inertia * load.acceleration.mul_add(ratio, turning);
            };
            match load.end {
                End::Drive => {
                    for i in (0..n).rev() {
                        let later = pull.power[i + 1];
                        pull.power[i] += later;
                        absorb(i, -later, pull, sums);
                    }
                    sums.torque += pull.power[0];
                }
                End::Output => {
                    for i in 0..n {
                        let earlier = pull.power[i];
                        pull.power[i + 1] += earlier;
                        absorb(i, earlier, pull, sums);
                    }
                    sums.torque += pull.power[n] * self.shafts[n - 1].ratio;
                    pull.ratio[n - 1] += pull.power[n] * load.torque;
                }
            }
            pull.power.fill(0.0);
        }
        for (i, ShaftAt { acceleration, jerk, by_q, .. }) in self.shafts.iter().enumerate() {
            let (by_ratio, by_acceleration) = (pull.ratio[i], pull.acceleration[i]);
            sums.q[i] += by_q[1] * by_ratio + by_q[2] * by_acceleration;
            pull.angle += by_ratio * acceleration + by_acceleration * jerk;
        }
        pull.ratio.fill(0.0);
        pull.acceleration.fill(0.0);
        let mut by_angle = std::mem::take(&mut pull.angle);
        if self.common.driven {
            // The drive angle changes so that the angle of the last shaft is the same.
            let last = self.shafts.len() - 1;
            by_angle /= self.shafts[last].ratio;
            sums.q[last] -= self.shafts[last].by_q[0] * by_angle;
        }
        sums.angle += by_angle;
    }
}

/// An output over the torsion or speed ratio to which it is proportional, its derivative by the bend,
/// and that by the input angle over `tan β`: by its formula in dual numbers.
#[inline(always)]
pub(super) fn by_formula(output: Output, bend: [f64; 2], [s, c]: [f64; 2]) -> [f64; 3] {
    // What vanishes with the bend changes with the input angle by a part of it.
    let [sine, cosine] = [bend[0].max(SMALLEST_SINE), bend[1]];
    let each = cosine / sine;
    let one = Dual::constant(1.0);
    let [s, c] = [Dual { value: s, by: [0.0, c * each] }, Dual { value: c, by: [0.0, -s * each] }];
    let [sine, cosine] =
        [Dual { value: sine, by: [cosine, 0.0] }, Dual { value: cosine, by: [-sine, 0.0] }];
    macro_rules! magnitude {
        ($($output:ident: $formula:ident),*) => {
            match output {
                $(Output::$output => Some(Pose::of_bend(sine, cosine).$formula(one, s, c)),)*
                _ => None,
            }
        };
    }
    macro_rules! swing {
        ($($output:ident: $formula:ident),*) => {
            match output {
                $(Output::$output => Some(Cross::of_bend(sine, cosine).$formula(one, s, c)),)*
                _ => None,
            }
        };
    }
    let found = output::magnitudes!(magnitude).or_else(|| output::swings!(swing));
    let Dual { value, by } = found.expect("every other output has its own derivatives");
    [value, by[0], by[1]]
}

/// `cos β sin β c/(s² + c² cos² β)`, its derivative by the bend, and that by the input angle over
/// `tan β`.
#[inline(always)]
pub(super) fn swing_driving([e, sigma]: [f64; 2], s: f64, c: f64) -> [f64; 3] {
    let (s2, ec) = (s * s, e * c);
    let inverse = ec.mul_add(ec, s2).recip();
    let by_bend = ec.mul_add(ec, (e - sigma) * (e + sigma) * s2) * c;
    let by_turn = -(e * e) * s * (sigma * c).mul_add(sigma * c, 1.0);
    [sigma * ec * inverse, by_bend * (inverse * inverse), by_turn * (inverse * inverse)]
}

/// The same of `−sin β s/√(s² + c² cos² β)`.
#[inline(always)]
pub(super) fn swing_driven([e, sigma]: [f64; 2], s: f64, c: f64) -> [f64; 3] {
    let (s2, ec) = (s * s, e * c);
    let inverse = ec.mul_add(ec, s2).recip();
    let root = inverse.sqrt();
    [-sigma * s * root, -e * s * (inverse * root), -(e * e) * ec * (inverse * root)]
}

/// The same of `√(1 + s² tan² β)`.
#[inline(always)]
pub(super) fn pin_moment([e, tangent]: [f64; 2], s: f64, c: f64) -> [f64; 3] {
    let bent = tangent * s;
    let value = bent.mul_add(bent, 1.0).sqrt();
    let by_turn = bent / value;
    [value, by_turn * s / (e * e), by_turn * c]
}

/// The sign, 0 for 0: where a magnitude vanishes it has no derivative.
#[inline(always)]
pub(super) fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { 1_f64.copysign(x) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_by_dual_numbers_are_those_that_are_written_out() {
        for (bend, angle) in [(0.4_f64, 0.9_f64), (1.5, -2.0), (0.0, 0.7)] {
            let ([sigma, e], [s, c]) = ([bend.sin(), bend.cos()], [angle.sin(), angle.cos()]);
            let tangent = sigma / e;
            for (output, known) in [
                (Output::SwingDriving, swing_driving([e, sigma], s, c)),
                (Output::SwingDriven, swing_driven([e, sigma], s, c)),
                (Output::PinMoment, pin_moment([e, tangent], s, c)),
                (Output::BendingDriving, [tangent * s.abs(), s.abs() / (e * e), c * sign(s)]),
            ] {
                let found = by_formula(output, [sigma, e], [s, c]);
                for (found, known) in found.iter().zip(known) {
                    let close = 1e-13 * (1.0 + known.abs());
                    assert!((found - known).abs() <= close, "{output:?} {found} {known}");
                }
            }
        }
    }
}
