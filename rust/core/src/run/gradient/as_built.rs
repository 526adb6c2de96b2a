//! One sample of a driveline of joints as built. Dual numbers carry the derivatives by some of the
//! parameters through all formulas.

use crate::mechanics::as_built::{DEVIATIONS, JointAsBuilt};
use crate::mechanics::derivatives::vector;
use crate::mechanics::moment::absorbed_power;
use crate::number::dual::Dual;
use crate::number::float::Real;
use crate::plan::forces::ForceStep;
use crate::plan::{End, Output};
use crate::run::gradient::as_built_forces::{self, PlacesAsBuilt, solve_as_built};
use crate::run::gradient::line::{Counts, Wanted};
use crate::run::gradient::sample::LoadAt;
use crate::run::gradient::{Carried, Direction, WIDTH};

/// A parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variable {
    Bend(usize),
    Twist(usize),
    Phase(usize),
    Angle,
    Torque,
    Inertia(usize),
    Deviation(usize, usize),
    Length(usize),
    Position(usize),
}

/// The parameters that are wanted, in the order of their columns behind that of the value.
pub(super) fn variables(wanted: Wanted, Counts { joints, bearings }: Counts) -> Vec<Variable> {
    let between = || 0..joints - 1;
    let deviation = |joint| (0..DEVIATIONS).map(move |which| Variable::Deviation(joint, which));
    let mut all = vec![];
    let mut add = |is_wanted: bool, more: &mut dyn Iterator<Item = Variable>| {
        all.extend(more.filter(|_| is_wanted));
    };
    add(wanted.bends, &mut (0..joints).map(Variable::Bend));
    add(wanted.twists, &mut between().map(Variable::Twist));
    add(wanted.phases, &mut between().map(Variable::Phase));
    add(wanted.angle, &mut std::iter::once(Variable::Angle));
    add(wanted.torque, &mut std::iter::once(Variable::Torque));
    add(wanted.inertias, &mut (0..=joints).map(Variable::Inertia));
    add(wanted.lengths, &mut (0..=joints).map(Variable::Length));
    add(wanted.positions, &mut (0..bearings).map(Variable::Position));
    add(wanted.deviations, &mut (0..joints).flat_map(deviation));
    all
}

/// The geometry of one driveline.
#[derive(Clone, Copy)]
pub(super) struct LineAsBuilt<'a> {
    pub(super) bends: &'a [f64],
    pub(super) twists: &'a [f64],
    pub(super) phases: &'a [f64],
    pub(super) directions: &'a [f64],
    pub(super) normals: &'a [f64],
    /// Empty for ideal joints.
    pub(super) deviations: &'a [f64],
    /// Lengths of the shafts; empty if they are unknown.
    pub(super) lengths: &'a [f64],
    /// Positions of the bearings.
    pub(super) positions: &'a [f64],
}

/// One joint, with the axes `u`, `e_in` and `m` of its driving shaft, and sine and cosine of the
/// turn of the shaft before it.
struct DualStage {
    joint: JointAsBuilt<Carried>,
    axes: [Direction; 3],
    turn: (Carried, Carried),
}

/// A driveline and some of the parameters by which its outputs are differentiated.
pub(super) struct Pass {
    variables: Vec<Variable>,
    stages: Vec<DualStage>,
    /// The direction of the last shaft.
    last: Direction,
    /// Per shaft: the mean of the sum of the angle errors before it; empty if no angle is wanted.
    means: Vec<Carried>,
    places: PlacesAsBuilt,
}

impl Pass {
    /// At most [`WIDTH`] of the parameters. `has_angles` says whether angles are wanted.
    pub(super) fn new(line: LineAsBuilt<'_>, variables: &[Variable], has_angles: bool) -> Self {
        let n = line.bends.len();
        let (stages, last) = (Vec::with_capacity(n), [Dual::constant(0.0); 3]);
        let places = PlacesAsBuilt { lengths: vec![], positions: vec![] };
        let mut pass = Self { variables: variables.to_vec(), stages, last, means: vec![], places };
        let lengths = line.lengths.iter().enumerate();
        let positions = line.positions.iter().enumerate();
        pass.places = PlacesAsBuilt {
            lengths: lengths.map(|(i, &x)| pass.number(x, Variable::Length(i))).collect(),
            positions: positions.map(|(i, &x)| pass.number(x, Variable::Position(i))).collect(),
        };
        let (u, m) = (vector(line.directions, 0), vector(line.normals, 0));
        let [mut shaft, mut in_plane, mut normal] =
            [u, m.cross(&u), m].map(|v| [v.x, v.y, v.z].map(Dual::constant));
        for j in 0..n {
            let mut turn = Dual::constant(0.0);
            if let Some(before) = j.checked_sub(1) {
                let twist = pass.number(line.twists[before], Variable::Twist(before));
                let phase = pass.number(line.phases[before], Variable::Phase(before));
                let right_angle = Dual::constant(std::f64::consts::FRAC_PI_2);
                turn = phase - twist + right_angle;
                (in_plane, normal) = rotated(in_plane, normal, twist.sin_cos());
            }
            let bend = pass.number(line.bends[j], Variable::Bend(j));
            let deviation = |which: usize| {
                let value = line.deviations.get(DEVIATIONS * j + which).copied().unwrap_or(0.0);
                pass.number(value, Variable::Deviation(j, which)).sin_cos()
            };
            let (sine, cosine) = bend.sin_cos();
            let (half_sine, _) = bend.scaled(0.5).sin_cos();
            let versine = half_sine.square().scaled(2.0);
            let deviations = std::array::from_fn(deviation);
            let joint = JointAsBuilt::of_parts([cosine, sine, versine], deviations);
            let axes = [shaft, in_plane, normal];
            pass.stages.push(DualStage { joint, axes, turn: turn.sin_cos() });
            (shaft, in_plane) = rotated(shaft, in_plane, (sine, cosine));
        }
        pass.last = shaft;
        if has_angles {
            pass.means = pass.means_over_turn();
        }
        pass
    }

    /// A number that is a parameter.
    pub(super) fn number(&self, value: f64, variable: Variable) -> Carried {
        let mut number = Dual::constant(value);
        for (by, &own) in number.by.iter_mut().zip(&self.variables) {
            *by = if own == variable { 1.0 } else { 0.0 };
        }
        number
    }

    /// The means over a turn of the sums of angle errors before each shaft, by the trapezoidal rule.
    /// As for [`General`](crate::General), the means of the squares tell when there are samples
    /// enough: those of each value and of each derivative.
    fn means_over_turn(&self) -> Vec<Carried> {
        const MOST: u32 = 1 << 16;
        /// Twice as many samples square a relative error of this size.
        const SMALL: f64 = 1e-10;
        let shafts = self.stages.len() + 1;
        let mut sums = vec![Dual::constant(0.0); shafts];
        let mut squares = vec![[0.0; WIDTH + 1]; shafts];
        let mut add = |squares: &mut [[f64; WIDTH + 1]], i: u32, count: u32| {
            let turned = f64::from(i) / f64::from(count) * std::f64::consts::TAU;
            let errors = self.motion(Dual::constant(turned)).errors;
            for ((sum, squares), error) in sums.iter_mut().zip(squares).zip(errors) {
                *sum = *sum + error;
                for (square, part) in squares.iter_mut().zip(parts(error)) {
                    *square += part * part;
                }
            }
        };
        let mut count = 16;
        (0..count).for_each(|i| add(&mut squares, i, count));
        loop {
            let before = squares.clone();
            // Adds the samples halfway between the previous ones.
            (1..2 * count).step_by(2).for_each(|i| add(&mut squares, i, 2 * count));
            count *= 2;
            let is_close = |part: usize| {
                let largest = squares.iter().map(|own| own[part]).fold(0.0, f64::max);
                let mut pairs = before.iter().zip(&squares);
                pairs.all(|(one, both)| (both[part] - 2.0 * one[part]).abs() <= SMALL * largest)
            };
            if count >= MOST || (0..=WIDTH).all(is_close) {
                return sums.iter().map(|sum| sum.scaled(1.0 / f64::from(count))).collect();
            }
        }
    }

    /// The motion of all shafts at a drive angle.
    fn motion(&self, angle: Carried) -> MotionAt {
        let (zero, one) = (Dual::constant(0.0), Dual::constant(1.0));
        let (mut error, mut rates) = (zero, [one, zero, zero]);
        let mut at = MotionAt { errors: vec![error], rates: vec![rates], pins: vec![] };
        let (mut s, mut c) = angle.sin_cos();
        for (j, DualStage { joint, turn: (sine, cosine), .. }) in self.stages.iter().enumerate() {
            if j > 0 {
                (s, c) = (s * *cosine + c * *sine, c * *cosine - s * *sine);
            }
            at.pins.push((s, c));
            let (y, x) = joint.error_tangent(s, c);
            error = error + Dual::atan2(y, x);
            let ([r, a, k], [ratio, acceleration, jerk]) = (rates, joint.rates::<true>(s, c));
            rates = [
                ratio * r,
                acceleration * r.square() + ratio * a,
                jerk * r * r.square() + (acceleration * r * a).scaled(3.0) + ratio * k,
            ];
            at.errors.push(error);
            at.rates.push(rates);
            (s, c) = joint.driven(s, c);
        }
        at
    }
}

fn parts(number: Carried) -> [f64; WIDTH + 1] {
    std::array::from_fn(|i| if i < WIDTH { number.by[i] } else { number.value })
}

/// Rotates two perpendicular vectors in their plane, from the first towards the second.
fn rotated(
    a: Direction,
    b: Direction,
    (sine, cosine): (Carried, Carried),
) -> (Direction, Direction) {
    let one = std::array::from_fn(|i| a[i] * cosine + b[i] * sine);
    (one, std::array::from_fn(|i| b[i] * cosine - a[i] * sine))
}

/// The motion of all shafts, and sine and cosine of the input angle of each joint.
struct MotionAt {
    errors: Vec<Carried>,
    rates: Vec<[Carried; 3]>,
    pins: Vec<(Carried, Carried)>,
}

/// The state of a driveline at one drive angle.
pub(super) struct SampleAsBuilt<'a> {
    pass: &'a Pass,
    angle: Carried,
    motion: MotionAt,
    /// Power over the drive's speed, on its way into each shaft and out of the last.
    power: Vec<Carried>,
    step: Option<&'a ForceStep>,
    /// The forces of both supports of each balanced shaft.
    forces: Vec<[Direction; 2]>,
}

impl<'a> SampleAsBuilt<'a> {
    pub(super) fn new(
        pass: &'a Pass,
        step: Option<&'a ForceStep>,
        angle: f64,
        load: Option<&LoadAt>,
    ) -> Self {
        let angle = pass.number(angle, Variable::Angle);
        let motion = pass.motion(angle);
        let power = load.map_or_else(Vec::new, |load| pass.powers(&motion, load));
        let mut sample = Self { pass, angle, motion, power, step, forces: vec![] };
        let (axis, support) = (|shaft| sample.axis(shaft), |shaft| sample.support(shaft));
        let solve = |step| solve_as_built(step, &pass.places, axis, support);
        sample.forces = step.map_or_else(Vec::new, solve);
        sample
    }

    fn ratio(&self, shaft: usize) -> Carried {
        self.motion.rates[shaft][0]
    }

    /// The torsion of a joint's driving shaft.
    fn torsion(&self, joint: usize) -> Carried {
        self.power[joint + 1] / self.ratio(joint)
    }

    /// An output of a shaft, joint or bearing. Scalars are in the first component.
    pub(super) fn output(&self, output: Output, item: usize) -> Direction {
        let zero = Dual::constant(0.0);
        let scalar = match output {
            Output::Moment => return self.moment(item),
            Output::SupportMoment => return self.support(item),
            Output::JointForce | Output::BearingForce => {
                let per = output.row().per;
                let target = self.step.and_then(|step| step.target((per, item)));
                let force = target.and_then(|target| target.force);
                return force.map_or([zero; 3], |of| as_built_forces::of(&self.forces, of));
            }
            Output::Angle => self.angle + self.error(item),
            Output::AngleError => self.error(item),
            Output::SpeedRatio => self.ratio(item),
            Output::AccelerationRatio => self.motion.rates[item][1],
            Output::JerkRatio => self.motion.rates[item][2],
            Output::Torque => self.power[item] / self.ratio(item),
            Output::TiltDriving | Output::TiltDriven => {
                let (joint, (s, c)) = (&self.pass.stages[item].joint, self.motion.pins[item]);
                let (y, x) = if output == Output::TiltDriving {
                    joint.tilt_driving_tangent(s, c)
                } else {
                    joint.tilt_driven_tangent(s, c)
                };
                Dual::atan2(y, x)
            }
            Output::BendingDriving | Output::BendingDriven => {
                let [in_plane, out_plane, normal] = self.unit_moments(item);
                let across = if output == Output::BendingDriving { in_plane } else { out_plane };
                self.torsion(item).abs() * (across.square() + normal.square()).sqrt()
            }
            _ => {
                debug_assert!(output.is_ideal(), "{output:?} has no formula here");
                zero
            }
        };
        [scalar, zero, zero]
    }

    fn error(&self, shaft: usize) -> Carried {
        self.motion.errors[shaft] - self.pass.means[shaft]
    }

    fn unit_moments(&self, joint: usize) -> Direction {
        let (s, c) = self.motion.pins[joint];
        self.pass.stages[joint].joint.moments(s, c)
    }

    /// The moment on the joint's driven shaft.
    fn moment(&self, joint: usize) -> Direction {
        let ([in_plane, _, normal], torsion) = (self.unit_moments(joint), self.torsion(joint));
        let [u, e, m] = &self.pass.stages[joint].axes;
        std::array::from_fn(|i| torsion * (u[i] + e[i] * in_plane - m[i] * normal))
    }

    fn axis(&self, shaft: usize) -> Direction {
        self.pass.stages.get(shaft).map_or(self.pass.last, |stage| stage.axes[0])
    }

    /// The moment of the joint behind a shaft minus that of the joint before it, across the shaft.
    fn support(&self, shaft: usize) -> Direction {
        let (joints, axis) = (self.pass.stages.len(), self.axis(shaft));
        let mut difference = [Dual::constant(0.0); 3];
        if shaft < joints {
            difference = self.moment(shaft);
        }
        if shaft > 0 {
            let before = self.moment(shaft - 1);
            difference = std::array::from_fn(|i| difference[i] - before[i]);
        }
        let [x, y, z]: Direction = std::array::from_fn(|i| difference[i] * axis[i]);
        let along = x + y + z;
        std::array::from_fn(|i| difference[i] - axis[i] * along)
    }
}

impl Pass {
    fn powers(&self, motion: &MotionAt, load: &LoadAt) -> Vec<Carried> {
        let n = motion.rates.len();
        let torque = self.number(load.torque, Variable::Torque);
        let [speed, acceleration] = [load.speed, load.acceleration].map(Dual::constant);
        let absorbed = |shaft: usize| {
            let inertia = self.number(load.inertias[shaft], Variable::Inertia(shaft));
            let [ratio, own, _] = motion.rates[shaft];
            absorbed_power(inertia, speed, acceleration, ratio, own)
        };
        let mut power = vec![torque; n + 1];
        match load.end {
            End::Drive => {
                for i in 0..n {
                    power[i + 1] = power[i] - absorbed(i);
                }
            }
            End::Output => {
                power[n] = torque * motion.rates[n - 1][0];
                for i in (0..n).rev() {
                    power[i] = power[i + 1] + absorbed(i);
                }
            }
        }
        power
    }
}
