//! Derivatives of drivelines from points: against differences of the plan's own results, which
//! other code computes, and the same bits whatever runs them.
#![allow(clippy::disallowed_methods, reason = "oracles are the platform's functions")]

use cardan::{
    Angles, Axes, Counts, Differentiated, Drivelines, End, Execution, Geometry, Load, Output, Per,
    Plan, Planes, Precision, Request, Samples, Source, Spread, SpreadAngles, SpreadLoad, Vector,
    Wanted, level,
};

const SAMPLES: usize = 700;
const STEP: f64 = 1e-6;
const BEARINGS: [usize; 3] = [0, 0, 1];

/// Every parameter of a driveline of three joints.
#[derive(Clone)]
struct Parameters {
    points: Vec<f64>,
    phases: Vec<f64>,
    torque: f64,
    inertias: Vec<f64>,
    positions: Vec<f64>,
    /// The first drive angle.
    angle: f64,
}

impl Parameters {
    fn new() -> Self {
        Self {
            points: vec![0.0, 0.0, 0.0, 1.0, 0.1, 0.0, 2.0, 0.3, 0.4, 3.2, 0.3, 0.3, 4.0, 0.2, 0.2],
            phases: vec![0.4, -1.0],
            torque: 30.0,
            inertias: vec![0.1, 0.2, 0.3, 0.4],
            positions: vec![0.2, 0.7, 0.6],
            angle: -2.0,
        }
    }

    fn lay_out(&self) -> Arrays {
        let points: Vec<_> = self.points.chunks(3).map(Vector::from_column_slice).collect();
        let line = Geometry::from_points(&points, &self.phases).unwrap();
        Arrays {
            directions: line.directions.iter().flat_map(|v| v.iter().copied()).collect(),
            normals: line.normals.iter().flat_map(|v| v.iter().copied()).collect(),
            lengths: points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect(),
            positions: self.positions.clone(),
            line,
        }
    }
}

struct Arrays {
    line: Geometry,
    directions: Vec<f64>,
    normals: Vec<f64>,
    lengths: Vec<f64>,
    positions: Vec<f64>,
}

impl Arrays {
    fn drivelines(&self) -> Drivelines<'_> {
        Drivelines {
            bends: &self.line.bends,
            twists: &self.line.twists,
            phases: &self.line.phases,
            directions: &self.directions,
            normals: &self.normals,
            lengths: &self.lengths,
            positions: &self.positions,
            deviations: &[],
        }
    }
}

fn outputs() -> Vec<(Output, Vec<usize>)> {
    let items =
        |output: Output| if output.row().per == Per::Shaft { vec![3] } else { vec![0, 1, 2] };
    Output::ALL.iter().map(|&output| (output, items(output))).collect()
}

/// A weight for each plane and sample.
fn weights(planes: usize, samples: usize) -> Vec<Vec<f64>> {
    let weight = |plane: usize, i: usize| (1.3 * plane as f64 + 0.37 * i as f64).sin();
    (0..planes).map(|plane| (0..samples).map(|i| weight(plane, i)).collect()).collect()
}

fn angles(given: &Parameters, samples: usize) -> Vec<f64> {
    (0..samples).map(|i| 0.011 * i as f64 + given.angle).collect()
}

fn constant(data: &[f64]) -> Spread<'_> {
    Spread { data, per_line: 0, per_sample: 0 }
}

fn gradient(given: &Parameters, samples: usize, wanted: Wanted, how: Execution<'_>) -> Vec<f64> {
    let arrays = given.lay_out();
    let angles = angles(given, samples);
    let load = SpreadLoad {
        end: End::Output,
        torque: constant(std::slice::from_ref(&given.torque)),
        speed: constant(&[20.0]),
        acceleration: constant(&[3.0]),
        inertias: given.inertias.iter().map(|x| Some(constant(std::slice::from_ref(x)))).collect(),
    };
    let task = Differentiated {
        joints: 3,
        lines: arrays.drivelines(),
        bearings: &BEARINGS,
        samples,
        outputs: outputs(),
        axes: Axes::Space,
        angle: SpreadAngles::Array(Spread { data: &angles, per_line: 0, per_sample: 1 }),
        driven: false,
        load: Some(load),
    };
    assert!(task.is_complete());
    let weights = weights(task.planes(), samples);
    let weights: Vec<&[f64]> = weights.iter().map(Vec::as_slice).collect();
    let mut out = vec![f64::NAN; wanted.count(Counts { joints: 3, bearings: 3 })];
    task.gradient(&weights, wanted, &mut out, how);
    out
}

/// The weighted sum of the plan's results.
fn value(given: &Parameters) -> f64 {
    let arrays = given.lay_out();
    let names: Vec<Output> = outputs().iter().map(|(output, _)| *output).collect();
    let plan = Plan::new(&Request {
        largest_bends: &arrays.line.bends,
        outputs: &names,
        shafts: &[3],
        joints: &[0, 1, 2],
        load: Some(End::Output),
        inertias: &[0, 1, 2, 3],
        bearings: Some(&BEARINGS),
        as_built: false,
        axes: Axes::Space,
    })
    .unwrap();
    let angles = angles(given, SAMPLES);
    let load = Load {
        torque: Source { data: std::slice::from_ref(&given.torque), strides: &[0] },
        speed: Source { data: &[20.0], strides: &[0] },
        acceleration: Source { data: &[3.0], strides: &[0] },
        inertias: given
            .inertias
            .iter()
            .enumerate()
            .map(|(i, x)| (i, Source { data: std::slice::from_ref(x), strides: &[0] }))
            .collect(),
    };
    let samples = Samples {
        shape: &[SAMPLES],
        lines: arrays.drivelines(),
        line_strides: &[0],
        angle: Angles::Array(Source { data: &angles, strides: &[1] }),
        load: Some(load),
    };
    let mut planes = vec![vec![0.0; SAMPLES]; plan.planes()];
    let mut parts: Vec<&mut [f64]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    plan.run(&samples, None, Precision::Double, Planes::Double(&mut parts), Execution::default())
        .unwrap();
    let weights = weights(plan.planes(), SAMPLES);
    let pairs = planes.iter().flatten().zip(weights.iter().flatten());
    pairs.map(|(x, weight)| x * weight).sum()
}

fn slope(change: impl Fn(&mut Parameters, f64)) -> f64 {
    let at = |step: f64| {
        let mut given = Parameters::new();
        change(&mut given, step);
        value(&given)
    };
    (at(STEP) - at(-STEP)) / (2.0 * STEP)
}

#[test]
fn gradients_are_differences_of_results() {
    let wanted = Wanted {
        value: true,
        phases: true,
        points: true,
        torque: true,
        inertias: true,
        positions: true,
        ..Wanted::default()
    };
    let mut found = gradient(&Parameters::new(), SAMPLES, wanted, Execution::default());
    let mut expected = vec![value(&Parameters::new())];
    expected.extend((0..2).map(|i| slope(|x, step| x.phases[i] += step)));
    expected.extend((0..15).map(|i| slope(|x, step| x.points[i] += step)));
    expected.push(slope(|x, step| x.torque += step));
    expected.extend((0..4).map(|i| slope(|x, step| x.inertias[i] += step)));
    expected.extend((0..3).map(|i| slope(|x, step| x.positions[i] += step)));
    let scale = expected.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    assert_eq!(found.len(), expected.len());
    let angle = Wanted { angle: true, ..Wanted::default() };
    found.extend(gradient(&Parameters::new(), SAMPLES, angle, Execution::default()));
    expected.push(slope(|x, step| x.angle += step));
    for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert!((found - expected).abs() < 1e-8 * scale, "{i}: {found} {expected}");
    }
}

#[test]
fn bits_depend_neither_on_threads_nor_on_the_instruction_set() {
    let wanted =
        Wanted { value: true, bends: true, twists: true, points: true, ..Default::default() };
    // Several blocks.
    let samples = 50_000;
    let alone = Execution { workers: Some(1), ..Execution::default() };
    let expected = gradient(&Parameters::new(), samples, wanted, alone);
    for (_, level) in level::available() {
        for workers in [1, 2, 3] {
            let how =
                Execution { level: Some(level), workers: Some(workers), ..Execution::default() };
            assert_eq!(gradient(&Parameters::new(), samples, wanted, how), expected);
        }
    }
}

#[test]
fn what_does_not_fit_is_incomplete() {
    let (given, angles) = (Parameters::new(), [0.1, 0.2]);
    let arrays = given.lay_out();
    let task = |bearings: &'static [usize], samples: usize, output: Output, item: usize| {
        let task = Differentiated {
            joints: 3,
            lines: Drivelines {
                positions: &arrays.positions[..bearings.len()],
                ..arrays.drivelines()
            },
            bearings,
            samples,
            outputs: vec![(output, vec![item])],
            axes: Axes::Space,
            angle: SpreadAngles::Array(Spread { data: &angles, per_line: 0, per_sample: 1 }),
            driven: false,
            load: Some(SpreadLoad {
                end: End::Drive,
                torque: constant(&[1.0]),
                speed: constant(&[0.0]),
                acceleration: constant(&[0.0]),
                inertias: vec![None; 4],
            }),
        };
        task.is_complete()
    };
    assert!(task(&BEARINGS, 2, Output::JointForce, 2));
    assert!(!task(&BEARINGS, 3, Output::JointForce, 2), "three samples, two angles");
    assert!(!task(&BEARINGS, 2, Output::JointForce, 3), "no such joint");
    assert!(!task(&BEARINGS, 2, Output::BearingForce, 3), "no such bearing");
    assert!(task(&[], 2, Output::Moment, 2));
    assert!(!task(&[], 2, Output::JointForce, 2), "two shafts float");
}
