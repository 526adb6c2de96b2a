//! Torsional vibration: periodic orbits and their multipliers, in parts of the largest value.

use std::f64::consts::PI;

use cardan::dynamics::{OF_DRIVE, Runs, multipliers_of_batch, orbits_of_batch, steady_of_batch};
use cardan::{Execution, ShaftEnds, TorsionalSystem};

use crate::error_table::{ErrorTable, RowLimits};
use crate::exact::ExactChain;
use crate::judge;
use crate::samples::Random;
use crate::shape_errors::ShapeErrors;
use crate::vibration::{VibratingDriveline, VibrationInstant, motion_of_pieces};

/// What the report says above the table.
const ABOUT: &str = r"Torsional vibration is judged in parts of the largest value: of a torque over the turn, of the angles, speeds
and accelerations of all shaft ends, and of the drive torque over 64 samples of half a turn. The permitted
error is the library's default, 1e-9. The oracle goes joint by joint, integrates half a turn of the drive by
the extrapolated midpoint rule, and corrects the start of the orbit until it closes. It judges the
multipliers by the traces of powers of the map of half a turn, which it finds by differences. Where joints lie
only before a single compliant shaft, mean, extremes and orders of the torque are those of the exact series.
";

/// What is judged.
const NAMES: [&str; 9] = [
    "mean torque",
    "extreme torques",
    "orders of torque",
    "angles",
    "speeds",
    "accelerations",
    "torques",
    "drive torque",
    "multipliers",
];

/// Samples of each orbit.
const SAMPLES: usize = 64;

/// The default of the library: the permitted error relative to the largest value.
const TOLERANCE: f64 = 1e-9;

const ORDERS: [usize; 3] = [2, 4, 6];

/// A kind of driveline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TorsionShape {
    Linear,
    One,
    Several,
}

impl TorsionShape {
    const ALL: [Self; 3] = [Self::Linear, Self::One, Self::Several];

    fn name(self) -> &'static str {
        match self {
            Self::Linear => "1 to 3 joints before the only compliant shaft",
            Self::One => "1 to 3 joints, any shaft compliant",
            Self::Several => "2 to 4 joints, 2 or 3 compliant shafts",
        }
    }

    fn line(self, random: &mut Random) -> VibratingDriveline {
        let joints = if self == Self::Several { 2 } else { 1 } + random.below(3);
        let compliant: Vec<usize> = match self {
            Self::Linear => vec![joints],
            Self::One => vec![random.below(joints + 1)],
            Self::Several => {
                let rigid = random.below(joints + 1);
                let mut others: Vec<usize> = (0..=joints).filter(|&i| i != rigid).collect();
                while others.len() > 3 {
                    others.remove(random.below(others.len()));
                }
                others
            }
        };
        let mut many = |count: usize, least: f64, most: f64| -> Vec<f64> {
            (0..count).map(|_| random.between(least, most)).collect()
        };
        let bends = many(joints, 0.02, 0.5);
        let (twists, phases) = (many(joints - 1, -PI, PI), many(joints - 1, -PI, PI));
        let inertias: Vec<f64> = many(2 * (joints + 1), -2.5, -0.5);
        let inertias: Vec<f64> = inertias.iter().map(|power| 10_f64.powf(*power)).collect();
        let stiffnesses: Vec<f64> = (0..=joints)
            .map(|i| if compliant.contains(&i) { random.power(3.0, 4.5) } else { f64::INFINITY })
            .collect();
        let damping = |(&c, ends): (&f64, &[f64])| {
            if c.is_finite() { 2.0 * random.between(0.03, 0.2) * (c * ends[1]).sqrt() } else { 0.0 }
        };
        let dampings = stiffnesses.iter().zip(inertias.chunks(2)).map(damping).collect();
        let load = [random.between(-20.0, 60.0), random.between(0.0, 0.05)];
        VibratingDriveline { bends, twists, phases, inertias, stiffnesses, dampings, load }
    }
}

/// The worst errors of a kind of driveline.
type TorsionErrors = ShapeErrors<TorsionShape, 1, 9>;

fn limits() -> [f64; 9] {
    NAMES.map(|name| judge::limit("torsion", name, "worst").expect("the table has it"))
}

/// Judges a few samples of each kind: each takes some thirty milliseconds.
pub(crate) fn table(seed: u64, samples: u64) -> ErrorTable {
    let head = ("Torsional vibration", ABOUT);
    let rows = [RowLimits { name: "tolerance=1e-9", single: true, limits: limits() }];
    ErrorTable::of(head, NAMES, &rows, &run(seed, samples / 250), TorsionShape::name)
}

/// At least so many systems of each kind.
fn run(seed: u64, systems: u64) -> Vec<TorsionErrors> {
    let mut random = Random::new(seed ^ 0x7025);
    ShapeErrors::of_each(&TorsionShape::ALL, systems, |shape, found| {
        let line = shape.line(&mut random);
        let speed = random.power(-0.8, 0.5);
        judge(&line, speed, found);
    })
}

/// What the core computes of a system at a speed.
struct Vibration {
    steady: Vec<f64>,
    orbit: Vec<f64>,
    multipliers: Vec<[f64; 2]>,
}

/// `None` if there is no orbit.
fn evaluate(system: &TorsionalSystem, speed: f64) -> Option<Vibration> {
    let systems = std::slice::from_ref(system);
    let runs = Runs { systems, system: &[0], speed: &[speed], tolerance: TOLERANCE };
    let (m, ends) = (system.compliant(), 2 * system.shafts());
    let mut steady = vec![f64::NAN; 3 * m + OF_DRIVE + 2 * ORDERS.len() * (m + ends)];
    let mut orbit = vec![f64::NAN; SAMPLES * (3 * ends + m + 1)];
    let mut multipliers = vec![f64::NAN; 2 * system.multipliers() + 2];
    let mut failures = [None; 3];
    let [one, two, three] = &mut failures;
    let alone = || Execution { workers: Some(1), ..Execution::default() };
    steady_of_batch(
        &runs,
        &ORDERS.map(|order| order as f64),
        &mut steady,
        std::slice::from_mut(one),
        alone(),
    );
    orbits_of_batch(&runs, SAMPLES, &mut orbit, std::slice::from_mut(two), alone());
    multipliers_of_batch(&runs, &mut multipliers, std::slice::from_mut(three), alone());
    let multipliers = multipliers[..4 * m].as_chunks().0.to_vec();
    failures.iter().all(Option::is_none).then_some(Vibration { steady, orbit, multipliers })
}

/// Judges a system at a speed, given in parts of the lowest natural frequency.
fn judge(line: &VibratingDriveline, speed: f64, found: &mut TorsionErrors) {
    let VibratingDriveline { bends, twists, phases, inertias, stiffnesses, dampings, load } = line;
    let ends = ShaftEnds { inertias, stiffnesses, dampings };
    let system = TorsionalSystem::new(bends, twists, phases, ends, *load).expect("it is sound");
    let frequencies = system.natural_frequencies();
    let speed = speed * frequencies[0];
    let Some(core) = evaluate(&system, speed) else { return };
    let place = |name: &str| format!("{name} of {line:?} at {speed:?} rad/s");
    let (m, count) = (system.compliant(), inertias.len());
    let value = |row: usize, i: usize| core.orbit[row * SAMPLES + i];
    // From the core's own start, if that is one: its angles and speeds there.
    let (leads, of_pieces) = line.leads();
    let outputs: Vec<usize> =
        (0..=bends.len()).filter(|&i| stiffnesses[i].is_finite()).map(|i| 2 * i + 1).collect();
    let angles = outputs.iter().zip(&of_pieces[1..]).map(|(&end, lead)| value(end, 0) + lead);
    let speeds = outputs.iter().map(|&end| value(count + end, 0) - speed);
    let start: Vec<f64> = std::iter::once(0.0).chain(angles).chain([speed]).chain(speeds).collect();
    let (time, highest) = (PI / speed, frequencies[m - 1]);
    let steps = 8 * (1.0 + 0.05 * highest * time).ceil() as usize;
    let (columns, mut state) = line.closed(&start, time, steps);
    let mut exact: Vec<VibrationSample> = vec![];
    for i in 0..SAMPLES {
        if i > 0 {
            state = line.after(&state, time / SAMPLES as f64, steps.div_ceil(SAMPLES));
        }
        exact.push(VibrationSample::of(line, &state, &leads));
    }
    for (kind, rows) in [count, count, count, m, 1].into_iter().enumerate() {
        let first = [0, count, 2 * count, 3 * count, 3 * count + m][kind];
        let all = exact.iter().flat_map(|sample| &sample.0[kind]);
        let largest = all.fold(0.0, |most: f64, x| most.max(x.abs()));
        for (i, sample) in exact.iter().enumerate() {
            for row in 0..rows {
                let off = (value(first + row, i) - sample.0[kind][row]).abs() / largest;
                found.take(0, 3 + kind, off, || place(NAMES[3 + kind]));
            }
        }
    }
    for (off, size) in apart_by_powers(&columns, &core.multipliers) {
        found.take(0, 8, off / size, || place(NAMES[8]));
    }
    if found.shape == TorsionShape::Linear {
        judge_series(line, speed, &core.steady, found);
    }
    found.judged += 1;
}

/// Of all shaft ends: angles relative to the drive without constants, speeds, accelerations; the
/// torques of compliant shafts, and that of the drive.
struct VibrationSample([Vec<f64>; 5]);

impl VibrationSample {
    fn of(line: &VibratingDriveline, state: &[f64], leads: &[f64]) -> Self {
        let [angles, speeds] = motion_of_pieces(state);
        let at: VibrationInstant = line.at(&angles, &speeds);
        let accelerations = line.accelerations(&at, &speeds);
        let motions: Vec<_> =
            at.ends.iter().map(|end| end.motion(&speeds, &accelerations)).collect();
        let error = |(motion, lead): (&[f64; 3], &f64)| motion[0] - angles[0] - lead;
        Self([
            motions.iter().zip(leads).map(error).collect(),
            motions.iter().map(|motion| motion[1]).collect(),
            motions.iter().map(|motion| motion[2]).collect(),
            at.torques.clone(),
            vec![at.drive_torque(speeds[0])],
        ])
    }
}

/// The differences between the traces of the powers of a matrix and the sums of the powers of its
/// eigenvalues, with the sizes that they could have.
fn apart_by_powers(columns: &[Vec<f64>], eigenvalues: &[[f64; 2]]) -> Vec<(f64, f64)> {
    let n = columns.len();
    let times = |a: &[Vec<f64>], b: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let entry = |r: usize, own: &Vec<f64>| (0..n).map(|k| a[k][r] * own[k]).sum();
        b.iter().map(|own| (0..n).map(|r| entry(r, own)).collect()).collect()
    };
    let mut power = columns.to_vec();
    let mut found = vec![];
    for exponent in 1..=n as i32 {
        if exponent > 1 {
            power = times(columns, &power);
        }
        let trace: f64 = (0..n).map(|i| power[i][i]).sum();
        let one = |[re, im]: &[f64; 2]| {
            re.hypot(*im).powi(exponent) * (f64::from(exponent) * im.atan2(*re)).cos()
        };
        let sum: f64 = eigenvalues.iter().map(one).sum();
        let size = eigenvalues.iter().map(|[re, im]| re.hypot(*im)).fold(0.0, f64::max);
        found.push(((trace - sum).abs(), size.powi(exponent).max(1.0)));
    }
    found
}

/// The exact series of joints before the only compliant shaft, whose equation is linear.
fn judge_series(line: &VibratingDriveline, speed: f64, steady: &[f64], found: &mut TorsionErrors) {
    const STEPS: usize = 256;
    let VibratingDriveline { bends, twists, phases, inertias, stiffnesses, dampings, load } = line;
    let last = bends.len();
    let (inertia, c, d) = (inertias[2 * last + 1], stiffnesses[last], dampings[last]);
    let q = ExactChain::of(bends, twists, phases).q();
    // −q̄, of which the angle error is the imaginary part of the logarithmic series.
    let (modulus, argument) = (q.re.high.hypot(q.im.high), q.im.high.atan2(-q.re.high));
    let mean = load[0] + load[1] * speed;
    let amplitude = |n: i32| -> [f64; 2] {
        let (order, size) = (f64::from(2 * n) * speed, modulus.powi(n) / f64::from(n));
        let phase = f64::from(n) * argument;
        let given = [size * phase.cos(), size * phase.sin()];
        let force = product(given, [inertia * order * order, -order * load[1]]);
        let twist = quotient(force, [c - inertia * order * order, order * (d + load[1])]);
        let torque = product(twist, [-c, -order * d]);
        // Im (z exp) is Re (−i z exp).
        [torque[1], -torque[0]]
    };
    let amplitudes: Vec<[f64; 2]> = (1..200).map(amplitude).collect();
    let at = |angle: f64| -> f64 {
        let terms = amplitudes.iter().zip(1_i32..).map(|([re, im], n)| {
            let (s, c) = (f64::from(2 * n) * angle).sin_cos();
            re * c - im * s
        });
        mean + terms.sum::<f64>()
    };
    let width = PI / STEPS as f64;
    let samples: Vec<f64> = (0..STEPS).map(|i| at(width * i as f64)).collect();
    let extreme = |sign: f64| -> f64 {
        let best = (0..STEPS)
            .max_by(|&i, &j| (sign * samples[i]).total_cmp(&(sign * samples[j])))
            .expect("there are samples");
        let (mut low, mut high) = (width * (best as f64 - 1.0), width * (best as f64 + 1.0));
        for _ in 0..60 {
            let third = (high - low) / 3.0;
            if sign * at(low + third) < sign * at(high - third) {
                low += third;
            } else {
                high -= third;
            }
        }
        at(0.5 * (low + high))
    };
    let largest = samples.iter().fold(mean.abs(), |most, x| most.max(x.abs()));
    let place = |name: &str| format!("{name} of {line:?} at {speed:?} rad/s");
    let mut take = |which: usize, got: f64, want: f64| {
        found.take(0, which, (got - want).abs() / largest, || place(NAMES[which]));
    };
    take(0, steady[0], mean);
    take(1, steady[1], extreme(-1.0));
    take(1, steady[2], extreme(1.0));
    for (i, order) in ORDERS.iter().enumerate() {
        for part in 0..2 {
            take(2, steady[3 + OF_DRIVE + 2 * i + part], amplitudes[order / 2 - 1][part]);
        }
    }
}

fn product([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a * c - b * d, a * d + b * c]
}

fn quotient(a: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    let size = c * c + d * d;
    product(a, [c / size, -d / size])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_within_limits(found: &TorsionErrors) {
        for ((off, place), limit) in found.off[0].iter().zip(&found.place[0]).zip(limits()) {
            assert!(*off <= limit, "{off} of {limit}: {place}");
        }
    }

    #[test]
    fn vibrations_are_within_their_limits() {
        run(7, 20).iter().for_each(assert_within_limits);
    }

    /// A system and its speed, from a line of `cardan-stress --worst`.
    fn printed(line: &str) -> (VibratingDriveline, f64) {
        let between = |start: &str, end: &str| -> Vec<f64> {
            let (_, rest) = line.split_once(start).expect("it is named");
            let (list, _) = rest.split_once(end).expect("it ends");
            let numbers = list.split(", ").filter(|number| !number.is_empty());
            numbers.map(|number| number.parse().expect("it is a number")).collect()
        };
        let load = between("load: [", "]");
        let line = VibratingDriveline {
            bends: between("bends: [", "]"),
            twists: between("twists: [", "]"),
            phases: between("phases: [", "]"),
            inertias: between("inertias: [", "]"),
            stiffnesses: between("stiffnesses: [", "]"),
            dampings: between("dampings: [", "]"),
            load: [load[0], load[1]],
        };
        (line, between("} at ", " rad/s")[0])
    }

    #[test]
    fn the_worst_vibrations_found_are_within_their_limits() {
        for text in include_str!("../worst_torsion.txt").lines() {
            let (line, speed) = printed(text);
            let linear = line.stiffnesses.iter().rev().skip(1).all(|c| c.is_infinite());
            let shape = if linear { TorsionShape::Linear } else { TorsionShape::Several };
            let mut found: TorsionErrors = ShapeErrors::of_each(&[shape], 0, |_, _| ()).remove(0);
            judge(&line, speed, &mut found);
            assert_eq!(found.judged, 1, "no orbit: {text}");
            assert_within_limits(&found);
        }
    }
}
