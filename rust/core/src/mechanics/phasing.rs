//! The yoke phases that bring the last shaft closest to constant velocity.
//!
//! With `L = ln sec β` a joint is a step of length `L` in the hyperbolic plane and an intermediate
//! shaft a turn by `2p`, `p = δ − τ + 90°`. For two joints this is the law of cosines,
//! `cosh L_E = cosh L₁ cosh L₂ + sinh L₁ sinh L₂ cos 2p`. Constant velocity corresponds to a closed
//! polygon. It exists if and only if the longest side is not longer than all others together.
//! Otherwise the best arrangement lines up all others against the longest.

use std::f64::consts::{FRAC_PI_2, PI};

use std::sync::atomic::{AtomicBool, Ordering};

use crate::mechanics::joint::Joint;
use crate::number::elementary;
use crate::number::trig;
use nalgebra::Complex;

/// The most steps of a search and the most halvings of a step; most searches need a handful.
const STEPS: usize = 60;
const HALVINGS: i32 = 12;

/// The longest step along closed polygons, in units of the step to the smallest change on their
/// tangent.
const LONGEST: f64 = 4.0;

/// A polygon with a gap up to this is closed.
const CLOSED: f64 = 1e-12;

/// The phases in rad that minimise the equivalent bend of the last shaft, from `n` bends, `n − 1`
/// twists and `n − 1` phases in rad. The bend is zero whenever the polygon closes. Among such
/// phases, the yokes turn the least from the given ones (least sum of squares); a yoke turned by
/// 180° is the same yoke.
///
/// With four or more bent joints the closing phases form a family. The search for the smallest turn
/// starts from the given phases, from two closing triangles and from halfway to them; the result is
/// a local minimum.
///
/// ```
/// let bends = [10_f64, 9.0, 6.0].map(f64::to_radians);
/// let phases = cardan::optimal_phases(&bends, &[0.0, 0.0], &[0.0, 0.0]);
/// let equivalent = cardan::Equivalent::of_chain(&bends, &[0.0, 0.0], &phases);
/// assert!(equivalent.joint.k < 1e-16);
/// ```
pub fn optimal_phases(bends: &[f64], twists: &[f64], phases: &[f64]) -> Vec<f64> {
    search_phases(bends, twists, phases, None)
}

/// The same, or the best phases so far when `stop` is set.
pub(crate) fn search_phases(
    bends: &[f64],
    twists: &[f64],
    phases: &[f64],
    stop: Option<&AtomicBool>,
) -> Vec<f64> {
    let mut polygon = Polygon { stop, ..Polygon::default() };
    let mut members: Vec<Vec<usize>> = vec![];
    let mut group = vec![];
    let mut turn = 0.0;
    for (j, &bend) in bends.iter().enumerate() {
        if j > 0 {
            group.push(j - 1);
            turn += within_a_turn(phases[j - 1]) - within_a_turn(twists[j - 1]) + FRAC_PI_2;
        }
        // A straight joint transmits every turn, so the shafts at both its ends turn as one.
        if bend == 0.0 {
            continue;
        }
        if polygon.sides.is_empty() {
            group.clear();
        } else {
            polygon.turns.push(turn);
            polygon.weights.push(group.len() as f64);
            members.push(std::mem::take(&mut group));
        }
        turn = 0.0;
        polygon.sides.push(Side::new(&Joint::new(bend)));
    }
    let mut best = phases.to_vec();
    for (x, members) in polygon.smallest_change().iter().zip(members) {
        for &shaft in &members {
            best[shaft] += x / members.len() as f64;
        }
    }
    best
}

pub(crate) fn is_set(stop: Option<&AtomicBool>) -> bool {
    stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
}

/// An angle modulo whole turns, exact even for angles far from zero.
fn within_a_turn(angle: f64) -> f64 {
    if angle.abs() <= PI {
        return angle;
    }
    let (sine, cosine) = trig::sin_cos(angle);
    elementary::atan2(sine, cosine)
}

/// One bent joint as a step of length `L` in the hyperbolic plane.
struct Side {
    length: f64,
    /// `cosh(L/2)`.
    cosh: f64,
    /// `sinh(L/2) = k cosh(L/2)`.
    sinh: f64,
}

impl Side {
    fn new(joint: &Joint) -> Self {
        let near = joint.cos > 0.5;
        let length =
            if near { -elementary::ln_1p(-joint.versine) } else { -elementary::ln(joint.cos) };
        let cosh = 1.0 / joint.complement().sqrt();
        Self { length, cosh, sinh: joint.k * cosh }
    }
}

/// A chain of bent joints with the current turns `p` between them.
#[derive(Default)]
struct Polygon<'a> {
    sides: Vec<Side>,
    turns: Vec<f64>,
    /// The number of shafts that share each turn.
    weights: Vec<f64>,
    /// Ends the search when set.
    stop: Option<&'a AtomicBool>,
}

impl Polygon<'_> {
    /// The change of each turn.
    fn smallest_change(&self) -> Vec<f64> {
        let lengths = || self.sides.iter().map(|side| side.length);
        let longest = lengths().fold(0.0, f64::max);
        let total: f64 = lengths().sum();
        if self.turns.is_empty() {
            return vec![];
        }
        if longest >= total - longest {
            return self.change_to(&self.against_longest(longest));
        }
        let mut starts: Vec<Vec<f64>> =
            self.triangles(total).iter().map(|turns| self.change_to(turns)).collect();
        if self.sides.len() > 3 {
            let halfway = starts.iter().map(|start| start.iter().map(|x| 0.5 * x).collect());
            starts.extend(halfway.collect::<Vec<_>>());
            starts.push(vec![0.0; self.turns.len()]);
        }
        starts
            .into_iter()
            .map(|start| self.close(start))
            .map(|closed| if self.sides.len() > 3 { self.search(closed) } else { closed })
            .map(|change| self.change_to(&self.turns_after(&change)))
            .map(|change| (self.gap(&change), self.size(&change), change))
            .min_by(|(gap, size, _), (other_gap, other_size, _)| {
                // A change that does not close the polygon loses, however small it is.
                let open = |gap: &f64| *gap > CLOSED;
                open(gap).cmp(&open(other_gap)).then(size.total_cmp(other_size))
            })
            .map_or_else(Vec::new, |(_, _, change)| change)
    }

    /// The smallest change to the given turns, each modulo 180°.
    fn change_to(&self, turns: &[f64]) -> Vec<f64> {
        let wrapped = |x: f64| x - PI * (x / PI).round();
        turns.iter().zip(&self.turns).map(|(to, from)| wrapped(to - from)).collect()
    }

    fn turns_after(&self, change: &[f64]) -> Vec<f64> {
        self.turns.iter().zip(change).map(|(turn, x)| turn + x).collect()
    }

    /// The sum of the squared turns of all yokes.
    fn size(&self, change: &[f64]) -> f64 {
        change.iter().zip(&self.weights).map(|(x, weight)| x * x / weight).sum()
    }

    /// The turns that put all sides on one line, the longest against all others.
    fn against_longest(&self, longest: f64) -> Vec<f64> {
        let index = self.sides.iter().position(|side| side.length == longest).unwrap_or(0);
        let adjacent = |j: usize| j == index || j + 1 == index;
        (0..self.turns.len()).map(|j| if adjacent(j) { FRAC_PI_2 } else { 0.0 }).collect()
    }

    /// The turns that fold the polygon flat into a triangle, and those of its mirror image. The
    /// triangle's sides are the first sides up to half the perimeter, the side that passes it, and
    /// the rest; none is longer than the other two together.
    fn triangles(&self, total: f64) -> [Vec<f64>; 2] {
        let half = 0.5 * total;
        let mut a = 0.0;
        let mut second = 0;
        while second + 2 < self.sides.len() && a + self.sides[second].length <= half {
            a += self.sides[second].length;
            second += 1;
        }
        let second = second.max(1);
        let a: f64 = self.sides[..second].iter().map(|side| side.length).sum();
        let b = self.sides[second].length;
        let c: f64 = self.sides[second + 1..].iter().map(|side| side.length).sum();
        let past = |x: f64| elementary::sinh((0.5 * (a + b + c) - x).max(0.0));
        let (s, s_a, s_b, s_c) = (past(0.0), past(a), past(b), past(c));
        // Half the interior angle between two sides; the turn `p` is 90° minus that.
        let angle = |near: f64, also: f64, far: f64| {
            elementary::atan2((near * also).sqrt(), (s * far).sqrt())
        };
        let mut turns = vec![0.0; self.turns.len()];
        turns[second - 1] = FRAC_PI_2 - angle(s_a, s_b, s_c);
        turns[second] = FRAC_PI_2 - angle(s_b, s_c, s_a);
        let mirrored = turns.iter().map(|turn| -turn).collect();
        [turns, mirrored]
    }

    /// `B` of the map `w → A w + B w̄` with `|A|² − |B|² = 1`. Also, at each turn, the rotation and
    /// the values of `A` and `B` behind it.
    fn walk(&self, change: &[f64]) -> (Complex<f64>, Vec<[Complex<f64>; 3]>) {
        let past = |side: &Side, a: Complex<f64>, b: Complex<f64>| {
            (a * side.cosh - b.conj() * side.sinh, b * side.cosh - a.conj() * side.sinh)
        };
        let (mut a, mut b) = past(&self.sides[0], Complex::new(1.0, 0.0), Complex::new(0.0, 0.0));
        let mut states = Vec::with_capacity(self.turns.len());
        for (side, turn) in self.sides[1..].iter().zip(self.turns_after(change)) {
            let (sine, cosine) = trig::sin_cos(turn);
            let rotation = Complex::new(cosine, sine);
            states.push([rotation, a * rotation, b * rotation]);
            (a, b) = past(side, a * rotation, b * rotation);
        }
        (b, states)
    }

    /// The same `B`, and its derivative with respect to each turn. Going backwards, `B̄` at the end
    /// is `p A + q B̄` of every state.
    fn slope(&self, change: &[f64]) -> (Complex<f64>, Vec<Complex<f64>>) {
        let (end, states) = self.walk(change);
        let (mut p, mut q) = (Complex::new(0.0, 0.0), Complex::new(1.0, 0.0));
        let mut derivatives = vec![Complex::new(0.0, 0.0); states.len()];
        for (i, [rotation, a, b]) in states.into_iter().enumerate().rev() {
            let side = &self.sides[i + 1];
            (p, q) = (p * side.cosh - q * side.sinh, q * side.cosh - p * side.sinh);
            derivatives[i] = (p * a - q * b.conj()).conj() * -Complex::<f64>::i();
            (p, q) = (p * rotation, q * rotation.conj());
        }
        (end, derivatives)
    }

    /// The gap of the polygon, `sinh(L_E/2)`.
    fn gap(&self, change: &[f64]) -> f64 {
        elementary::norm(self.walk(change).0)
    }

    /// Closes the polygon by Newton's method. Each step is the smallest that solves the linear
    /// equations, or a fraction of it.
    fn close(&self, mut change: Vec<f64>) -> Vec<f64> {
        let mut gap = self.gap(&change);
        for _ in 0..STEPS {
            let (b, derivatives) = self.slope(&change);
            let step = self.smallest_solution(&derivatives, -b);
            let closer = (0..HALVINGS).map(|halvings| 0.5_f64.powi(halvings)).find_map(|part| {
                let trial: Vec<f64> =
                    change.iter().zip(&step).map(|(x, dx)| x + part * dx).collect();
                let trial_gap = self.gap(&trial);
                (trial_gap < gap).then_some((trial, trial_gap))
            });
            match closer {
                Some(found) => (change, gap) = found,
                None => break,
            }
            if gap <= CLOSED * 1e-4 {
                break;
            }
        }
        change
    }

    /// Descends from a change that closes the polygon to the smallest nearby. Each step goes along
    /// the closed polygons in the direction that shortens the change most; then the polygon is
    /// closed again. The step length follows from how the last step changed the direction (Barzilai
    /// and Borwein): a fixed length would oscillate where the closed polygons are curved.
    fn search(&self, mut change: Vec<f64>) -> Vec<f64> {
        let mut size = self.size(&change);
        let mut last: Option<[Vec<f64>; 2]> = None;
        for _ in 0..STEPS {
            if is_set(self.stop) {
                return change;
            }
            let (_, derivatives) = self.slope(&change);
            let along: Complex<f64> = derivatives.iter().zip(&change).map(|(d, x)| d * *x).sum();
            let shortest = self.smallest_solution(&derivatives, along);
            let direction: Vec<f64> = shortest.iter().zip(&change).map(|(to, x)| to - x).collect();
            let scale = last.as_ref().map_or(1.0, |[from, last_direction]| {
                let (mut straight, mut turned) = (0.0, 0.0);
                for (i, weight) in self.weights.iter().enumerate() {
                    let step = change[i] - from[i];
                    straight += step * step / weight;
                    turned += step * (last_direction[i] - direction[i]) / weight;
                }
                (straight / turned.abs()).min(LONGEST)
            });
            let shorter = (0..HALVINGS).map(|halvings| 0.5_f64.powi(halvings)).find_map(|part| {
                let moved = change.iter().zip(&direction).map(|(x, dx)| x + scale * part * dx);
                let trial = self.close(moved.collect());
                let trial_size = self.size(&trial);
                let better = trial_size < size * (1.0 - 1e-12) && self.gap(&trial) <= CLOSED;
                better.then_some((trial, trial_size))
            });
            let Some((trial, trial_size)) = shorter else { break };
            last = Some([std::mem::replace(&mut change, trial), direction]);
            size = trial_size;
        }
        // A yoke turned past 90° is nearer to the given one after half a turn back, and the search
        // can go on from there.
        let nearer = self.change_to(&self.turns_after(&change));
        if self.size(&nearer) < size * (1.0 - 1e-9) { self.search(nearer) } else { nearer }
    }

    /// The `x` with `Σ d_j x_j = target` and the smallest `Σ x_j²/weight_j`.
    fn smallest_solution(&self, derivatives: &[Complex<f64>], target: Complex<f64>) -> Vec<f64> {
        let weighted = || derivatives.iter().zip(&self.weights);
        let rr: f64 = weighted().map(|(d, w)| w * d.re * d.re).sum();
        let ri: f64 = weighted().map(|(d, w)| w * d.re * d.im).sum();
        let ii: f64 = weighted().map(|(d, w)| w * d.im * d.im).sum();
        // A folded polygon can move in one direction only; the shift keeps the solution finite
        // there.
        let shift = f64::EPSILON * (rr + ii);
        let (rr, ii) = (rr + shift, ii + shift);
        let determinant = rr * ii - ri * ri;
        let multiplier = Complex::new(
            (target.re * ii - target.im * ri) / determinant,
            (target.im * rr - target.re * ri) / determinant,
        );
        weighted().map(|(d, w)| w * (d.re * multiplier.re + d.im * multiplier.im)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(from: &[f64], to: &[f64]) -> f64 {
        let wrapped = |x: f64| x - PI * (x / PI).round();
        from.iter().zip(to).map(|(from, to)| wrapped(to - from).powi(2)).sum()
    }

    #[test]
    fn no_closed_string_nearby_turns_the_yokes_less() {
        let bends = [0.2, 0.17, 0.0, 0.0, 0.15, 0.19];
        let twists = [0.1, -0.3, 0.4, 0.0, 0.2];
        for given in [[0.3, 0.2, -0.5, 0.9, 0.1], [-1.2, 0.7, 0.2, 0.4, 1.0]] {
            let best = optimal_phases(&bends, &twists, &given);
            for shaft in 0..given.len() {
                for aside in [-0.02, 0.02] {
                    let mut start = best.clone();
                    start[shaft] += aside;
                    let other = optimal_phases(&bends, &twists, &start);
                    assert!(turned(&given, &other) > turned(&given, &best) - 1e-9);
                }
            }
        }
    }

    #[test]
    fn twists_far_from_zero_count_with_all_their_digits() {
        let (bends, twists) = ([0.2, 0.17, 0.15], [1.7e308, -9e15]);
        let phases = optimal_phases(&bends, &twists, &[0.3, 0.2]);
        assert!(crate::Equivalent::of_chain(&bends, &twists, &phases).joint.k < 1e-16);
    }

    #[test]
    fn the_smallest_turn_of_a_family_is_across_it() {
        let sides = [0.2, 0.17, 0.15, 0.19].map(|bend| Side::new(&Joint::new(bend)));
        let mut polygon =
            Polygon { sides: sides.into(), weights: vec![1.0; 3], ..Polygon::default() };
        for turns in [[0.3, 0.2, -0.5], [-1.2, 0.7, 0.2], [1.1, -0.4, 0.9], [0.1, 0.1, 0.2]] {
            polygon.turns = turns.into();
            let change = polygon.smallest_change();
            let (gap, derivatives) = polygon.slope(&change);
            assert!(gap.norm() < CLOSED);
            // Along the family neither part of the gap changes.
            let parts = |part: fn(&Complex<f64>) -> f64| {
                nalgebra::Vector3::from_iterator(derivatives.iter().map(part))
            };
            let along = parts(|d| d.re).cross(&parts(|d| d.im)).normalize();
            let change = nalgebra::Vector3::from_column_slice(&change);
            assert!(along.dot(&change).abs() < 1e-4 * change.norm(), "{along} {change}");
        }
    }
}
