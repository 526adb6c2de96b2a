//! Yokes on splines: which tooth to take on each shaft.

use std::f64::consts::PI;
use std::ops::Range;
use std::slice::IterMut;
use std::sync::atomic::AtomicBool;

use nalgebra::Complex;

use crate::mechanics::common_phases::chain::{Chain, StateChains};
use crate::mechanics::common_phases::{turned, turning_least};
use crate::mechanics::phasing::is_set;
use crate::number::elementary;

/// So many settings, and the teeth of so many neighbouring shafts, are compared at once.
const SETTINGS: u64 = 1 << 16;
const SHAFTS: usize = 12;

/// Mean of `|q|` left by rounding where joints cancel each other.
const ROUNDING: f64 = 1e-15;

/// By how many teeth to turn the yokes for the least mean of `|q|²`; the best so far when `stop` is
/// set.
///
/// All positions of all shafts are compared if there are not too many: three shafts of 80 teeth, or
/// five of 18. Otherwise it is the positions nearest to each of the `valleys`, changes of the phases
/// that are good. Of settings that differ by rounding only, the one that turns the yokes least is
/// taken.
pub(super) fn least_turned<V: Iterator<Item = Vec<f64>>>(
    chains: &StateChains,
    teeth: &[u64],
    valleys: impl FnOnce() -> V,
    stop: Option<&AtomicBool>,
) -> Vec<i64> {
    let all = teeth.iter().map(|&teeth| period(teeth)).fold(1, u64::saturating_mul);
    if all <= SETTINGS {
        let positions: Vec<_> = teeth.iter().map(|&teeth| every(teeth)).collect();
        return Comparison { chains, teeth, positions: &positions }.least(stop).1;
    }
    let width = teeth.len().min(SHAFTS) as u32;
    let most = (1..=SETTINGS).take_while(|most| most.pow(width) <= SETTINGS).count();
    let near = |change: Vec<f64>| -> Vec<_> {
        teeth.iter().zip(change).map(|(&teeth, x)| nearest(teeth, x, most)).collect()
    };
    let mut compared: Vec<Vec<Vec<i64>>> = valleys().map(near).collect();
    // The same valley is found from several starts.
    compared.sort_unstable();
    compared.dedup();
    let found: Vec<_> = compared
        .iter()
        .map(|positions| Comparison { chains, teeth, positions }.least(stop))
        .collect();
    let nearest = turning_least(found.into_iter(), ROUNDING, |turns| size(turns.iter().zip(teeth)));
    nearest.map_or_else(Vec::new, |(_, turns)| turns)
}

/// The sum of the squares of turns on splines.
fn size<'a>(turns: impl Iterator<Item = (&'a i64, &'a u64)>) -> f64 {
    turns.map(|(&turn, &teeth)| turned(turn, teeth).powi(2)).sum()
}

/// The number of positions of a yoke, which looks the same after half a turn.
///
/// With an odd number of teeth half a turn is no whole number of them, so that there are twice as
/// many positions as within half a turn of the spline.
fn period(teeth: u64) -> u64 {
    if teeth.is_multiple_of(2) { teeth / 2 } else { teeth }
}

/// The turns to all positions, from the one farthest counter-clockwise.
fn every(teeth: u64) -> Vec<i64> {
    let period = period(teeth) as i64;
    let before = (period - 1) / 2;
    (-before..period - before).collect()
}

/// The turn in teeth, the shorter way, to a position counted in parts of half a turn.
fn turn(teeth: u64, position: i128) -> i64 {
    let period = i128::from(period(teeth));
    let turn =
        if teeth.is_multiple_of(2) { position } else { position * (i128::from(teeth) + 1) / 2 };
    let before = (period - 1) / 2;
    ((turn + before).rem_euclid(period) - before) as i64
}

/// The turns to the positions nearest to a change, the nearest first.
fn nearest(teeth: u64, change: f64, most: usize) -> Vec<i64> {
    let place = change / (PI / period(teeth) as f64);
    let first = place.round();
    let side = if place < first { -1 } else { 1 };
    let count = i128::from(period(teeth)).min(most as i128);
    // 0, 1, −1, 2, −2, … towards the nearer side first.
    let steps = (0..count).map(|i| if i % 2 == 0 { -(i / 2) } else { i / 2 + 1 });
    steps.map(|step| turn(teeth, first as i128 + side * step)).collect()
}

/// Positions of all shafts that are compared.
struct Comparison<'a> {
    chains: &'a StateChains,
    teeth: &'a [u64],
    positions: &'a [Vec<i64>],
}

impl Comparison<'_> {
    /// The best turns with the root of their mean: of neighbouring shafts at a time until nothing
    /// improves.
    fn least(&self, stop: Option<&AtomicBool>) -> (f64, Vec<i64>) {
        let shafts = self.teeth.len();
        let width = shafts.min(SHAFTS);
        let mut groups: Vec<Range<usize>> = (0..=shafts - width)
            .step_by((width / 2).max(1))
            .map(|first| first..first + width)
            .collect();
        if shafts > width {
            groups.push(shafts - width..shafts);
        }
        let mut turns: Vec<i64> = self.positions.iter().map(|own| own[0]).collect();
        let mut least = f64::INFINITY;
        loop {
            let mut found = f64::INFINITY;
            for group in &groups {
                if is_set(stop) {
                    return (found, turns);
                }
                found = self.choose(group.clone(), &mut turns);
            }
            if groups.len() == 1 || found >= least - ROUNDING {
                return (found, turns);
            }
            least = found;
        }
    }

    /// Takes the best teeth of some shafts while the others stay; returns the root of their mean.
    fn choose(&self, shafts: Range<usize>, turns: &mut [i64]) -> f64 {
        let spin = |(&turn, &teeth): (&i64, &u64)| elementary::turn(2.0 * turned(turn, teeth));
        let (positions, teeth) = (&self.positions[shafts.clone()], &self.teeth[shafts.clone()]);
        let spins: Vec<Vec<_>> = positions
            .iter()
            .zip(teeth)
            .map(|(own, teeth)| own.iter().map(|turn| spin((turn, teeth))).collect())
            .collect();
        let others: Vec<_> = turns.iter().zip(self.teeth).map(spin).collect();
        let mut means = vec![0.0; positions.iter().map(Vec::len).product()];
        for chain in self.chains.iter() {
            let first = chain.before(&others, shafts.start);
            let rest = chain.rest(&others, shafts.end - 1);
            add_settings(chain, first, shafts.start, &spins, rest, &mut means.iter_mut());
        }
        let settings = means.iter().map(|mean| mean.sqrt()).zip(0..);
        let size = |&index: &usize| size(setting(positions, index).iter().zip(teeth));
        let (root, taken) = turning_least(settings, ROUNDING, size).unwrap_or_default();
        turns[shafts].copy_from_slice(&setting(positions, taken));
        root
    }
}

/// The turn of each shaft of a setting, the last shaft changing fastest.
fn setting(positions: &[Vec<i64>], mut index: usize) -> Vec<i64> {
    let mut turns = vec![0; positions.len()];
    for (turn, own) in turns.iter_mut().zip(positions).rev() {
        *turn = own[index % own.len()];
        index /= own.len();
    }
    turns
}

/// Adds the share of a chain to the mean of every setting, the last shaft changing fastest.
fn add_settings(
    chain: &Chain,
    [b, a]: [Complex<f64>; 2],
    shaft: usize,
    spins: &[Vec<Complex<f64>>],
    rest: [Complex<f64>; 2],
    means: &mut IterMut<'_, f64>,
) {
    let Some((own, later)) = spins.split_first() else { return };
    if later.is_empty() {
        let (turning, still) =
            (rest[0] * b * chain.turn(shaft, Complex::new(1.0, 0.0)), rest[1] * a);
        for (&spin, mean) in own.iter().zip(means) {
            *mean += chain.share(turning * spin + still);
        }
        return;
    }
    for &spin in own {
        let behind = chain.past(shaft + 1, [b * chain.turn(shaft, spin), a]);
        add_settings(chain, behind, shaft + 1, later, rest, means);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::common_phases::{States, within_half_turn};

    #[test]
    fn positions_are_all_there_are() {
        for teeth in [1, 2, 7, 12, 15] {
            let mut turns: Vec<i64> = (0..period(teeth)).map(|i| turn(teeth, i.into())).collect();
            for (i, &turn) in turns.iter().enumerate() {
                let position = PI * i as f64 / period(teeth) as f64;
                assert!(within_half_turn(turned(turn, teeth) - position).abs() < 1e-14);
            }
            turns.sort_unstable();
            assert_eq!(turns, every(teeth));
        }
        let many = (1 << 63) - 1;
        assert!((turned(turn(many, 3), many) - (3.0 * PI / many as f64 - PI)).abs() < 1e-15);
    }

    #[test]
    fn the_nearest_come_first() {
        for (teeth, change) in [(15, 0.3), (16, -1.5), (7, 1.5), (1_000_001, 0.1)] {
            let turns = nearest(teeth, change, 5);
            let off = |turn: &i64| within_half_turn(turned(*turn, teeth) - change).abs();
            assert!(turns.is_sorted_by(|one, other| off(one) <= off(other) + 1e-12));
            assert!(off(&turns[4]) < 3.0 * PI / period(teeth) as f64);
            assert_eq!(turns.iter().collect::<std::collections::BTreeSet<_>>().len(), 5);
        }
        assert_eq!(nearest(4, 0.2, 9).len(), 2);
    }

    #[test]
    fn many_shafts_end_where_no_tooth_improves() {
        let (joints, teeth) = (16, [16; 15]);
        let bends: Vec<f64> =
            (0..2 * joints).map(|i| 0.06 + 0.04 * f64::from(i as u32).sin()).collect();
        let twists: Vec<f64> = (0..30).map(|i| 1.3 * f64::from(i)).collect();
        let phases = [0.1; 30];
        let states = States {
            joints,
            bends: &bends,
            twists: &twists,
            phases: &phases,
            weights: &[0.5; 2],
            held: &[false; 15],
            teeth: &teeth,
        };
        let chains = StateChains::new(&states);
        let valleys = [0.3, -0.8].map(|x| vec![x; 15]);
        let turns = least_turned(&chains, &teeth, || valleys.clone().into_iter(), None);
        let mean = |turns: &[i64]| {
            let change: Vec<f64> = turns.iter().map(|&turn| turned(turn, 16)).collect();
            chains.mean_square(&change).sqrt()
        };
        // The nearest positions of twelve shafts at once are two for each.
        let of_turns = |valley: &[f64]| {
            let near = |(turn, x): (&i64, &f64)| nearest(16, *x, 2).contains(turn);
            turns.iter().zip(valley).all(near)
        };
        let valley = valleys.iter().find(|valley| of_turns(valley)).unwrap();
        for (shaft, x) in valley.iter().enumerate() {
            for turn in nearest(16, *x, 2) {
                let mut other = turns.clone();
                other[shaft] = turn;
                assert!(mean(&other) >= mean(&turns) - 1e-14);
            }
        }
        for valley in &valleys {
            let start: Vec<i64> = valley.iter().map(|x| nearest(16, *x, 1)[0]).collect();
            assert!(mean(&turns) <= mean(&start));
        }
    }
}
