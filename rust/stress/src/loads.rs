//! The loads and crosses of chains with `tolerance=0`, in plain ulp, of a vector in ulp of its largest
//! component.

use std::f64::consts::{FRAC_PI_2, PI};

use cardan::{Axes, Geometry, Output};

use crate::error_table::{ErrorTable, RowLimits};
use crate::exact::{COUNT, Frames, OUTPUTS, Turn};
use crate::judge::Tier;
use crate::loading::{LoadedDriveline, Loading};
use crate::samples::Random;
use crate::shape_errors::ShapeErrors;

/// What the table of the report is about.
const ABOUT: &str = "The loads of chains with `tolerance=0` are judged in plain ulp of the exact result, of a vector in ulp of its largest component. The \
    oracle is the vector picture: pins as unit vectors, turned about their shafts. \
    What is turned is in axes that turn with its shaft.\n";

/// Angles for each chain.
pub(crate) const ANGLES: usize = 20;

/// In axes that turn with the shaft on which they act.
const TURNED: [Output; 2] = [Output::Moment, Output::SupportMoment];

const JUDGED: usize = COUNT + TURNED.len();

/// What is judged: the outputs at rest, then those that are turned.
const NAMES: [&str; JUDGED] = {
    let mut names = ["turned moment"; JUDGED];
    let mut i = 0;
    while i < OUTPUTS.len() {
        names[i] = OUTPUTS[i].row().name;
        i += 1;
    }
    names[JUDGED - 1] = "turned support_moment";
    names
};

/// The largest errors of what is judged, in ulp.
fn limits() -> [f64; JUDGED] {
    NAMES.map(|name| Tier::Faithful.limit_in("chain", name))
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
type LoadErrors = ShapeErrors<LoadShape, 1, JUDGED>;

/// Judges at least so many samples of each kind.
pub(crate) fn table(seed: u64, samples: u64) -> ErrorTable {
    let head = ("Loads of chains", ABOUT);
    ErrorTable::of(
        head,
        NAMES,
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
        axes: Axes::Space,
    };
    let turned = LoadedDriveline { outputs: &TURNED, axes: Axes::Shaft, ..loaded };
    let planes: Vec<Vec<f64>> = [loaded, turned]
        .iter()
        .flat_map(|own| own.evaluate(&[Tier::Faithful]).expect("the request is sound").remove(0))
        .collect();
    let frames = Frames::of(line);
    let place =
        |output: Output| OUTPUTS.iter().position(|&own| own == output).expect("it is judged");
    for (i, &angle) in angles.iter().enumerate() {
        let at = Turn::by(&[angle]);
        let mut exact = frames.outputs(&loading, &at);
        for (output, first) in TURNED.into_iter().zip([1, 0]) {
            let vectors = exact[place(output)].iter().enumerate();
            exact.push(vectors.map(|(i, own)| frames.along(own, i + first, &at)).collect());
        }
        let mut plane = 0;
        for (q, items) in exact.iter().enumerate() {
            for (item, want) in items.iter().enumerate() {
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
                            NAMES[q], x.high
                        )
                    });
                }
                plane += want.len();
            }
        }
    }
    found.judged += ANGLES as u64;
}
