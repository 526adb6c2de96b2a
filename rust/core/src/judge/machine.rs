//! A machine: its drivelines in all states, its duty cycle, its parts and their limits.

use crate::design::tube::Round;
use crate::error::{Error, Result, Rule};
use crate::input::batch::{Batch, check_length, check_shaft};
use crate::input::{Angles, Drivelines, Load, Samples, Source};
use crate::judge::{Kind, Limit, Scope, Side};
use crate::plan::output::Per;
use crate::plan::request::End;
use crate::turns::rows::Rows;

const POSITIVE: Rule = Rule::new("", "it must be positive");
const NOT_NEGATIVE: Rule = Rule::new("", "it must not be negative");

/// The arrays of [`Drivelines`], in the order of its fields.
pub(crate) type Arrays = [Vec<f64>; 8];

/// Loads of a machine in each of its cases.
#[derive(Clone, Debug)]
pub struct CaseLoads {
    /// The end at which the torque is given.
    pub end: End,
    /// Torque in N·m.
    pub torque: Vec<f64>,
    /// Acceleration of the drive in rad/s².
    pub acceleration: Vec<f64>,
    /// The shafts with an inertia, and these in kg·m².
    pub inertias: Vec<(usize, Vec<f64>)>,
}

/// The states of a machine, or the steps of its duty cycle: in each a driveline, the speed of the
/// drive in rad/s and a load.
#[derive(Clone, Debug)]
pub struct Cases {
    pub(crate) lines: Arrays,
    pub(crate) count: usize,
    /// Strides of rows of several variants and their samples, in drivelines.
    strides: [usize; 3],
    speeds: Vec<f64>,
    pub(crate) load: Option<CaseLoads>,
}

impl Cases {
    /// Drivelines of a batch with their speeds, of which 0 means that it is not known, and with
    /// their loads, if these are known. A torque of 0 without inertias is none.
    ///
    /// # Errors
    /// Joints with deviations, no driveline, arrays of other lengths, a shaft that does not exist.
    pub fn new(
        batch: &Batch,
        lines: &Drivelines<'_>,
        speeds: &[f64],
        mut load: Option<CaseLoads>,
    ) -> Result<Self> {
        batch.check_ideal("machines are judged")?;
        let count = lines.check(batch.joints())?;
        check_length("speed", speeds.len(), count, 1)?;
        if let Some(CaseLoads { end, torque, acceleration, inertias }) = &mut load {
            check_length(end.torque_name(), torque.len(), count, 1)?;
            check_length("acceleration", acceleration.len(), count, 1)?;
            for (shaft, each) in &*inertias {
                check_shaft(batch.joints(), *shaft)?;
                check_length("inertias", each.len(), count, 1)?;
            }
            for (case, torque) in torque.iter_mut().enumerate() {
                if *torque == 0.0 && inertias.iter().all(|(_, each)| each[case] == 0.0) {
                    *torque = f64::NAN;
                }
            }
        }
        let lines = lines.arrays().map(<[f64]>::to_vec);
        Ok(Self { lines, count, strides: [count, 1, 0], speeds: speeds.to_vec(), load })
    }

    /// The magnitude of the speed in a case; NaN where it is not known.
    pub(crate) fn speed(&self, case: usize) -> f64 {
        let speed = self.speeds[case].abs();
        if speed == 0.0 { f64::NAN } else { speed }
    }

    /// Whether the shafts have lengths.
    pub(crate) fn has_lengths(&self) -> bool {
        !self.lines[5].is_empty()
    }

    /// The cases of several variants of a machine as rows, one variant after another.
    pub(crate) fn rows<'a>(&'a self, lines: Drivelines<'a>, shape: &'a [usize; 2]) -> Rows<'a> {
        Rows { shape, lines, line_strides: &self.strides[..2], load: self.loads(&[0, 1]) }
    }

    /// The same with samples at these drive angles along each row.
    pub(crate) fn samples<'a>(
        &'a self,
        lines: Drivelines<'a>,
        shape: &'a [usize; 3],
        angles: &'a [f64],
    ) -> Samples<'a> {
        let angle = Angles::Array(Source { data: angles, strides: &[0, 0, 1] });
        let load = self.loads(&[0, 1, 0]);
        Samples { shape, lines, line_strides: &self.strides, angle, load }
    }

    fn loads<'a>(&'a self, strides: &'a [usize]) -> Option<Load<'a>> {
        let of = |data: &'a Vec<f64>| Source { data, strides };
        self.load.as_ref().map(|load| Load {
            torque: of(&load.torque),
            speed: of(&self.speeds),
            acceleration: of(&load.acceleration),
            inertias: load.inertias.iter().map(|(shaft, each)| (*shaft, of(each))).collect(),
        })
    }
}

/// A shaft with a spline. What is not known is NaN.
#[derive(Clone, Debug)]
pub struct SlidingShaft {
    /// Which shaft.
    pub shaft: usize,
    /// The engaged length in the drawing in m.
    pub engaged: f64,
    /// How far it can be pushed in there until it bottoms, in m.
    pub push_in: f64,
    /// Coefficient of friction under load.
    pub friction: f64,
    /// Pitch radius in m.
    pub radius: f64,
}

/// Parts of a machine besides its drivelines. Those that it does not have are empty.
#[derive(Clone, Debug, Default)]
pub struct Parts {
    /// The share of each step of the duty cycle in the time.
    pub shares: Vec<f64>,
    /// The rating of each joint in N·m; NaN for one whose life is not known.
    pub ratings: Vec<f64>,
    /// Coefficient of friction, radius of the pins and arm in m, and torque of the seals in N·m, of
    /// each joint.
    pub friction: Vec<[f64; 4]>,
    /// Shafts that are tubes, and their sections. One whose length is NaN is as long as its shaft
    /// in each case.
    pub tubes: Vec<(usize, Round)>,
    /// The spline.
    pub spline: Option<SlidingShaft>,
    /// The drive angle straight ahead of a steering column in rad: in each state, or that of the
    /// drawing alone, from which the column carries its yoke along.
    pub centres: Vec<f64>,
    /// The driveline of the drawing, whose points move as those of the states do. A spline needs its
    /// lengths; if it is not known, the first state is the drawing of a steering column.
    pub drawn: Option<Cases>,
    /// The play of the pins of each joint in their bearings over their arm, in rad.
    pub play: Vec<f64>,
}

/// One limit of a machine.
#[derive(Clone, Copy, Debug)]
pub struct LimitOf {
    /// Kind of the figure.
    pub kind: Kind,
    /// Its shaft, joint or bearing; all if there is none.
    pub item: Option<usize>,
    /// Up to here a figure is within.
    pub limit: f64,
    /// Up to here it is tolerable.
    pub maximum: f64,
}

/// One figure that a machine has in its states, or in all of its cases, or once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Figured {
    pub(crate) kind: Kind,
    pub(crate) item: usize,
    pub(crate) limit: Limit,
    /// The place of its first value among all.
    pub(crate) first: usize,
    pub(crate) count: usize,
}

/// A machine, all of whose arrays fit together.
#[derive(Clone, Debug)]
pub struct Machine {
    pub(crate) joints: usize,
    pub(crate) bearings: Vec<usize>,
    /// The states, and the steps of the duty cycle.
    pub(crate) cases: Vec<Cases>,
    pub(crate) parts: Parts,
    pub(crate) figured: Vec<Figured>,
    /// The limits of what the machine does not have.
    pub(crate) absent: Vec<LimitOf>,
}

impl Machine {
    /// A machine in its states, with bearings on these shafts, and with the steps of its duty cycle
    /// if it has one.
    ///
    /// # Errors
    /// Arrays of other lengths, parts and limits of what does not exist, values that break a rule.
    pub fn new(
        joints: usize,
        bearings: &[usize],
        states: Cases,
        steps: Option<Cases>,
        parts: Parts,
        limits: &[LimitOf],
    ) -> Result<Self> {
        let cases: Vec<Cases> = std::iter::once(states).chain(steps).collect();
        for each in &cases {
            check_length("steps", each.lines[0].len(), each.count, joints)?;
        }
        check_parts(joints, &cases, &parts)?;
        let mut machine = Self {
            joints,
            bearings: bearings.to_vec(),
            cases,
            parts,
            figured: vec![],
            absent: vec![],
        };
        machine.figured = machine.arranged();
        for (place, limit) in limits.iter().enumerate() {
            machine.put(place, limit)?;
        }
        Ok(machine)
    }

    /// The number of values of all figures.
    pub(crate) fn values(&self) -> usize {
        self.figured.last().map_or(0, |last| last.first + last.count)
    }

    /// The figures of a kind.
    pub(crate) fn of(&self, kind: Kind) -> &[Figured] {
        let first = self.figured.partition_point(|figured| figured.kind < kind);
        let count = self.figured[first..].partition_point(|figured| figured.kind == kind);
        &self.figured[first..first + count]
    }

    /// The same machine with the figures that have a limit.
    #[must_use]
    pub fn limited(&self) -> Self {
        let mut own = self.clone();
        own.figured.retain(|figured| !figured.limit.limit.is_nan());
        let mut first = 0;
        for figured in &mut own.figured {
            figured.first = first;
            first += figured.count;
        }
        own
    }

    /// The figures that the machine has, without limits.
    fn arranged(&self) -> Vec<Figured> {
        let (mut figured, mut first) = (vec![], 0);
        for kind in Kind::ALL {
            let row = kind.row();
            let count = self.places(kind);
            for item in self.items(kind) {
                let size = self.size(kind);
                // What has come apart or bottoms is beyond, whatever the limit.
                let ends = matches!(kind, Kind::SplineEngaged | Kind::SplinePushIn);
                let limit = if ends { 0.0 } else { f64::NAN };
                let limit = Limit { limit, maximum: limit, side: row.side, size };
                figured.push(Figured { kind, item, limit, first, count });
                first += count;
            }
        }
        figured
    }

    /// In how many places a figure of a kind has values.
    pub(crate) fn places(&self, kind: Kind) -> usize {
        match kind.row().scope {
            Scope::States => self.cases[0].count,
            Scope::Cases => self.cases.iter().map(|cases| cases.count).sum(),
            Scope::Once => 1,
        }
    }

    /// The shafts, joints or bearings of which a kind of figure is known; 0 if it is of none of
    /// them.
    fn items(&self, kind: Kind) -> Vec<usize> {
        let Self { joints, bearings, cases, parts, .. } = self;
        let only = |has: bool, items: usize| if has { (0..items).collect() } else { vec![] };
        let loaded = cases[0].load.is_some() && cases[0].has_lengths();
        let sliding = |has: fn(&SlidingShaft) -> bool| {
            parts.spline.iter().filter(|one| has(one)).map(|one| one.shaft).collect()
        };
        let any_load = cases.iter().any(|cases| cases.load.is_some());
        match kind {
            Kind::EquivalentBend | Kind::TorsionalExcitation => vec![0],
            Kind::BendDifference => only(*joints == 2, 1),
            Kind::InertiaDriving | Kind::InertiaCoasting => only(*joints > 1, 1),
            Kind::Bend | Kind::SpeedBend => only(true, *joints),
            Kind::Life => only(!parts.ratings.is_empty() && cases.len() > 1, *joints),
            Kind::Heat => only(!parts.friction.is_empty() && any_load, *joints),
            Kind::CriticalMargin => parts.tubes.iter().map(|tube| tube.0).collect(),
            Kind::ShearStress => {
                parts.tubes.iter().filter(|_| any_load).map(|tube| tube.0).collect()
            }
            Kind::SplineTravel => sliding(|_| true),
            Kind::SplineEngaged => sliding(|one| !one.engaged.is_nan()),
            Kind::SplinePushIn => sliding(|one| !one.push_in.is_nan()),
            Kind::SplineForce => {
                if any_load {
                    sliding(|one| !(one.friction / one.radius).is_nan())
                } else {
                    vec![]
                }
            }
            Kind::SteeringOffset | Kind::SteeringRatio => only(!parts.centres.is_empty(), 1),
            Kind::Lash => only(!parts.play.is_empty(), 1),
            Kind::JointForce => only(loaded && !bearings.is_empty(), *joints),
            Kind::BearingForce => only(loaded, bearings.len()),
        }
    }

    /// The length of a shaft in the drawing; NaN where that is not known.
    pub(crate) fn drawn_length(&self, shaft: usize) -> f64 {
        let lengths = self.parts.drawn.as_ref().map(|drawn| drawn.lines[5].as_slice());
        lengths.and_then(|each| each.get(shaft)).copied().unwrap_or(f64::NAN)
    }

    /// The size of what is judged, of which rounding is a part where a limit is 0.
    fn size(&self, kind: Kind) -> f64 {
        match kind {
            Kind::SplineTravel | Kind::SplineEngaged | Kind::SplinePushIn => {
                self.parts.spline.as_ref().map_or(0.0, |one| self.drawn_length(one.shaft))
            }
            Kind::SteeringOffset => std::f64::consts::FRAC_PI_2,
            Kind::SteeringRatio => 1.0,
            _ => 0.0,
        }
    }

    /// Gives figures their limit.
    fn put(&mut self, place: usize, given: &LimitOf) -> Result<()> {
        let LimitOf { kind, item, limit, maximum } = *given;
        let row = kind.row();
        let past = if row.side == Side::Most { maximum >= limit } else { maximum <= limit };
        if limit.is_nan() || !past {
            let rule = Rule::new(row.unit, "a maximum must lie on the far side of its limit");
            return Err(Error::of_value("limits", &[place], maximum, rule));
        }
        let count = match row.per {
            None => 1,
            Some(Per::Joint) => self.joints,
            Some(Per::Shaft) => self.joints + 1,
            Some(Per::Bearing) => self.bearings.len(),
        };
        if let Some(item) = item.filter(|&item| item >= count) {
            let problem = format!("is of {} {item}; there are {count}", row.name);
            return Err(Error::new("limits", &[place], problem));
        }
        let concerns =
            |one: &&mut Figured| one.kind == kind && item.is_none_or(|item| item == one.item);
        let mut found = self.figured.iter_mut().filter(concerns).peekable();
        if found.peek().is_none() {
            self.absent.push(*given);
            return Ok(());
        }
        for figured in found {
            (figured.limit.limit, figured.limit.maximum) = (limit, maximum);
        }
        Ok(())
    }
}

fn check_parts(joints: usize, cases: &[Cases], parts: &Parts) -> Result<()> {
    let each = |name, found: usize, count| {
        if found == 0 { Ok(()) } else { check_length(name, found, count, 1) }
    };
    each("rating", parts.ratings.len(), joints)?;
    each("friction", parts.friction.len(), joints)?;
    each("play", parts.play.len(), joints)?;
    if parts.centres.len() != 1 {
        each("centre", parts.centres.len(), cases[0].count)?;
    }
    if let Some(drawn) = &parts.drawn {
        check_length("drawn", drawn.lines[0].len(), 1, joints)?;
    }
    check_length("shares", parts.shares.len(), cases.get(1).map_or(0, |steps| steps.count), 1)?;
    let all = |name, values: &[f64], rule: Rule, keeps: fn(f64) -> bool| {
        let broken = values.iter().position(|&x| !keeps(x));
        broken.map_or(Ok(()), |i| Err(Error::of_value(name, &[i], values[i], rule)))
    };
    all("rating", &parts.ratings, POSITIVE, |x| x > 0.0 || x.is_nan())?;
    all("play", &parts.play, NOT_NEGATIVE, |x| x >= 0.0)?;
    all("shares", &parts.shares, POSITIVE, |x| x > 0.0)?;
    for (name, column, rule) in [
        ("friction", 0, NOT_NEGATIVE),
        ("pin_radius", 1, POSITIVE),
        ("arm", 2, POSITIVE),
        ("seal_torque", 3, NOT_NEGATIVE),
    ] {
        let values: Vec<f64> = parts.friction.iter().map(|own| own[column]).collect();
        all(name, &values, rule, if rule == POSITIVE { |x| x > 0.0 } else { |x| x >= 0.0 })?;
    }
    let spline = parts.spline.iter().map(|spline| spline.shaft);
    parts.tubes.iter().map(|tube| tube.0).chain(spline).try_for_each(|x| check_shaft(joints, x))?;
    let drawn = parts.drawn.as_ref().is_some_and(Cases::has_lengths);
    if parts.spline.is_some() && !(drawn && cases[0].has_lengths()) {
        return Err(Error::new("spline", &[], "needs the lengths of the shafts"));
    }
    Ok(())
}
