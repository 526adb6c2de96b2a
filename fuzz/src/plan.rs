//! Plans from any request, run over samples of any shape and strides: every way to the same bits.
#![no_main]

mod input;

use arbitrary::{Result, Unstructured};
use cardan::{
    Angles, Axes, Call, Drivelines, End, Execution, Geometry, Load, Output, Plan, Planes,
    Precision, Reduction, Request, Samples, Source, Sweep, level,
};
use input::{JOINTS, about, bend, number, several};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    // Bytes that run out end the case.
    let _ = case(&mut Unstructured::new(data));
});

/// Samples of a case: more than two chunks, but few of huge twists, whose sines with many digits take
/// a thousand times as long.
const MOST: usize = 2500;
const FEW: usize = 10;
const HUGE: f64 = 1e18;

fn case(u: &mut Unstructured<'_>) -> Result<()> {
    let n = u.int_in_range(1..=JOINTS)?;
    let lines = u.int_in_range(1..=3)?;
    let count = u.int_in_range(0..=4)?;
    let bearings = (0..count).map(|_| u.int_in_range(0..=n)).collect::<Result<Vec<_>>>()?;
    let as_built = u.arbitrary()?;
    let mut flat = [const { Vec::<f64>::new() }; 8];
    for _ in 0..lines {
        let (bends, twists) = (several(u, n, bend)?, several(u, n - 1, number)?);
        let Ok(line) = Geometry::from_bends(&bends, &twists, &several(u, n - 1, number)?) else {
            return Ok(());
        };
        flat[0].extend(line.bends);
        flat[1].extend(line.twists);
        flat[2].extend(line.phases);
        flat[3].extend(line.directions.iter().flat_map(|v| v.iter()));
        flat[4].extend(line.normals.iter().flat_map(|v| v.iter()));
        flat[5].extend(several(u, n + 1, number)?);
        flat[6].extend(several(u, bearings.len(), number)?);
        flat[7].extend(several(u, if as_built { 3 * n } else { 0 }, number)?);
    }
    if u.ratio(1, 64)? {
        let array = u.int_in_range(0..=7)?;
        flat[array].pop();
    }
    let lines = Drivelines::from_arrays(flat.each_ref().map(Vec::as_slice));

    let outputs: Vec<Output> =
        Output::ALL.into_iter().filter(|_| u.arbitrary().unwrap_or(false)).collect();
    let shafts = items(u, n + 1)?;
    let joints = items(u, n)?;
    let inertias = items(u, n + 1)?;
    let load = *u.choose(&[None, Some(End::Drive), Some(End::Output)])?;
    let largest_bends = lines.largest_bends(n);
    let request = Request {
        largest_bends: &largest_bends,
        outputs: &outputs,
        shafts: &shafts,
        joints: &joints,
        load,
        inertias: &inertias,
        bearings: if u.arbitrary()? { Some(&bearings) } else { None },
        // A plan that does not fit the drivelines must be refused.
        as_built: as_built ^ u.ratio(1, 64)?,
        axes: if u.ratio(1, 4)? { Axes::Shaft } else { Axes::Space },
    };
    let Ok(plan) = Plan::new(&request) else { return Ok(()) };

    let axes = u.int_in_range(0..=3)?;
    let shape = several(u, axes, |u| {
        Ok(if u.ratio(1, 8)? { u.int_in_range(0..=MOST)? } else { u.int_in_range(1..=5)? })
    })?;
    let total: usize = shape.iter().product();
    let is_huge = [lines.twists, lines.phases].concat().iter().any(|x| x.abs() > HUGE);
    if total > if is_huge { FEW } else { MOST } {
        return Ok(());
    }
    let line_strides = strides(u, &shape, lines.bends.len() / n)?;
    let angle = source(u, &shape)?;
    let sweep = match (shape.last(), u.arbitrary::<u8>()? % 4) {
        (Some(&count), 0) => Sweep::new(number(u)?, number(u)?, about(u, count)?).ok(),
        (Some(&count), 1) => Sweep::of_turns(about(u, count)?, u.int_in_range(1..=1000)?).ok(),
        _ => None,
    };
    let loads = [source(u, &shape)?, source(u, &shape)?, source(u, &shape)?];
    let inertia = source(u, &shape)?;
    let samples = Samples {
        shape: &shape,
        lines,
        line_strides: &line_strides,
        angle: sweep.map_or_else(|| Angles::Array(seen(&angle)), Angles::Sweep),
        load: (u.arbitrary::<u8>()? > 3).then(|| Load {
            torque: seen(&loads[0]),
            speed: seen(&loads[1]),
            acceleration: seen(&loads[2]),
            inertias: inertias.iter().map(|&shaft| (shaft, seen(&inertia))).collect(),
        }),
    };
    let precision = *u.choose(&[Precision::Single, Precision::Double, Precision::DoubleDouble])?;
    let reduction = u.choose(&[None, Some(0), Some(1), Some(2), Some(3), Some(4)])?;
    let reduction = reduction.map(|i| Reduction::ALL[i]);
    let call = Call { precision, reduction, single: false };
    if let Ok(text) = plan.explain(&samples, call) {
        assert!(text.contains("per sample"));
    }

    let one_line = lines.bends.len() == n && line_strides.iter().all(|&stride| stride == 0);
    let constants = if one_line { plan.fold(&lines, precision).ok() } else { None };
    let rows = shape.len().checked_sub(1).map_or(1, |last| shape[..last].iter().product());
    let mut first: Option<Vec<Vec<u64>>> = None;
    for (_, level) in level::available().into_iter().step_by(2) {
        for constants in [None, constants.as_ref()] {
            let execution =
                Execution { level: Some(level), workers: Some(1), ..Execution::default() };
            let (count, length) = match reduction {
                Some(reduction) => (reduction.results(&plan), rows),
                None => (plan.planes(), total),
            };
            let mut planes = vec![vec![f64::NAN; length]; count];
            let mut views: Vec<&mut [f64]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
            let done = match reduction {
                Some(reduction) => {
                    plan.reduce(&samples, constants, precision, reduction, &mut views, execution)
                }
                None => {
                    plan.run(&samples, constants, precision, Planes::Double(&mut views), execution)
                }
            };
            if done.is_err() {
                return Ok(());
            }
            let bits: Vec<Vec<u64>> =
                planes.iter().map(|plane| plane.iter().map(|&x| comparable(x)).collect()).collect();
            match &first {
                Some(first) => assert!(*first == bits, "{request:?} {precision:?}"),
                None => first = Some(bits),
            }
        }
    }
    Ok(())
}

/// A NaN is a NaN, and a zero may have either sign.
fn comparable(x: f64) -> u64 {
    if x.is_nan() { u64::MAX } else { (x + 0.0).to_bits() }
}

/// Some of the first `count` numbers; now and then one too many.
fn items(u: &mut Unstructured<'_>, count: usize) -> Result<Vec<usize>> {
    let count = about(u, count)?;
    Ok((0..count).filter(|_| u.arbitrary().unwrap_or(false)).collect())
}

/// Strides of an array over the samples, of some axes or none; now and then they lead beyond it.
fn strides(u: &mut Unstructured<'_>, shape: &[usize], len: usize) -> Result<Vec<usize>> {
    let mut strides = vec![0; shape.len()];
    let mut step = 1;
    for (stride, &length) in strides.iter_mut().zip(shape).rev() {
        if u.arbitrary()? && step * length.max(1) <= len {
            *stride = step;
            step *= length.max(1);
        }
    }
    if u.ratio(1, 64)? {
        strides.push(u.arbitrary::<u8>()?.into());
    }
    Ok(strides)
}

fn source(u: &mut Unstructured<'_>, shape: &[usize]) -> Result<(Vec<f64>, Vec<usize>)> {
    let len = shape.iter().product::<usize>().max(1);
    let strides = strides(u, shape, len)?;
    let pattern = several(u, 5, number)?;
    Ok((pattern.into_iter().cycle().take(about(u, len)?).collect(), strides))
}

fn seen((data, strides): &(Vec<f64>, Vec<usize>)) -> Source<'_> {
    Source { data, strides }
}
