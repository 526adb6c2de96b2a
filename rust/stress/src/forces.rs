//! The forces of joints and bearings, in the units of `rust/stress/forces.md`.
//!
//! The oracle solves the balance of all shafts at once, as one linear system in which no formula for
//! a force appears. Across each supported shaft its forces are in balance, and their moments together
//! with those of its joints. A bearing gives no thrust, a joint no force along the shaft that it
//! supports, and a joint that supports no shaft gives none at all.

use cardan::{Axes, Geometry, Output};

use crate::error_table::{ErrorTable, RowLimits};
use crate::exact::{Frames, Turn};
use crate::judge::Tier;
use crate::loading::{BearingLayout, LoadedDriveline, Loading};
use crate::loads::{ANGLES, LoadShape};
use crate::samples::Random;
use crate::shape_errors::ShapeErrors;
use crate::space::{ExactAxes, Span, Transmitted, cross, dot, solved};
use crate::wide::{Wide, hex};

/// What the report says above the table.
const ABOUT: &str = r"The forces of joints and bearings with `tolerance=0` are judged in ulp of the largest component of
the exact vector. The default is judged in ulp of the largest force at that drive angle, or of the
largest moment of the joints divided by the smallest distance between the two supports of a shaft if
that is larger; the moment is what the torques of drive and inertias give if none of them cancel.
`tolerance=1e-6` and `float32` are judged in parts of the same. Which joints support which shafts is
drawn at random; the bearings make up what is missing. The oracle solves the balance of all shafts as
one linear system. What is turned is in axes that turn with its shaft.
";

const OUTPUTS: [Output; 2] = [Output::JointForce, Output::BearingForce];

/// What is judged: the forces in axes at rest, then in axes that turn with their shafts.
const NAMES: [&str; 4] =
    ["joint_force", "bearing_force", "turned joint_force", "turned bearing_force"];

/// The largest errors of what is judged in a tier.
fn limits(tier: Tier) -> [f64; 4] {
    NAMES.map(|name| tier.limit_in("force", name))
}

/// The worst errors of the forces of a kind of chain, by tier and output.
type ForceErrors = ShapeErrors<LoadShape, 4, 4>;

/// Judges at least so many samples of each kind.
pub(crate) fn table(seed: u64, samples: u64) -> ErrorTable {
    let head = ("Forces", ABOUT);
    ErrorTable::of(head, NAMES, &RowLimits::of_tiers(limits), &run(seed, samples), LoadShape::name)
}

/// At least so many samples of each kind.
fn run(seed: u64, samples: u64) -> Vec<ForceErrors> {
    let mut random = Random::new(seed ^ 0xf0ce);
    ShapeErrors::of_each(&LoadShape::ALL, samples, |shape, found| {
        judge(&shape.line(&mut random), &mut random, found);
    })
}

/// What carries the shafts of a driveline.
#[derive(Debug)]
pub(crate) struct Arrangement {
    pub(crate) layout: BearingLayout,
    /// Which shaft each joint supports.
    supported: Vec<Option<usize>>,
}

impl Arrangement {
    /// Any in which each shaft has two supports, or is a first or last one held by its machine.
    pub(crate) fn of(random: &mut Random, joints: usize) -> Self {
        let supported: Vec<_> =
            (0..joints).map(|joint| random.pick(&[None, Some(joint), Some(joint + 1)])).collect();
        let lengths: Vec<f64> = (0..=joints).map(|_| random.between(0.3, 2.0)).collect();
        let (mut bearings, mut positions) = (vec![], vec![]);
        for (shaft, length) in lengths.iter().enumerate() {
            let own = supported.iter().filter(|&&held| held == Some(shaft)).count();
            let end = shaft == 0 || shaft == joints;
            let count = if end && own == 0 { random.pick(&[0, 2]) } else { 2 - own };
            for at in &[0.15, 0.65][..count] {
                bearings.push(shaft);
                positions.push(length * (at + random.between(0.0, 0.25)));
            }
        }
        Self { layout: BearingLayout { bearings, lengths, positions }, supported }
    }

    /// The smallest distance between the two supports of a shaft.
    pub(crate) fn shortest_span(&self) -> f64 {
        let BearingLayout { bearings, lengths, positions } = &self.layout;
        let span = |shaft: usize| {
            let own = (0..bearings.len()).filter(|&i| bearings[i] == shaft).map(|i| positions[i]);
            let joints = (0..self.supported.len())
                .filter(|&joint| self.supported[joint] == Some(shaft))
                .map(|joint| if joint == shaft { lengths[shaft] } else { 0.0 });
            match own.chain(joints).collect::<Vec<_>>()[..] {
                [first, second] => (second - first).abs(),
                _ => f64::INFINITY,
            }
        };
        (0..lengths.len()).map(span).fold(f64::INFINITY, f64::min)
    }

    /// Forces of joints, then of bearings, for each of these loads.
    pub(crate) fn forces(&self, axes: &ExactAxes, transmitted: &[Transmitted]) -> Vec<Vec<Span>> {
        let BearingLayout { bearings, lengths, positions } = &self.layout;
        let n = self.supported.len();
        let unknowns = 3 * (n + bearings.len());
        let mut rows: Vec<Vec<Wide>> = vec![];
        let mut add = |terms: &[(usize, Span)], right: Vec<Wide>| {
            let mut row = vec![Wide::ZERO; unknowns];
            for &(vector, factor) in terms {
                for axis in 0..3 {
                    row[3 * vector + axis] = row[3 * vector + axis] + factor[axis];
                }
            }
            row.extend(right);
            rows.push(row);
        };
        let zeros = || vec![Wide::ZERO; transmitted.len()];
        for (joint, held) in self.supported.iter().enumerate() {
            match *held {
                Some(shaft) => add(&[(joint, axes.directions[shaft])], zeros()),
                None => {
                    for axis in 0..3 {
                        let unit = [0, 1, 2].map(|i| Wide::from(f64::from(i == axis)));
                        add(&[(joint, unit)], zeros());
                    }
                }
            }
        }
        for (i, &shaft) in bearings.iter().enumerate() {
            add(&[(n + i, axes.directions[shaft])], zeros());
        }
        for (shaft, &length) in lengths.iter().enumerate() {
            let held = bearings.contains(&shaft) || self.supported.contains(&Some(shaft));
            if !held {
                continue;
            }
            let (before, after) = (shaft.checked_sub(1), Some(shaft).filter(|&joint| joint < n));
            // What acts on the shaft: the unknown, its sign, and its place.
            let mut acting = vec![];
            acting.extend(before.map(|joint| (joint, Wide::ONE, 0.0)));
            acting.extend(after.map(|joint| (joint, -Wide::ONE, length)));
            for (i, &place) in positions.iter().enumerate() {
                if bearings[i] == shaft {
                    acting.push((n + i, Wide::ONE, place));
                }
            }
            let along = axes.directions[shaft];
            let normal = axes.normals[before.unwrap_or(0)];
            for axis in [normal, cross(along, normal)] {
                let force =
                    |&(vector, sign, _): &(usize, Wide, f64)| (vector, axis.map(|x| x * sign));
                add(&acting.iter().map(force).collect::<Vec<_>>(), zeros());
                // (u × F) · axis = (axis × u) · F.
                let arm = cross(axis, along);
                let moment = |&(vector, sign, place): &(usize, Wide, f64)| {
                    (vector, arm.map(|x| x * sign * place))
                };
                let right = transmitted.iter().map(|Transmitted { moments, .. }| {
                    let of = |joint: Option<usize>| {
                        joint.map_or(Wide::ZERO, |joint| dot(moments[joint], axis))
                    };
                    of(after) - of(before)
                });
                add(&acting.iter().map(moment).collect::<Vec<_>>(), right.collect());
            }
        }
        assert_eq!(rows.len(), unknowns, "the arrangement is determinate");
        let vectors = |side: &Vec<Wide>| side.as_chunks().0.to_vec();
        let mut forces: Vec<Vec<Span>> = solved(rows).iter().map(vectors).collect();
        // The equations of a joint that supports no shaft say zero, the solution has rounding.
        for forces in &mut forces {
            for (force, held) in forces.iter_mut().zip(&self.supported) {
                if held.is_none() {
                    *force = [Wide::ZERO; 3];
                }
            }
        }
        forces
    }
}

fn judge(line: &Geometry, random: &mut Random, found: &mut ForceErrors) {
    let n = line.bends.len();
    let loading = Loading::of(random, n + 1);
    let arrangement = Arrangement::of(random, n);
    let bearings = arrangement.layout.bearings.len();
    let outputs = &OUTPUTS[..if bearings > 0 { 2 } else { 1 }];
    let angles: Vec<f64> = (0..ANGLES).map(|_| random.between(-4.0, 4.0)).collect();
    let loaded = LoadedDriveline {
        line,
        loading: &loading,
        angles: &angles,
        outputs,
        layout: Some(&arrangement.layout),
        deviations: &[],
        repeated: false,
        axes: Axes::Space,
    };
    // Joints can support the shafts in another way as well, or shafts that float follow each other.
    let Ok(at_rest) = loaded.evaluate(&Tier::ALL) else { return };
    let turned = LoadedDriveline { axes: Axes::Shaft, ..loaded }.evaluate(&Tier::ALL);
    let turned = turned.expect("the axes do not matter");
    let frames = Frames::of(line);
    let turns: Vec<Turn> = angles.iter().map(|&angle| Turn::by(&[angle])).collect();
    let transmitted: Vec<_> = turns.iter().map(|at| frames.transmitted(&loading, at)).collect();
    let exact = arrangement.forces(&frames.axes, &transmitted);
    let span = arrangement.shortest_span();
    for (i, &angle) in angles.iter().enumerate() {
        let moment = transmitted[i].largest / span;
        let largest = exact[i].iter().flatten().map(|x| x.high.abs()).fold(moment, f64::max);
        for (item, at_rest_want) in exact[i].iter().enumerate() {
            let shaft = if item < n { item + 1 } else { arrangement.layout.bearings[item - n] };
            let along = frames.along(at_rest_want, shaft, &turns[i]);
            for (tiers, want, turned) in
                [(&at_rest, &at_rest_want[..], false), (&turned, &along, true)]
            {
                let q = usize::from(item >= n) + if turned { 2 } else { 0 };
                let own = want.iter().map(|x| x.ulp()).fold(0.0, f64::max);
                for (tier, planes) in Tier::ALL.into_iter().zip(tiers) {
                    let unit = match tier {
                        Tier::Faithful => own,
                        Tier::Default => Wide::from(largest).ulp(),
                        Tier::Loose | Tier::Float32 => largest,
                    };
                    for (k, x) in want.iter().enumerate() {
                        let got = planes[3 * item + k][i];
                        let off = if x.distance(got) == 0.0 { 0.0 } else { x.distance(got) / unit };
                        found.take(tier as usize, q, off, || {
                            let Geometry { bends, twists, phases, .. } = line;
                            format!(
                                "{} {item}, component {k}, at bends {bends:?}, twists {twists:?}, \
                                 phases {phases:?}, {arrangement:?}, angle {angle:?}, {loading:?}: \
                                 {got:e} instead of {:e}",
                                NAMES[q], x.high
                            )
                        });
                    }
                }
            }
        }
    }
    found.judged += ANGLES as u64;
}

/// Prints the forces of a chain under a drive torque for `tests/check_oracle.py`: torque, the shaft
/// that each joint supports (−1 without one), the lengths, and shaft and position of each bearing.
pub(crate) fn print_oracle(line: &Geometry, angle: f64, random: &mut Random) {
    let arrangement = Arrangement::of(random, line.bends.len());
    let loading = Loading::of_drive(random.between(-9.0, 9.0), line.bends.len() + 1);
    let frames = Frames::of(line);
    let forces =
        arrangement.forces(&frames.axes, &[frames.transmitted(&loading, &Turn::by(&[angle]))]);
    let BearingLayout { bearings, lengths, positions } = &arrangement.layout;
    let supported = arrangement.supported.iter().map(|held| held.map_or(-1.0, |s| s as f64));
    let list = |all: Vec<f64>| all.into_iter().map(hex).collect::<Vec<_>>().join(" ");
    println!(
        "forces {} / {} / {} / {} / {}",
        hex(loading.torque),
        list(supported.collect()),
        list(lengths.clone()),
        list(bearings.iter().map(|&shaft| shaft as f64).collect()),
        list(positions.clone()),
    );
    for (item, force) in forces[0].iter().enumerate() {
        for (x, axis) in force.iter().zip(["x", "y", "z"]) {
            println!("force {item} {axis}: {}", x.hex());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_within_their_limits() {
        for found in run(7, 400) {
            for tier in Tier::ALL {
                for (off, limit) in found.off[tier as usize].into_iter().zip(limits(tier)) {
                    assert!(off > 0.0 && off <= limit, "{off} of {limit}: {:?}", found.place);
                }
            }
        }
    }
}
