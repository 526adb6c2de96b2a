//! The loads and crosses of chains with `tolerance=0`, in plain ulp, of a vector in ulp of its largest
//! component.
//!
//! The oracle is the vector picture. A yoke is a unit vector along its pin, turned about its shaft.
//! The cross keeps both pins of a joint perpendicular and transmits only a moment normal to both.

use std::f64::consts::{FRAC_PI_2, PI};

use cardan::{Geometry, Output};

use crate::angle::sin_cos;
use crate::error_table::{ErrorTable, RowLimits};
use crate::exact::{ExactChain, Turn};
use crate::judge::{self, Tier};
use crate::loading::{LoadedDriveline, Loading};
use crate::samples::Random;
use crate::shape_errors::ShapeErrors;
use crate::space::{ExactAxes, Span, Transmitted, cross, dot, scaled, turned};
use crate::wide::Wide;

/// What the table of the report is about.
const ABOUT: &str = "The loads of chains with `tolerance=0` are judged in plain ulp of the exact result, of a vector in ulp of its largest component. The \
    oracle is the vector picture: pins as unit vectors, turned about their shafts.\n";

/// Angles for each chain.
pub(crate) const ANGLES: usize = 20;

const OUTPUTS: [Output; 10] = [
    Output::Torque,
    Output::Moment,
    Output::SupportMoment,
    Output::BendingDriving,
    Output::BendingDriven,
    Output::PinMoment,
    Output::SwingDriving,
    Output::SwingDriven,
    Output::DrivingPin,
    Output::DrivenPin,
];

/// The names of the outputs.
fn names() -> [&'static str; 10] {
    OUTPUTS.map(|output| output.row().name)
}

/// The largest errors of the outputs, in ulp.
fn limits() -> [f64; 10] {
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

/// The worst errors of a kind of chain, by output.
type LoadErrors = ShapeErrors<LoadShape, 1, 10>;

/// Judges at least so many samples of each kind.
pub(crate) fn table(seed: u64, samples: u64) -> ErrorTable {
    let head = ("Loads of chains", ABOUT);
    ErrorTable::of(
        head,
        names(),
        &[RowLimits { name: "tolerance=0", single: false, limits: limits() }],
        &run(seed, samples),
        LoadShape::name,
    )
}

/// At least so many samples of each kind.
fn run(seed: u64, samples: u64) -> Vec<LoadErrors> {
    let mut random = Random::new(seed ^ 0x10ad);
    ShapeErrors::of_each(&LoadShape::ALL, samples, |shape, found| {
        judge(&shape.line(&mut random), &mut random, found);
    })
}

/// A driveline of ideal joints in space.
pub(crate) struct Frames {
    pub(crate) axes: ExactAxes,
    /// Of the motion of each shaft.
    chains: Vec<ExactChain>,
    /// Sine and cosine of each phase.
    phases: Vec<(Wide, Wide)>,
}

impl Frames {
    pub(crate) fn of(line: &Geometry) -> Self {
        let Geometry { bends, twists, phases, .. } = line;
        let upto = |i: usize| {
            ExactChain::of(
                &bends[..i],
                &twists[..i.saturating_sub(1)],
                &phases[..i.saturating_sub(1)],
            )
        };
        let chains = (0..=bends.len()).map(upto).collect();
        let phases = phases.iter().map(|&phase| sin_cos(&[phase])).collect();
        Self { axes: ExactAxes::of(bends, twists), chains, phases }
    }

    /// What the shafts and joints transmit at an angle.
    pub(crate) fn transmitted(&self, loading: &Loading, angle: f64) -> Transmitted {
        let (directions, at) = (&self.axes.directions, Turn::by(&[angle]));
        let n = directions.len() - 1;
        let motion = self.chains.iter().map(|chain| chain.motion(&at).0);
        let rates: Vec<_> = motion.map(|motion| [motion.ratio, motion.acceleration]).collect();
        let (power, terms) = loading.powers(&rates);
        let mut largest = 0.0_f64;
        let mut moments = vec![];
        for (j, [driving, driven]) in self.pins(&at).into_iter().enumerate() {
            let along = cross(driving, driven);
            // The moment of a unit of power over the drive's speed.
            let unit = Wide::ONE / (rates[j][0] * dot(along, directions[j]));
            moments.push(scaled(along, power[j + 1] * unit));
            let components = scaled(along, terms * unit).map(|x| x.high.abs());
            largest = components.into_iter().fold(largest, f64::max);
        }
        let torques = (0..=n).map(|i| power[i] / rates[i][0]).collect();
        Transmitted { torques, moments, largest }
    }

    /// The pins of each joint.
    fn pins(&self, at: &Turn) -> Vec<[Span; 2]> {
        let ExactAxes { directions, normals } = &self.axes;
        let (u, m) = (directions[0], normals[0]);
        let mut driving = turned(cross(m, u), u, (at.s, at.c));
        let mut pins = vec![];
        for (j, &after) in directions[1..].iter().enumerate() {
            let driven = cross(after, driving);
            let driven = scaled(driven, Wide::ONE / dot(driven, driven).sqrt());
            pins.push([driving, driven]);
            if let Some(&phase) = self.phases.get(j) {
                driving = turned(driven, after, phase);
            }
        }
        pins
    }

    /// The components of every plane of magnitudes of moments, rates of crosses and pins, in the
    /// order of the outputs.
    fn crosses(&self, moments: &[Span], angle: f64) -> Vec<Vec<Wide>> {
        let (u, at) = (&self.axes.directions, Turn::by(&[angle]));
        let pins = self.pins(&at);
        let ratio = |shaft: usize| self.chains[shaft].motion(&at).0.ratio;
        let joints = || pins.iter().enumerate();
        let sizes = moments.iter().map(|&m| vec![dot(m, m).sqrt()]);
        sizes
            .chain(joints().map(|(j, pins)| vec![ratio(j + 1) * dot(u[j + 1], pins[0])]))
            .chain(joints().map(|(j, pins)| vec![-ratio(j) * dot(u[j], pins[1])]))
            .chain(pins.iter().map(|pins| pins[0].to_vec()))
            .chain(pins.iter().map(|pins| pins[1].to_vec()))
            .collect()
    }
}

fn judge(line: &Geometry, random: &mut Random, found: &mut LoadErrors) {
    let n = line.bends.len();
    let loading = Loading::of(random, n + 1);
    let angles: Vec<f64> = (0..ANGLES).map(|_| random.between(-4.0, 4.0)).collect();
    let loaded = LoadedDriveline {
        line,
        loading: &loading,
        angles: &angles,
        outputs: &OUTPUTS,
        layout: None,
        deviations: &[],
        repeated: false,
    };
    let tiers = loaded.evaluate(&[Tier::Faithful]);
    let [planes] = &tiers.expect("the request is sound")[..] else { unreachable!("one tier") };
    let frames = Frames::of(line);
    for (i, &angle) in angles.iter().enumerate() {
        let mut plane = 0;
        let transmitted = frames.transmitted(&loading, angle);
        let crosses = frames.crosses(&transmitted.moments, angle);
        let mut exact = frames.axes.loads(transmitted).into_iter().chain(crosses);
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
