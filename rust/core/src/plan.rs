//! From the outputs asked for to the steps that compute them, once per call.
//!
//! A plan knows nothing of angles or of particular bends: it says which shafts and joints are
//! needed, in which plane of the result each quantity lands, and in which order a load is carried
//! along the driveline. [`crate::batch`] runs it.

use crate::error::{Error, Result};

/// A quantity that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Output {
    /// Rotation of a shaft in rad, continuous and mean-synchronous with the drive.
    Angle,
    /// Angle of a shaft less the drive angle, in rad, mean zero.
    AngleError,
    /// `ω_i/ω_0`.
    SpeedRatio,
    /// `d²(angle)/dα²`.
    AccelerationRatio,
    /// Torsion entering a shaft, in N·m.
    Torque,
    /// Moment vector that a joint exerts on its driven shaft, in N·m.
    Moment,
}

impl Output {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 6] = [
        Self::Angle,
        Self::AngleError,
        Self::SpeedRatio,
        Self::AccelerationRatio,
        Self::Torque,
        Self::Moment,
    ];

    /// The name by which users ask for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::AngleError => "angle_error",
            Self::SpeedRatio => "speed_ratio",
            Self::AccelerationRatio => "acceleration_ratio",
            Self::Torque => "torque",
            Self::Moment => "moment",
        }
    }

    /// Whether there is one per joint; otherwise there is one per shaft.
    pub fn per_joint(self) -> bool {
        self == Self::Moment
    }

    /// Whether it needs a load.
    pub fn needs_load(self) -> bool {
        matches!(self, Self::Torque | Self::Moment)
    }

    /// Planes of the result per shaft or joint: 3 for a vector.
    pub fn components(self) -> usize {
        if self == Self::Moment { 3 } else { 1 }
    }
}

/// Where the load's torque is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Put into shaft 0.
    Drive,
    /// Delivered by the last shaft.
    Output,
}

/// What is asked of a driveline.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Number of joints, `n`.
    pub joint_count: usize,
    /// The quantities, each at most once.
    pub outputs: &'a [Output],
    /// The shafts, `0..=n`, each at most once.
    pub shafts: &'a [usize],
    /// The joints, `0..n`, each at most once.
    pub joints: &'a [usize],
    /// Where the load's torque is given, if there is a load.
    pub load: Option<End>,
    /// The shafts whose inertia takes part.
    pub inertias: &'a [usize],
}

/// The steps for one request. The planes of the result are numbered output by output, within an
/// output item by item, within an item component by component.
#[derive(Clone, Debug)]
pub struct Plan {
    pub(crate) joint_count: usize,
    pub(crate) planes: usize,
    /// In ascending order.
    pub(crate) shafts: Vec<ShaftStep>,
    pub(crate) load: Option<LoadStep>,
}

/// What to compute of one shaft: the plane of each output, and whether the load needs the rates.
#[derive(Clone, Debug, Default)]
pub(crate) struct ShaftStep {
    pub(crate) shaft: usize,
    pub(crate) angle: Option<usize>,
    pub(crate) angle_error: Option<usize>,
    pub(crate) speed_ratio: Option<usize>,
    pub(crate) acceleration_ratio: Option<usize>,
    pub(crate) keep_rates: bool,
}

/// How the power is carried along the driveline from the end where the torque is given.
#[derive(Clone, Debug)]
pub(crate) struct LoadStep {
    pub(crate) end: End,
    /// In the order of travel.
    pub(crate) stations: Vec<Station>,
}

/// One shaft on the way: what its inertia takes, and what is wanted of the power entering it.
#[derive(Clone, Debug)]
pub(crate) struct Station {
    pub(crate) shaft: usize,
    pub(crate) absorbs: bool,
    /// Plane of the torque entering this shaft.
    pub(crate) torque: Option<usize>,
    /// First plane of the moment of the joint before this shaft.
    pub(crate) moment: Option<usize>,
}

impl Plan {
    /// Plans a request.
    ///
    /// # Errors
    /// A shaft or joint that does not exist or is named twice, an output named twice, an output
    /// that needs a load where none is given.
    pub fn new(request: &Request<'_>) -> Result<Self> {
        let n = request.joint_count;
        check_items("shafts", request.shafts, n + 1)?;
        check_items("joints", request.joints, n)?;
        check_items("inertias", request.inertias, n + 1)?;
        let mut plan = Self { joint_count: n, planes: 0, shafts: vec![], load: None };
        let mut torque = vec![None; n + 1];
        let mut moment = vec![None; n];
        for (i, &output) in request.outputs.iter().enumerate() {
            if request.outputs[..i].contains(&output) {
                let problem = format!("is {:?} again; name each output once", output.name());
                return Err(Error::new("outputs", &[i], problem));
            }
            if output.needs_load() && request.load.is_none() {
                let problem = format!("is {:?}, which needs a load", output.name());
                return Err(Error::new("outputs", &[i], problem));
            }
            let items = if output.per_joint() { request.joints } else { request.shafts };
            for &item in items {
                let plane = Some(plan.planes);
                plan.planes += output.components();
                match output {
                    Output::Angle => plan.step(item).angle = plane,
                    Output::AngleError => plan.step(item).angle_error = plane,
                    Output::SpeedRatio => plan.step(item).speed_ratio = plane,
                    Output::AccelerationRatio => plan.step(item).acceleration_ratio = plane,
                    Output::Torque => torque[item] = plane,
                    Output::Moment => moment[item] = plane,
                }
            }
        }
        if let Some(end) = request.load {
            plan.plan_load(end, request.inertias, &torque, &moment);
        }
        plan.shafts.sort_by_key(|step| step.shaft);
        Ok(plan)
    }

    /// Number of planes of the result.
    pub fn planes(&self) -> usize {
        self.planes
    }

    /// Joints that must be folded to serve the last shaft or moment that is needed.
    pub(crate) fn reach(&self) -> usize {
        let shafts = self.shafts.iter().map(|step| step.shaft).max().unwrap_or(0);
        let moments = self.stations().filter(|s| s.moment.is_some()).map(|s| s.shaft).max();
        shafts.max(moments.unwrap_or(0))
    }

    /// Whether the moment of a joint is wanted.
    pub(crate) fn needs_pose(&self, joint: usize) -> bool {
        self.stations().any(|s| s.shaft == joint + 1 && s.moment.is_some())
    }

    fn stations(&self) -> impl Iterator<Item = &Station> {
        self.load.iter().flat_map(|load| &load.stations)
    }

    fn step(&mut self, shaft: usize) -> &mut ShaftStep {
        let found = self.shafts.iter().position(|step| step.shaft == shaft);
        let index = found.unwrap_or_else(|| {
            self.shafts.push(ShaftStep { shaft, ..ShaftStep::default() });
            self.shafts.len() - 1
        });
        &mut self.shafts[index]
    }

    /// Lists the stations between the end where the torque is given and the farthest shaft whose
    /// entering power is wanted; inertias beyond it do not matter.
    fn plan_load(
        &mut self,
        end: End,
        inertias: &[usize],
        torque: &[Option<usize>],
        moment: &[Option<usize>],
    ) {
        let n = self.joint_count;
        let moment_before = |shaft: usize| shaft.checked_sub(1).and_then(|joint| moment[joint]);
        let wanted = |shaft: &usize| torque[*shaft].is_some() || moment_before(*shaft).is_some();
        let range: Vec<usize> = match end {
            End::Drive => match (0..=n).rev().find(wanted) {
                Some(last) => (0..=last).collect(),
                None => return,
            },
            End::Output => match (0..=n).find(wanted) {
                Some(first) => (first..=n).rev().collect(),
                None => return,
            },
        };
        let farthest = range[range.len() - 1];
        let mut stations = vec![];
        for shaft in range {
            let passed = end == End::Output || shaft != farthest;
            let station = Station {
                shaft,
                absorbs: passed && inertias.contains(&shaft),
                torque: torque[shaft],
                moment: moment_before(shaft),
            };
            let starts = end == End::Output && shaft == n;
            if station.absorbs || station.torque.is_some() || starts {
                self.step(shaft).keep_rates = true;
            }
            if station.moment.is_some() {
                self.step(shaft - 1).keep_rates = true;
            }
            stations.push(station);
        }
        self.load = Some(LoadStep { end, stations });
    }
}

fn check_items(argument: &'static str, items: &[usize], count: usize) -> Result<()> {
    for (i, &item) in items.iter().enumerate() {
        if item >= count {
            let problem = format!("is {item}; there are {count}, counted from 0");
            return Err(Error::new(argument, &[i], problem));
        }
        if items[..i].contains(&item) {
            return Err(Error::new(argument, &[i], format!("is {item} again; name each once")));
        }
    }
    Ok(())
}
