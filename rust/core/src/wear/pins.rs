//! Means over a turn of the moments of the pins and of the way that they turn in their bearings.

use crate::error::{Error, Result};
use crate::plan::output::Output;
use crate::plan::request::{Axes, End, Request};
use crate::plan::steps::Plan;
use crate::run::execution::Execution;
use crate::turns::rows::Rows;
use crate::turns::{Integrands, Turns};
use crate::wear::life::harm;

/// Quantities averaged over the turn, per radian of the drive. The moment `M` of a joint loads the
/// pins of both yokes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wear {
    /// The torque of the drive, and for each joint `|M|` times the ways of both yokes, and these
    /// ways.
    Friction,
    /// For each joint the torque that enters it, without what the inertia of its driving shaft
    /// takes; for either yoke `|M|^(10/3)` times the way; and for either yoke the way.
    Fatigue,
}

impl Wear {
    /// The number of means for each row.
    pub fn count(self, joints: usize) -> usize {
        match self {
            Self::Friction => 1 + 2 * joints,
            Self::Fatigue => 5 * joints,
        }
    }

    /// The kind of wear with this name, `"friction"` or `"fatigue"`.
    ///
    /// # Errors
    /// An unknown name.
    pub fn named(name: &str) -> Result<Self> {
        match name {
            "friction" => Ok(Self::Friction),
            "fatigue" => Ok(Self::Fatigue),
            _ => Err(Error::new("wear", &[], format!("is {name:?}; it is friction or fatigue"))),
        }
    }
}

/// The means over a turn of what wears the pins, [`Wear::count`] for each row, for a load whose
/// torque is given at `end`. The rows need a load and ideal joints.
///
/// They are exact to some 1e-14 of the largest.
///
/// # Errors
/// No load, joints with deviations, arrays whose lengths do not fit together.
pub fn pin_means(
    rows: &Rows<'_>,
    largest_bends: &[f64],
    end: End,
    wear: Wear,
    out: &mut [f64],
    execution: Execution<'_>,
) -> Result<()> {
    let joints = largest_bends.len();
    let all: Vec<usize> = (0..=joints).collect();
    let inertias: Vec<usize> =
        rows.load.iter().flat_map(|load| &load.inertias).map(|&(shaft, _)| shaft).collect();
    let pins = [Output::PinMoment, Output::SwingDriving, Output::SwingDriven];
    let outputs = match wear {
        Wear::Friction => [&[Output::Torque], &pins[..]].concat(),
        Wear::Fatigue => [&[Output::Torque, Output::SpeedRatio], &pins[..]].concat(),
    };
    let plan = Plan::new(&Request {
        largest_bends,
        outputs: &outputs,
        shafts: if wear == Wear::Friction { &all[..1] } else { &all },
        joints: &all[..joints],
        load: rows.load.is_some().then_some(end),
        inertias: &inertias,
        bearings: None,
        as_built: false,
        axes: Axes::Space,
    })?;
    let of = |_: &[f64], planes: &[&[f64]], values: &mut [f64]| match wear {
        Wear::Friction => friction(planes, joints, values),
        Wear::Fatigue => fatigue(planes, joints, values),
    };
    let integrands = Integrands { count: wear.count(joints), together: 1, of: &of };
    Turns::new(&plan, rows).means(&integrands, out, execution)
}

/// The heat of a joint per radian of the drive, from its two means of [`Wear::Friction`] and from
/// its coefficient of friction, the radius of its pins, their arm and the torque of its seals. The
/// moment `M` presses each of two pins on its bearing with `M/(2 R)` at the arm `R`; a seal adds
/// its torque.
pub fn heat([lost, way]: [f64; 2], [friction, radius, arm, seal]: [f64; 4]) -> f64 {
    friction * radius / arm * lost + seal * way
}

/// Moments of the pins and their ways in the driving and in the driven yokes, each joint by joint.
fn pins<'a>(planes: &'a [&'a [f64]], joints: usize) -> impl Iterator<Item = [&'a [f64]; 3]> {
    let (moments, swings) = planes.split_at(joints);
    let (driving, driven) = swings.split_at(joints);
    (0..joints).map(move |joint| [moments[joint], driving[joint], driven[joint]])
}

fn friction(planes: &[&[f64]], joints: usize, values: &mut [f64]) {
    let (drive, planes) = (planes[0], &planes[1..]);
    let (torque, of_joints) = values.split_at_mut(drive.len());
    torque.copy_from_slice(drive);
    let each = of_joints.chunks_exact_mut(2 * drive.len());
    for ([moment, driving, driven], values) in pins(planes, joints).zip(each) {
        let (lost, way) = values.split_at_mut(moment.len());
        for i in 0..moment.len() {
            way[i] = driving[i].abs() + driven[i].abs();
            lost[i] = moment[i].abs() * way[i];
        }
    }
}

fn fatigue(planes: &[&[f64]], joints: usize, values: &mut [f64]) {
    let (torques, planes) = planes.split_at(joints + 1);
    let (ratios, planes) = planes.split_at(joints + 1);
    let each = values.chunks_exact_mut(5 * torques[0].len()).enumerate();
    for ([moment, driving, driven], (joint, values)) in pins(planes, joints).zip(each) {
        let count = moment.len();
        for i in 0..count {
            // From the power behind the joint.
            let torque = torques[joint + 1][i] * ratios[joint + 1][i] / ratios[joint][i];
            let harm = harm(moment[i].abs());
            let ways = [driving[i].abs(), driven[i].abs()];
            let row = [torque.abs(), harm * ways[0], harm * ways[1], ways[0], ways[1]];
            for (function, value) in row.into_iter().enumerate() {
                values[function * count + i] = value;
            }
        }
    }
}
