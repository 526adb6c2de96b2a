//! Properties of random drivelines to 64 joints: every path to the same bits, and what folding must
//! keep.
#![allow(clippy::disallowed_methods, reason = "oracles are the platform's functions")]

use std::f64::consts::{FRAC_PI_2, PI};

use cardan::{
    Angles, Axes, Drivelines, Equivalent, Execution, Geometry, Load, Output, Plan, Planes,
    Precision, Reduction, Request, Samples, Source, Sweep, Vector, level,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Half a unit in the last place of numbers near 1.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// Many joints, of which few are bent much.
fn drivelines() -> impl Strategy<Value = Geometry> {
    (1_usize..=64).prop_flat_map(|n| {
        let little = prop_oneof![2 => Just(0.0), 1 => (-12.0..-2.0).prop_map(|x| 10_f64.powf(x))];
        let much = prop_oneof![
            2 => 0.01..1.2,
            1 => (-4.0..-1.0).prop_map(|x| FRAC_PI_2 - 10_f64.powf(x)),
        ];
        let bends = prop::collection::vec(little, n);
        let much = prop::collection::vec((0..n, much), 1..4);
        let angles = prop::collection::vec(-4.0..4.0, 2 * (n - 1));
        (bends, much, angles).prop_map(move |(mut bends, much, angles)| {
            for (joint, bend) in much {
                bends[joint] = bend;
            }
            Geometry::from_bends(&bends, &angles[..n - 1], &angles[n - 1..]).unwrap()
        })
    })
}

/// What rounding may change of `tan²(β/2)` of a chain whose angles are known to `change`: each joint
/// and shaft is folded with sines and cosines within 2⁻⁶², and steep joints stretch it all.
fn known(line: &Geometry, k: f64, change: f64) -> f64 {
    let determinant: f64 = line.bends.iter().map(|bend| bend.cos()).product();
    let total: f64 = line.bends.iter().map(|bend| (0.5 * bend).tan().powi(2)).sum();
    let length = (determinant / (1.0 - k * k)).sqrt();
    let fold = 2_f64.powi(-60) + change;
    8.0 * UNIT * k + line.bends.len() as f64 * fold * total.min(1.0) / length
}

fn k_of(line: &Geometry) -> f64 {
    Equivalent::of_chain(&line.bends, &line.twists, &line.phases).joint.k
}

fn flat(vectors: &[Vector]) -> Vec<f64> {
    vectors.iter().flat_map(|v| v.iter().copied()).collect()
}

/// All outputs of the last shaft and the first joint under a load, a plane each; without forces,
/// which need the lengths of shafts.
fn run(
    line: &Geometry,
    angles: &Angles<'_>,
    shape: &[usize],
    precision: Precision,
    execution: Execution,
    reduction: Option<Reduction>,
) -> Vec<Vec<f64>> {
    let n = line.bends.len();
    let without_forces = Output::ALL.into_iter().filter(|output| output.row().unit != "N");
    let plan = Plan::new(&Request {
        largest_bends: &line.bends,
        outputs: &without_forces.collect::<Vec<_>>(),
        shafts: &[n],
        joints: &[0],
        load: Some(cardan::End::Drive),
        inertias: &[n - 1],
        bearings: None,
        as_built: false,
        axes: Axes::Space,
    })
    .unwrap();
    let (directions, normals) = (flat(&line.directions), flat(&line.normals));
    let lines = Drivelines {
        bends: &line.bends,
        twists: &line.twists,
        phases: &line.phases,
        directions: &directions,
        normals: &normals,
        ..Drivelines::default()
    };
    let still = vec![0; shape.len()];
    let constant = |data| Source { data, strides: &still };
    let samples = Samples {
        shape,
        lines,
        line_strides: &still,
        angle: angles.clone(),
        load: Some(Load {
            torque: constant(&[7.0]),
            speed: constant(&[3.0]),
            acceleration: constant(&[0.5]),
            inertias: vec![(n - 1, constant(&[0.25]))],
        }),
    };
    let constants = plan.fold(&lines, precision).unwrap();
    let length = if reduction.is_some() { 1 } else { shape.iter().product() };
    let count = reduction.map_or(plan.planes(), |reduction| reduction.results(&plan));
    let mut planes = vec![vec![f64::NAN; length]; count];
    let mut views: Vec<&mut [f64]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    match reduction {
        Some(reduction) => plan
            .reduce(&samples, Some(&constants), precision, reduction, &mut views, execution)
            .unwrap(),
        None => plan
            .run(&samples, Some(&constants), precision, Planes::Double(&mut views), execution)
            .unwrap(),
    }
    planes
}

fn bits(planes: &[Vec<f64>]) -> Vec<u64> {
    // A zero may have either sign.
    planes.iter().flatten().map(|x| (x + 0.0).to_bits()).collect()
}

proptest! {
    // The same cases every time, and no file of them beside the tests.
    #![proptest_config(ProptestConfig {
        cases: 48,
        rng_seed: RngSeed::Fixed(1939),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn levels_threads_and_shapes_give_the_same_bits(
        line in drivelines(),
        angle in prop::collection::vec(prop_oneof![-9.0..9.0, -1e9..1e9], 60),
        precision in prop_oneof![
            Just(Precision::Single), Just(Precision::Double), Just(Precision::DoubleDouble),
        ],
    ) {
        let array = Angles::Array(Source { data: &angle, strides: &[1] });
        let plain = Execution::default();
        let want = bits(&run(&line, &array, &[60], precision, plain, None));
        for (name, level) in level::available() {
            for workers in [Some(1), Some(3)] {
                let execution = Execution { level: Some(level), workers, ..Execution::default() };
                let got = run(&line, &array, &[60], precision, execution, None);
                prop_assert_eq!(&bits(&got), &want, "{}", name);
            }
        }
        let folded = Angles::Array(Source { data: &angle, strides: &[10, 1] });
        prop_assert_eq!(bits(&run(&line, &folded, &[6, 10], precision, plain, None)), want);
    }

    #[test]
    fn threads_share_long_sweeps(line in drivelines(), start in -9.0..9.0, step in 1e-5..1e-2) {
        let count = 110_000;
        let sweep = Angles::Sweep(Sweep::new(start, start + step * count as f64, count).unwrap());
        let [one, three] = [1, 3].map(|workers| {
            let execution = Execution { workers: Some(workers), ..Execution::default() };
            run(&line, &sweep, &[count], Precision::Double, execution, None)
        });
        prop_assert_eq!(bits(&one), bits(&three));
        // And extremes of them are extremes of the samples.
        for (reduction, plain) in
            [(Reduction::Min, f64::min as fn(f64, f64) -> f64), (Reduction::Max, f64::max)]
        {
            let execution = Execution { workers: Some(2), ..Execution::default() };
            let precision = Precision::Double;
            let found = run(&line, &sweep, &[count], precision, execution, Some(reduction));
            for (plane, found) in one.iter().zip(&found) {
                prop_assert_eq!(plane.iter().copied().reduce(plain), Some(found[0]));
            }
        }
    }

    #[test]
    fn reversal_keeps_the_equivalent_bend(line in drivelines()) {
        let back = |angles: &[f64]| angles.iter().rev().copied().collect::<Vec<f64>>();
        let [bends, twists, phases] = [&line.bends, &line.twists, &line.phases].map(|x| back(x));
        let (want, got) = (k_of(&line), Equivalent::of_chain(&bends, &twists, &phases).joint.k);
        prop_assert!((got - want).abs() <= known(&line, want, 0.0), "{got:e} {want:e}");
    }

    #[test]
    fn half_a_turn_of_a_yoke_keeps_the_equivalent_joint(line in drivelines(), shaft in 0_usize..63) {
        if line.phases.is_empty() {
            return Ok(());
        }
        let shaft = shaft % line.phases.len();
        let mut other = line.clone();
        other.phases[shaft] += PI;
        // π and a sum of up to 8 are rounded.
        let (want, got) = (k_of(&line), k_of(&other));
        prop_assert!((got - want).abs() <= known(&line, want, 10.0 * UNIT), "{got:e} {want:e}");
    }

    #[test]
    fn a_straight_joint_within_a_shaft_keeps_the_equivalent_joint(
        line in drivelines(), at in 0_usize..63, twist in -4.0..4.0, phase in -4.0..4.0,
    ) {
        if line.phases.is_empty() {
            return Ok(());
        }
        let at = at % line.phases.len();
        let Geometry { mut bends, mut twists, mut phases, .. } = line.clone();
        bends.insert(at + 1, 0.0);
        twists[at] -= twist;
        phases[at] -= phase + FRAC_PI_2;
        twists.insert(at, twist);
        phases.insert(at, phase);
        // Three sums of up to 10 are rounded.
        let (want, got) = (k_of(&line), Equivalent::of_chain(&bends, &twists, &phases).joint.k);
        prop_assert!((got - want).abs() <= known(&line, want, 40.0 * UNIT), "{got:e} {want:e}");
    }

    #[test]
    fn joints_in_line_multiply_their_cosines(
        bends in prop::collection::vec(prop_oneof![1e-9..1e-3, 0.01..0.5], 1..64),
        opposite in any::<u64>(),
    ) {
        // ln sec β adds up with the sense of each yoke: quarter and three-quarter turns between.
        let n = bends.len();
        let twists = vec![0.0; n - 1];
        let sense = |j: usize| if opposite >> j & 1 == 0 { 1.0 } else { -1.0 };
        // p = δ + 90° must be 0 for joints that add up, 90° for those that take away.
        let phases: Vec<f64> = (1..n)
            .map(|j| if sense(j) * sense(j - 1) > 0.0 { -FRAC_PI_2 } else { 0.0 })
            .collect();
        let line = Geometry::from_bends(&bends, &twists, &phases).unwrap();
        let total: f64 = (0..n).map(|j| -sense(j) * bends[j].cos().ln()).sum();
        // tan²(β/2) from ln sec β: (1 − cos β)/(1 + cos β).
        let want = (0.5 * total.abs()).tanh();
        let sizes: f64 = bends.iter().map(|bend| -bend.cos().ln()).sum();
        // Each logarithm is known to a few units of its cosine.
        let close = known(&line, want, 2.0 * UNIT) + 4.0 * UNIT * (n as f64 + sizes);
        let got = k_of(&line);
        prop_assert!(got >= 0.0 && (got - want).abs() <= close, "{got:e} {want:e} {close:e}");
    }
}
