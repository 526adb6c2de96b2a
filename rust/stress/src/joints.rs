//! Single joints: every output at every tier, a block of samples at a time.

use cardan::{
    Angles, Axes, Drivelines, End, Execution, Geometry, Load, Output, Plan, Planes, Precision,
    Request, Samples, Source, Sweep, level,
};

use crate::exact::{ExactJoint, Turn};
use crate::judge::{Ledger, Quantity, Tier, Worst, rows_of};
use crate::samples::{JointSample, Kind, Random};
use crate::wide::{Wide, two_sum};

/// Rows of one joint each, and samples in a row.
const ROWS: usize = 64;
const ROW: usize = 128;
pub(crate) const BLOCK: usize = ROWS * ROW;

/// A result that is made wrong on purpose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Break {
    pub(crate) quantity: Quantity,
    /// By so many units in the last place, at one sample of a block.
    pub(crate) ulps: i64,
}

/// The samples of a block and what is exact for them.
struct SampleBlock {
    kind: Kind,
    bends: Vec<f64>,
    samples: Vec<JointSample>,
    sweep: Option<Sweep>,
    /// Rows of the tables that each sample belongs to.
    rows: Vec<[usize; 3]>,
    exact: Vec<Exact>,
}

/// The exact results of one quantity.
#[derive(Default)]
struct Exact {
    /// The results, a component at a time.
    components: Vec<Vec<Wide>>,
    /// The unit of errors in ulp: that of a vector's largest component, and of the larger term of a
    /// difference.
    ulp: Vec<f64>,
    /// The largest over a turn.
    largest: Vec<f64>,
}

impl Exact {
    fn put(&mut self, numbers: &[Wide], terms: &[Wide], largest: f64) {
        self.components.resize_with(numbers.len(), Vec::new);
        for (component, &number) in self.components.iter_mut().zip(numbers) {
            component.push(number);
        }
        let by_size = |a: &&Wide, b: &&Wide| a.high.abs().total_cmp(&b.high.abs());
        self.ulp.push(terms.iter().max_by(by_size).map_or(0.0, |x| x.ulp()));
        self.largest.push(largest);
    }
}

impl SampleBlock {
    fn empty(kind: Kind, bends: Vec<f64>, sweep: Option<Sweep>) -> Self {
        let exact = Quantity::ALL.iter().map(|_| Exact::default()).collect();
        Self { kind, bends, samples: vec![], sweep, rows: vec![], exact }
    }

    fn put(&mut self, joint: &ExactJoint, at: &Turn, sample: JointSample) {
        use Quantity as Q;

        let motion = joint.motion(at);
        let torque = sample.torque;
        let times = |v: [Wide; 3]| v.map(|x| x * torque);
        let [support_driving, support_driven] = joint.supports(at).map(times);
        let [bending_driving, bending_driven] = joint.bending(at).map(|x| x * torque.abs());
        let pin_moment = joint.pin_moment(at) * torque.abs();
        let [tilt_driving, tilt_driven] = joint.tilts(at);
        let [swing_driving, swing_driven] = joint.swings(at);
        let [driving_pin, driven_pin] = joint.pins(at);
        let size = torque.abs();
        let [sin, cos, tan] = [joint.sin, joint.cos, joint.tan].map(|x| x.high);
        let steepest = joint.steepest();
        let bending = if cos * cos > 0.5 { sin } else { 0.5 / cos };
        let angle = motion.angle.high.abs().max(std::f64::consts::TAU);
        let bending_largest = size * bending;
        for (quantity, numbers, largest) in [
            (Q::Angle, &[motion.angle][..], angle),
            (Q::AngleError, &[motion.error], joint.k.high.min(1.0).asin()),
            (Q::SpeedRatio, &[motion.ratio], 1.0 / cos),
            (Q::AccelerationRatio, &[motion.acceleration], steepest),
            // The series of cosines with coefficients of one sign is largest where all are 1.
            (Q::JerkRatio, &[motion.jerk], 2.0 * tan * tan / cos),
            (Q::TorqueDriven, &[Wide::from(torque) / motion.ratio], size / cos),
            (Q::TorqueDriving, &[motion.ratio * torque], size / cos),
            (Q::TorqueFlywheel, &[motion.acceleration * torque], size * steepest),
            (Q::Moment, &times(joint.moment(at)), size / cos),
            (Q::SupportDriving, &support_driving, size * tan),
            (Q::SupportDriven, &support_driven, bending_largest),
            (Q::BendingDriving, &[bending_driving], size * tan),
            (Q::BendingDriven, &[bending_driven], bending_largest),
            (Q::PinMoment, &[pin_moment], size / cos),
            (Q::TiltDriving, &[tilt_driving], sample.bend),
            (Q::TiltDriven, &[tilt_driven], sample.bend),
            (Q::SwingDriving, &[swing_driving], tan),
            (Q::SwingDriven, &[swing_driven], sin),
            (Q::DrivingPin, &driving_pin, 1.0),
            (Q::DrivenPin, &driven_pin, 1.0),
        ] {
            let terms = if quantity == Q::JerkRatio { &[joint.jerk_term(at)] } else { numbers };
            self.exact[quantity as usize].put(numbers, terms, largest);
        }
        self.rows.push(rows_of(&sample, self.kind));
        self.samples.push(sample);
    }

    fn new(kind: Kind, random: &mut Random, worst: &[JointSample]) -> Self {
        if kind == Kind::Sweep {
            return Self::sweeping(random);
        }
        let rows = if kind == Kind::Apart { BLOCK } else { ROWS };
        let bends: Vec<f64> = (0..rows).map(|_| kind.bend(random, worst)).collect();
        let mut block = Self::empty(kind, bends, None);
        for i in 0..rows {
            let bend = block.bends[i];
            let joint = ExactJoint::bent(bend);
            for _ in 0..BLOCK / rows {
                let angle = kind.angle(random, bend, worst);
                let torque = random.power(-3.0, 3.0) * random.sign();
                block.put(&joint, &Turn::by(&[angle]), JointSample { bend, angle, torque });
            }
        }
        block
    }

    /// One joint over a sweep, long enough for its groups.
    fn sweeping(random: &mut Random) -> Self {
        let bend = Kind::Sweep.bend(random, &[]);
        let joint = ExactJoint::bent(bend);
        let (sweep, turns): (_, Box<dyn Fn(usize) -> Turn>) = if random.below(2) == 0 {
            let per_turn = random.power(0.0, 5.0) as usize;
            let sweep = Sweep::of_turns(BLOCK, per_turn);
            (sweep, Box::new(move |i| Turn::part(i, per_turn)))
        } else {
            let size = random.pick(&[1e-3, 1.0, 10.0, 1e3]);
            let (start, stop) = (random.between(-size, size), random.between(-size, size));
            let span = two_sum(stop, -start);
            let turn = move |i| {
                let way = span * (i as f64) / Wide::from((BLOCK - 1) as f64);
                Turn::by(&[start, way.high, way.low])
            };
            (Sweep::new(start, stop, BLOCK), Box::new(turn))
        };
        let sweep = sweep.expect("sweeps of so many samples exist");
        let torque = random.power(-3.0, 3.0);
        let mut block = Self::empty(Kind::Sweep, vec![bend], Some(sweep));
        for i in 0..BLOCK {
            block.put(&joint, &turns(i), JointSample { bend, angle: sweep.at(i), torque });
        }
        block
    }
}

/// Where the planes of a plan go.
struct Job {
    outputs: &'static [Output],
    shafts: &'static [usize],
    end: Option<End>,
    flywheel: bool,
    /// The quantity of each plane, component by component.
    planes: &'static [Option<(Quantity, usize)>],
}

#[allow(clippy::unnecessary_wraps, reason = "beside planes that are not judged")]
const fn plane(quantity: Quantity) -> Option<(Quantity, usize)> {
    Some((quantity, 0))
}

/// All ways on which an output is computed: alone, with others in one loop, for a load.
#[rustfmt::skip]
const JOBS: &[Job] = {
    use Quantity as Q;
    const fn motion(
        outputs: &'static [Output], planes: &'static [Option<(Quantity, usize)>],
    ) -> Job {
        Job { outputs, shafts: &[1], end: None, flywheel: false, planes }
    }
    &[
        motion(
            &[Output::Angle, Output::SpeedRatio, Output::AccelerationRatio],
            &[plane(Q::Angle), plane(Q::SpeedRatio), plane(Q::AccelerationRatio)],
        ),
        motion(
            &[Output::AngleError, Output::SpeedRatio, Output::AccelerationRatio],
            &[plane(Q::AngleError), plane(Q::SpeedRatio), plane(Q::AccelerationRatio)],
        ),
        motion(&[Output::Angle, Output::AngleError], &[plane(Q::Angle), plane(Q::AngleError)]),
        motion(
            &[Output::SpeedRatio, Output::AccelerationRatio],
            &[plane(Q::SpeedRatio), plane(Q::AccelerationRatio)],
        ),
        motion(&[Output::Angle], &[plane(Q::Angle)]),
        motion(&[Output::AngleError], &[plane(Q::AngleError)]),
        motion(&[Output::SpeedRatio], &[plane(Q::SpeedRatio)]),
        motion(&[Output::AccelerationRatio], &[plane(Q::AccelerationRatio)]),
        motion(&[Output::JerkRatio], &[plane(Q::JerkRatio)]),
        motion(
            &[Output::AngleError, Output::SpeedRatio, Output::AccelerationRatio, Output::JerkRatio],
            &[
                plane(Q::AngleError), plane(Q::SpeedRatio), plane(Q::AccelerationRatio),
                plane(Q::JerkRatio),
            ],
        ),
        Job {
            outputs: &[
                Output::Torque, Output::SupportMoment, Output::Moment, Output::BendingDriving,
                Output::BendingDriven, Output::PinMoment, Output::TiltDriving, Output::TiltDriven,
                Output::SwingDriving, Output::SwingDriven, Output::DrivingPin, Output::DrivenPin,
            ],
            shafts: &[0, 1],
            end: Some(End::Drive),
            flywheel: false,
            planes: &[
                None, plane(Q::TorqueDriven),
                Some((Q::SupportDriving, 0)), Some((Q::SupportDriving, 1)),
                Some((Q::SupportDriving, 2)),
                Some((Q::SupportDriven, 0)), Some((Q::SupportDriven, 1)),
                Some((Q::SupportDriven, 2)),
                Some((Q::Moment, 0)), Some((Q::Moment, 1)), Some((Q::Moment, 2)),
                plane(Q::BendingDriving), plane(Q::BendingDriven),
                plane(Q::PinMoment), plane(Q::TiltDriving), plane(Q::TiltDriven),
                plane(Q::SwingDriving), plane(Q::SwingDriven),
                Some((Q::DrivingPin, 0)), Some((Q::DrivingPin, 1)), Some((Q::DrivingPin, 2)),
                Some((Q::DrivenPin, 0)), Some((Q::DrivenPin, 1)), Some((Q::DrivenPin, 2)),
            ],
        },
        Job {
            outputs: &[Output::Torque],
            shafts: &[0],
            end: Some(End::Output),
            flywheel: false,
            planes: &[plane(Q::TorqueDriving)],
        },
        Job {
            outputs: &[Output::Torque],
            shafts: &[1],
            end: Some(End::Output),
            flywheel: true,
            planes: &[plane(Q::TorqueFlywheel)],
        },
    ]
};

/// Runs so many blocks, every `stride`-th from `first` on.
pub(crate) fn run(seed: u64, blocks: impl Iterator<Item = u64>, broken: Option<Break>) -> Ledger {
    let mut ledger = Ledger::new();
    let levels = level::available();
    for number in blocks {
        let kind = Kind::ALL[(number % Kind::ALL.len() as u64) as usize];
        let mut random = Random::new(seed.wrapping_mul(0x1_0000_0001) ^ number << 20);
        let block = SampleBlock::new(kind, &mut random, &ledger.worst());
        // The best instruction set, and now and then another.
        let level = if number % 23 == 22 { 1 + number as usize / 23 } else { 0 };
        let (_, level) = levels[level % levels.len()];
        for tier in Tier::ALL {
            for job in JOBS {
                let planes = job.run(&block, tier, level);
                job.judge(&block, tier, planes, broken, &mut ledger);
            }
        }
    }
    ledger
}

impl Job {
    fn run(&self, block: &SampleBlock, tier: Tier, level: cardan::Level) -> Vec<Vec<f64>> {
        let mut directions = vec![];
        for &bend in &block.bends {
            let line = Geometry::from_bends(&[bend], &[], &[]).expect("bends are in range");
            directions.extend(line.directions.iter().flat_map(|u| [u.x, u.y, u.z]));
        }
        let normals: Vec<f64> = block.bends.iter().flat_map(|_| [0.0, 0.0, 1.0]).collect();
        let lines = Drivelines {
            bends: &block.bends,
            twists: &[],
            phases: &[],
            directions: &directions,
            normals: &normals,
            ..Drivelines::default()
        };
        let plan = Plan::new(&Request {
            largest_bends: &lines.largest_bends(1),
            outputs: self.outputs,
            shafts: self.shafts,
            joints: if self.shafts.len() == 2 { &[0] } else { &[] },
            load: self.end,
            inertias: if self.flywheel { &[1] } else { &[] },
            bearings: None,
            as_built: false,
            axes: Axes::Space,
        })
        .expect("the request is sound");
        let (rows, row) = (block.bends.len(), BLOCK / block.bends.len());
        let (zero, one) = ([0.0], [1.0]);
        let every = [row, 1];
        let still = [0, 0];
        let column = |f: fn(&JointSample) -> f64| block.samples.iter().map(f).collect::<Vec<f64>>();
        let (angles, torques) = (column(|s| s.angle), column(|s| s.torque));
        let constant = |data| Source { data, strides: &still };
        let each = |data| Source { data, strides: &every };
        let load = self.end.map(|_| Load {
            torque: if self.flywheel { constant(&zero) } else { each(&torques) },
            speed: constant(&one),
            acceleration: constant(&zero),
            inertias: if self.flywheel { vec![(1, each(&torques))] } else { vec![] },
        });
        let angle = match block.sweep {
            Some(sweep) => Angles::Sweep(sweep),
            None => Angles::Array(each(&angles)),
        };
        let shape = [rows, row];
        let samples = Samples { shape: &shape, lines, line_strides: &[1, 0], angle, load };
        let execution = Execution { level: Some(level), workers: Some(1), ..Execution::default() };
        let precision = match tier {
            Tier::Faithful => Precision::DoubleDouble,
            Tier::Default => Precision::Double,
            Tier::Loose | Tier::Float32 => Precision::Single,
        };
        let mut planes = vec![vec![f64::NAN; BLOCK]; plan.planes()];
        if tier == Tier::Float32 {
            let mut singles = vec![vec![f32::NAN; BLOCK]; plan.planes()];
            let mut views: Vec<_> = singles.iter_mut().map(Vec::as_mut_slice).collect();
            plan.run(&samples, None, precision, Planes::Single(&mut views), execution)
                .expect("the arrays fit");
            for (plane, single) in planes.iter_mut().zip(singles) {
                *plane = single.into_iter().map(f64::from).collect();
            }
        } else {
            let mut views: Vec<_> = planes.iter_mut().map(Vec::as_mut_slice).collect();
            plan.run(&samples, None, precision, Planes::Double(&mut views), execution)
                .expect("the arrays fit");
        }
        planes
    }

    fn judge(
        &self,
        block: &SampleBlock,
        tier: Tier,
        mut planes: Vec<Vec<f64>>,
        broken: Option<Break>,
        ledger: &mut Ledger,
    ) {
        for (plane, place) in planes.iter_mut().zip(self.planes) {
            if let (Some(broken), Some((quantity, _))) = (broken, place)
                && *quantity == broken.quantity
            {
                let unit = if tier.is_single() { 1 << 29 } else { 1 };
                let at = &mut plane[BLOCK / 2];
                *at = f64::from_bits(at.to_bits().wrapping_add_signed(broken.ulps * unit));
            }
        }
        for (place, plane) in self.planes.iter().zip(&planes) {
            let &Some((quantity, component)) = place else { continue };
            let errors = ledger.of_mut(tier, quantity);
            let Exact { components, ulp, largest } = &block.exact[quantity as usize];
            for (i, (&got, want)) in plane.iter().zip(&components[component]).enumerate() {
                let unit = if tier.is_single() { largest[i] } else { ulp[i] };
                // Products on the way to smaller results lose digits for want of smaller doubles,
                // and singles end at 1e38; so does the power, which hastens with a flywheel.
                let sound = if tier.is_single() {
                    let power = if self.flywheel { block.samples[i].cosine() } else { 1.0 };
                    (1e-30..1e30 * power).contains(&unit)
                } else {
                    unit > 1e-306 || want.high == 0.0
                };
                if sound {
                    let off = want.distance(got) / unit;
                    let found = Worst { off, sample: block.samples[i], got, want: want.high };
                    errors.take(found, block.kind, block.rows[i]);
                }
            }
        }
    }
}
