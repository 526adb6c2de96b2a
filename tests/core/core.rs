//! The core against independent pictures: a vector model, naive broadcasting, other trigonometry.
#![allow(clippy::disallowed_methods, reason = "oracles are the platform's functions")]

use std::f64::consts::{FRAC_PI_2, TAU};

use cardan::{
    Angles, Axes, Drivelines, End, Execution, Geometry, Load, Output, Plan, Planes, Precision,
    Reduction, Request, Samples, Source, Sweep, Vector, level, number::trig,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn plan(joints: usize, outputs: &[Output], shafts: &[usize]) -> Plan {
    Plan::new(&Request {
        largest_bends: &vec![1.5; joints],
        outputs,
        shafts,
        joints: &[],
        load: None,
        inertias: &[],
        bearings: None,
        as_built: false,
        axes: Axes::Space,
    })
    .unwrap()
}

/// The driven pin of each joint from perpendicular pins alone, for the drive angle `alpha`.
fn pins(line: &Geometry, alpha: f64) -> Vec<(Vector, Vector)> {
    let turned = |v: Vector, u: Vector, a: f64| v * a.cos() + u.cross(&v) * a.sin();
    let u = &line.directions;
    let mut driving = turned(line.normals[0].cross(&u[0]), u[0], alpha);
    let mut all = vec![];
    for j in 0..line.bends.len() {
        let driven = u[j + 1].cross(&driving).normalize();
        all.push((driving, driven));
        if j < line.phases.len() {
            driving = turned(driven, u[j + 1], line.phases[j]);
        }
    }
    all
}

/// Angle about the last shaft from one direction across it to another.
fn turn_about(axis: Vector, from: Vector, to: Vector) -> f64 {
    from.cross(&to).dot(&axis).atan2(from.dot(&to))
}

fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

fn drivelines() -> impl Strategy<Value = Geometry> {
    (1_usize..6).prop_flat_map(|n| {
        let angles = prop::collection::vec(-3.0..3.0, 2 * (n - 1));
        let bends = prop::collection::vec(prop_oneof![Just(0.0), 0.0..1.3], n);
        (bends, angles).prop_map(move |(bends, angles)| {
            Geometry::from_bends(&bends, &angles[..n - 1], &angles[n - 1..]).unwrap()
        })
    })
}

proptest! {
    // The same cases every time, and no file of them beside the tests.
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(1920),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn the_last_shaft_turns_as_its_pin_does(line in drivelines(), a in -9.0..9.0, b in -9.0..9.0) {
        let n = line.bends.len();
        let angles = plan(n, &[Output::Angle], &[n]).evaluate(&line, &[a, b]).unwrap();
        let (first, second) = (pins(&line, a)[n - 1].1, pins(&line, b)[n - 1].1);
        let turned = turn_about(line.directions[n], first, second);
        let conditioning: f64 = line.bends.iter().map(|bend| bend.cos()).product();
        let error = wrapped(angles[0][1] - angles[0][0] - turned);
        prop_assert!(error.abs() < 1e-14 / conditioning, "{error:e}");
    }

    #[test]
    fn points_give_back_the_bends(line in drivelines(), scale in 1e-3..1e3, at in -10.0..10.0) {
        let mut points = vec![Vector::new(at, -at, 0.5)];
        for (i, u) in line.directions.iter().enumerate() {
            points.push(points[i] + u * scale);
        }
        let again = Geometry::from_points(&points, &line.phases).unwrap();
        for (given, found) in line.bends.iter().zip(&again.bends) {
            prop_assert!((given - found).abs() < 1e-13 * (1.0 + at.abs() / scale));
        }
    }

    #[test]
    fn sine_and_cosine_agree_with_the_system(x in prop_oneof![-10.0..10.0, -1e9..1e9, -1e300..1e300]) {
        let (sine, cosine) = trig::sin_cos(x);
        prop_assert!((sine - x.sin()).abs() <= 2.3e-16);
        prop_assert!((cosine - x.cos()).abs() <= 2.3e-16);
    }

    /// Any broadcasting against naive indexing, at any level and number of threads, bit for bit.
    #[test]
    fn broadcasting_reads_the_right_elements(
        dims in prop::collection::vec(prop_oneof![Just(1_usize), 2_usize..6], 0..4),
        over_lines in any::<[bool; 4]>(),
        over_angles in any::<[bool; 4]>(),
        over_torques in any::<[bool; 4]>(),
    ) {
        let strided = |over: [bool; 4]| {
            let mut strides = vec![0; dims.len()];
            let mut count = 1;
            for axis in (0..dims.len()).rev() {
                if over[axis] && dims[axis] > 1 {
                    strides[axis] = count;
                    count *= dims[axis];
                }
            }
            (strides, count)
        };
        let ((lines, line_count), (angles, angle_count)) = (strided(over_lines), strided(over_angles));
        let (torques, torque_count) = strided(over_torques);
        let bends: Vec<f64> = (0..2 * line_count).map(|i| 0.1 + 0.9 * i as f64 / 200.0).collect();
        let between: Vec<f64> = (0..line_count).map(|i| 0.01 * i as f64).collect();
        let geometries: Vec<Geometry> = (0..line_count)
            .map(|i| Geometry::from_bends(&bends[2 * i..2 * i + 2], &between[i..=i], &[0.4]).unwrap())
            .collect();
        let flat = |vectors: fn(&Geometry) -> &[Vector]| -> Vec<f64> {
            geometries.iter().flat_map(vectors).flat_map(|v| v.iter().copied()).collect()
        };
        let (directions, normals) = (flat(|g| &g.directions), flat(|g| &g.normals));
        let phases = vec![0.4; line_count];
        let angle: Vec<f64> = (0..angle_count).map(|i| i as f64 * 0.7 - 3.0).collect();
        let torque: Vec<f64> = (0..torque_count).map(|i| i as f64 - 5.0).collect();
        let plan = Plan::new(&Request {
            largest_bends: &[1.0; 2],
            outputs: &[Output::AngleError, Output::AccelerationRatio, Output::Moment],
            shafts: &[1, 2],
            joints: &[1],
            load: Some(End::Drive),
            inertias: &[1],
            bearings: None,
            as_built: false,
            axes: Axes::Space,
        }).unwrap();
        let run = |shape: &[usize], line_strides: &[usize], angle: Source<'_>, torque: Source<'_>,
                   line: Option<usize>, level| {
            let zeros = vec![0; shape.len()];
            let constant = |data| Source { data, strides: &zeros };
            let pick = |all: &'_ [f64], each: usize| match line {
                Some(i) => all[i * each..(i + 1) * each].to_vec(),
                None => all.to_vec(),
            };
            let (bends, twists) = (pick(&bends, 2), pick(&between, 1));
            let (phases, directions) = (pick(&phases, 1), pick(&directions, 9));
            let normals = pick(&normals, 6);
            let samples = Samples {
                shape,
                lines: Drivelines {
                    bends: &bends, twists: &twists, phases: &phases,
                    directions: &directions, normals: &normals,
                    ..Drivelines::default()
                },
                line_strides,
                angle: Angles::Array(angle),
                load: Some(Load {
                    torque, speed: constant(&[3.0]), acceleration: constant(&[0.5]),
                    inertias: vec![(1, constant(&[0.25]))],
                }),
            };
            let total: usize = shape.iter().product();
            let mut planes = vec![vec![f64::NAN; total]; plan.planes()];
            let mut views: Vec<&mut [f64]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
            let execution = Execution { level, workers: Some(3), ..Execution::default() };
            plan.run(&samples, None, Precision::Double, Planes::Double(&mut views), execution).unwrap();
            planes
        };
        let source = |data, strides| Source { data, strides };
        for (_, level) in level::available() {
            let all = run(
                &dims, &lines, source(&angle, &angles), source(&torque, &torques), None, Some(level),
            );
            let total: usize = dims.iter().product();
            for sample in 0..total {
                let (mut rest, mut at) = (sample, [0; 3]);
                for axis in (0..dims.len()).rev() {
                    let index = rest % dims[axis];
                    rest /= dims[axis];
                    for (at, strides) in at.iter_mut().zip([&lines, &angles, &torques]) {
                        *at += index * strides[axis];
                    }
                }
                let one = run(
                    &[], &[], source(&angle[at[1]..=at[1]], &[]), source(&torque[at[2]..=at[2]], &[]),
                    Some(at[0]), None,
                );
                for (plane, single) in all.iter().zip(&one) {
                    // A zero may have either sign.
                    prop_assert_eq!((plane[sample] + 0.0).to_bits(), (single[0] + 0.0).to_bits());
                }
            }
        }
    }
}

#[test]
fn the_hardest_reductions() {
    // The double closest to a multiple of π/2, and the one after π/2 itself: cosines from 60-digit
    // arithmetic.
    let (_, cosine) = trig::sin_cos(6_381_956_970_095_103.0 * 2.0_f64.powi(797));
    assert_eq!(cosine.abs(), 4.687_165_924_254_628e-19);
    // The double closest to a multiple of π/2 among those below 2⁶⁰, 29 π/2.
    let (_, cosine) = trig::sin_cos(45.553_093_477_052);
    assert_eq!(cosine, -6.189_806_365_883_577e-19);
    let (_, cosine) = trig::sin_cos(FRAC_PI_2);
    assert_eq!(cosine, 6.123_233_995_736_766e-17);
}

#[test]
fn the_unit_joint_survives_the_last_bend_below_a_right_angle() {
    let bend = FRAC_PI_2.next_down();
    let line = Geometry::from_bends(&[bend], &[], &[]).unwrap();
    let ratio =
        &plan(1, &[Output::SpeedRatio], &[1]).evaluate(&line, &[0.0, FRAC_PI_2]).unwrap()[0];
    let cosine = trig::sin_cos(bend).1;
    assert!((ratio[0] * cosine - 1.0).abs() < 1e-15);
    assert!((ratio[1] / cosine - 1.0).abs() < 1e-6);
}

#[test]
fn arrays_that_do_not_fit_are_refused() {
    let line = Geometry::from_bends(&[0.1], &[], &[]).unwrap();
    let plan = plan(1, &[Output::Angle], &[1]);
    let directions = [1.0; 6];
    let lines = Drivelines {
        bends: &line.bends,
        twists: &[],
        phases: &[],
        directions: &directions,
        normals: &[0.0; 3],
        lengths: &[],
        positions: &[],
        deviations: &[],
    };
    let run = |angle: &[f64], planes: &mut [&mut [f64]]| {
        let angle = Angles::Array(Source { data: angle, strides: &[1] });
        let samples = Samples { shape: &[3], lines, line_strides: &[0], angle, load: None };
        plan.run(&samples, None, Precision::Double, Planes::Double(planes), Execution::default())
    };
    let error = run(&[0.0; 2], &mut [&mut [0.0; 3]]).unwrap_err();
    assert_eq!(error.to_string(), "angle has 2 elements, which do not fill the samples");
    let error = run(&[0.0; 3], &mut []).unwrap_err();
    assert_eq!(error.to_string(), "planes has 0 planes; it needs 1 of 3 samples");
}

const ONE_JOINT: Drivelines<'static> = Drivelines {
    bends: &[0.1],
    twists: &[],
    phases: &[],
    directions: &[1.0; 6],
    normals: &[0.0; 3],
    lengths: &[],
    positions: &[],
    deviations: &[],
};

#[test]
fn what_does_not_fill_the_samples_is_named() {
    let lines = ONE_JOINT;
    let plan = plan(1, &[Output::Angle], &[1]);
    let names = ["angle", "torque", "speed", "acceleration", "inertias"];
    for (short, name) in names.into_iter().enumerate() {
        let source = |i| Source { data: &[0.0; 3][usize::from(i == short)..], strides: &[1] };
        let load = Load {
            torque: source(1),
            speed: source(2),
            acceleration: source(3),
            inertias: vec![(0, Source { data: &[0.0; 3], strides: &[1] }), (1, source(4))],
        };
        let angle = match short {
            0 => Angles::Array(source(0)),
            _ => Angles::Sweep(Sweep::new(0.0, 1.0, 3).unwrap()),
        };
        let load = Some(load);
        let samples = Samples { shape: &[3], lines, line_strides: &[0], angle, load };
        let planes = Planes::Double(&mut [&mut [0.0; 3]]);
        let run = plan.run(&samples, None, Precision::Double, planes, Execution::default());
        let problem = format!("{name} has 2 elements, which do not fill the samples");
        assert_eq!(run.unwrap_err().to_string(), problem);
    }
}

#[test]
fn reductions_want_a_number_for_each_row() {
    let lines = ONE_JOINT;
    let reduce = |outputs: &[Output], shape: [usize; 2], planes: &mut [&mut [f64]]| {
        let plan = plan(1, outputs, &[1]);
        let angle = Angles::Array(Source { data: &[0.0; 6], strides: &[3, 1] });
        let samples = Samples { shape: &shape, lines, line_strides: &[0, 0], angle, load: None };
        let (how, execution) = (Reduction::Peak, Execution::default());
        plan.reduce(&samples, None, Precision::Double, how, planes, execution)
    };
    for planes in [&mut [][..], &mut [&mut [0.0; 3][..]]] {
        let problem = format!("planes has {} planes; it needs 1 of 2 rows", planes.len());
        let error = reduce(&[Output::Angle], [2, 3], planes).unwrap_err();
        assert_eq!(error.to_string(), problem);
    }
    let mut untouched = [7.0; 2];
    reduce(&[], [2, 3], &mut []).unwrap();
    reduce(&[Output::Angle], [0, 3], &mut [&mut []]).unwrap();
    reduce(&[Output::Angle], [2, 0], &mut [&mut untouched]).unwrap();
    assert_eq!(untouched, [7.0; 2]);
}

#[test]
fn means_over_turns_count_every_turn() {
    let line = Geometry::from_bends(&[1.2], &[], &[]).unwrap();
    let plan = plan(1, &[Output::SpeedRatio], &[1]);
    let lines = Drivelines {
        bends: &line.bends,
        twists: &[],
        phases: &[],
        directions: &[1.0; 6],
        normals: &[0.0; 3],
        lengths: &[],
        positions: &[],
        deviations: &[],
    };
    for (turns, per_turn) in [(1, 720), (5, 721), (100, 720)] {
        let count = turns * per_turn;
        let angle = Angles::Sweep(Sweep::of_turns(count, per_turn).unwrap());
        let samples = Samples { shape: &[count], lines, line_strides: &[0], angle, load: None };
        let (mut mean, execution) = ([0.0], Execution::default());
        let planes: &mut [&mut [f64]] = &mut [&mut mean];
        plan.reduce(&samples, None, Precision::Double, Reduction::Mean, planes, execution).unwrap();
        assert!((mean[0] - 1.0).abs() < 1e-14, "{}", mean[0]);
    }
}

#[test]
fn a_sweep_of_one_sample_is_one_angle_for_all() {
    let bends = [0.3, 0.5, 0.7];
    let lines = Drivelines {
        bends: &bends,
        twists: &[],
        phases: &[],
        directions: &[1.0; 18],
        normals: &[0.0; 9],
        lengths: &[],
        positions: &[],
        deviations: &[],
    };
    let plan = plan(1, &[Output::SpeedRatio], &[1]);
    let shapes: [(&[usize], &[usize]); 3] = [(&[3], &[1]), (&[3, 1], &[1, 0]), (&[1, 3], &[0, 1])];
    for (shape, line_strides) in shapes {
        for sweep in [Sweep::new(1.0, 2.0, 1).unwrap(), Sweep::of_turns(1, 720).unwrap()] {
            let angle = Angles::Sweep(sweep);
            let samples = Samples { shape, lines, line_strides, angle, load: None };
            let mut ratio = [0.0; 3];
            let planes = Planes::Double(&mut [&mut ratio]);
            plan.run(&samples, None, Precision::Double, planes, Execution::default()).unwrap();
            for (bend, ratio) in bends.into_iter().zip(ratio) {
                let line = Geometry::from_bends(&[bend], &[], &[]).unwrap();
                let want = plan.evaluate(&line, &[sweep.at(0)]).unwrap()[0][0];
                assert!((ratio - want).abs() < 1e-15, "{shape:?}: {ratio}, {want}");
            }
        }
    }
}

#[test]
fn elements_lie_as_far_apart_as_the_strides_say() {
    const LENGTH: usize = 1500;
    let run = |strides: [usize; 2], load: Option<End>| {
        let all = |value: fn(usize) -> f64| {
            let mut data = vec![0.5; strides[0] + LENGTH * strides[1]];
            for i in 0..2 * LENGTH {
                data[i / LENGTH * strides[0] + i % LENGTH * strides[1]] = value(i);
            }
            data
        };
        let (bends, angle) = (all(|i| 0.1 + 3e-4 * i as f64), all(|i| 0.01 * i as f64));
        let (torque, still) = (all(|i| i as f64), || Source { data: &[1.0], strides: &[0, 0] });
        let (directions, normals) = (vec![1.0; 6 * bends.len()], vec![0.0; 3 * bends.len()]);
        let with_load = load.map(|_| Load {
            torque: Source { data: &torque, strides: &strides },
            speed: still(),
            acceleration: still(),
            inertias: vec![],
        });
        let samples = Samples {
            shape: &[2, LENGTH],
            lines: Drivelines {
                bends: &bends,
                twists: &[],
                phases: &[],
                directions: &directions,
                normals: &normals,
                ..Drivelines::default()
            },
            line_strides: &strides,
            angle: Angles::Array(Source { data: &angle, strides: &strides }),
            load: with_load,
        };
        let output = load.map_or(Output::AngleError, |_| Output::Torque);
        let plan = Plan::new(&Request {
            largest_bends: &[1.0],
            outputs: &[output],
            shafts: &[1],
            joints: &[],
            load,
            inertias: &[],
            bearings: None,
            as_built: false,
            axes: Axes::Space,
        })
        .unwrap();
        let mut plane = vec![0.0; 2 * LENGTH];
        let planes = Planes::Double(&mut [&mut plane]);
        plan.run(&samples, None, Precision::Double, planes, Execution::default()).unwrap();
        plane
    };
    for load in [None, Some(End::Drive)] {
        let side_by_side = run([LENGTH, 1], load);
        for strides in [[LENGTH + 1, 1], [2 * LENGTH, 2]] {
            assert_eq!(run(strides, load), side_by_side);
        }
    }
}

#[test]
fn runs_within_jobs_of_a_pool_have_the_same_bits() {
    let line = Geometry::from_bends(&[0.5, 0.3], &[0.2], &[1.0]).unwrap();
    let plan = plan(2, &[Output::Angle, Output::AccelerationRatio], &[1, 2]);
    let angle: Vec<f64> = (0..200_000).map(|i| 0.37 * f64::from(i)).collect();
    let flat =
        |vectors: &[Vector]| vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect::<Vec<_>>();
    let (directions, normals) = (flat(&line.directions), flat(&line.normals));
    let run = |workers: Option<usize>| {
        let samples = Samples {
            shape: &[angle.len()],
            lines: Drivelines {
                bends: &line.bends,
                twists: &line.twists,
                phases: &line.phases,
                directions: &directions,
                normals: &normals,
                ..Drivelines::default()
            },
            line_strides: &[0],
            angle: Angles::Array(Source { data: &angle, strides: &[1] }),
            load: None,
        };
        let mut planes = vec![vec![0.0; angle.len()]; plan.planes()];
        let mut views: Vec<&mut [f64]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
        let execution = Execution { workers, ..Execution::default() };
        plan.run(&samples, None, Precision::Double, Planes::Double(&mut views), execution).unwrap();
        planes
    };
    let alone = run(Some(1));
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let runs = pool.install(|| rayon::join(|| run(None), || run(Some(2))));
        assert!(runs.0 == alone && runs.1 == alone);
    }
    assert!(run(Some(0)) == alone && run(None) == alone);
}

#[test]
fn directions_may_be_subnormal() {
    let tiny = 5e-324;
    let spans = [Vector::new(tiny, 0.0, 0.0), Vector::new(tiny, tiny, 0.0)];
    let line = Geometry::from_directions(&spans, &[]).unwrap();
    assert!((line.bends[0] - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
}

#[test]
fn joints_as_built_have_no_single_precision_and_are_computed_in_double() {
    let request = Request {
        largest_bends: &[0.3],
        outputs: &[Output::Angle, Output::AccelerationRatio],
        shafts: &[1],
        joints: &[],
        load: None,
        inertias: &[],
        bearings: None,
        as_built: true,
        axes: Axes::Space,
    };
    let plan = Plan::new(&request).unwrap();
    let line = Geometry::from_bends(&[0.3], &[], &[]).unwrap();
    let flat = |vectors: &[Vector]| -> Vec<f64> {
        vectors.iter().flat_map(|v| v.iter().copied()).collect()
    };
    let (directions, normals) = (flat(&line.directions), flat(&line.normals));
    let lines = Drivelines {
        bends: &line.bends,
        directions: &directions,
        normals: &normals,
        deviations: &[1e-3, 0.0, 0.0],
        ..Drivelines::default()
    };
    let angles = [0.1, 0.9, 2.0];
    let samples = Samples {
        shape: &[3],
        lines,
        line_strides: &[0],
        angle: Angles::Array(Source { data: &angles, strides: &[1] }),
        load: None,
    };
    let run = |precision| {
        let folded = plan.fold(&lines, precision).unwrap();
        [None, Some(&folded)].map(|folded| {
            let mut planes = [[f64::NAN; 3]; 2];
            let mut views = planes.each_mut().map(<[f64; 3]>::as_mut_slice);
            let views = Planes::Double(&mut views);
            plan.run(&samples, folded, precision, views, Execution::default()).unwrap();
            planes
        })
    };
    let [first, second] = run(Precision::Double);
    assert_eq!(first, second);
    assert!(first.iter().flatten().all(|x| x.is_finite()));
    assert_eq!(run(Precision::Single), [first, first]);
    let peaks = |precision| {
        let mut planes = [[f64::NAN]; 2];
        let mut views = planes.each_mut().map(<[f64; 1]>::as_mut_slice);
        let execution = Execution::default();
        plan.reduce(&samples, None, precision, Reduction::Max, &mut views, execution).unwrap();
        planes
    };
    assert_eq!(peaks(Precision::Single), peaks(Precision::Double));
}
