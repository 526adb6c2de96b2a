//! The oracle of joints as built: pins as vectors, the driven angle by Newton's method.
//!
//! With the driving pin `p` and the driven pin `q`, which turns about its shaft by `ψ`, the driven
//! angle is the root of `p·q − sin e₂`. Newton's method begins where `q` would be with `e₂ = e₃ = 0`:
//! from there the sine that the residual is in `ψ` rises to its root without an overshoot. Rates are
//! the coefficients of `ψ` as a power series of the drive angle, from Newton's method on series.

use cardan::Geometry;

use crate::angle::{atan2, sin_cos};
use crate::exact::Turn;
use crate::space::{ExactAxes, Span, Transmitted, cross, dot, plus, scaled};
use crate::taylor::TaylorSeries;
use crate::wide::{Wide, hex};

/// A joint in the axes `u`, `e_in` and `m` of its driving shaft.
#[derive(Clone, Copy, Debug)]
struct LeaningJoint {
    /// Sine and cosine of the bend.
    bend: (Wide, Wide),
    /// Of the deviations of driving yoke, cross and driven yoke.
    deviations: [(Wide, Wide); 3],
}

impl LeaningJoint {
    /// Components of the driving pin along `e_out`, `m` and `v`, from sine and cosine of the input
    /// angle.
    fn driving_pin(&self, (s, c): (Wide, Wide)) -> Span {
        let (sin, cos) = self.bend;
        let (lean, level) = self.deviations[0];
        [level * c * cos - lean * sin, level * s, level * c * sin + lean * cos]
    }

    /// The same of the driven pin, from sine and cosine of the driven angle.
    fn driven_pin(&self, (s, c): (Wide, Wide)) -> Span {
        let (lean, level) = self.deviations[2];
        [-(level * s), level * c, lean]
    }

    /// Sine and cosine of the driven angle.
    fn driven(&self, pins: (Wide, Wide)) -> (Wide, Wide) {
        let [_, (skew, _), (lean, level)] = self.deviations;
        let [out, normal, along] = self.driving_pin(pins);
        let constant = lean * along - skew;
        let mut angle = normal.high.atan2(out.high);
        for _ in 0..200 {
            let (s, c) = angle.sin_cos();
            let residual = level.high * (c * normal.high - s * out.high) + constant.high;
            let step = residual / (level.high * (c * out.high + s * normal.high));
            angle += step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        let mut driven = {
            let (s, c) = angle.sin_cos();
            let length = (Wide::from(s).square() + Wide::from(c).square()).sqrt();
            (Wide::from(s) / length, Wide::from(c) / length)
        };
        for _ in 0..4 {
            let (s, c) = driven;
            let residual = level * (c * normal - s * out) + constant;
            let step = residual / (level * (c * out + s * normal));
            driven = turned_by_half(driven, step.scaled(0.5));
        }
        driven
    }

    /// The same as series, whose constant parts are known.
    fn driven_series(
        &self,
        [s, c]: [TaylorSeries; 2],
        (driven_s, driven_c): (Wide, Wide),
    ) -> [TaylorSeries; 2] {
        let (sin, cos) = self.bend;
        let [(lean, level), (skew, _), (lean_driven, level_driven)] = self.deviations;
        let of_lean = |factor: Wide| TaylorSeries::constant(lean * factor);
        let out = c * (level * cos) - of_lean(sin);
        let normal = s * level;
        let along = c * (level * sin) + of_lean(cos);
        let constant = along * lean_driven - TaylorSeries::constant(skew);
        let mut driven = [driven_s, driven_c].map(TaylorSeries::constant);
        // Each step doubles the number of coefficients that are known.
        for _ in 0..3 {
            let [s, c] = driven;
            let residual = (c * normal - s * out) * level_driven + constant;
            let half = residual / ((c * out + s * normal) * level_driven) * Wide::from(0.5);
            let one = TaylorSeries::constant(Wide::ONE);
            let inverse = one / (one + half * half);
            let (by_s, by_c) = (half * inverse * Wide::from(2.0), (one - half * half) * inverse);
            driven = [s * by_c + c * by_s, c * by_c - s * by_s];
        }
        driven
    }
}

/// Sine and cosine after a turn by twice the inverse tangent of a number.
fn turned_by_half((s, c): (Wide, Wide), tangent: Wide) -> (Wide, Wide) {
    let square = tangent.square();
    let inverse = Wide::ONE / (Wide::ONE + square);
    let (by_s, by_c) = (tangent.scaled(2.0) * inverse, (Wide::ONE - square) * inverse);
    (s * by_c + c * by_s, c * by_c - s * by_s)
}

/// A driveline of joints as built, in space.
#[derive(Debug)]
pub(crate) struct ExactAsBuilt {
    joints: Vec<LeaningJoint>,
    /// Sine and cosine of what the shaft behind each joint adds to its driven angle.
    turns: Vec<(Wide, Wide)>,
    pub(crate) axes: ExactAxes,
    /// Of each shaft: the mean of the sum of the joints' angle errors before it.
    means: Vec<Wide>,
    /// Drive angles, as parts of the turn, at which some shaft is fastest, is slowest, or changes its
    /// speed most.
    pub(crate) extremes: Vec<f64>,
}

/// A driveline at an angle.
#[derive(Clone, Debug)]
pub(crate) struct LeaningInstant {
    /// Of each shaft: angle error with its mean, speed ratio, acceleration ratio and jerk ratio.
    pub(crate) motion: Vec<[Wide; 4]>,
    /// Of each joint, against the driving and the driven shaft.
    pub(crate) tilts: Vec<[Wide; 2]>,
    /// Driving and driven pin of each joint in space.
    pins: Vec<[Span; 2]>,
}

/// The most samples of a turn for a mean.
const MOST: usize = 1 << 15;

impl ExactAsBuilt {
    pub(crate) fn of(bends: &[f64], twists: &[f64], phases: &[f64], deviations: &[f64]) -> Self {
        let joint = |(&bend, own): (&f64, &[f64; 3])| LeaningJoint {
            bend: sin_cos(&[bend]),
            deviations: own.map(|e| sin_cos(&[e])),
        };
        let quarter_more = |(&phase, &twist): (&f64, &f64)| {
            let (s, c) = sin_cos(&[phase, -twist]);
            (c, -s)
        };
        let joints: Vec<_> = bends.iter().zip(deviations.as_chunks().0).map(joint).collect();
        let mut line = Self {
            turns: phases.iter().zip(twists).map(quarter_more).collect(),
            axes: ExactAxes::of(bends, twists),
            means: vec![Wide::ZERO; joints.len() + 1],
            extremes: vec![],
            joints,
        };
        line.find_means();
        line
    }

    /// The sums of angle errors before each shaft, and its speed ratio.
    fn errors(&self, at: (Wide, Wide)) -> Vec<[Wide; 2]> {
        let mut input = at;
        let mut found = vec![[Wide::ZERO, Wide::ONE]];
        for (j, joint) in self.joints.iter().enumerate() {
            let driven = joint.driven(input);
            let [error, ratio] = found[j];
            // p × q along u over the same along v.
            let [p, q] = [joint.driving_pin(input), joint.driven_pin(driven)];
            let normal = cross(p, q);
            let (sin, cos) = joint.bend;
            let own = (normal[2] * cos - normal[0] * sin) / normal[2];
            found.push([error + apart(driven, input), ratio * own]);
            if let Some(&turn) = self.turns.get(j) {
                input = turned(driven, turn);
            }
        }
        found
    }

    /// Means by the trapezoidal rule, whose error decreases geometrically, until they do not change.
    fn find_means(&mut self) {
        let (shafts, mut count) = (self.means.len(), 32);
        let at = |i: usize, count: usize| {
            let Turn { s, c, .. } = Turn::part(i, count);
            (s, c)
        };
        let mut samples: Vec<_> = (0..count).map(|i| self.errors(at(i, count))).collect();
        let mean = |samples: &[Vec<[Wide; 2]>], shaft: usize| {
            let sum = samples.iter().fold(Wide::ZERO, |sum, own| sum + own[shaft][0]);
            sum / Wide::from(samples.len() as f64)
        };
        loop {
            let before: Vec<_> = (0..shafts).map(|shaft| mean(&samples, shaft)).collect();
            let between: Vec<_> =
                (0..count).map(|i| self.errors(at(2 * i + 1, 2 * count))).collect();
            samples = samples.into_iter().zip(between).flat_map(|(a, b)| [a, b]).collect();
            count *= 2;
            let after = (0..shafts).map(|shaft| mean(&samples, shaft));
            self.means = after.collect();
            let settled = (0..shafts).all(|shaft| {
                let size = |own: &Vec<[Wide; 2]>| own[shaft][0].high.abs();
                let largest = samples.iter().map(size).fold(0.0, f64::max);
                (self.means[shaft] - before[shaft]).high.abs() <= 1e-26 * largest
            });
            if settled || count >= MOST {
                break;
            }
        }
        let mut extremes = vec![];
        (1..shafts).for_each(|shaft| {
            let ratio = |i: usize| samples[i % count][shaft][1].high;
            let step = |i: usize| (ratio(i + 1) - ratio(i)).abs();
            let largest = |of: &dyn Fn(usize) -> f64| {
                (0..count).max_by(|&i, &j| of(i).total_cmp(&of(j))).expect("a turn has samples")
            };
            for i in [largest(&ratio), largest(&|i| -ratio(i)), largest(&step)] {
                extremes.push(i as f64 / count as f64);
            }
        });
        self.extremes = extremes;
    }

    /// What the driveline does at an angle.
    pub(crate) fn at(&self, angle: f64) -> LeaningInstant {
        let Turn { s, c, .. } = Turn::by(&[angle]);
        let mut input = [
            TaylorSeries([s, c, -s.scaled(0.5), -(c / Wide::from(6.0))]),
            TaylorSeries([c, -s, -c.scaled(0.5), s / Wide::from(6.0)]),
        ];
        let none = [Wide::ZERO, Wide::ONE, Wide::ZERO, Wide::ZERO];
        let (mut motion, mut tilts, mut pins) = (vec![none], vec![], vec![]);
        let mut error = Wide::ZERO;
        for (j, joint) in self.joints.iter().enumerate() {
            let start = (input[0].0[0], input[1].0[0]);
            let driven = joint.driven(start);
            let [s, c] = joint.driven_series(input, driven);
            error = error + apart(driven, start);
            let TaylorSeries([ratio, acceleration, half_jerk, _]) = c * s.slope() - s * c.slope();
            let centred = error - self.means[j + 1];
            motion.push([centred, ratio, acceleration, half_jerk.scaled(2.0)]);
            let [u, v] = [self.axes.directions[j], self.axes.directions[j + 1]];
            let m = self.axes.normals[j];
            let ((lean, level), (lean_driven, level_driven)) =
                (joint.deviations[0], joint.deviations[2]);
            let p = plus(scaled(u, lean), scaled(about(m, u, start), level));
            let across = about(m, v, (driven.1, -driven.0));
            let q = plus(scaled(v, lean_driven), scaled(across, level_driven));
            tilts.push([tilt(p, u, q), -tilt(q, v, p.map(|x| -x))]);
            pins.push([p, q]);
            if let Some(&(by_s, by_c)) = self.turns.get(j) {
                input = [s * by_c + c * by_s, c * by_c - s * by_s];
            }
        }
        LeaningInstant { motion, tilts, pins }
    }

    /// The components of torques, moments, support moments and bending moments, from the powers on
    /// their way into each shaft.
    pub(crate) fn loads(&self, at: &LeaningInstant, powers: &[Wide]) -> Vec<Vec<Wide>> {
        self.axes.loads(self.transmitted(at, powers))
    }

    /// Torques and moments, from the powers on their way into each shaft.
    pub(crate) fn transmitted(&self, at: &LeaningInstant, powers: &[Wide]) -> Transmitted {
        let torques: Vec<_> =
            powers.iter().zip(&at.motion).map(|(&power, motion)| power / motion[1]).collect();
        let moment = |(j, &[p, q]): (usize, &[Span; 2])| {
            // The power that enters the next shaft is what the joint transmits.
            let normal = cross(p, q);
            let along = dot(normal, self.axes.directions[j]);
            scaled(normal, powers[j + 1] / (at.motion[j][1] * along))
        };
        let moments = at.pins.iter().enumerate().map(moment).collect();
        Transmitted { torques, moments, largest: 0.0 }
    }
}

/// Prints the last joint of a driveline of joints as built for `tests/check_oracle.py`.
pub(crate) fn print_oracle(line: &Geometry, deviations: &[f64], angle: f64) {
    let Geometry { bends, twists, phases, .. } = line;
    let list = |all: &[f64]| all.iter().map(|&x| hex(x)).collect::<Vec<_>>().join(" ");
    let [bends, twists, phases, own] = [bends, twists, phases, deviations].map(list);
    println!("leaning {bends} / {twists} / {phases} / {own}");
    let oracle = ExactAsBuilt::of(&line.bends, &line.twists, &line.phases, deviations);
    let at = oracle.at(angle);
    let [error, ratio, acceleration, jerk] = *at.motion.last().expect("a shaft");
    let [tilt_driving, tilt_driven] = *at.tilts.last().expect("a joint");
    // A unit of power on its way to the end.
    let joints = line.bends.len();
    let moment = &oracle.loads(&at, &vec![Wide::ONE; joints + 2])[2 * joints];
    for (name, x) in [
        ("angle_error", error),
        ("speed_ratio", ratio),
        ("acceleration_ratio", acceleration),
        ("jerk_ratio", jerk),
        ("tilt_driving", tilt_driving),
        ("tilt_driven", tilt_driven),
        ("moment x", moment[0]),
        ("moment y", moment[1]),
        ("moment z", moment[2]),
    ] {
        println!("{name}: {}", x.hex());
    }
}

/// The angle from one direction to another of a plane, both as sine and cosine.
fn apart((s, c): (Wide, Wide), (from_s, from_c): (Wide, Wide)) -> Wide {
    atan2(s * from_c - c * from_s, c * from_c + s * from_s)
}

/// Sine and cosine of a sum of two angles.
fn turned((s, c): (Wide, Wide), (by_s, by_c): (Wide, Wide)) -> (Wide, Wide) {
    (s * by_c + c * by_s, c * by_c - s * by_s)
}

/// The unit vector across a shaft that is turned from `m × u` towards `m`.
fn about(m: Span, u: Span, (s, c): (Wide, Wide)) -> Span {
    plus(scaled(cross(m, u), c), scaled(m, s))
}

/// The angle of the cross about one pin, from where the other pin is normal to the shaft.
fn tilt(axis: Span, shaft: Span, other: Span) -> Wide {
    let level = cross(shaft, axis);
    atan2(dot(other, cross(axis, level)), dot(other, level))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joints and chains from a loop of hinges with 40 digits.
    const HINGES: &str = include_str!("../../../tests/data/deviations.json");

    /// The numbers behind a key up to another one.
    fn numbers(text: &str, key: &str, next: &str) -> Vec<f64> {
        let (_, behind) = text.split_once(&format!("\"{key}\": ")).expect("the key is there");
        let own = behind.split_once(&format!("\"{next}\"")).map_or(behind, |(own, _)| own);
        let own = own.split('}').next().expect("a split has a part");
        let is_part = |c: char| c.is_ascii_digit() || "+-.e".contains(c);
        let words = own.split(|c| !is_part(c)).filter(|word| !word.is_empty());
        words.map(|word| word.parse().expect("it is a number")).collect()
    }

    /// How far a shaft is from its driven angle, speed ratio and acceleration ratio.
    fn apart(line: &ExactAsBuilt, angle: f64, wanted: [f64; 3]) -> f64 {
        let [error, ratio, acceleration, _] = *line.at(angle).motion.last().expect("a shaft");
        let driven = (error + *line.means.last().expect("a shaft")).high + angle - wanted[0];
        let turned = (driven / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        [driven - turned, ratio.high - wanted[1], acceleration.high - wanted[2]]
            .iter()
            .fold(0.0, |most, off| most.max(off.abs()))
    }

    #[test]
    fn joints_and_chains_are_those_of_the_loop_of_hinges() {
        let (single, chains) = HINGES.split_once("\"chains\"").expect("both are there");
        let mut judged = 0;
        for row in single.split("\"bend\": ").skip(1).map(|row| format!("\"bend\": {row}")) {
            let of = |key, next| numbers(&row, key, next)[0];
            let deviations = [
                of("driving_yoke", "cross"),
                of("cross", "driven_yoke"),
                of("driven_yoke", "angle"),
            ];
            let line = ExactAsBuilt::of(&[of("bend", "driving_yoke")], &[], &[], &deviations);
            let wanted = [
                of("driven", "speed_ratio"),
                of("speed_ratio", "acceleration_ratio"),
                of("acceleration_ratio", "}"),
            ];
            let off = apart(&line, of("angle", "driven"), wanted);
            assert!(off < 4e-15, "{off:e}: {row}");
            judged += 1;
        }
        for case in chains.split("\"bends\": ").skip(1).map(|case| format!("\"bends\": {case}")) {
            let bends = numbers(&case, "bends", "twists");
            let (twists, phases) =
                (numbers(&case, "twists", "phases"), numbers(&case, "phases", "deviations"));
            let deviations = numbers(&case, "deviations", "rows");
            let line = ExactAsBuilt::of(&bends, &twists, &phases, &deviations);
            let (_, rows) = case.split_once("\"rows\"").expect("it has rows");
            let mut constant = None;
            for row in rows.split("\"angle\": ").skip(1).map(|row| format!("\"angle\": {row}")) {
                let of = |key, next| numbers(&row, key, next)[0];
                let angle = of("angle", "driven_mod_2pi");
                let driven = of("driven_mod_2pi", "speed_ratio");
                let rates =
                    [of("speed_ratio", "acceleration_ratio"), of("acceleration_ratio", "}")];
                // The angle has no turns of the shafts between: the first row gives them.
                let own = line.at(angle).motion.last().expect("a shaft")[0]
                    + *line.means.last().expect("a shaft");
                let turns = *constant.get_or_insert(driven - own.high - angle);
                let off = apart(&line, angle, [driven - turns, rates[0], rates[1]]);
                assert!(off < 4e-15, "{off:e}: {row}");
                judged += 1;
            }
        }
        assert!(judged > 50);
    }
}
