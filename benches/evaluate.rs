//! `cargo bench`: time per angle by outputs, instruction set, joints and size, and closing tables of
//! ratios and of time against error, each measured in one run.
#![allow(clippy::disallowed_methods, reason = "inputs need no particular bits")]

mod case;
mod time_and_error;

use std::time::{Duration, Instant};

use cardan::{Level, Output, Precision, Sweep, level};
use criterion::{BenchmarkId, Criterion, Throughput};

use Output::{AccelerationRatio, Angle, AngleError, JerkRatio, Moment, SpeedRatio};
use case::Case;

const MOTION: [Output; 3] = [Angle, SpeedRatio, AccelerationRatio];

fn criterion_groups(criterion: &mut Criterion) {
    for (name, level) in level::available() {
        // Without a fused multiply-add in hardware every step is a call: fewer samples do.
        let samples = if name.starts_with("sse") { 10_000 } else { 100_000 };
        let mut group = criterion.benchmark_group(format!("one thread, {name}"));
        group.throughput(Throughput::Elements(samples as u64));
        for outputs in
            [&MOTION[..], &[SpeedRatio], &[AngleError], &[Angle], &[JerkRatio], &[Moment]]
        {
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
        time_and_error::print();
    }
}
