//! One chunk of the angles: the steps of a plan over slices that the first-level cache holds.

use std::ops::Range;

use crate::chain::Equivalent;
use crate::fold::{Folded, with_constants};
use crate::kernel;
use crate::moment::Pose;
use crate::plan::{End, JointStep, LoadStep, Plan, ShaftStep};
use crate::samples::{ACCELERATION, SPEED, TORQUE, Table};
use crate::trig::AtanRange;

/// The buffers of one block, each as long as its longest chunk.
pub(crate) struct Scratch {
    pub(crate) folded: Folded,
    /// Where the current row begins in each column of the table, and its step.
    pub(crate) cursors: Vec<(usize, usize)>,
    /// The load's columns at the current chunk.
    pub(crate) gathered: Vec<Vec<f64>>,
    sine: Vec<f64>,
    cosine: Vec<f64>,
    turned_sine: Vec<f64>,
    turned_cosine: Vec<f64>,
    /// Speed ratio and acceleration ratio of each shaft that the load needs.
    rates: Vec<[Vec<f64>; 2]>,
    power: Vec<f64>,
    torsion: Vec<f64>,
}

impl Scratch {
    pub(crate) fn new(plan: &Plan, table: &Table<'_>, longest: usize) -> Self {
        let chunk = |needed: bool| vec![0.0; if needed { longest } else { 0 }];
        let mut rates: Vec<[Vec<f64>; 2]> = vec![[vec![], vec![]]; plan.joint_count + 1];
        for step in plan.shafts.iter().filter(|step| step.keep_rates) {
            rates[step.shaft] = [chunk(true), chunk(true)];
        }
        let loaded = plan.load.is_some();
        Self {
            folded: Folded::new(plan),
            cursors: vec![(0, 0); table.columns.len()],
            gathered: vec![chunk(loaded); table.columns.len()],
            sine: chunk(true),
            cosine: chunk(true),
            turned_sine: chunk(plan.joint_count > 1),
            turned_cosine: chunk(plan.joint_count > 1),
            rates,
            power: chunk(loaded),
            torsion: chunk(loaded),
        }
    }
}

/// Angles and rates of every shaft of the plan at one chunk.
#[inline(always)]
pub(crate) fn run_motion(
    plan: &Plan,
    angle: &[f64],
    scratch: &mut Scratch,
    planes: &mut [&mut [f64]],
    place: Range<usize>,
) {
    let size = place.len();
    let Scratch { folded, sine, cosine, turned_sine, turned_cosine, rates, .. } = scratch;
    let (sine, cosine) = (&mut sine[..size], &mut cosine[..size]);
    if plan.needs_sense() {
        kernel::sensed_pins(angle, sine, cosine);
    } else {
        kernel::pins(angle, sine, cosine);
    }
    for step in &plan.shafts {
        let rates = rates[step.shaft].each_mut().map(|rate| &mut rate[..]);
        let Some(shaft) = &folded.shafts[step.shaft] else {
            run_drive_shaft(step, angle, rates, planes, place.clone());
            continue;
        };
        with_constants!(&shaft.equivalents, at => {
            if shaft.turned {
                let turned = (&mut turned_sine[..size], &mut turned_cosine[..size]);
                kernel::turn(at, sine, cosine, turned.0, turned.1);
                run_shaft(step, shaft.range, at, [angle, turned.0, turned.1], rates, planes, place.clone());
            } else {
                run_shaft(step, shaft.range, at, [angle, sine, cosine], rates, planes, place.clone());
            }
        });
    }
    for (step, poses) in plan.joints.iter().zip(&folded.poses) {
        with_constants!(poses, at => {
            if let Some(plane) = step.tilt_driving {
                let out = &mut planes[plane][place.clone()];
                kernel::tilt(at, Pose::tilt_driving, sine, cosine, out);
            }
            if let Some(plane) = step.tilt_driven {
                let out = &mut planes[plane][place.clone()];
                kernel::tilt(at, Pose::tilt_driven, sine, cosine, out);
            }
        });
    }
}

/// Shaft 0 turns with the drive.
#[inline(always)]
fn run_drive_shaft(
    step: &ShaftStep,
    angle: &[f64],
    rates: [&mut [f64]; 2],
    planes: &mut [&mut [f64]],
    place: Range<usize>,
) {
    if let Some(plane) = step.angle {
        kernel::drive_angle(angle, &mut planes[plane][place.clone()]);
    }
    let constants =
        [(step.angle_error, 0.0), (step.speed_ratio, 1.0), (step.acceleration_ratio, 0.0)];
    for (plane, value) in constants {
        if let Some(plane) = plane {
            kernel::drive_constant(value, angle, &mut planes[plane][place.clone()]);
        }
    }
    let [ratio, acceleration] = rates;
    kernel::drive_constant(1.0, angle, ratio);
    kernel::drive_constant(0.0, angle, acceleration);
}

/// Every output of one shaft, each written straight to its plane; the rates go by way of a buffer
/// where the load reads them too.
#[inline(always)]
fn run_shaft(
    step: &ShaftStep,
    range: AtanRange,
    at: impl Fn(usize) -> Equivalent + Copy,
    [angle, s, c]: [&[f64]; 3],
    rates: [&mut [f64]; 2],
    planes: &mut [&mut [f64]],
    place: Range<usize>,
) {
    let size = place.len();
    match (step.angle_error, step.angle) {
        (Some(error), None) => {
            kernel::angle_error(range, at, s, c, &mut planes[error][place.clone()]);
        }
        (None, Some(turned)) => {
            kernel::angle(range, at, angle, s, c, &mut planes[turned][place.clone()]);
        }
        (Some(error), Some(turned)) => {
            let [error, turned] = two(planes, error, turned, place.clone());
            kernel::angle_error(range, at, s, c, error);
            kernel::sum(angle, error, turned);
        }
        (None, None) => {}
    }
    if step.keep_rates {
        let [ratio, acceleration] = rates.map(|rate| &mut rate[..size]);
        kernel::rates(at, s, c, ratio, acceleration);
        for (plane, rate) in [(step.speed_ratio, ratio), (step.acceleration_ratio, acceleration)] {
            if let Some(plane) = plane {
                planes[plane][place.clone()].copy_from_slice(rate);
            }
        }
        return;
    }
    match (step.speed_ratio, step.acceleration_ratio) {
        (Some(ratio), None) => kernel::speed_ratio(at, s, c, &mut planes[ratio][place]),
        (None, Some(acceleration)) => {
            kernel::acceleration_ratio(at, s, c, &mut planes[acceleration][place]);
        }
        (Some(ratio), Some(acceleration)) => {
            let [ratio, acceleration] = two(planes, ratio, acceleration, place);
            kernel::rates(at, s, c, ratio, acceleration);
        }
        (None, None) => {}
    }
}

/// Every output of one joint that its torsion gives.
#[inline(always)]
fn run_joint(
    step: &JointStep,
    at: impl Fn(usize) -> Pose + Copy,
    input: [&[f64]; 3],
    planes: &mut [&mut [f64]],
    place: Range<usize>,
) {
    if let Some(plane) = step.moment {
        let out = three(planes, plane, place.clone());
        kernel::vector::<false>(at, Pose::moment, input, out);
    }
    if let Some(plane) = step.support_driving {
        let out = three(planes, plane, place.clone());
        kernel::vector::<true>(at, Pose::bending_driving_vector, input, out);
    }
    if let Some(plane) = step.support_driven {
        let out = three(planes, plane, place.clone());
        kernel::vector::<true>(at, Pose::support_driven, input, out);
    }
    if let Some(plane) = step.bending_driving {
        kernel::size(at, Pose::bending_driving, input, &mut planes[plane][place.clone()]);
    }
    if let Some(plane) = step.bending_driven {
        kernel::size(at, Pose::bending_driven, input, &mut planes[plane][place]);
    }
}

/// The same place in the three planes of a vector.
#[inline(always)]
fn three<'a>(
    planes: &'a mut [&mut [f64]],
    first: usize,
    place: Range<usize>,
) -> [&'a mut [f64]; 3] {
    planes
        .get_disjoint_mut([first, first + 1, first + 2])
        .expect("a plan gives every output planes of its own")
        .map(|plane| &mut plane[place.clone()])
}

/// The same place in two planes.
#[inline(always)]
fn two<'a>(
    planes: &'a mut [&mut [f64]],
    first: usize,
    second: usize,
    place: Range<usize>,
) -> [&'a mut [f64]; 2] {
    planes
        .get_disjoint_mut([first, second])
        .expect("a plan gives every output planes of its own")
        .map(|plane| &mut plane[place.clone()])
}

/// Torques and moments at one chunk: the power travels from the end where the torque is given.
#[inline(always)]
pub(crate) fn run_load(
    plan: &Plan,
    load: &LoadStep,
    table: &Table<'_>,
    scratch: &mut Scratch,
    planes: &mut [&mut [f64]],
    place: Range<usize>,
) {
    let size = place.len();
    let Scratch { folded, gathered, sine, cosine, rates, power, torsion, .. } = scratch;
    let column = |index: usize| &gathered[index][..size];
    let (sine, cosine) = (&sine[..size], &cosine[..size]);
    let (power, torsion) = (&mut power[..size], &mut torsion[..size]);
    let ratio = |shaft: usize| &rates[shaft][0][..size];
    match load.end {
        End::Drive => power.copy_from_slice(column(TORQUE)),
        End::Output => kernel::multiply(column(TORQUE), ratio(load.stations[0].shaft), power),
    }
    for &plane in &load.supports {
        for component in &mut planes[plane..plane + 3] {
            component[place.clone()].fill(0.0);
        }
    }
    for station in &load.stations {
        let absorb = |sign: f64, power: &mut [f64]| {
            if let (true, Some(inertia)) = (station.absorbs, table.inertia[station.shaft]) {
                let drive = [column(inertia), column(SPEED), column(ACCELERATION)];
                let acceleration = &rates[station.shaft][1][..size];
                kernel::absorb(sign, drive, ratio(station.shaft), acceleration, power);
            }
        };
        if load.end == End::Output {
            absorb(1.0, power);
        }
        if let Some(plane) = station.torque {
            kernel::divide(power, ratio(station.shaft), &mut planes[plane][place.clone()]);
        }
        if station.torsion {
            let joint = station.shaft - 1;
            kernel::divide(power, ratio(joint), torsion);
            with_constants!(&folded.poses[joint], at => {
                run_joint(&plan.joints[joint], at, [sine, cosine, torsion], planes, place.clone());
            });
        }
        if load.end == End::Drive {
            absorb(-1.0, power);
        }
    }
}
