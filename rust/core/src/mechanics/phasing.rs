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
use crate::mechanics::phasing_search::{CLOSED, ClosingSearch, EQUAL};
use crate::number::elementary;
use crate::number::trig;

/// The phases in rad that minimise the equivalent bend of the last shaft, from `n` bends, `n − 1`
/// twists and `n − 1` phases in rad. The bend is zero whenever the polygon closes. Among such
/// phases, the yokes turn the least from the given ones (least sum of squares); a yoke turned by
/// 180° is the same yoke.
///
/// With four or more bent joints the closing phases form a family. The search for the smallest turn
/// starts from two closing triangles, from halfway to them and from the given phases; the result is a
/// local minimum, of equal ones the first.
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
#[inline(never)]
pub(crate) fn search_phases(
    bends: &[f64],
    twists: &[f64],
    phases: &[f64],
    stop: Option<&AtomicBool>,
) -> Vec<f64> {
    search_phases_inlined(bends, twists, phases, stop, true)
}

/// The same as part of a function for some instruction set, with loops of fixed lengths unless
/// compact. The results have the same bits.
#[inline(always)]
pub(crate) fn search_phases_inlined(
    bends: &[f64],
    twists: &[f64],
    phases: &[f64],
    stop: Option<&AtomicBool>,
    compact: bool,
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
        polygon.sides.push(PolygonSide::new(&Joint::new(bend)));
    }
    let mut best = phases.to_vec();
    for (x, members) in polygon.smallest_change(compact).iter().zip(members) {
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

/// An angle modulo half turns.
#[inline(always)]
pub(crate) fn within_half_a_turn(x: f64) -> f64 {
    x - PI * (x / PI).round()
}

/// One bent joint as a step of length `L` in the hyperbolic plane.
pub(crate) struct PolygonSide {
    length: f64,
    /// `cosh(L/2)`.
    pub(crate) cosh: f64,
    /// `sinh(L/2) = k cosh(L/2)`.
    pub(crate) sinh: f64,
}

impl PolygonSide {
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
pub(crate) struct Polygon<'a> {
    pub(crate) sides: Vec<PolygonSide>,
    pub(crate) turns: Vec<f64>,
    /// The number of shafts that share each turn.
    pub(crate) weights: Vec<f64>,
    /// Ends the search when set.
    pub(crate) stop: Option<&'a AtomicBool>,
}

impl Polygon<'_> {
    /// The change of each turn.
    #[inline(always)]
    fn smallest_change(&self, compact: bool) -> Vec<f64> {
        let lengths = || self.sides.iter().map(|side| side.length);
        let longest = lengths().fold(0.0, f64::max);
        let total: f64 = lengths().sum();
        if self.turns.is_empty() {
            return vec![];
        }
        if longest >= total - longest {
            return self.change_to(&self.against_longest(longest));
        }
        match self.turns.len() {
            0..=4 if !compact => {
                self.least(total, ClosingSearch::new(self, [0.0; 4], [[0.0; 4]; 4]))
            }
            5..=8 if !compact => {
                self.least(total, ClosingSearch::new(self, [0.0; 8], [[0.0; 8]; 8]))
            }
            _ => self.least_of_any_length(total),
        }
    }

    /// The smallest change, with loops of any length.
    #[inline(never)]
    fn least_of_any_length(&self, total: f64) -> Vec<f64> {
        let row = vec![0.0; self.turns.len()];
        self.least(total, ClosingSearch::new(self, row.clone(), vec![row; self.turns.len()]))
    }

    /// The smallest change that a search finds from several starts.
    #[inline(always)]
    fn least<R, M>(&self, total: f64, mut search: ClosingSearch<'_, R, M>) -> Vec<f64>
    where
        R: AsRef<[f64]> + AsMut<[f64]> + Clone,
        M: AsMut<[R]>,
    {
        let [one, other] = self.triangles(total).map(|turns| self.change_to(&turns));
        let mut starts = vec![one, other];
        if self.turns.len() > 2 {
            for i in 0..2 {
                starts.push(starts[i].iter().map(|x| 0.5 * x).collect());
            }
            starts.push(vec![0.0; self.turns.len()]);
        }
        let mut best: Option<(bool, f64, Vec<f64>)> = None;
        for mut change in starts {
            if self.turns.len() > 2 && !search.descend(&mut change) {
                continue;
            }
            // A change that does not close the polygon loses, however small it is.
            let open = search.close_exactly(&mut change) > CLOSED;
            let size = self.size(&change);
            let better = best.as_ref().is_none_or(|(best_open, best_size, _)| {
                (open, size) < (*best_open, *best_size * (1.0 - EQUAL))
            });
            if better {
                search.remember(open);
                best = Some((open, size, change));
            }
        }
        best.map_or_else(Vec::new, |(_, _, change)| change)
    }

    /// The smallest change to the given turns, each modulo 180°.
    fn change_to(&self, turns: &[f64]) -> Vec<f64> {
        turns.iter().zip(&self.turns).map(|(to, from)| within_half_a_turn(to - from)).collect()
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Complex, Vector3};

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
    fn loops_of_fixed_lengths_give_the_same_bits() {
        for joints in 2..12 {
            let bends: Vec<f64> = (0..joints).map(|j| 0.3 + 0.1 * f64::from(j).sin()).collect();
            let [twists, phases] = [0.7, 1.9]
                .map(|x| (1..joints).map(|j| (x * f64::from(j)).sin()).collect::<Vec<_>>());
            let [one, other] = [true, false]
                .map(|compact| search_phases_inlined(&bends, &twists, &phases, None, compact));
            assert_eq!(one, other);
        }
    }

    #[test]
    fn twists_far_from_zero_count_with_all_their_digits() {
        let (bends, twists) = ([0.2, 0.17, 0.15], [1.7e308, -9e15]);
        let phases = optimal_phases(&bends, &twists, &[0.3, 0.2]);
        assert!(crate::Equivalent::of_chain(&bends, &twists, &phases).joint.k < 1e-16);
    }

    /// `B` of the map of a polygon.
    fn end(polygon: &Polygon<'_>, change: &Vector3<f64>) -> Complex<f64> {
        let (mut a, mut b) = (Complex::new(1.0, 0.0), Complex::new(0.0, 0.0));
        for (j, side) in polygon.sides.iter().enumerate() {
            if j > 0 {
                let turn = elementary::turn(polygon.turns[j - 1] + change[j - 1]);
                (a, b) = (a * turn, b * turn);
            }
            let (cosh, sinh) = (side.cosh, side.sinh);
            (a, b) = (a * cosh - b.conj() * sinh, b * cosh - a.conj() * sinh);
        }
        b
    }

    #[test]
    fn the_smallest_turn_of_a_family_is_across_it() {
        let sides = [0.2, 0.17, 0.15, 0.19].map(|bend| PolygonSide::new(&Joint::new(bend)));
        let mut polygon =
            Polygon { sides: sides.into(), weights: vec![1.0; 3], ..Polygon::default() };
        for turns in [[0.3, 0.2, -0.5], [-1.2, 0.7, 0.2], [1.1, -0.4, 0.9], [0.1, 0.1, 0.2]] {
            polygon.turns = turns.into();
            let change = polygon.smallest_change(true);
            assert_eq!(change, polygon.smallest_change(false));
            let change = Vector3::from_column_slice(&change);
            assert!(end(&polygon, &change).norm() < CLOSED);
            // Along the family neither part of the gap changes.
            let slopes = Vector3::from_fn(|i, _| {
                let aside = Vector3::from_fn(|j, _| if i == j { 1e-6 } else { 0.0 });
                end(&polygon, &(change + aside)) - end(&polygon, &(change - aside))
            });
            let along = slopes.map(|d| d.re).cross(&slopes.map(|d| d.im)).normalize();
            assert!(along.dot(&change).abs() < 1e-6 * change.norm(), "{along} {change}");
        }
    }
}
