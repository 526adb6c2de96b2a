//! Joints as built: every output of every shaft and joint, in ulp of its largest magnitude over the
//! turn; with `tolerance=1e-6` and in single precision in parts of it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use cardan::{Axes, Geometry, Output, check_deviations};

use crate::error_table::{ErrorTable, RowLimits};
use crate::forces::Arrangement;
use crate::judge::Tier;
use crate::leaning::{ExactAsBuilt, LeaningInstant};
use crate::loading::{LoadedDriveline, Loading};
use crate::samples::{Kind, Random};
use crate::shape_errors::ShapeErrors;
use crate::wide::Wide;

/// What the report says above the table.
const ABOUT: &str = r"Drivelines of joints as built are judged by every output of every shaft and joint, under a load of torques
and inertias. The unit is the ulp of the largest magnitude over the turn, of a vector that of its largest
component. It is that of a motion of the shaft or of any before it, of a load or a tilt at any place of the
driveline, because what is added may cancel. That of a force is the largest of any force. Except with
`tolerance=0`, it is the larger of this and the largest bending moment divided by the smallest distance
between the two supports of a shaft. For `angle` it is the ulp of the result if that is larger. `tolerance=1e-6` and
`float32` are judged in parts of the same magnitude. It is the largest of 40 samples, among them those at
which a shaft is fastest or slowest or changes its speed most. Some results are evaluated together with all
others, some in groups and some alone, with one driveline or one per sample. The oracle places both pins of
a joint as vectors, finds the driven angle by Newton's method, the rates by Newton's method on power series,
and the mean over the turn by the trapezoidal rule. Forces follow from the moments by the balance of all
shafts, solved as one linear system.
";

/// Angles for each driveline.
const ANGLES: usize = 40;

const OUTPUTS: [Output; 14] = [
    Output::Angle,
    Output::AngleError,
    Output::SpeedRatio,
    Output::AccelerationRatio,
    Output::JerkRatio,
    Output::Torque,
    Output::Moment,
    Output::SupportMoment,
    Output::BendingDriving,
    Output::BendingDriven,
    Output::TiltDriving,
    Output::TiltDriven,
    Output::JointForce,
    Output::BearingForce,
];

/// How many of these are motions: each shaft adds to those before it.
const MOTIONS: usize = 5;

/// Where bending moments and forces are among these.
const BENDING: std::ops::Range<usize> = 8..10;
const FORCES: std::ops::Range<usize> = 12..14;

/// What is asked for at once: each selection is computed by another loop.
const SELECTIONS: [&[Output]; 7] = [
    &OUTPUTS,
    &[Output::AngleError, Output::SpeedRatio, Output::AccelerationRatio],
    &[Output::AngleError],
    &[Output::SpeedRatio],
    &[Output::AccelerationRatio, Output::TiltDriving, Output::TiltDriven],
    &[Output::Torque, Output::BendingDriven, Output::BendingDriving],
    &[Output::JointForce, Output::BearingForce],
];

/// The names of the outputs.
fn names() -> [&'static str; 14] {
    OUTPUTS.map(|output| output.row().name)
}

/// The largest errors of the outputs in a tier.
fn limits(tier: Tier) -> [f64; 14] {
    names().map(|name| tier.limit_in("as_built", name))
}

/// A kind of driveline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AsBuiltShape {
    Single,
    Steep,
    NearlyBlocked,
    Chain,
    NearlyStraight,
    OneSteep,
}

impl AsBuiltShape {
    const ALL: [Self; 6] = [
        Self::Single,
        Self::Steep,
        Self::NearlyBlocked,
        Self::Chain,
        Self::NearlyStraight,
        Self::OneSteep,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Single => "1 joint, bends of 1e-8 to 1.2",
            Self::Steep => "1 joint, 1° to 5° from 90°",
            Self::NearlyBlocked => "1 joint, deviations 5 % to 50 % below those that block it",
            Self::Chain => "2 to 6 joints, bends to 60°",
            Self::NearlyStraight => "2 to 6 joints, bends of 1e-6 to 0.01",
            Self::OneSteep => "2 or 3 joints, one of them 1° to 5° from 90°",
        }
    }

    fn line(self, random: &mut Random) -> (Geometry, Vec<f64>) {
        let n = match self {
            Self::Single | Self::Steep | Self::NearlyBlocked => 1,
            Self::Chain | Self::NearlyStraight => 2 + random.below(5),
            Self::OneSteep => 2 + random.below(2),
        };
        let steep = matches!(self, Self::Steep | Self::OneSteep).then(|| random.below(n));
        let bend = |joint: usize, random: &mut Random| match self {
            _ if steep == Some(joint) => FRAC_PI_2 - random.between(1.0, 5.0).to_radians(),
            Self::Single if random.below(2) == 0 => random.power(-8.0, 0.0),
            Self::NearlyStraight => random.power(-6.0, -2.0),
            Self::Single | Self::NearlyBlocked => random.between(0.0, 1.2),
            _ => random.between(0.0, PI / 3.0),
        };
        let bends: Vec<f64> = (0..n).map(|joint| bend(joint, random)).collect();
        let twists: Vec<f64> = (1..n).map(|_| random.between(-PI, PI)).collect();
        let phases: Vec<f64> = (1..n).map(|_| random.between(-PI, PI)).collect();
        let deviations = bends.iter().flat_map(|&bend| self.deviations(bend, random)).collect();
        let line = Geometry::from_bends(&bends, &twists, &phases).expect("bends are in range");
        (line, deviations)
    }

    /// Deviations with which a joint turns.
    fn deviations(self, bend: f64, random: &mut Random) -> [f64; 3] {
        let sizes = [0, 1, 2].map(|_| {
            let size = if random.below(4) == 0 { 0.0 } else { random.power(-7.0, -1.0) };
            size * random.sign()
        });
        let scaled = |factor: f64| sizes.map(|size| factor * size);
        let turns = |factor: f64| {
            let within = scaled(factor).iter().all(|e| e.abs() < 1.5);
            within && check_deviations(&[bend], &scaled(factor)).is_ok()
        };
        if self != Self::NearlyBlocked {
            // At most half of those that block the joint; without any deviation it is ideal.
            let mut factor = 1.0;
            while !turns(2.0 * factor) {
                factor *= 0.7;
            }
            let [driving, cross, driven] = scaled(factor);
            return if sizes == [0.0; 3] {
                [1e-3, cross, driven]
            } else {
                [driving, cross, driven]
            };
        }
        let (mut least, mut most) = (0.0, 1e9);
        for _ in 0..200 {
            let middle = 0.5 * (least + most);
            *if turns(middle) { &mut least } else { &mut most } = middle;
        }
        scaled(least * random.between(0.5, 0.95))
    }
}

/// The worst errors of a kind of driveline, by tier and output.
type AsBuiltErrors = ShapeErrors<AsBuiltShape, 4, 14>;

/// Judges a fifth as many samples of each kind: each has some hundred results.
pub(crate) fn table(seed: u64, samples: u64) -> ErrorTable {
    let head = ("Joints as built", ABOUT);
    ErrorTable::of(
        head,
        names(),
        &RowLimits::of_tiers(limits),
        &run(seed, samples / 5),
        AsBuiltShape::name,
    )
}

/// At least so many samples of each kind.
fn run(seed: u64, samples: u64) -> Vec<AsBuiltErrors> {
    let mut random = Random::new(seed ^ 0xa5b1);
    ShapeErrors::of_each(&AsBuiltShape::ALL, samples, |shape, found| {
        let (line, deviations) = shape.line(&mut random);
        judge(&line, &deviations, &mut random, found);
    })
}

/// The components of every item of every output at an angle, of the forces only with bearings.
fn exact(
    line: &ExactAsBuilt,
    at: &LeaningInstant,
    (loading, arrangement): (&Loading, Option<&Arrangement>),
    angle: f64,
) -> Vec<Vec<Vec<Wide>>> {
    let rates: Vec<_> = at.motion.iter().map(|&[_, ratio, rate, _]| [ratio, rate]).collect();
    let (powers, _) = loading.powers(&rates);
    let (shafts, joints) = (at.motion.len(), at.tilts.len());
    let motion = |k: usize| at.motion.iter().map(|motion| vec![motion[k]]).collect();
    let angles = at.motion.iter().map(|motion| vec![motion[0] + Wide::from(angle)]).collect();
    let mut all = vec![angles, motion(0), motion(1), motion(2), motion(3)];
    let mut loads = line.loads(at, &powers).into_iter();
    for items in [shafts, joints, shafts, joints, joints] {
        all.push(loads.by_ref().take(items).collect());
    }
    all.extend([0, 1].map(|end| at.tilts.iter().map(|tilts| vec![tilts[end]]).collect()));
    if let Some(arrangement) = arrangement {
        let forces = arrangement.forces(&line.axes, &[line.transmitted(at, &powers)]).remove(0);
        let (of_joints, of_bearings) = forces.split_at(joints);
        all.extend([of_joints, of_bearings].map(|own| own.iter().map(|v| v.to_vec()).collect()));
    }
    all
}

fn judge(line: &Geometry, deviations: &[f64], random: &mut Random, found: &mut AsBuiltErrors) {
    let Geometry { bends, twists, phases, .. } = line;
    let loading = Loading::of(random, bends.len() + 1);
    let arrangement = Arrangement::of(random, bends.len());
    let oracle = ExactAsBuilt::of(bends, twists, phases, deviations);
    let start = random.between(-PI, PI);
    let mut angles: Vec<f64> = oracle.extremes.iter().map(|part| part * TAU).collect();
    angles.extend((0..16).map(|i| start + TAU * f64::from(i) / 16.0));
    while angles.len() < ANGLES {
        angles.push(Kind::Random.angle(random, 0.0, &[]));
    }
    let mut outputs =
        SELECTIONS[random.below(2 * SELECTIONS.len()).saturating_sub(SELECTIONS.len())];
    let loaded = LoadedDriveline {
        line,
        loading: &loading,
        angles: &angles,
        outputs,
        layout: Some(&arrangement.layout),
        deviations,
        repeated: random.below(4) == 0,
        axes: Axes::Space,
    };
    let tiers = loaded.evaluate(&Tier::ALL).unwrap_or_else(|_| {
        // The forces of these bearings are not determinate.
        outputs = &OUTPUTS[..FORCES.start];
        let loaded = LoadedDriveline { outputs, layout: None, ..loaded };
        loaded.evaluate(&Tier::ALL).expect("the request is sound")
    });
    let has_forces = outputs.contains(&Output::JointForce);
    let acting = (&loading, has_forces.then_some(&arrangement));
    let exact = |&angle: &f64| exact(&oracle, &oracle.at(angle), acting, angle);
    let wanted: Vec<_> = angles.iter().map(exact).collect();
    let largest_of = |q: usize| {
        let all = wanted.iter().flat_map(|all| all.get(q).into_iter().flatten().flatten());
        all.map(|x| x.high.abs()).fold(0.0, f64::max)
    };
    let largest_force = FORCES.map(largest_of).fold(0.0, f64::max);
    // The terms of a force, which bend the shafts, may cancel.
    let bending = BENDING.map(largest_of).fold(0.0, f64::max);
    let largest_term = largest_force.max(bending / arrangement.shortest_span());
    let mut first = 0;
    for output in outputs {
        let q = OUTPUTS.iter().position(|own| own == output).expect("it is one of all");
        // An angle is as exact as the larger of itself and the errors that it contains.
        let own = if *output == Output::Angle { 1 } else { q };
        let wanted = &wanted;
        let size = |item: usize| {
            let all = wanted.iter().flat_map(move |all| &all[own][item]);
            all.map(|x| x.high.abs()).fold(0.0, f64::max)
        };
        let items = wanted[0][q].len();
        for (item, components) in wanted[0][q].iter().enumerate() {
            // What is added along the driveline, or shared by it, may cancel.
            let others = if q < MOTIONS { 0..item + 1 } else { 0..items };
            let largest = others.map(size).fold(0.0, f64::max);
            for (i, &angle) in angles.iter().enumerate() {
                for (k, want) in wanted[i][q][item].iter().enumerate() {
                    let largest = if q == own { largest } else { want.high.abs().max(largest) };
                    for (tier, planes) in Tier::ALL.into_iter().zip(&tiers) {
                        let largest = match tier {
                            _ if !FORCES.contains(&q) => largest,
                            Tier::Faithful => largest_force,
                            _ => largest_term,
                        };
                        let got = planes[first + k][i];
                        let unit =
                            if tier.is_single() { largest } else { Wide::from(largest).ulp() };
                        let distance = want.distance(got);
                        let off = if distance == 0.0 { 0.0 } else { distance / unit };
                        found.take(tier as usize, q, off, || {
                            format!(
                                "{} {item}, component {k}, of {} outputs at bends {bends:?}, twists \
                                 {twists:?}, phases {phases:?}, deviations {deviations:?}, angle \
                                 {angle:?}, {loading:?}: {got:e} instead of {:e}",
                                output.row().name,
                                outputs.len(),
                                want.high
                            )
                        });
                    }
                }
            }
            first += components.len();
        }
    }
    found.judged += angles.len() as u64;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_as_built_are_within_their_limits() {
        for found in run(7, 400) {
            for tier in Tier::ALL {
                for (off, limit) in found.off[tier as usize].into_iter().zip(limits(tier)) {
                    assert!(off > 0.0 && off <= limit, "{off} of {limit}: {:?}", found.place);
                }
            }
        }
    }
}
