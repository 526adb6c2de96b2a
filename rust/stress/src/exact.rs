//! The oracle: what the outputs are for the exact values of the doubles given.
//!
//! A joint is the Poisson kernel of `k = tan²(β/2)`, not the tangents and quotients by which the
//! library computes; a chain is the map `w → A w + B w̄` with the lengths left in. Loads and crosses of
//! chains are the vector picture. A yoke is a unit vector along its pin, turned about its shaft. The
//! cross keeps both pins of a joint perpendicular and transmits only a moment normal to both.

use std::f64::consts::TAU;

use cardan::{Geometry, Output, Per};

use crate::angle::{HALF_PI, atan2, sin_cos, sin_cos_in};
use crate::judge::Quantity;
use crate::loading::Loading;
use crate::samples::JointSample;
use crate::space::{ExactAxes, Span, Transmitted, cross, dot, scaled, turned};
use crate::wide::{Wide, WideComplex};

/// Sine and cosine of a drive angle, and the angle itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    pub(crate) angle: Wide,
    pub(crate) s: Wide,
    pub(crate) c: Wide,
}

impl Turn {
    /// Of a sum of doubles, the first the largest.
    pub(crate) fn by(parts: &[f64]) -> Self {
        let (s, c) = sin_cos(parts);
        let angle = parts.iter().fold(Wide::ZERO, |sum, &x| sum + Wide::from(x));
        Self { angle, s, c }
    }

    /// Step `i` of a turn of so many, exactly.
    pub(crate) fn part(i: usize, per_turn: usize) -> Self {
        let part = |n: f64| *HALF_PI * n / Wide::from(per_turn as f64);
        let quarters = 4 * i as i64;
        let count = (2 * quarters + per_turn as i64).div_euclid(2 * per_turn as i64);
        let rest = quarters - count * per_turn as i64;
        let (s, c) = sin_cos_in(part(rest as f64), count as u64);
        Self { angle: part(quarters as f64), s, c }
    }
}

/// Motion of a shaft.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExactMotion {
    pub(crate) angle: Wide,
    pub(crate) error: Wide,
    pub(crate) ratio: Wide,
    pub(crate) acceleration: Wide,
    pub(crate) jerk: Wide,
}

impl ExactMotion {
    /// Angle, angle error, speed ratio, acceleration ratio and jerk ratio.
    pub(crate) fn all(&self) -> [Wide; 5] {
        [self.angle, self.error, self.ratio, self.acceleration, self.jerk]
    }
}

/// One joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExactJoint {
    pub(crate) sin: Wide,
    pub(crate) cos: Wide,
    pub(crate) tan: Wide,
    pub(crate) k: Wide,
    /// `1 − k`.
    gap: Wide,
    /// `1 − k²`.
    complement: Wide,
}

impl ExactJoint {
    pub(crate) fn bent(bend: f64) -> Self {
        Self::bent_by(&[bend])
    }

    /// Bent by a sum of doubles.
    fn bent_by(parts: &[f64]) -> Self {
        let (sin, cos) = sin_cos(parts);
        let (half_sin, half_cos) = half_sin_cos(parts);
        let k = (half_sin / half_cos).square();
        // cos β = cos²(β/2) − sin²(β/2).
        let gap = cos / half_cos.square();
        Self { sin, cos, tan: sin / cos, k, gap, complement: gap * (Wide::ONE + k) }
    }

    /// `angle error = arg(1 − k e^{−2iα})`, `speed ratio = (1 − k²)/(1 − 2k cos 2α + k²)`, and its
    /// derivatives by the rule of the quotient.
    pub(crate) fn motion(&self, at: &Turn) -> ExactMotion {
        let s2 = at.s.square();
        let k_sin = (at.s * at.c).scaled(2.0) * self.k;
        let k_s2 = s2 * self.k;
        let across = self.gap.square() + k_s2.scaled(4.0);
        let error = atan2(k_sin, self.gap + k_s2.scaled(2.0));
        let ratio = self.complement / across;
        let acceleration = -(k_sin.scaled(4.0) * ratio / across);
        let k_cos = (at.c.square() - s2) * self.k;
        let jerk = quotient_curvature(ratio, across, k_sin.scaled(4.0), k_cos.scaled(8.0));
        ExactMotion { angle: at.angle + error, error, ratio, acceleration, jerk }
    }

    /// The components of a quantity with the torque of a sample, and the largest over a turn.
    pub(crate) fn exact(
        &self,
        quantity: Quantity,
        at: &Turn,
        motion: &ExactMotion,
        sample: JointSample,
    ) -> (Vec<Wide>, f64) {
        let (torque, size) = (sample.torque, sample.torque.abs());
        let [sin, cos, tan] = [self.sin, self.cos, self.tan].map(|x| x.high);
        let times = |v: [Wide; 3]| v.map(|x| x * torque).to_vec();
        let bent = size * if cos * cos > 0.5 { sin } else { 0.5 / cos };
        let output = match quantity {
            Quantity::TorqueDriven => return (vec![Wide::from(torque) / motion.ratio], size / cos),
            Quantity::TorqueDriving => return (vec![motion.ratio * torque], size / cos),
            Quantity::TorqueFlywheel => {
                return (vec![motion.acceleration * torque], size * self.steepest());
            }
            Quantity::SupportDriving => return (times(self.supports(at)[0]), size * tan),
            Quantity::SupportDriven => return (times(self.supports(at)[1]), bent),
            Quantity::Of(output) => output,
        };
        match output {
            Output::Angle => (vec![motion.angle], motion.angle.high.abs().max(TAU)),
            Output::AngleError => (vec![motion.error], self.k.high.min(1.0).asin()),
            Output::SpeedRatio => (vec![motion.ratio], 1.0 / cos),
            Output::AccelerationRatio => (vec![motion.acceleration], self.steepest()),
            // The series of cosines with coefficients of one sign is largest where all are 1.
            Output::JerkRatio => (vec![motion.jerk], 2.0 * tan * tan / cos),
            Output::Moment => (times(self.moment(at)), size / cos),
            Output::BendingDriving => (vec![self.bending(at)[0] * size], size * tan),
            Output::BendingDriven => (vec![self.bending(at)[1] * size], bent),
            Output::PinMoment => (vec![self.pin_moment(at) * size], size / cos),
            Output::TiltDriving => (vec![self.tilts(at)[0]], sample.bend),
            Output::TiltDriven => (vec![self.tilts(at)[1]], sample.bend),
            Output::SwingDriving => (vec![self.swings(at)[0]], tan),
            Output::SwingDriven => (vec![self.swings(at)[1]], sin),
            Output::DrivingPin => (self.pins(at)[0].to_vec(), 1.0),
            Output::DrivenPin => (self.pins(at)[1].to_vec(), 1.0),
            Output::Torque | Output::SupportMoment | Output::JointForce | Output::BearingForce => {
                unreachable!("{output:?} is no quantity of one joint")
            }
        }
    }

    /// The larger of the two terms whose difference is the jerk ratio: those of
    /// `sin⁴ α + 3 sin² β sin² α cos² α − cos² β cos⁴ α`, times what stands before it.
    pub(crate) fn jerk_term(&self, at: &Turn) -> Wide {
        let [s2, c2, sin2, cos2] = [at.s, at.c, self.sin, self.cos].map(Wide::square);
        let plus = s2 * (s2 + sin2 * c2 * 3.0);
        let minus = cos2 * c2.square();
        let larger = if plus.high > minus.high { plus } else { minus };
        let across = c2 * cos2 + s2;
        (self.cos * sin2 * larger).scaled(2.0) / (across * across.square())
    }

    /// The largest acceleration ratio, where `cos 2α = (−p + √(p² + 8))/2`, `p = (1 + k²)/(2k)`.
    fn steepest(&self) -> f64 {
        let (k, gap2) = (self.k.high, self.gap.high.powi(2));
        let (p, p_less_one) = ((1.0 + k * k) / (2.0 * k), gap2 / (2.0 * k));
        let root = (p * p + 8.0).sqrt();
        let cosine = 4.0 / (p + root);
        let versine = p_less_one * (1.0 + (p + 1.0) / (root + 3.0)) / (p + root);
        let across = gap2 + 2.0 * k * versine;
        let sine = (versine * (1.0 + cosine)).sqrt();
        4.0 * k * self.complement.high * sine / (across * across)
    }

    /// The moment on the driven shaft per unit of torque in the driving one, shaft 0 along x, the
    /// bend-plane normal along z: normal to both pins.
    fn moment(&self, at: &Turn) -> [Wide; 3] {
        [Wide::ONE, self.tan * at.s.square(), -(self.tan * at.s * at.c)]
    }

    /// What the bearings must give both shafts, per unit of torque.
    fn supports(&self, at: &Turn) -> [[Wide; 3]; 2] {
        let [_, y, z] = self.moment(at);
        let in_plane = self.sin * at.c.square();
        [[Wide::ZERO, y, z], [-(in_plane * self.sin), in_plane * self.cos, -z]]
    }

    /// Bending moments of both shafts, per unit of torque: the lengths of the supports.
    fn bending(&self, at: &Turn) -> [Wide; 2] {
        let across = (self.sin * at.c).square() + (self.tan * at.s).square();
        [self.tan * at.s.abs(), at.c.abs() * across.sqrt()]
    }

    /// Tilts of the cross against both shafts: `tan ψ₁ = tan β sin α`, `sin ψ₂ = sin β cos α`.
    fn tilts(&self, at: &Turn) -> [Wide; 2] {
        let sine = self.sin * at.c;
        let cosine = (at.s.square() + (self.cos * at.c).square()).sqrt();
        [atan2(self.sin * at.s, self.cos), atan2(sine, cosine)]
    }

    /// The moment's magnitude per unit of torque: the length of the vector.
    fn pin_moment(&self, at: &Turn) -> Wide {
        let moment = self.moment(at);
        dot(moment, moment).sqrt()
    }

    /// Rates of the cross in both yokes: the parts along the pins of the rotation of the driven shaft
    /// relative to the driving one.
    fn swings(&self, at: &Turn) -> [Wide; 2] {
        let ([driving, driven], ratio) = (self.pins(at), self.motion(at).ratio);
        [ratio * self.sin * driving[1], -driven[0]]
    }

    /// The unit vectors along the pins of both yokes, shaft 0 along x, the normal along z.
    fn pins(&self, at: &Turn) -> [[Wide; 3]; 2] {
        let driving = [Wide::ZERO, at.c, at.s];
        let driven = cross([self.cos, self.sin, Wide::ZERO], driving);
        [driving, scaled(driven, Wide::ONE / dot(driven, driven).sqrt())]
    }
}

/// The second derivative of a quotient with this value whose denominator alone changes, from the
/// denominator and its first two derivatives.
fn quotient_curvature(value: Wide, denominator: Wide, slope: Wide, curvature: Wide) -> Wide {
    let relative = slope / denominator;
    value * (relative.square().scaled(2.0) - curvature / denominator)
}

/// Sine and cosine of half a sum of doubles.
fn half_sin_cos(parts: &[f64]) -> (Wide, Wide) {
    sin_cos(&parts.iter().map(|x| 0.5 * x).collect::<Vec<_>>())
}

/// A parameter of a chain: the bend of a joint, or the phase of an intermediate shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChainParameter {
    Bend(usize),
    Phase(usize),
}

/// A chain of joints.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExactChain {
    a: WideComplex,
    b: WideComplex,
    /// `|A|² − |B|²`, the product of the cosines.
    determinant: Wide,
    /// `|B/A|`.
    pub(crate) k: f64,
    /// The sum of the joints' `k`.
    pub(crate) total: f64,
}

impl ExactChain {
    pub(crate) fn of(bends: &[f64], twists: &[f64], phases: &[f64]) -> Self {
        Self::moved(bends, twists, phases, None)
    }

    /// The chain after a change of one parameter.
    pub(crate) fn moved(
        bends: &[f64],
        twists: &[f64],
        phases: &[f64],
        change: Option<(ChainParameter, f64)>,
    ) -> Self {
        let step = |parameter| change.and_then(|(of, step)| (of == parameter).then_some(step));
        let mut a = WideComplex { re: Wide::ONE, im: Wide::ZERO };
        let mut b = WideComplex { re: Wide::ZERO, im: Wide::ZERO };
        let (mut determinant, mut total) = (Wide::ONE, 0.0);
        for (j, &bend) in bends.iter().enumerate() {
            if j > 0 {
                // A quarter turn more than the phase less the twist.
                let mut parts = vec![phases[j - 1], -twists[j - 1]];
                parts.extend(step(ChainParameter::Phase(j - 1)));
                let (s, c) = sin_cos(&parts);
                let turn = WideComplex { re: -s, im: c };
                (a, b) = (a * turn, b * turn);
            }
            // (cos α, sin α) → (cos β cos α, sin α), half the sum and half the difference.
            let mut parts = vec![bend];
            parts.extend(step(ChainParameter::Bend(j)));
            let joint = ExactJoint::bent_by(&parts);
            let (s, c) = half_sin_cos(&parts);
            let (keep, turn_back) = (c.square(), s.square());
            (a, b) = (
                a.times(keep) - b.conj().times(turn_back),
                b.times(keep) - a.conj().times(turn_back),
            );
            determinant = determinant * joint.cos;
            total += joint.k.high;
        }
        let k = (b.norm_squared() / a.norm_squared()).sqrt().high;
        Self { a, b, determinant, k, total }
    }

    /// `B/A`.
    pub(crate) fn q(&self) -> WideComplex {
        (self.b * self.a.conj()).times(Wide::ONE / self.a.norm_squared())
    }

    /// `|A|`.
    pub(crate) fn length(&self) -> f64 {
        self.a.norm_squared().high.sqrt()
    }

    /// `1 − k`, which the determinant knows without cancellation.
    pub(crate) fn gap(&self) -> f64 {
        (self.determinant / self.a.norm_squared()).high / (1.0 + self.k)
    }

    /// The larger of the two terms whose difference is the jerk ratio: those of the equivalent joint.
    pub(crate) fn jerk_term(&self, at: &Turn) -> Wide {
        let w = WideComplex { re: at.c, im: at.s };
        let (aw, bw) = (self.a * w, self.b * w.conj());
        let (square, side) = ((aw + bw).norm_squared(), aw.conj() * bw);
        let size = side.norm_squared().sqrt();
        // Twice the squares of sine and cosine of the equivalent joint's input angle: the product
        // points against the real axis where the joint is fastest.
        let cosine = if size.high > 0.0 { -side.re / size } else { Wide::ONE };
        let (s2, c2) = ((Wide::ONE - cosine).scaled(0.5), (Wide::ONE + cosine).scaled(0.5));
        let a2 = self.a.norm_squared();
        let sum = (a2.sqrt() + self.b.norm_squared().sqrt()).square();
        let (cos, sin2) = (self.determinant / sum, size.scaled(4.0) / sum);
        let plus = s2 * (s2 + sin2 * c2 * 3.0);
        let minus = (cos * c2).square();
        let larger = if plus.high > minus.high { plus } else { minus };
        let across = square / sum;
        (cos * sin2 * larger).scaled(2.0) / (across * across.square())
    }

    /// Motion of the last shaft, and how fast each quantity changes with the drive angle (the
    /// angle's part is that of its error).
    pub(crate) fn motion(&self, at: &Turn) -> (ExactMotion, [f64; 5]) {
        let w = WideComplex { re: at.c, im: at.s };
        let (aw, bw) = (self.a * w, self.b * w.conj());
        let square = (aw + bw).norm_squared();
        let side = aw.conj() * bw;
        let error = atan2(side.im, aw.norm_squared() + side.re);
        let ratio = self.determinant / square;
        // |v|² = |A|² + |B|² + 2 Re(A w conj(B w̄)).
        let acceleration = -(ratio / square * side.im).scaled(4.0);
        let (r, a) = (ratio.high, acceleration.high);
        let steep = 2.0 * a * a / r + 8.0 * r * side.re.high / square.high;
        // The squared length differentiated: `4 Im`, `−8 Re` and `−16 Im` of the product.
        let (slope, curvature) = (side.im.scaled(4.0), side.re.scaled(-8.0));
        let jerk = quotient_curvature(ratio, square, slope, curvature);
        let [slope, curvature, third] =
            [slope, curvature, side.im.scaled(-16.0)].map(|x| x.high / square.high);
        let snap = r * (6.0 * slope * curvature - third - 6.0 * slope.powi(3));
        let motion = ExactMotion { angle: at.angle + error, error, ratio, acceleration, jerk };
        (motion, [(r - 1.0).abs(), (r - 1.0).abs(), a.abs(), steep.abs(), snap.abs()])
    }
}

/// The outputs that chains are judged by here: all but motion and forces.
pub(crate) const OUTPUTS: [Output; COUNT] = {
    let mut outputs = [Output::Torque; COUNT];
    let (mut i, mut found) = (0, 0);
    while i < Output::COUNT {
        if is_judged(Output::ALL[i]) {
            outputs[found] = Output::ALL[i];
            found += 1;
        }
        i += 1;
    }
    outputs
};

pub(crate) const COUNT: usize = {
    let (mut i, mut found) = (0, 0);
    while i < Output::COUNT {
        found += is_judged(Output::ALL[i]) as usize;
        i += 1;
    }
    found
};

const fn is_judged(output: Output) -> bool {
    use Output::{AccelerationRatio, Angle, AngleError, JerkRatio, SpeedRatio};
    use Output::{BearingForce, JointForce};

    let motion = matches!(output, Angle | AngleError | SpeedRatio | AccelerationRatio | JerkRatio);
    !motion && !matches!(output, JointForce | BearingForce)
}

/// A driveline of ideal joints in space.
pub(crate) struct Frames {
    pub(crate) axes: ExactAxes,
    /// Of the motion of each shaft.
    chains: Vec<ExactChain>,
    /// Sine and cosine of each phase.
    phases: Vec<(Wide, Wide)>,
}

impl Frames {
    pub(crate) fn of(line: &Geometry) -> Self {
        let Geometry { bends, twists, phases, .. } = line;
        let upto = |i: usize| {
            ExactChain::of(
                &bends[..i],
                &twists[..i.saturating_sub(1)],
                &phases[..i.saturating_sub(1)],
            )
        };
        let chains = (0..=bends.len()).map(upto).collect();
        let phases = phases.iter().map(|&phase| sin_cos(&[phase])).collect();
        Self { axes: ExactAxes::of(bends, twists), chains, phases }
    }

    /// What the shafts and joints transmit at an angle.
    pub(crate) fn transmitted(&self, loading: &Loading, at: &Turn) -> Transmitted {
        let directions = &self.axes.directions;
        let n = directions.len() - 1;
        let motions = self.motions(at);
        let rates: Vec<_> = motions.iter().map(|own| [own.ratio, own.acceleration]).collect();
        let (power, terms) = loading.powers(&rates);
        let mut largest = 0.0_f64;
        let mut moments = vec![];
        for (j, [driving, driven]) in self.pins(at).into_iter().enumerate() {
            let along = cross(driving, driven);
            // The moment of a unit of power over the drive's speed.
            let unit = Wide::ONE / (rates[j][0] * dot(along, directions[j]));
            moments.push(scaled(along, power[j + 1] * unit));
            let components = scaled(along, terms * unit).map(|x| x.high.abs());
            largest = components.into_iter().fold(largest, f64::max);
        }
        let torques = (0..=n).map(|i| power[i] / rates[i][0]).collect();
        Transmitted { torques, moments, largest }
    }

    /// The motion of each shaft.
    pub(crate) fn motions(&self, at: &Turn) -> Vec<ExactMotion> {
        self.chains.iter().map(|chain| chain.motion(at).0).collect()
    }

    /// The pins of each joint.
    fn pins(&self, at: &Turn) -> Vec<[Span; 2]> {
        let ExactAxes { directions, normals } = &self.axes;
        let (u, m) = (directions[0], normals[0]);
        let mut driving = turned(cross(m, u), u, (at.s, at.c));
        let mut pins = vec![];
        for (j, &after) in directions[1..].iter().enumerate() {
            let driven = cross(after, driving);
            let driven = scaled(driven, Wide::ONE / dot(driven, driven).sqrt());
            pins.push([driving, driven]);
            if let Some(&phase) = self.phases.get(j) {
                driving = turned(driven, after, phase);
            }
        }
        pins
    }

    /// The components of every plane of [`OUTPUTS`], output by output and item by item.
    pub(crate) fn outputs(&self, loading: &Loading, at: &Turn) -> Vec<Vec<Vec<Wide>>> {
        let (u, pins, motions) = (&self.axes.directions, self.pins(at), self.motions(at));
        let Transmitted { torques, moments, .. } = self.transmitted(loading, at);
        let length = |v: Span| dot(v, v).sqrt();
        let sine_of = |pin: Span, u: Span| atan2(dot(pin, u), length(cross(pin, u)));
        let of = |output: Output, item: usize| match output {
            Output::Torque => vec![torques[item]],
            Output::SupportMoment => self.axes.support(&moments, item).to_vec(),
            Output::Moment => moments[item].to_vec(),
            Output::BendingDriving => vec![self.axes.bending(moments[item], item)],
            Output::BendingDriven => vec![self.axes.bending(moments[item], item + 1)],
            Output::PinMoment => vec![length(moments[item])],
            Output::TiltDriving => vec![sine_of(pins[item][1], u[item])],
            Output::TiltDriven => vec![sine_of(pins[item][0], u[item + 1])],
            Output::SwingDriving => vec![motions[item + 1].ratio * dot(u[item + 1], pins[item][0])],
            Output::SwingDriven => vec![-motions[item].ratio * dot(u[item], pins[item][1])],
            Output::DrivingPin => pins[item][0].to_vec(),
            Output::DrivenPin => pins[item][1].to_vec(),
            Output::Angle
            | Output::AngleError
            | Output::SpeedRatio
            | Output::AccelerationRatio
            | Output::JerkRatio
            | Output::JointForce
            | Output::BearingForce => unreachable!("{output:?} is judged elsewhere"),
        };
        let items =
            |output: Output| if output.row().per == Per::Shaft { u.len() } else { pins.len() };
        let all = |output| (0..items(output)).map(|item| of(output, item)).collect();
        OUTPUTS.into_iter().map(all).collect()
    }

    /// A vector along a shaft, the pin of its input side (of the first shaft, of its output side), and
    /// across both.
    pub(crate) fn along(&self, vector: &[Wide], shaft: usize, at: &Turn) -> Vec<Wide> {
        let (u, pins) = (self.axes.directions[shaft], self.pins(at));
        let pin = if shaft == 0 { pins[0][0] } else { pins[shaft - 1][1] };
        let vector = [vector[0], vector[1], vector[2]];
        [u, pin, cross(u, pin)].map(|axis| dot(vector, axis)).to_vec()
    }
}
