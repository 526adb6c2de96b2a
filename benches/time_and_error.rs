//! The closing table of `cargo bench`: what each arithmetic costs, and what it is off.
//!
//! The reference is `tolerance=0`, whose results are within one ulp; `cardan-stress` holds it against
//! exact numbers. Errors are in parts of the largest value over a turn, those of doubles also in ulp of
//! the value itself, of a vector of its largest component. Behind several joints the ulp mean little,
//! because a sum that vanishes has few digits next to its zero.

use std::hint::black_box;
use std::time::Instant;

use cardan::dynamics::{Runs, steady_of_batch};
use cardan::{Equivalent, Execution, Level, Output, Precision, ShaftEnds, TorsionalSystem, level};

use crate::case::Case;

use Output::{AccelerationRatio, Angle, BearingForce, Moment, SpeedRatio, SupportMoment};

const ANGLES: usize = 10_000;
const SPEEDS: usize = 1000;
const ROUNDS: usize = 20;

const MOTION: &[Output] = &[Angle, SpeedRatio, AccelerationRatio];

/// Name, joints and outputs.
const JOBS: [(&str, usize, &[Output]); 7] = [
    ("speed ratio", 1, &[SpeedRatio]),
    ("angle", 1, &[Angle]),
    ("motion", 1, MOTION),
    ("motion, three joints", 3, MOTION),
    ("moment", 1, &[Moment]),
    ("support moment, two joints", 2, &[SupportMoment]),
    ("bearing forces, two joints", 2, &[BearingForce]),
];

/// The arithmetics in the words of a caller, and whether results are singles.
const TIERS: [(&str, Precision, bool); 4] = [
    ("tolerance=0", Precision::DoubleDouble, false),
    ("default", Precision::Double, false),
    ("tolerance=1e-6", Precision::Single, false),
    ("float32", Precision::Single, true),
];

pub(crate) fn print() {
    for (name, level) in level::available() {
        // Without a fused multiply-add in hardware every step is a call.
        if !name.starts_with("sse") {
            println!("\n{name}, one thread, {ANGLES} angles, bends of 20 degrees");
            evaluations(level);
        }
    }
    searches();
    torsion();
}

fn evaluations(level: Level) {
    println!(
        "{:28} {:>15} {:>12} {:>14} {:>10}",
        "", "", "ns per angle", "of the largest", "worst ulp"
    );
    for (name, joints, outputs) in JOBS {
        let mut reference = vec![];
        for (tier, precision, single) in TIERS {
            let mut case = Case::new(joints, 20.0, outputs, ANGLES);
            case.precision = precision;
            if single {
                case.singles = Some(vec![vec![0.0; ANGLES]; case.planes.len()]);
            }
            let time = shortest(|| case.run(level, Some(1))) / ANGLES as f64;
            let found = match case.singles {
                Some(planes) => planes
                    .into_iter()
                    .map(|plane| plane.into_iter().map(f64::from).collect())
                    .collect(),
                None => case.planes,
            };
            let [mut part, mut ulp] = [const { String::new() }; 2];
            if precision == Precision::DoubleDouble {
                reference = found;
            } else {
                part = format!("{:.0e}", worst_part(outputs, &found, &reference));
                if precision == Precision::Double {
                    ulp = format!("{:.1}", worst_ulp(outputs, &found, &reference));
                }
            }
            println!("{name:28} {tier:>15} {time:>12.2} {part:>14} {ulp:>10}");
        }
    }
}

/// The planes of each output: a component of a vector, or all of it.
fn vectors<'a>(outputs: &[Output], planes: &'a [Vec<f64>]) -> impl Iterator<Item = &'a [Vec<f64>]> {
    let is_vector = [Moment, SupportMoment, BearingForce].contains(&outputs[0]);
    planes.chunks(if is_vector { 3 } else { 1 })
}

fn worst_ulp(outputs: &[Output], found: &[Vec<f64>], exact: &[Vec<f64>]) -> f64 {
    let mut worst = 0.0_f64;
    for (found, exact) in vectors(outputs, found).zip(vectors(outputs, exact)) {
        for i in 0..ANGLES {
            let size = exact.iter().fold(0.0_f64, |size, plane| size.max(plane[i].abs()));
            let ulp = size.next_up() - size;
            for (found, exact) in found.iter().zip(exact) {
                worst = worst.max((found[i] - exact[i]).abs() / ulp);
            }
        }
    }
    worst
}

fn worst_part(outputs: &[Output], found: &[Vec<f64>], exact: &[Vec<f64>]) -> f64 {
    let mut worst = 0.0_f64;
    for (found, exact) in vectors(outputs, found).zip(vectors(outputs, exact)) {
        let size = exact.iter().flatten().fold(0.0_f64, |size, x| size.max(x.abs()));
        for (found, exact) in found.iter().flatten().zip(exact.iter().flatten()) {
            worst = worst.max((found - exact).abs() / size);
        }
    }
    worst
}

/// Phases and equivalent joints of single drivelines.
fn searches() {
    println!("\n{:28} {:>15} {:>25}", "one driveline", "µs", "remaining tan(bend/2)");
    for joints in [3, 4, 5, 8] {
        let bends: Vec<f64> = (0..joints).map(|i| 0.2 - 0.01 * f64::from(i)).collect();
        let turns = vec![0.3; bends.len() - 1];
        let search = || cardan::optimal_phases(&bends, &turns, &turns);
        let left = Equivalent::of_chain(&bends, &turns, &search()).joint.k.sqrt();
        let time = shortest(|| _ = black_box(search())) / 1e3;
        println!("{:28} {time:>15.1} {left:>25.0e}", format!("phases of {joints} joints"));
    }
    let time = shortest(|| _ = black_box(Equivalent::of_chain(&[0.2; 3], &[0.3; 2], &[0.1; 2])));
    println!("{:28} {:>15.2}", "equivalent joint of three", time / 1e3);
}

/// Periodic motions over the speed, by the permitted error.
fn torsion() {
    let shafts = ShaftEnds {
        inertias: &[0.0, 0.004, 0.006, 0.02, 0.01, 0.05],
        stiffnesses: &[f64::INFINITY, 9000.0, 4000.0],
        dampings: &[0.0, 0.6, 0.4],
    };
    let system = TorsionalSystem::new(&[0.2, 0.25], &[0.1], &[0.0], shafts, [30.0, 0.0])
        .expect("the system is valid");
    let speed: Vec<f64> = (0..SPEEDS).map(|i| 50.0 + 0.3 * i as f64).collect();
    let run = |tolerance| {
        let runs = Runs {
            systems: std::slice::from_ref(&system),
            system: &[0; SPEEDS],
            speed: &speed,
            tolerance,
        };
        // Mean, least and largest torque of two shafts.
        let (mut results, mut failures) = (vec![0.0; 6 * SPEEDS], vec![None; SPEEDS]);
        let execution = Execution { workers: Some(1), ..Execution::default() };
        let start = Instant::now();
        steady_of_batch(&runs, &[], &mut results, &mut failures, execution);
        assert!(failures.iter().all(Option::is_none), "every speed has an orbit");
        (start.elapsed().as_secs_f64() * 1e6 / SPEEDS as f64, vec![results])
    };
    println!("\n{:28} {:>15} {:>25}", "two compliant shafts", "µs per speed", "worst part");
    let (_, exact) = run(1e-13);
    for tolerance in [1e-4, 1e-6, 1e-9] {
        let (time, found) = run(tolerance);
        let error = found[0].iter().zip(&exact[0]).fold(0.0_f64, |worst, (found, exact)| {
            worst.max((found - exact).abs() / exact.abs().max(1.0))
        });
        println!("{:28} {time:>15.1} {error:>25.0e}", format!("tolerance {tolerance:.0e}"));
    }
}

/// Shortest of some calls, in nanoseconds.
fn shortest(mut call: impl FnMut()) -> f64 {
    let times = (0..ROUNDS).map(|_| {
        let start = Instant::now();
        call();
        start.elapsed().as_secs_f64() * 1e9
    });
    times.fold(f64::INFINITY, f64::min)
}
