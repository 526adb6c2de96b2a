//! The explanation says what runs.

use super::*;
use crate::input::{Angles, Drivelines, Source, Sweep};
use crate::plan::request::{Axes, Request};
use crate::run::execution::{Execution, Planes};

/// Drivelines of three joints.
struct BatchCase {
    bends: Vec<f64>,
    between: Vec<f64>,
    frame: Vec<f64>,
}

impl BatchCase {
    fn new(bends: &[[f64; 3]]) -> Self {
        let count = bends.len();
        let between = [0.3, 0.4].repeat(count);
        Self { bends: bends.concat(), between, frame: vec![0.0; 12 * count] }
    }

    fn lines(&self) -> Drivelines<'_> {
        Drivelines {
            bends: &self.bends,
            twists: &self.between,
            phases: &self.between,
            directions: &self.frame,
            normals: &self.frame[..self.bends.len() * 3],
            ..Drivelines::default()
        }
    }

    fn plan(&self, outputs: &[Output], shafts: &[usize]) -> Plan {
        let request = Request {
            largest_bends: &self.lines().largest_bends(3),
            outputs,
            shafts,
            joints: &[],
            load: None,
            inertias: &[],
            bearings: None,
            as_built: false,
            axes: Axes::Space,
        };
        Plan::new(&request).unwrap()
    }
}

const MOTION: &[Output] = &[Output::AngleError, Output::SpeedRatio, Output::AccelerationRatio];

fn text(outputs: &[Output], shafts: &[usize], precision: Precision, angle: Angles<'_>) -> String {
    text_of([0.1, 0.0, 0.2], outputs, shafts, precision, angle)
}

fn text_of(
    bends: [f64; 3],
    outputs: &[Output],
    shafts: &[usize],
    precision: Precision,
    angle: Angles<'_>,
) -> String {
    let batch = BatchCase::new(&[bends]);
    let count = if let Angles::Sweep(sweep) = &angle { sweep.count() } else { 2 };
    let shape = &[count];
    let samples = Samples { shape, lines: batch.lines(), line_strides: &[0], angle, load: None };
    let call = Call { precision, reduction: None, single: false };
    batch.plan(outputs, shafts).explain(&samples, call).unwrap()
}

fn array() -> Angles<'static> {
    Angles::Array(Source { data: &[0.5], strides: &[0] })
}

fn has(text: &str, lines: &[&str]) {
    for line in lines {
        assert!(text.lines().any(|found| found.trim() == *line), "{line}: {text}");
    }
}

#[test]
fn what_runs_and_what_does_not() {
    let last = text(MOTION, &[3], Precision::Double, array());
    has(
        &last,
        &[
            "angle to unnormalised sine and cosine (tangent form, sign left open)",
            "shaft 3: sine and cosine turned to its equivalent joint",
            "joint 1: straight, it passes its rotation on",
            "joints one by one: the 3 before shaft 3 act as one",
            "shafts 0, 1, 2: motion not asked for",
            "torques and moments: not asked for",
        ],
    );
    assert!(last.contains("bytes read, 24 bytes written"), "{last}");
    assert!(!last.contains("twice the angle") && !last.contains("beyond"), "{last}");
    let twice = text(MOTION, &[3], Precision::DoubleDouble, array());
    has(&twice, &["angle to sine and cosine of twice the angle"]);
    assert!(!twice.contains("tangent form") && !twice.contains("turned to"), "{twice}");
    let first = text(&[Output::SpeedRatio], &[1], Precision::Double, array());
    has(&first, &["shaft 1: speed ratio", "joint 1 to 2: beyond everything asked for"]);
    assert!(!first.contains("turned to") && !first.contains("one by one"), "{first}");
    let second = text(&[Output::SpeedRatio], &[0, 1, 2], Precision::Double, array());
    has(&second, &["joint 2: beyond everything asked for", "shaft 3: motion not asked for"]);
    let drive = text(&[Output::SpeedRatio], &[0], Precision::Double, array());
    has(&drive, &["sine and cosine: everything turns with the drive"]);
    has(&drive, &["shaft 0: speed ratio, those of the drive"]);
}

#[test]
fn joints_that_compensate_each_other_are_skipped() {
    let of = |bend: f64| text_of([0.3, bend, 0.2], MOTION, &[2], Precision::DoubleDouble, array());
    let constant = of(0.3);
    let why = "the joints before it compensate each other exactly";
    has(&constant, &[&format!("shaft 2: turns with the drive, {why}")]);
    has(&constant, &["sine and cosine: everything turns with the drive"]);
    assert!(!of(0.3_f64.next_up()).contains("turns with the drive"));
}

#[test]
fn sweeps_have_steps_of_their_own() {
    let turns = Angles::Sweep(Sweep::of_turns(7200, 720).unwrap());
    let repeated = text(MOTION, &[3], Precision::Double, turns);
    has(
        &repeated,
        &[
            "sample number to unnormalised sine and cosine (tangent form, sign left open)",
            "samples after the first 360 of a row: results repeat and are copied",
            "array of angles: a sweep needs none",
        ],
    );
    let long = || Angles::Sweep(Sweep::new(0.0, 30.0, 10_000).unwrap());
    let rotated = text(MOTION, &[3], Precision::Double, long());
    has(
        &rotated,
        &["sample number to sine and cosine of twice the angle, turned by whole steps from the \
           middle of groups of samples"],
    );
    assert!(!rotated.contains("tangent form") && !rotated.contains("copied"), "{rotated}");
}

/// For every kind of samples and arithmetic, a run takes the routes that `explain` reports.
#[test]
fn what_is_explained_is_what_runs() {
    let moderate = [0.1, 0.0, 0.2];
    let batches = [
        BatchCase::new(&[moderate]),
        BatchCase::new(&[[1.5, 0.3, 0.8]]),
        BatchCase::new(&[[0.0, 0.0, 0.4]]),
        // The first two compensate each other.
        BatchCase::new(&[[0.3, 0.3, 0.2]]),
        // Each of the first two is moderate by itself; the bound for the batch is steep.
        BatchCase::new(&[[0.6, 0.6, 0.0], moderate, [1.2, 0.9, 0.2]]),
    ];
    let array: Vec<f64> = (0..5000).map(|i| f64::from(i) * 0.01).collect();
    let sweeps = [
        Sweep::of_turns(5000, 720).unwrap(),
        Sweep::new(0.0, 30.0, 5000).unwrap(),
        Sweep::new(0.0, 3e6, 5000).unwrap(),
        Sweep::new(0.0, 30.0, 700).unwrap(),
    ];
    let mut compared = std::collections::BTreeSet::new();
    for batch in &batches {
        let rows = batch.bends.len() / 3;
        let plan = batch.plan(MOTION, &[0, 1, 2, 3]);
        for (angle, count) in std::iter::once((None, 5000))
            .chain(sweeps.iter().map(|sweep| (Some(*sweep), sweep.count())))
        {
            for line_strides in [[1, 0], [0, 0], [0, 1]] {
                let along = line_strides[1] == 1;
                let shape = if along { [1, rows] } else { [rows, count] };
                let angle = match angle {
                    Some(_) if along => continue,
                    Some(sweep) => Angles::Sweep(sweep),
                    None => Angles::Array(Source { data: &array, strides: &[0, 1] }),
                };
                let lines = batch.lines();
                let samples = Samples {
                    shape: &shape,
                    lines,
                    line_strides: &line_strides,
                    angle,
                    load: None,
                };
                for precision in [Precision::Single, Precision::Double, Precision::DoubleDouble] {
                    let table = Table::new(3, false, &samples).unwrap();
                    let choices = plan.choices(&table, precision);
                    let one = table.geometry_variation() == GeometryVariation::One;
                    let folded = one.then(|| plan.fold(&lines, precision).unwrap());
                    let mut results = vec![vec![0.0; shape[0] * shape[1]]; plan.planes()];
                    let mut planes: Vec<&mut [f64]> =
                        results.iter_mut().map(Vec::as_mut_slice).collect();
                    taken::take();
                    let execution = Execution { workers: Some(1), ..Execution::default() };
                    plan.run(
                        &samples,
                        folded.as_ref(),
                        precision,
                        Planes::Double(&mut planes),
                        execution,
                    )
                    .unwrap();
                    let ran = taken::take();
                    for (step, &(route, range)) in plan.shafts.iter().zip(&choices.shafts) {
                        let own = (step.shaft, route, range);
                        assert!(ran.contains(&own), "{own:?} is not among {ran:?}");
                        compared.insert(route);
                    }
                    if table.geometry_variation() != GeometryVariation::ByRow {
                        assert_eq!(ran.len(), plan.shafts.len());
                    }
                }
            }
        }
    }
    assert_eq!(
        compared.into_iter().collect::<Vec<_>>(),
        [Route::Drive, Route::Tangent, Route::DoubleAngle, Route::Rotation]
    );
}
