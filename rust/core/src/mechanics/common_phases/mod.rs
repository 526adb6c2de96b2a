//! One setting of the yokes for all states of a driveline, such as its ride heights.
//!
//! The setting minimises the weighted sum of `|q|²` over the states, where `q = B/A` is the one
//! number on which the motion of the last shaft depends. The sum has many local minima.

mod chain;
mod newton;
mod teeth;

use std::f64::consts::{PI, TAU};
use std::sync::atomic::AtomicBool;

use crate::mechanics::common_phases::chain::StateChains;
use crate::mechanics::common_phases::newton::refined;
use crate::mechanics::common_phases::teeth::least_turned;
use crate::mechanics::phasing::search_phases;
use crate::number::elementary;

/// Settings that are tried, and how many of the best of them are refined.
const TRIED: usize = 512;
const REFINED: usize = 24;

/// Means of `|q|` that differ by less are as good.
const AS_GOOD: f64 = 1e-12;

/// The states of one driveline, or of several one after another, and what can be set.
#[derive(Clone, Copy, Debug)]
pub struct States<'a> {
    /// The number of joints, `n`.
    pub joints: usize,
    /// The bends of each state in rad, `(…, states, n)`.
    pub bends: &'a [f64],
    /// The twists of each state in rad, `(…, states, n − 1)`.
    pub twists: &'a [f64],
    /// The present phases of each state in rad, `(…, states, n − 1)`. Yokes turn from those of the
    /// first state.
    pub phases: &'a [f64],
    /// The weight of each state; their sum is 1.
    pub weights: &'a [f64],
    /// Whether the yokes of each intermediate shaft stay as they are.
    pub held: &'a [bool],
    /// The teeth of the spline of each intermediate shaft, at least 1; empty if every phase is
    /// possible.
    pub teeth: &'a [u64],
}

impl<'a> States<'a> {
    /// The number of intermediate shafts.
    pub(crate) fn between(&self) -> usize {
        self.joints.saturating_sub(1)
    }

    /// The states of one of several drivelines.
    pub(crate) fn of_line(&self, line: usize) -> Self {
        let part = |array: &'a [f64], each: usize| {
            let count = self.weights.len() * each;
            &array[line * count..][..count]
        };
        Self {
            bends: part(self.bends, self.joints),
            twists: part(self.twists, self.between()),
            phases: part(self.phases, self.between()),
            ..*self
        }
    }

    /// The phases of one driveline that minimise the weighted mean of `|q|²`, or the best so far
    /// when `stop` is set. Of settings that are as good it is the one that turns the yokes least.
    pub(crate) fn search(&self, stop: Option<&AtomicBool>) -> Vec<f64> {
        let chains = StateChains::new(self);
        let now = self.phases[..self.between()].iter();
        if self.teeth.is_empty() {
            let valleys = self.valleys(&chains, stop).into_iter();
            let size = |change: &Vec<f64>| change.iter().map(|x| x * x).sum();
            let (_, found) = turning_least(valleys, AS_GOOD, size).unwrap_or_default();
            return now.zip(found).map(|(now, x)| now + x).collect();
        }
        // A yoke that is held has one position.
        let settable = self.teeth.iter().zip(self.held);
        let teeth: Vec<u64> =
            settable.map(|(&teeth, &held)| if held { 1 } else { teeth }).collect();
        let valleys = || self.valleys(&chains, stop).into_iter().map(|(_, change)| change);
        let turns = least_turned(&chains, &teeth, valleys, stop);
        now.zip(turns.iter().zip(&teeth)).map(|(now, (&t, &of))| now + turned(t, of)).collect()
    }

    /// Changes of the phases from which none nearby is better, with the mean of `|q|` of each. The
    /// best of them is the best that is found, and one is near to the present phases.
    fn valleys(&self, chains: &StateChains, stop: Option<&AtomicBool>) -> Vec<(f64, Vec<f64>)> {
        let between = self.between();
        let free: Vec<usize> = (0..between).filter(|&shaft| !self.held[shaft]).collect();
        let now = vec![0.0; between];
        let rated = |change: Vec<f64>| (chains.mean_square(&change).sqrt(), change);
        if free.is_empty() {
            return vec![rated(now)];
        }
        let of_states = (0..self.weights.len()).map(|state| self.best_of_state(state, stop));
        let mut tried: Vec<_> = of_states.map(rated).collect();
        if tried.len() == 1 && free.len() == between {
            return tried;
        }
        tried.extend(spread(free.len()).map(|point| {
            let mut change = now.clone();
            for (&shaft, x) in free.iter().zip(point) {
                change[shaft] = PI * (x - 0.5);
            }
            rated(change)
        }));
        tried.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        tried.truncate(REFINED);
        let starts = std::iter::once(now).chain(tried.into_iter().map(|(_, change)| change));
        let found = starts.map(|start| {
            let (value, change) = refined(chains, start, &free, stop);
            (value.sqrt(), change.into_iter().map(within_half_turn).collect())
        });
        found.collect()
    }

    /// The change to the phases that are best for one state alone, where yokes are not held.
    fn best_of_state(&self, state: usize, stop: Option<&AtomicBool>) -> Vec<f64> {
        let of_shafts = state * self.between()..(state + 1) * self.between();
        let best = search_phases(
            &self.bends[state * self.joints..][..self.joints],
            &self.twists[of_shafts.clone()],
            &self.phases[of_shafts],
            stop,
        );
        let changes = best.iter().zip(self.phases).zip(self.held);
        changes
            .map(|((best, now), &held)| if held { 0.0 } else { within_half_turn(best - now) })
            .collect()
    }
}

/// A yoke looks the same after half a turn.
fn within_half_turn(angle: f64) -> f64 {
    angle - PI * (angle / PI).round()
}

/// The angle of a turn in teeth.
fn turned(turn: i64, teeth: u64) -> f64 {
    TAU * turn as f64 / teeth as f64
}

/// Of settings with the mean of `|q|` of each the one that turns the yokes least, by the sum of the
/// squares that `size` gives, among those that are as good as the least but for `rounding`.
fn turning_least<S>(
    settings: impl Iterator<Item = (f64, S)> + Clone,
    rounding: f64,
    size: impl Fn(&S) -> f64,
) -> Option<(f64, S)> {
    let least = settings.clone().map(|(root, _)| root).fold(f64::INFINITY, f64::min);
    let as_good = settings.filter(|(root, _)| *root <= least * (1.0 + 1e-9) + rounding);
    let sizes = as_good.map(|setting| (size(&setting.1), setting));
    sizes.min_by(|(one, _), (other, _)| one.total_cmp(other)).map(|(_, setting)| setting)
}

/// Points that fill a cube evenly: multiples of the powers of `1/φ`, modulo 1, where
/// `φ^(dimensions + 1) = φ + 1` (Roberts 2018). For one dimension `φ` is the golden ratio.
fn spread(dimensions: usize) -> impl Iterator<Item = Vec<f64>> {
    let root = 1.0 / (dimensions as f64 + 1.0);
    let phi = (0..64).fold(1.5, |phi: f64, _| elementary::pow(1.0 + phi, root));
    let mut steps = vec![1.0 / phi; dimensions];
    for i in 1..dimensions {
        steps[i] = steps[i - 1] / phi;
    }
    (1..=TRIED).map(move |n| steps.iter().map(|step| (0.5 + n as f64 * step) % 1.0).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::chain::Equivalent;

    const BENDS: [f64; 9] = [0.3, 0.25, 0.2, 0.1, 0.35, 0.3, 0.2, 0.2, 0.25];
    const TWISTS: [f64; 6] = [0.4, -1.0, 0.2, -0.8, 0.5, -0.9];
    const PHASES: [f64; 6] = [1e3, -0.2, 1e3, -0.2, 1e3, -0.2];

    fn states<'a>(weights: &'a [f64], held: &'a [bool], teeth: &'a [u64]) -> States<'a> {
        let (n, all) = (3, weights.len());
        let (bends, twists, phases) = (&BENDS[..n * all], &TWISTS[..2 * all], &PHASES[..2 * all]);
        States { joints: n, bends, twists, phases, weights, held, teeth }
    }

    fn mean_square(states: &States<'_>, phases: &[f64]) -> f64 {
        let chains = states.bends.chunks(3).zip(states.twists.chunks(2)).zip(states.weights);
        let square = |((bends, twists), weight): ((&[f64], &[f64]), &f64)| {
            weight * Equivalent::of_chain(bends, twists, phases).joint.k.powi(2)
        };
        chains.map(square).sum()
    }

    #[test]
    fn no_setting_nearby_is_better() {
        let states = states(&[0.2, 0.5, 0.3], &[false; 2], &[]);
        let found = states.search(None);
        let least = mean_square(&states, &found);
        for i in 0..64 {
            let around = TAU * f64::from(i) / 64.0;
            for far in [1e-3, 0.1, 0.7] {
                let other = [found[0] + far * around.cos(), found[1] + far * around.sin()];
                assert!(mean_square(&states, &other) > least);
            }
        }
        assert!(found.iter().zip(PHASES).all(|(x, now)| (x - now).abs() <= 0.5 * PI));
    }

    #[test]
    fn yokes_that_are_held_stay() {
        let states = states(&[0.2, 0.5, 0.3], &[true, false], &[]);
        let found = states.search(None);
        assert_eq!(found[0], PHASES[0]);
        let least = mean_square(&states, &found);
        for i in 1..500 {
            let other = [found[0], found[1] + PI * f64::from(i) / 500.0];
            assert!(mean_square(&states, &other) > least);
        }
        let held = States { held: &[true; 2], ..states };
        assert_eq!(held.search(None), PHASES[..2]);
    }

    #[test]
    fn one_state_has_its_own_best_phases() {
        let states = states(&[1.0], &[false; 2], &[]);
        let best = search_phases(&BENDS[..3], &TWISTS[..2], &PHASES[..2], None);
        let found = states.search(None);
        assert!(found.iter().zip(best).all(|(x, best)| (x - best).abs() < 1e-12));
    }

    #[test]
    fn teeth_are_the_best_of_all() {
        let states = states(&[0.2, 0.5, 0.3], &[false; 2], &[12, 7]);
        let found = states.search(None);
        let least = mean_square(&states, &found);
        for (i, j) in (0..12).flat_map(|i| (0..7).map(move |j| (i, j))) {
            let other = [PHASES[0] + turned(i, 12), PHASES[1] + turned(j, 7)];
            assert!(mean_square(&states, &other) >= least * (1.0 - 1e-12));
        }
        for (x, (now, teeth)) in found.iter().zip(PHASES.iter().zip([12.0, 7.0])) {
            let turn = (x - now) * teeth / TAU;
            assert!((turn - turn.round()).abs() < 1e-9 && turn.abs() <= 0.5 * teeth);
        }
    }

    #[test]
    fn points_spread_evenly() {
        let points: Vec<_> = spread(1).map(|point| point[0]).collect();
        let mut sorted = points.clone();
        sorted.sort_by(f64::total_cmp);
        assert!((points[0] - (0.5 + 0.618_033_988_749_894_8) % 1.0).abs() < 1e-15);
        assert!(sorted.windows(2).all(|pair| pair[1] - pair[0] < 2.0 / TRIED as f64));
        assert!(spread(3).all(|point| point.iter().all(|x| (0.0..1.0).contains(x))));
    }
}
