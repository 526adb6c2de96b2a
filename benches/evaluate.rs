//! `cargo bench`: time per angle by outputs, instruction set, joints and size, and a closing table
//! of ratios measured in one run.
#![allow(clippy::disallowed_methods, reason = "inputs need no particular bits")]

use std::hint::black_box;
use std::time::{Duration, Instant};

use cardan::{
    Angles, Axes, Drivelines, Execution, Geometry, Level, Output, Plan, Planes, Precision, Request,
    Samples, Source, Sweep, level,
};
use criterion::{BenchmarkId, Criterion, Throughput};
use rayon::prelude::*;

use Output::{AccelerationRatio, Angle, AngleError, JerkRatio, SpeedRatio};

const MOTION: [Output; 3] = [Angle, SpeedRatio, AccelerationRatio];

/// A plan of the last shaft with everything it reads and fills.
struct Case {
    line: Geometry,
    directions: Vec<f64>,
    normals: Vec<f64>,
    plan: Plan,
    angle: Vec<f64>,
    planes: Vec<Vec<f64>>,
    /// In place of the angles.
    sweep: Option<Sweep>,
    precision: Precision,
}

impl Case {
    fn new(joints: usize, bend_degrees: f64, outputs: &[Output], samples: usize) -> Self {
        let between = joints - 1;
        let bends = vec![bend_degrees.to_radians(); joints];
        let line = Geometry::from_bends(&bends, &vec![0.3; between], &vec![0.7; between])
            .expect("the bends are valid");
        let request = Request {
            largest_bends: &line.bends,
            outputs,
            shafts: &[joints],
            joints: &[],
            load: None,
            inertias: &[],
            bearings: None,
            as_built: false,
            axes: Axes::Space,
        };
        let plan = Plan::new(&request).expect("the request is valid");
        let turn = std::f64::consts::TAU / samples as f64;
        Self {
            directions: line.directions.iter().flat_map(|v| v.iter().copied()).collect(),
            normals: line.normals.iter().flat_map(|v| v.iter().copied()).collect(),
            angle: (0..samples).map(|i| i as f64 * turn).collect(),
            planes: vec![vec![0.0; samples]; plan.planes()],
            line,
            plan,
            sweep: None,
            precision: Precision::Double,
        }
    }

    fn run(&mut self, level: Level, workers: Option<usize>) {
        let samples = Samples {
            shape: &[self.angle.len()],
            lines: Drivelines {
                bends: &self.line.bends,
                twists: &self.line.twists,
                phases: &self.line.phases,
                directions: &self.directions,
                normals: &self.normals,
                ..Drivelines::default()
            },
            line_strides: &[0],
            angle: match self.sweep {
                Some(sweep) => Angles::Sweep(sweep),
                None => Angles::Array(Source { data: &self.angle, strides: &[1] }),
            },
            load: None,
        };
        let mut planes: Vec<&mut [f64]> = self.planes.iter_mut().map(Vec::as_mut_slice).collect();
        let execution = Execution { level: Some(level), workers, ..Execution::default() };
        let planes = Planes::Double(&mut planes);
        self.plan.run(&samples, None, self.precision, planes, execution).expect("the arrays fit");
        black_box(&mut self.planes);
    }

    /// Fills every plane from the angles by vector stores, as the evaluation does, on as many threads.
    fn fill(&mut self) {
        const BLOCK: usize = 16 * 1024;
        let factor = black_box(1.0);
        let angle = &self.angle;
        for plane in &mut self.planes {
            plane.par_chunks_mut(BLOCK).zip(angle.par_chunks(BLOCK)).for_each(|(to, from)| {
                for (to, from) in to.iter_mut().zip(from) {
                    *to = factor * from;
                }
            });
        }
        black_box(&mut self.planes);
    }

    /// The same by the system's copy, whose stores need not read what they overwrite.
    fn copy(&mut self) {
        const BLOCK: usize = 16 * 1024;
        let angle = &self.angle;
        for plane in &mut self.planes {
            plane
                .par_chunks_mut(BLOCK)
                .zip(angle.par_chunks(BLOCK))
                .for_each(|(to, from)| to.copy_from_slice(from));
        }
        black_box(&mut self.planes);
    }
}

fn criterion_groups(criterion: &mut Criterion) {
    for (name, level) in level::available() {
        // Without a fused multiply-add in hardware every step is a call: fewer samples do.
        let samples = if name.starts_with("sse") { 10_000 } else { 100_000 };
        let mut group = criterion.benchmark_group(format!("one thread, {name}"));
        group.throughput(Throughput::Elements(samples as u64));
        for outputs in [&MOTION[..], &[SpeedRatio], &[AngleError], &[Angle], &[JerkRatio]] {
            let names: Vec<&str> = outputs.iter().map(|output| output.row().name).collect();
            let mut case = Case::new(1, 30.0, outputs, samples);
            group.bench_function(names.join("+"), |b| b.iter(|| case.run(level, Some(1))));
        }
        group.finish();
    }
    let mut group = criterion.benchmark_group("motion of the last shaft by bend");
    group.throughput(Throughput::Elements(100_000));
    for bend in [5.0, 30.0, 50.0, 75.0, 88.0] {
        let mut case = Case::new(1, bend, &MOTION, 100_000);
        group.bench_function(BenchmarkId::from_parameter(bend), |b| {
            b.iter(|| case.run(Level::new(), Some(1)));
        });
    }
    group.finish();
    let mut group = criterion.benchmark_group("motion of the last shaft by joints");
    group.throughput(Throughput::Elements(100_000));
    for joints in [1, 2, 4, 16, 64] {
        let mut case = Case::new(joints, 5.0, &MOTION, 100_000);
        group.bench_function(BenchmarkId::from_parameter(joints), |b| {
            b.iter(|| case.run(Level::new(), Some(1)));
        });
    }
    group.finish();
}

/// The three outputs together by arithmetic, and over sweeps in place of an array.
fn ways(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("motion of the last shaft by arithmetic and sweep");
    for samples in [10_000, 100_000] {
        group.throughput(Throughput::Elements(samples as u64));
        let ways = [
            ("double", Precision::Double, None),
            ("single", Precision::Single, None),
            ("double with error terms", Precision::DoubleDouble, None),
            ("sweep", Precision::Double, Some(Sweep::new(0.0, 20.0, samples))),
            ("turns of 720", Precision::Double, Some(Sweep::of_turns(samples, 720))),
        ];
        for (name, precision, sweep) in ways {
            let mut case = Case::new(1, 30.0, &MOTION, samples);
            case.precision = precision;
            case.sweep = sweep.map(|sweep| sweep.expect("the sweep is valid"));
            group.bench_function(BenchmarkId::new(name, samples), |b| {
                b.iter(|| case.run(Level::new(), Some(1)));
            });
        }
    }
    group.finish();
}

/// Shortest of some runs of each job in turn, in nanoseconds per angle.
fn interleaved(samples: usize, jobs: &mut [(&str, &mut dyn FnMut())]) -> Vec<f64> {
    let mut best = vec![f64::INFINITY; jobs.len()];
    for _ in 0..15 {
        for (best, (_, job)) in best.iter_mut().zip(jobs.iter_mut()) {
            let start = Instant::now();
            job();
            *best = best.min(start.elapsed().as_secs_f64() * 1e9 / samples as f64);
        }
    }
    best
}

/// Prints how the evaluation compares with plain copies of the same bytes, in one run.
fn ratios() {
    let level = Level::new();
    println!("\nangle+speed_ratio+acceleration_ratio against filling the same three arrays");
    println!(
        "{:>10} {:>8} {:>10} {:>8} {:>8} {:>10} {:>10}",
        "angles", "threads", "evaluate", "fill", "copy", "fill/eval", "copy/eval"
    );
    for samples in [100_000, 1_000_000, 10_000_000] {
        let case = || Case::new(1, 30.0, &MOTION, samples);
        let (mut evaluated, mut filled, mut copied) = (case(), case(), case());
        let best = interleaved(
            samples,
            &mut [
                ("evaluate", &mut || evaluated.run(level, None)),
                ("fill", &mut || filled.fill()),
                ("copy", &mut || copied.copy()),
            ],
        );
        println!(
            "{samples:>10} {:>8} {:>7.3} ns {:>5.3} ns {:>5.3} ns {:>10.2} {:>10.2}",
            rayon::current_num_threads(),
            best[0],
            best[1],
            best[2],
            best[1] / best[0],
            best[2] / best[0]
        );
    }
}

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(30)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .configure_from_args();
    criterion_groups(&mut criterion);
    ways(&mut criterion);
    criterion.final_summary();
    // Under `cargo test --benches` each bench only has to run.
    if std::env::args().any(|argument| argument == "--bench") {
        ratios();
    }
}
