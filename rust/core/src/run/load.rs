//! Torques and moments for one chunk, over slices that fit in the first-level cache.

use std::cell::Cell;

use crate::input::table::{ACCELERATION, SPEED, TORQUE, Table};
use crate::mechanics::moment::Pose;
use crate::mechanics::turning::Turning;
use crate::number::float::{Float, Real};
use crate::number::reduction::LargeAngleFlag;
use crate::number::storage::{Column, View, ViewMut, views_mut};
use crate::number::strips::{At, OneByOne, Same, Strips, mapped};
use crate::number::{Number, Precision};
use crate::plan::output::{self, Output};
use crate::plan::request::{Axes, End};
use crate::plan::route::Pins;
use crate::plan::steps::{JointStep, LoadStep, Plan, Station};
use crate::run::as_built;
use crate::run::by_strips::{self, strip_length};
use crate::run::constants::{GeometryIndex, run_for_geometry, with_constants};
use crate::run::fold::Folded;
use crate::run::forces::{ForceBuffers, run_forces, run_turning_forces};
use crate::run::kernels::Chunk;
use crate::run::level::{Compiled, Level};
use crate::run::map;
use crate::run::scratch::Scratch;
use crate::run::sines::pins_of;
use crate::run::sink::Outputs;
use crate::run::supports::{run_supports, run_turning_supports};
use crate::run::torsion_parts;
use crate::run::turned::{self, ChunkLines};
use crate::sincos::array::{DriveAngles, SinCos, SinCosBlocks};
use crate::sincos::fresh::{FreshPins, ReducedAngles};

/// Torques and moments for one chunk, in order from the end where the torque is given. Returns whether
/// all results are valid, as the motion does.
#[allow(clippy::too_many_lines, reason = "the loops of a chunk, each a function of its own")]
pub(crate) fn run_load<T: Number + Compiled, W: Float>(
    chunk: &Chunk<'_, T>,
    load: &LoadStep,
    table: &Table<'_>,
    scratch: &mut Scratch<T>,
    outputs: &mut Outputs<'_, '_, W>,
) -> bool {
    let &Chunk { level, plan, drive, folded, chains, geometry, size, .. } = chunk;
    let mut valid = true;
    let lines = ChunkLines { chains, numbers: &folded.lines, geometry };
    let (origin, step) = scratch.cursors[TORQUE];
    let shares_power = has_even_torque(load, (origin, step));
    let alone = finds_pins_alone(plan, chunk.pins, shares_power);
    if let (true, DriveAngles::Array(angles), GeometryIndex::Shared(index)) =
        (alone, drive, geometry)
    {
        let (step, pose) = (&plan.joints[0], &folded.poses[0][index]);
        let torque = T::from_f64(table.columns[TORQUE].data[origin]);
        valid = T::run(
            level,
            #[inline(always)]
            |compact, stores| {
                if compact || T::LOW {
                    return true;
                }
                run_even_moment(step, pose, torque, angles, &mut outputs.by(stores))
            },
        );
        if !reads_power(plan, load, chunk.pins, shares_power) {
            return valid;
        }
    }
    scratch.allocate_power(plan);
    let Scratch {
        gathered,
        pins,
        wide_pins,
        turned_pins,
        rates,
        power,
        kept_power,
        torsion,
        parts,
        support,
        forces,
        as_built: built,
        ..
    } = scratch;
    let is_wide = T::LOW && plan.has_wide_loads();
    let pins = pins_of(if is_wide { wide_pins } else { pins }, size);
    if T::LOW {
        run_for_geometry::<T, _>(
            level,
            geometry,
            #[inline(always)]
            |geometry, compact, _| run_all_rates(folded, geometry, pins, rates, size, compact),
        );
        for (shaft, (turnings, rates)) in folded.turnings.iter().zip(&mut *rates).enumerate() {
            if !turnings.is_empty() && !rates[1].is_empty() {
                turned::mend_accelerations(turnings, shaft, lines, drive, rates, size);
            }
        }
    }
    let ratio = |shaft: usize| rates[shaft][0].view(size);
    let bent = plan.first_bent();
    let first = match load.end {
        End::Drive => None,
        End::Output => Some(load.stations[0].shaft).filter(|&shaft| shaft > bent).map(ratio),
    };
    let is_even = shares_power && first.is_none();
    if *kept_power < size {
        T::run(
            level,
            #[inline(always)]
            |_, _| map::from_doubles(&gathered[TORQUE][..size], first, power.view_mut(size)),
        );
        *kept_power = if is_even { size } else { 0 };
    }
    let weighs_power = plan.needs_inverse_squares();
    if weighs_power {
        T::run(
            level,
            #[inline(always)]
            |_, _| torsion_parts::inverse_squares(pins, forces.inverse_squares.view_mut(size)),
        );
    }
    for station in &load.stations {
        if load.end == End::Output {
            run_inertia(level, 1.0, station, table, gathered, rates, power.view_mut(size));
        }
        if let Some(plane) = station.torque {
            let ratio = (station.shaft > bent).then(|| ratio(station.shaft));
            T::run(
                level,
                #[inline(always)]
                |_, stores| {
                    let (power, mut outputs) = (power.view(size), outputs.by(stores));
                    match ratio {
                        Some(ratio) => map::divide::<T>(power, ratio, outputs.plane(plane)),
                        None => map::copy::<T>(power, outputs.plane(plane)),
                    }
                },
            );
        }
        if !alone && (station.torsion || station.force_power) {
            let joint = station.shaft - 1;
            let poses = &folded.poses[joint][..geometry.count(size)];
            let power = power.view(size);
            let own_pins = if T::LOW && joint > 0 && !plan.is_as_built() {
                let maps = mapped(OneByOne(poses), |pose: Pose<T>| pose.matrix);
                turned::find_turned(level, maps, joint, lines, drive, pins, turned_pins);
                pins_of(turned_pins, size)
            } else {
                pins
            };
            if station.force_power && weighs_power {
                let inputs = (power, forces.inverse_squares.view(size));
                let parts = &mut forces.parts[joint];
                run_for_geometry::<T, _>(
                    level,
                    geometry,
                    #[inline(always)]
                    |geometry, compact, _| {
                        let parts = views_mut(parts, 0, size);
                        with_constants!(compact, geometry, at_pins(poses), at => {
                            torsion_parts::of_power(at, own_pins, inputs, parts);
                        });
                    },
                );
            }
            let torsion = if station.torsion && joint > bent {
                let ratio = ratio(joint);
                T::run(
                    level,
                    #[inline(always)]
                    |_, _| map::divide(power, ratio, torsion.view_mut(size)),
                );
                torsion.view(size)
            } else {
                power
            };
            let is_as_built = plan.is_as_built() && T::PRECISION != Precision::Single;
            let loads = JointLoads {
                torsion: station.torsion.then_some(torsion),
                power: (station.force_power && !weighs_power).then_some(power),
                turning: plan.axes == Axes::Shaft,
                unit: is_as_built.then(|| &built.moments[joint]),
            };
            let step = &plan.joints[joint];
            let mut buffers = (&mut *parts, &mut *support, &mut *forces);
            let fresh = match (chunk.pins, drive, geometry) {
                (Pins::Fresh, DriveAngles::Array(angles), GeometryIndex::Shared(index)) => {
                    Some((angles, index))
                }
                _ => None,
            };
            if let Some((angles, index)) = fresh {
                valid &= T::run(
                    level,
                    #[inline(always)]
                    |compact, stores| {
                        if !stores.has_wide_registers() || T::PRECISION != Precision::Double {
                            return true;
                        }
                        let too_large = Cell::new(LargeAngleFlag::for_quadrants());
                        let turn = [T::from_f64(0.0); 2];
                        let pins = FreshPins::<T, false> { angles, turn, too_large: &too_large };
                        let geometry = GeometryIndex::Shared(index);
                        let loads = JointLoads { unit: None, ..loads };
                        let outputs = &mut outputs.by(stores);
                        run_joint(
                            joint,
                            step,
                            poses,
                            geometry,
                            [pins; 2],
                            loads,
                            &mut buffers,
                            outputs,
                            size,
                            compact,
                        );
                        !too_large.get().any()
                    },
                );
            } else {
                run_for_geometry::<T, _>(
                    level,
                    geometry,
                    #[inline(always)]
                    |geometry, compact, stores| {
                        let outputs = &mut outputs.by(stores);
                        run_joint(
                            joint,
                            step,
                            poses,
                            geometry,
                            [pins, own_pins],
                            loads,
                            &mut buffers,
                            outputs,
                            size,
                            compact,
                        );
                    },
                );
            }
            if let (Axes::Shaft, Some(torsion)) = (plan.axes, loads.torsion) {
                let places = (poses, &folded.phases[joint][..]);
                run_for_geometry::<T, _>(
                    level,
                    geometry,
                    #[inline(always)]
                    |geometry, compact, stores| {
                        let buffers = (&mut *buffers.0, &mut *buffers.1);
                        let outputs = &mut outputs.by(stores);
                        run_turning_moments(
                            step, places, geometry, own_pins, torsion, buffers, outputs, compact,
                        );
                    },
                );
            }
        }
        if load.end == End::Drive {
            run_inertia(level, -1.0, station, table, gathered, rates, power.view_mut(size));
        }
    }
    match &plan.forces {
        Some(step) if plan.axes == Axes::Shaft => {
            run_turning_forces(level, step, &folded.forces, geometry, pins, forces, outputs);
        }
        Some(step) => T::run(
            level,
            #[inline(always)]
            |_, stores| {
                let outputs = &mut outputs.by(stores);
                run_forces(step, &folded.forces, geometry, forces, outputs, size);
            },
        ),
        None => {}
    }
    valid
}

/// Whether all samples of a row share one torque, given where it begins in the table and its step.
pub(super) fn has_even_torque(load: &LoadStep, (_, step): (usize, usize)) -> bool {
    step == 0 && !load.absorbs()
}

/// Whether the moment vector of the first joint, for one torque at all samples, is all that needs pins,
/// and its loops find them.
fn finds_pins_alone(plan: &Plan, pins: Pins, even: bool) -> bool {
    pins != Pins::Stored && even && plan.joints[0].is_moment()
}

/// Whether any loop reads the power of each sample.
pub(super) fn reads_power(plan: &Plan, load: &LoadStep, pins: Pins, even: bool) -> bool {
    let alone = finds_pins_alone(plan, pins, even);
    !alone || load.stations.iter().any(|station| station.torque.is_some())
}

/// The moment vector of the first joint, whose pins are those of the drive, for one torque at all
/// samples. Its loops find the pins themselves. Returns whether they are valid.
#[inline(always)]
fn run_even_moment<T: Number, W: Float>(
    step: &JointStep,
    pose: &Pose<T>,
    torque: T,
    angles: &[f64],
    outputs: &mut Outputs<'_, '_, W>,
) -> bool {
    let Some(plane) = step.planes.get(Output::Moment) else { return true };
    if let Some(axes) = pose.plane_axes() {
        let (pose, planes) = (pose.with_axes(axes), axes.map(|axis| plane + axis));
        run_drive_moment::<true, T, W>(&pose, torque, angles, planes, outputs)
    } else {
        let planes = AXES.map(|axis| plane + axis);
        run_drive_moment::<false, T, W>(pose, torque, angles, planes, outputs)
    }
}

/// The same in planes for the components of a pose: in strips in single precision, else in one loop.
#[inline(always)]
fn run_drive_moment<const PLANAR: bool, T: Number, W: Float>(
    pose: &Pose<T>,
    torque: T,
    angles: &[f64],
    planes: [usize; 3],
    outputs: &mut Outputs<'_, '_, W>,
) -> bool {
    if T::PRECISION == Precision::Single {
        const N: usize = strip_length(Precision::Single);
        return by_strips::run_moment::<PLANAR, T, W, N>(pose, torque, angles, planes, outputs);
    }
    let too_large = &Cell::new(LargeAngleFlag::for_quadrants());
    let reduced = (ReducedAngles::new(angles, too_large), angles.len());
    map::drive_moment::<PLANAR, T>(*pose, torque, reduced, outputs.several(planes));
    !too_large.get().any()
}

/// Adds what the inertia of a station's shaft absorbs, multiplied by `sign`, to the power.
fn run_inertia<T: Number + Compiled>(
    level: Level,
    sign: f64,
    station: &Station,
    table: &Table<'_>,
    gathered: &[Vec<f64>],
    rates: &[[Column<T>; 2]],
    mut power: ViewMut<'_, T>,
) {
    if let (true, Some(inertia)) = (station.absorbs, table.inertia[station.shaft]) {
        let size = power.len();
        let drive = [inertia, SPEED, ACCELERATION].map(|index| &gathered[index][..size]);
        let [ratio, acceleration] = &rates[station.shaft];
        let (ratio, acceleration) = (ratio.view(size), acceleration.view(size));
        T::run(
            level,
            #[inline(always)]
            |_, _| map::absorb(sign, drive, ratio, acceleration, power.reborrow()),
        );
    }
}

/// The pose for the pins that a load reads: with error terms those of the joint, else those of the
/// drive.
#[inline(always)]
fn own<T: Real>(pose: Pose<T>) -> Pose<T> {
    if T::LOW { pose.by_own_pins() } else { pose }
}

/// The poses of a joint, for those pins.
#[inline(always)]
fn at_pins<T: Real>(poses: &[Pose<T>]) -> impl Strips<Value = Pose<T>> {
    mapped(OneByOne(poses), own)
}

/// The loads of a joint in a chunk.
#[derive(Clone, Copy)]
struct JointLoads<'a, T: Real> {
    /// The torsion, if it is needed.
    torsion: Option<View<'a, T>>,
    /// The power, if forces need the parts of the drive shaft.
    power: Option<View<'a, T>>,
    /// Whether moment vectors have axes that turn and so loops of their own.
    turning: bool,
    /// The moments of a joint as built for a torsion of 1.
    unit: Option<&'a [Column<T>; 3]>,
}

/// Moments of one joint and parts of its torsion, from the pins of the drive and those that the poses
/// are for.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "inputs and outputs of one joint")]
fn run_joint<T: Number, W: Float>(
    joint: usize,
    step: &JointStep,
    poses: &[Pose<T>],
    geometry: GeometryIndex,
    [drive_pins, pins]: [impl SinCosBlocks<T>; 2],
    JointLoads { torsion, power, turning, unit }: JointLoads<'_, T>,
    (parts, support, forces): &mut (&mut [Column<T>; 3], &mut [Column<T>; 3], &mut ForceBuffers<T>),
    outputs: &mut Outputs<'_, '_, W>,
    size: usize,
    compact: bool,
) {
    if let Some(power) = power {
        torsion_parts::of_drive(drive_pins, power, views_mut(&mut forces.parts[joint], 0, size));
    }
    let Some(torsion) = torsion else { return };
    if let Some(unit) = unit {
        let of_forces = &mut forces.parts[joint];
        let parts = (&mut **parts, of_forces);
        as_built::run_moments(step, poses, geometry, unit, torsion, parts, outputs, compact);
    } else {
        with_constants!(compact, geometry, at_pins(poses), at => {
            run_magnitudes(step, at, pins, torsion, outputs);
            if !turning && step.needs_support() {
                torsion_parts::of_torsion(at, pins, torsion, views_mut(parts, 0, size));
            }
        });
    }
    if turning {
        return;
    }
    // Only a driveline that all samples share is treated as planar.
    if let GeometryIndex::Shared(index) = geometry
        && let Some(axes) = poses[index].plane_axes()
    {
        let at = Same(own(poses[index]).with_axes(axes));
        if unit.is_none() {
            run_moment::<true, T, W>(step, at, axes, pins, torsion, outputs);
        }
        run_supports::<true, T, W>(step, at, axes, parts, support, outputs, size);
    } else {
        with_constants!(compact, geometry, at_pins(poses), at => {
            if unit.is_none() {
                run_moment::<false, T, W>(step, at, AXES, pins, torsion, outputs);
            }
            run_supports::<false, T, W>(step, at, AXES, parts, support, outputs, size);
        });
    }
}

/// The moment of a joint and what it adds to support moments, in axes that turn with the shafts, from
/// its poses and the phases of its driving shaft.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "inputs and outputs of one joint")]
fn run_turning_moments<T: Number, W: Float>(
    step: &JointStep,
    (poses, phases): (&[Pose<T>], &[[T; 2]]),
    geometry: GeometryIndex,
    pins: SinCos<'_, T>,
    torsion: View<'_, T>,
    (parts, support): (&mut [Column<T>; 3], &mut [Column<T>; 3]),
    outputs: &mut Outputs<'_, '_, W>,
    compact: bool,
) {
    let size = torsion.len();
    if let Some(plane) = step.planes.get(Output::Moment) {
        let out = outputs.several([plane, plane + 1, plane + 2]);
        with_constants!(compact, geometry, at_pins(poses), at => {
            map::turning_moment(at, pins, torsion, out);
        });
    }
    if step.needs_support() {
        let places = (at_pins(poses), &phases[..poses.len()]);
        with_constants!(compact, geometry, places, at => {
            torsion_parts::turning_supports(at, pins, torsion, views_mut(parts, 0, size));
        });
        run_turning_supports(step, parts, support, outputs, size);
    }
}

/// Speed ratio and acceleration ratio of the shafts that the load needs.
#[inline(always)]
fn run_all_rates<T: Number>(
    folded: &Folded<T>,
    geometry: GeometryIndex,
    pins: SinCos<'_, T>,
    rates: &mut [[Column<T>; 2]],
    size: usize,
    compact: bool,
) {
    for (turnings, rates) in folded.turnings.iter().zip(rates) {
        if !turnings.is_empty() {
            let turnings = &turnings[..geometry.count(size)];
            with_constants!(compact, geometry, OneByOne(turnings), at => run_rates(at, pins, rates));
        }
    }
}

/// Speed ratio and acceleration ratio of a shaft, instead of those with fewer digits.
#[inline(always)]
fn run_rates<T: Number>(
    at: impl Strips<Value = Turning<T>>,
    pins: SinCos<'_, T>,
    [ratio, acceleration]: &mut [Column<T>; 2],
) {
    let ratio = ratio.view_mut(pins.len());
    if acceleration.is_empty() {
        map::formula(Turning::ratio, at, pins, ratio);
    } else {
        let rates = (ratio, acceleration.view_mut(pins.len()));
        map::formula(Turning::rates, at, pins, rates);
    }
}

/// Magnitudes of a joint's moment and bending moments.
#[inline(always)]
fn run_magnitudes<T: Number, W: Float>(
    step: &JointStep,
    at: impl Strips<Value = Pose<T>>,
    pins: impl SinCosBlocks<T>,
    torsion: View<'_, T>,
    outputs: &mut Outputs<'_, '_, W>,
) {
    macro_rules! each {
        ($($output:ident: $formula:ident),*) => {$(
            if let Some(plane) = step.planes.get(Output::$output) {
                map::formula_of(Pose::$formula, at, torsion, pins, outputs.plane(plane));
            }
        )*};
    }
    output::magnitudes!(each);
}

const AXES: [usize; 3] = [0, 1, 2];

/// The moment vector that a joint transmits, from a pose with its components in the order `axes`.
#[inline(always)]
fn run_moment<const PLANAR: bool, T: Number, W: Float>(
    step: &JointStep,
    at: impl Strips<Value = Pose<T>>,
    axes: [usize; 3],
    pins: impl SinCosBlocks<T>,
    torsion: impl Strips<Value = T>,
    outputs: &mut Outputs<'_, '_, W>,
) {
    if let Some(plane) = step.planes.get(Output::Moment) {
        let out = outputs.several(axes.map(|axis| plane + axis));
        map::moment::<PLANAR, T>(at, pins, torsion, out);
    }
}
