//! Pins of a long sweep, by the addition theorem of the tangent from the middle of a group of
//! samples.

use crate::input::sweep::Sweep;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Float;
use crate::number::storage::ViewMut;
use crate::number::trig::{self, Angle};

/// Tangents of whole steps from the middle of a group of samples. The tangent of each sample
/// follows from that of the middle by the addition theorem, `(a + b)/(1 − a b)`, without a sine per
/// sample.
#[derive(Clone, Debug)]
pub(crate) struct TangentSum<T: Angle> {
    tangents: [Vec<T::Float>; 2],
}

impl<T: Angle> TangentSum<T> {
    /// The part of the middle's distance from a quarter turn within which a sample's sum cancels
    /// more than its error terms can recover.
    const CANCELLATION: f64 = 1.0 / 1024.0;

    /// The table for groups of `length` samples of a sweep, a multiple of 16.
    #[inline(always)]
    pub(crate) fn new(sweep: &Sweep, length: usize) -> Self {
        let mut tangents = [vec![T::Float::default(); length], vec![T::Float::default(); length]];
        let [high, low] = &mut tangents;
        for (i, (high, low)) in high.iter_mut().zip(low).enumerate() {
            let steps = DoubleDouble::exact(i as f64 - (length / 2) as f64);
            let (numerator, denominator) = DoubleDouble::tangent(steps * sweep.step);
            [*high, *low] = words::<T>(numerator / denominator);
        }
        Self { tangents }
    }

    pub(crate) fn length(&self) -> usize {
        self.tangents[0].len()
    }

    /// Sine and cosine, up to a positive factor, of the samples from `first` on.
    #[inline(always)]
    pub(crate) fn pins(
        &self,
        sweep: &Sweep,
        first: usize,
        mut sine: ViewMut<'_, T>,
        mut cosine: ViewMut<'_, T>,
    ) {
        const MAX_GROUPS: usize = 64;
        let length = self.length();
        let reduction = sweep.reduction();
        let count = sine.len();
        let mut middles = [([T::Float::default(); 2], 0_u64, 0.0); MAX_GROUPS];
        let mut at = 0;
        while at < count {
            // First the middles of the next groups, in one loop; then group by group.
            let group = (first + at) / length;
            let groups = ((first + count).div_ceil(length) - group).min(MAX_GROUPS);
            for (i, middle) in middles[..groups].iter_mut().enumerate() {
                let sample = ((group + i) * length + length / 2) as f64;
                let (remainder, quadrant) = reduction.of(sample);
                let (numerator, denominator) = DoubleDouble::tangent(remainder);
                let tangent = words::<T>(numerator / denominator);
                *middle = (tangent, quadrant, remainder.high / sweep.step.high);
            }
            for (i, &(middle, quadrant, steps)) in middles[..groups].iter().enumerate() {
                let begin = (group + i) * length;
                let from = (first + at) - begin;
                let size = (length - from).min(count - at);
                let [high, low] = &self.tangents;
                let (high, low) = (&high[from..from + size], &low[from..from + size]);
                let (odd, half) = (quadrant & 1, quadrant >> 1 & 1);
                let (mut s, mut c) = (sine.window(at, size), cosine.window(at, size));
                let tangent = |j: usize| {
                    let (y, x) = T::tangent_of_sum(middle, [high[j], low[j]]);
                    (y.turned_if(half), x.turned_if(half))
                };
                if odd == 1 {
                    for j in 0..size {
                        let (y, x) = tangent(j);
                        s.set(j, x);
                        c.set(j, -y);
                    }
                } else {
                    for j in 0..size {
                        let (y, x) = tangent(j);
                        s.set(j, y);
                        c.set(j, x);
                    }
                }
                // Next to a quarter turn the sum cancels and mainly its rounding is left.
                let crossing = (length / 2) as f64 - steps - from as f64;
                let margin = 1.0 + Self::CANCELLATION * steps.abs();
                let near = (crossing - margin).max(0.0) as usize..size;
                for j in near.take_while(|&j| j as f64 <= crossing + margin) {
                    let (r, quadrant) = reduction.of((begin + from + j) as f64);
                    let (y, x) = trig::directed_pin((T::from_double_double(r), quadrant));
                    s.set(j, y);
                    c.set(j, x);
                }
                at += size;
            }
        }
    }
}

/// The word nearest to a number, and the remainder.
#[inline(always)]
fn words<T: Angle>(number: DoubleDouble) -> [T::Float; 2] {
    let high = T::Float::near(number.value());
    [high, T::Float::near((number.high - high.into()) + number.low)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::storage::{Column, columns, views, views_mut};

    #[test]
    fn high_word_and_rest_make_the_number() {
        let third = DoubleDouble::exact(1.0) / DoubleDouble::exact(3.0);
        assert_eq!(words::<DoubleDouble>(third), [third.high, third.low]);
        let [high, rest] = words::<f32>(third).map(f64::from);
        assert!((high + rest - third.value()).abs() < 1e-15);
        assert_ne!(rest, 0.0);
    }

    #[test]
    fn sums_of_tangents_keep_their_digits_beside_quarter_turns() {
        for (start, stop, count, length) in
            [(-0.3, 0.2, 5000, 512), (1.0, 20.0, 20_000, 512), (9.7, -5.3, 8191, 416)]
        {
            let sweep = Sweep::new(start, stop, count).unwrap();
            let group = TangentSum::<DoubleDouble>::new(&sweep, length);
            let mut pins: [Column<DoubleDouble>; 2] = columns(count);
            let [sine, cosine] = views_mut(&mut pins, 0, count);
            group.pins(&sweep, 0, sine, cosine);
            let [sine, cosine] = views(&pins, count);
            for i in 0..count {
                let (s, c) = trig::sin_cos_double_double(sweep.reduction().of(i as f64));
                let (y, x) = (sine.get(i), cosine.get(i));
                let length = (y * s + x * c).value();
                let least = s.value().abs().min(c.value().abs());
                let error = (y * c - x * s).value() / length;
                assert!(error.abs() < 2_f64.powi(-54) * least, "{i}: {error:e} of {least:e}");
            }
        }
    }
}
