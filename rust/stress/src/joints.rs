//! Single joints: every output at every tier, a block of samples at a time.

use cardan::{
    Angles, Axes, Drivelines, End, Execution, Geometry, Load, Output, Per, Plan, Planes, Precision,
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
        let exact = Quantity::all().map(|_| Exact::default()).collect();
        Self { kind, bends, samples: vec![], sweep, rows: vec![], exact }
    }

    fn put(&mut self, joint: &ExactJoint, at: &Turn, sample: JointSample) {
        let motion = joint.motion(at);
        for (exact, quantity) in self.exact.iter_mut().zip(Quantity::all()) {
            let (numbers, largest) = joint.exact(quantity, at, &motion, sample);
            if quantity == Quantity::Of(Output::JerkRatio) {
                exact.put(&numbers, &[joint.jerk_term(at)], largest);
            } else {
                exact.put(&numbers, &numbers, largest);
            }
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

/// Outputs that are computed together.
struct Job {
    outputs: Vec<Output>,
    shafts: &'static [usize],
    end: Option<End>,
    flywheel: bool,
}

/// All ways on which an output is computed: alone, with others in one loop, for a load.
fn jobs() -> Vec<Job> {
    use Output::{AccelerationRatio, Angle, AngleError, JerkRatio, SpeedRatio, Torque};

    let together = [
        vec![Angle, SpeedRatio, AccelerationRatio],
        vec![AngleError, SpeedRatio, AccelerationRatio],
        vec![Angle, AngleError],
        vec![SpeedRatio, AccelerationRatio],
        vec![AngleError, SpeedRatio, AccelerationRatio, JerkRatio],
    ];
    let (motion, others): (Vec<Output>, Vec<Output>) = Quantity::all()
        .filter_map(
            |quantity| if let Quantity::Of(output) = quantity { Some(output) } else { None },
        )
        .partition(|output| output.row().per == Per::Shaft);
    let loaded = [vec![Torque, Output::SupportMoment], others].concat();
    let alone = motion.into_iter().map(|output| vec![output]);
    let job = |end, flywheel| move |outputs, shafts| Job { outputs, shafts, end, flywheel };
    let mut jobs: Vec<Job> =
        together.into_iter().chain(alone).map(|own| job(None, false)(own, &[1])).collect();
    jobs.push(job(Some(End::Drive), false)(loaded, &[0, 1]));
    jobs.push(job(Some(End::Output), false)(vec![Torque], &[0]));
    jobs.push(job(Some(End::Output), true)(vec![Torque], &[1]));
    jobs
}

/// Runs so many blocks, every `stride`-th from `first` on.
pub(crate) fn run(seed: u64, blocks: impl Iterator<Item = u64>, broken: Option<Break>) -> Ledger {
    let mut ledger = Ledger::new();
    let (levels, jobs) = (level::available(), jobs());
    for number in blocks {
        let kind = Kind::ALL[(number % Kind::ALL.len() as u64) as usize];
        let mut random = Random::new(seed.wrapping_mul(0x1_0000_0001) ^ number << 20);
        let block = SampleBlock::new(kind, &mut random, &ledger.worst());
        // The best instruction set, and now and then another.
        let level = if number % 23 == 22 { 1 + number as usize / 23 } else { 0 };
        let (_, level) = levels[level % levels.len()];
        for tier in Tier::ALL {
            for job in &jobs {
                let planes = job.run(&block, tier, level);
                job.judge(&block, tier, planes, broken, &mut ledger);
            }
        }
    }
    ledger
}

impl Job {
    /// The quantity of each plane, and its component.
    fn planes(&self) -> Vec<Option<(Quantity, usize)>> {
        let of = |&output: &Output| {
            let per_shaft = output.row().per == Per::Shaft;
            let items = if per_shaft { self.shafts } else { &[1] };
            items.iter().flat_map(move |&shaft| {
                let quantity = match (output, self.end, shaft) {
                    (Output::Torque, Some(End::Drive), 0) => None,
                    (Output::Torque, Some(End::Drive), _) => Some(Quantity::TorqueDriven),
                    (Output::Torque, ..) if self.flywheel => Some(Quantity::TorqueFlywheel),
                    (Output::Torque, ..) => Some(Quantity::TorqueDriving),
                    (Output::SupportMoment, _, 0) => Some(Quantity::SupportDriving),
                    (Output::SupportMoment, ..) => Some(Quantity::SupportDriven),
                    _ => Some(Quantity::Of(output)),
                };
                (0..output.components()).map(move |component| Some((quantity?, component)))
            })
        };
        self.outputs.iter().flat_map(of).collect()
    }

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
            outputs: &self.outputs,
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
        let places = self.planes();
        for (plane, place) in planes.iter_mut().zip(&places) {
            if let (Some(broken), Some((quantity, _))) = (broken, place)
                && *quantity == broken.quantity
            {
                let unit = if tier.is_single() { 1 << 29 } else { 1 };
                let at = &mut plane[BLOCK / 2];
                *at = f64::from_bits(at.to_bits().wrapping_add_signed(broken.ulps * unit));
            }
        }
        for (place, plane) in places.iter().zip(&planes) {
            let &Some((quantity, component)) = place else { continue };
            let errors = ledger.of_mut(tier, quantity);
            let Exact { components, ulp, largest } = &block.exact[quantity.number()];
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
