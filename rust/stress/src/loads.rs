//! The loads of chains with `tolerance=0`, in plain ulp, of a vector in ulp of its largest
//! component.
//!
//! The oracle is the vector picture. A yoke is a unit vector along its pin, turned about its shaft.
//! The cross keeps both pins of a joint perpendicular and transmits only a moment normal to both.

use std::f64::consts::{FRAC_PI_2, PI};

use cardan::{
    Angles, Drivelines, End, Geometry, Load, Output, Plan, Request, Samples, Source, Vector,
};

use crate::angle::sin_cos;
use crate::evaluated::planes;
use crate::exact::{ExactChain, Turn};
use crate::judge::{self, Tier};
use crate::points::{Span, cross, dot};
use crate::samples::Random;
use crate::shape_errors::ShapeErrors;
use crate::wide::Wide;

/// Angles for each chain.
pub(crate) const ANGLES: usize = 20;

const OUTPUTS: [Output; 5] = [
    Output::Torque,
    Output::Moment,
    Output::SupportMoment,
    Output::BendingDriving,
    Output::BendingDriven,
];

/// The names of the outputs.
pub(crate) fn names() -> [&'static str; 5] {
    OUTPUTS.map(|output| output.row().name)
}

/// The largest errors of the outputs, in ulp.
pub(crate) fn limits() -> [f64; 5] {
    names().map(|name| judge::limit("chain", name, "tolerance_0").expect("the table has it"))
}

/// A kind of chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LoadShape {
    Ordinary,
    Planar,
    Steep,
}

impl LoadShape {
    pub(crate) const ALL: [Self; 3] = [Self::Ordinary, Self::Planar, Self::Steep];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Ordinary => "2 to 6 joints, bends to 60°",
            Self::Planar => "2 to 6 joints in a plane, yokes aligned or crossed",
            Self::Steep => "2 to 6 joints, one of them 0.1° to 5° from 90°",
        }
    }

    pub(crate) fn line(self, random: &mut Random) -> Geometry {
        let n = 2 + random.below(5);
        let mut bends: Vec<f64> = (0..n).map(|_| random.between(0.0, PI / 3.0)).collect();
        if self == Self::Steep {
            let steep = random.below(n);
            bends[steep] = FRAC_PI_2 - random.between(0.1, 5.0).to_radians();
        }
        let planar = self == Self::Planar;
        let mut angle =
            |all: &[f64]| if planar { random.pick(all) } else { random.between(-PI, PI) };
        let twists: Vec<f64> = (1..n).map(|_| angle(&[0.0, PI])).collect();
        let phases: Vec<f64> = (1..n).map(|_| angle(&[0.0, FRAC_PI_2])).collect();
        Geometry::from_bends(&bends, &twists, &phases).expect("bends are in range")
    }
}

/// The bearings of a driveline.
#[derive(Debug)]
pub(crate) struct BearingLayout {
    /// The shaft of each.
    pub(crate) bearings: Vec<usize>,
    /// Of the shafts.
    pub(crate) lengths: Vec<f64>,
    /// Of the bearings.
    pub(crate) positions: Vec<f64>,
}

/// What a driveline is loaded with.
#[derive(Debug)]
pub(crate) struct Loading {
    end: End,
    pub(crate) torque: f64,
    speed: f64,
    acceleration: f64,
    /// Of each shaft; zeros without them.
    inertias: Vec<f64>,
}

impl Loading {
    pub(crate) fn of(random: &mut Random, shafts: usize) -> Self {
        let end = random.pick(&[End::Drive, End::Output]);
        let turns = random.below(3) == 0;
        let inertias = (0..shafts).map(|_| if turns { random.between(0.0, 0.1) } else { 0.0 });
        Self {
            end,
            inertias: inertias.collect(),
            torque: random.between(-9.0, 9.0),
            speed: random.between(1.0, 5.0),
            acceleration: random.between(-3.0, 3.0),
        }
    }

    /// A torque of the drive alone.
    pub(crate) fn of_drive(torque: f64, shafts: usize) -> Self {
        let inertias = vec![0.0; shafts];
        Self { end: End::Drive, torque, speed: 0.0, acceleration: 0.0, inertias }
    }

    /// The shafts with an inertia.
    fn heavy(&self) -> Vec<usize> {
        (0..self.inertias.len()).filter(|&shaft| self.inertias[shaft] != 0.0).collect()
    }
}

/// The worst errors of a kind of chain, by output.
pub(crate) type LoadErrors = ShapeErrors<LoadShape, 1, 5>;

/// At least so many samples of each kind.
pub(crate) fn run(seed: u64, samples: u64) -> Vec<LoadErrors> {
    let mut random = Random::new(seed ^ 0x10ad);
    ShapeErrors::of_each(&LoadShape::ALL, samples, |shape, found| {
        judge(&shape.line(&mut random), &mut random, found);
    })
}

/// The planes of the outputs in each of the tiers.
///
/// # Errors
/// Forces that are not determinate.
pub(crate) fn evaluate(
    line: &Geometry,
    loading: &Loading,
    angles: &[f64],
    outputs: &[Output],
    layout: Option<&BearingLayout>,
    tiers: &[Tier],
) -> cardan::Result<Vec<Vec<Vec<f64>>>> {
    let n = line.bends.len();
    let flat = |vectors: &[Vector]| -> Vec<f64> {
        vectors.iter().flat_map(|v| v.iter().copied()).collect()
    };
    let (directions, normals) = (flat(&line.directions), flat(&line.normals));
    let lines = Drivelines {
        bends: &line.bends,
        twists: &line.twists,
        phases: &line.phases,
        directions: &directions,
        normals: &normals,
        lengths: layout.map_or(&[], |own| &own.lengths),
        positions: layout.map_or(&[], |own| &own.positions),
        deviations: &[],
    };
    let heavy = loading.heavy();
    let plan = Plan::new(&Request {
        largest_bends: &line.bends,
        outputs,
        shafts: &(0..=n).collect::<Vec<_>>(),
        joints: &(0..n).collect::<Vec<_>>(),
        load: Some(loading.end),
        inertias: &heavy,
        bearings: layout.map(|own| &own.bearings[..]),
        as_built: false,
    })?;
    let given = [loading.torque, loading.speed, loading.acceleration];
    let constant = |i: usize| Source { data: &given[i..=i], strides: &[0] };
    let inertia =
        |&shaft: &usize| (shaft, Source { data: &loading.inertias[shaft..=shaft], strides: &[0] });
    let load = Load {
        torque: constant(0),
        speed: constant(1),
        acceleration: constant(2),
        inertias: heavy.iter().map(inertia).collect(),
    };
    let angle = Angles::Array(Source { data: angles, strides: &[1] });
    let shape = &[angles.len()];
    let samples = Samples { shape, lines, line_strides: &[0], angle, load: Some(load) };
    Ok(tiers.iter().map(|&tier| planes(&plan, &samples, tier)).collect())
}

/// What a driveline transmits at an angle.
pub(crate) struct Transmitted {
    /// Of each shaft.
    pub(crate) torques: Vec<Wide>,
    /// Of each joint on its driven shaft.
    pub(crate) moments: Vec<Span>,
    /// The largest component of a moment if none of the torques of drive and inertias cancelled.
    pub(crate) largest: f64,
}

/// A driveline in space.
pub(crate) struct Frames {
    pub(crate) directions: Vec<Span>,
    pub(crate) normals: Vec<Span>,
    /// Of the motion of each shaft.
    chains: Vec<ExactChain>,
    /// Sine and cosine of each phase.
    phases: Vec<(Wide, Wide)>,
}

impl Frames {
    pub(crate) fn of(line: &Geometry) -> Self {
        let Geometry { bends, twists, phases, .. } = line;
        let unit = |i: usize| [0, 1, 2].map(|j| Wide::from(f64::from(i == j)));
        let (mut directions, mut normals) = (vec![unit(0)], vec![unit(2)]);
        for (j, &bend) in bends.iter().enumerate() {
            if j > 0 {
                normals.push(turned(normals[j - 1], directions[j], sin_cos(&[twists[j - 1]])));
            }
            directions.push(turned(directions[j], normals[j], sin_cos(&[bend])));
        }
        let upto = |i: usize| {
            ExactChain::of(
                &bends[..i],
                &twists[..i.saturating_sub(1)],
                &phases[..i.saturating_sub(1)],
            )
        };
        let chains = (0..=bends.len()).map(upto).collect();
        let phases = phases.iter().map(|&phase| sin_cos(&[phase])).collect();
        Self { directions, normals, chains, phases }
    }

    /// What the shafts and joints transmit at an angle.
    pub(crate) fn transmitted(&self, loading: &Loading, angle: f64) -> Transmitted {
        let (n, at) = (self.normals.len(), Turn::by(&[angle]));
        let motion: Vec<_> = self.chains.iter().map(|chain| chain.motion(&at).0).collect();
        let parts = |i: usize| {
            let turning = motion[i].acceleration * loading.speed * loading.speed;
            [turning, motion[i].ratio * loading.acceleration]
                .map(|part| part * motion[i].ratio * loading.inertias[i])
        };
        let absorbed = |i: usize| {
            let [steady, accelerating] = parts(i);
            steady + accelerating
        };
        // The power over the drive's speed on its way into each shaft.
        let mut power = vec![Wide::from(loading.torque); n + 2];
        if loading.end == End::Drive {
            (0..=n).for_each(|i| power[i + 1] = power[i] - absorbed(i));
        } else {
            power[n + 1] = motion[n].ratio * loading.torque;
            (0..=n).rev().for_each(|i| power[i] = power[i + 1] + absorbed(i));
        }
        let given = if loading.end == End::Drive { power[0] } else { power[n + 1] };
        let terms = (0..=n).flat_map(parts).fold(given.abs(), |sum, part| sum + part.abs());
        let mut largest = 0.0_f64;
        let mut driving = {
            let (u, m) = (self.directions[0], self.normals[0]);
            turned(cross(m, u), u, (at.s, at.c))
        };
        let mut moments = vec![];
        for j in 0..n {
            let after = self.directions[j + 1];
            let driven = cross(after, driving);
            let driven = scaled(driven, Wide::ONE / dot(driven, driven).sqrt());
            let along = cross(driving, driven);
            // The moment of a unit of power over the drive's speed.
            let unit = Wide::ONE / (motion[j].ratio * dot(along, self.directions[j]));
            moments.push(scaled(along, power[j + 1] * unit));
            let components = scaled(along, terms * unit).map(|x| x.high.abs());
            largest = components.into_iter().fold(largest, f64::max);
            if let Some(&phase) = self.phases.get(j) {
                driving = turned(driven, after, phase);
            }
        }
        let torques = (0..=n).map(|i| power[i] / motion[i].ratio).collect();
        Transmitted { torques, moments, largest }
    }

    /// The components of every plane.
    fn loads(&self, loading: &Loading, angle: f64) -> Vec<Vec<Wide>> {
        let (n, Transmitted { torques, moments, .. }) =
            (self.normals.len(), self.transmitted(loading, angle));
        let across = |v: Span, u: Span| plus(v, scaled(u, -dot(v, u)));
        let length = |v: Span| dot(v, v).sqrt();
        let (none, u) = ([Wide::ZERO; 3], &self.directions);
        let moment = |j: usize| *moments.get(j).unwrap_or(&none);
        let support = |i: usize| {
            let before = moment(i.wrapping_sub(1)).map(|x| -x);
            across(plus(moment(i), before), u[i]).to_vec()
        };
        torques
            .into_iter()
            .map(|torque| vec![torque])
            .chain(moments.iter().map(|m| m.to_vec()))
            .chain((0..=n).map(support))
            .chain((0..n).map(|j| vec![length(across(moments[j], u[j]))]))
            .chain((0..n).map(|j| vec![length(across(moments[j], u[j + 1]))]))
            .collect()
    }
}

/// A vector turned about a unit vector perpendicular to it.
fn turned(v: Span, axis: Span, (s, c): (Wide, Wide)) -> Span {
    plus(scaled(v, c), scaled(cross(axis, v), s))
}

fn plus(a: Span, b: Span) -> Span {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn scaled(v: Span, factor: Wide) -> Span {
    v.map(|x| x * factor)
}

fn judge(line: &Geometry, random: &mut Random, found: &mut LoadErrors) {
    let n = line.bends.len();
    let loading = Loading::of(random, n + 1);
    let angles: Vec<f64> = (0..ANGLES).map(|_| random.between(-4.0, 4.0)).collect();
    let tiers = evaluate(line, &loading, &angles, &OUTPUTS, None, &[Tier::Faithful]);
    let [planes] = &tiers.expect("the request is sound")[..] else { unreachable!("one tier") };
    let frames = Frames::of(line);
    for (i, &angle) in angles.iter().enumerate() {
        let mut plane = 0;
        let mut exact = frames.loads(&loading, angle).into_iter();
        for (q, output) in OUTPUTS.into_iter().enumerate() {
            let items =
                if matches!(output, Output::Torque | Output::SupportMoment) { n + 1 } else { n };
            for item in 0..items {
                let want = exact.next().expect("every output has its items");
                let unit = want.iter().map(|x| x.ulp()).fold(0.0, f64::max);
                for (k, x) in want.iter().enumerate() {
                    let got = planes[plane + k][i];
                    found.take(0, q, x.distance(got) / unit, || {
                        let Geometry { bends, twists, phases, .. } = line;
                        let Loading { end, torque, speed, acceleration, inertias } = &loading;
                        format!(
                            "{} {item}, component {k}, at bends {bends:?}, twists {twists:?}, \
                             phases {phases:?}, angle {angle:?}, {end:?} {torque:?}, \
                             speed {speed:?}, acceleration {acceleration:?}, \
                             inertias {inertias:?}: {got:e} instead of {:e}",
                            output.row().name,
                            x.high
                        )
                    });
                }
                plane += want.len();
            }
        }
    }
    found.judged += ANGLES as u64;
}
