//! Sine, cosine and inverse tangent in two doubles, for any angle.
//!
//! π comes from Machin's formula in long integers, 2/π from it by long division, so that no constant
//! of the library is used to judge the library.

use std::sync::LazyLock;

use crate::wide::Wide;

/// Words of 2/π after the point: enough for the largest double and 318 digits behind the quadrant.
const DIGITS: usize = 23;
/// Words of π, after the point and before it.
const WORDS: usize = DIGITS + 3;

/// A long integer, lowest word first.
type Long = Vec<u64>;

fn divide_by(number: &mut Long, divisor: u64) {
    let mut rest = 0_u128;
    for word in number.iter_mut().rev() {
        let part = rest << 64 | u128::from(*word);
        *word = (part / u128::from(divisor)) as u64;
        rest = part % u128::from(divisor);
    }
}

fn add(to: &mut Long, other: &Long, subtract: bool) {
    let mut carry = u64::from(subtract);
    for (word, &other) in to.iter_mut().zip(other) {
        let other = if subtract { !other } else { other };
        let (sum, first) = word.overflowing_add(other);
        let (sum, second) = sum.overflowing_add(carry);
        *word = sum;
        carry = u64::from(first) + u64::from(second);
    }
}

/// `factor · atan(1/x)`, the point before the last word.
fn inverse_tangent_of_inverse(x: u64, factor: u64) -> Long {
    let mut power = vec![0; WORDS];
    power[WORDS - 1] = factor;
    divide_by(&mut power, x);
    let mut sum = power.clone();
    for n in 1.. {
        divide_by(&mut power, x * x);
        if power.iter().all(|&word| word == 0) {
            break;
        }
        let mut term = power.clone();
        divide_by(&mut term, 2 * n + 1);
        add(&mut sum, &term, n % 2 == 1);
    }
    sum
}

/// π/4, the point before the last word (J. Machin, 1706).
static QUARTER_PI: LazyLock<Long> = LazyLock::new(|| {
    let mut sum = inverse_tangent_of_inverse(5, 4);
    add(&mut sum, &inverse_tangent_of_inverse(239, 1), true);
    sum
});

/// 2/π after the point, highest word first.
static TWO_OVER_PI: LazyLock<[u64; DIGITS]> = LazyLock::new(|| {
    // Bit by bit: what is left of 1/2, against π/4.
    let mut rest = vec![0; WORDS];
    rest[WORDS - 2] = 1 << 63;
    let mut digits = [0; DIGITS];
    for i in 0..64 * DIGITS {
        let mut carry = 0;
        for word in &mut rest {
            (*word, carry) = (*word << 1 | carry, *word >> 63);
        }
        let fits = rest.iter().rev().cmp(QUARTER_PI.iter().rev()).is_ge();
        if fits {
            add(&mut rest, &QUARTER_PI, true);
            digits[i / 64] |= 1 << (63 - i % 64);
        }
    }
    digits
});

/// π/2 in two doubles.
pub(crate) static HALF_PI: LazyLock<Wide> = LazyLock::new(|| {
    let bits = |from: usize| u128::from(QUARTER_PI[from]) << 64 | u128::from(QUARTER_PI[from - 1]);
    let head = bits(WORDS - 2);
    let (first, second) = (head >> 75, head >> 22 & ((1 << 53) - 1));
    let third = (head & ((1 << 22) - 1)) << 31 | bits(WORDS - 4) >> 97;
    let word = |digits: u128, power: i32| Wide::from(digits as f64 * 2_f64.powi(power));
    word(first, -52) + (word(second, -105) + word(third, -158))
});

/// A part of the circle in units of 2⁻³¹⁸ of a quarter turn, modulo a whole one; lowest word first.
type Turn = [u64; 5];

fn bits_of_two_over_pi(first: i64) -> u64 {
    let word = |i: i64| match usize::try_from(i) {
        Ok(i) if i < DIGITS => TWO_OVER_PI[i],
        _ => 0,
    };
    let (index, shift) = (first.div_euclid(64), first.rem_euclid(64));
    if shift == 0 { word(index) } else { word(index) << shift | word(index + 1) >> (64 - shift) }
}

fn plus(a: Turn, b: Turn) -> Turn {
    let mut sum = [0; 5];
    let mut carry = 0_u128;
    for i in 0..5 {
        carry += u128::from(a[i]) + u128::from(b[i]);
        sum[i] = carry as u64;
        carry >>= 64;
    }
    sum
}

fn negative(a: Turn) -> Turn {
    plus(a.map(|word| !word), [1, 0, 0, 0, 0])
}

/// Where on the circle a double stands.
fn turn_of(x: f64) -> Turn {
    let bits = x.abs().to_bits();
    let exponent = (bits >> 52) as i64;
    if exponent == 0 {
        return [0; 5];
    }
    let mantissa = u128::from(bits & ((1 << 52) - 1) | 1 << 52);
    // x · 2/π · 2³¹⁸ = mantissa · 2/π · 2^shift.
    let shift = exponent - 1075 + 318;
    let mut turn = [0; 5];
    let mut carry = 0_u128;
    for (i, word) in turn.iter_mut().enumerate() {
        carry += mantissa * u128::from(bits_of_two_over_pi(shift - 64 * (i as i64 + 1)));
        *word = carry as u64;
        carry >>= 64;
    }
    if x < 0.0 { negative(turn) } else { turn }
}

/// `x · 2/π` less its whole part, in units of 2⁻¹²⁷.
pub(crate) fn fraction_of_quarter(x: f64) -> u128 {
    let turn = turn_of(x);
    let head = u128::from(turn[4]) << 64 | u128::from(turn[3]);
    (head & (u128::MAX >> 2)) << 1 | u128::from(turn[2] >> 63)
}

/// The nearest multiple of π/2 to a sum of doubles, modulo 4, and the remainder.
pub(crate) fn reduce(parts: &[f64]) -> (Wide, u64) {
    let turn = parts.iter().fold([0; 5], |sum, &x| plus(sum, turn_of(x)));
    // Rounded to the nearest quarter.
    let quadrant = (turn[4] >> 61).div_ceil(2) & 3;
    let mut rest = turn;
    rest[4] = rest[4].wrapping_sub(quadrant << 62);
    let below = rest[4] >> 63 == 1;
    if below {
        rest = negative(rest);
    }
    let Some(top) = (0..5).rev().find(|&i| rest[i] != 0) else { return (Wide::ZERO, quadrant) };
    let zeros = rest[top].leading_zeros();
    let word = |i: usize| top.checked_sub(i).map_or(0, |i| rest[i]);
    let aligned = |i: usize| {
        let (high, low) = (u128::from(word(i)), u128::from(word(i + 1)));
        ((high << 64 | low) << zeros >> 64) as u64
    };
    let head = u128::from(aligned(0)) << 64 | u128::from(aligned(1));
    let scale = 2_f64.powi(64 * (top as i32 + 1) - zeros as i32 - 318);
    let first = (head >> 75) as f64 * 2_f64.powi(-53) * scale;
    let second = (head >> 22 & ((1 << 53) - 1)) as f64 * 2_f64.powi(-106) * scale;
    let third = (head & ((1 << 22) - 1)) as f64 * 2_f64.powi(-128) * scale;
    let fraction = Wide::from(first) + Wide::new(second, third);
    let remainder = fraction * *HALF_PI;
    (if below { -remainder } else { remainder }, quadrant)
}

/// 1/n!.
static INVERSE_FACTORIALS: LazyLock<[Wide; 30]> = LazyLock::new(|| {
    let mut all = [Wide::ONE; 30];
    for n in 1..30 {
        all[n] = all[n - 1] / Wide::from(n as f64);
    }
    all
});

/// `Σ (−z)ⁱ/(first + 2 i)!`, the terms that a double can hold beside the first in doubles.
#[inline]
fn series(z: Wide, first: usize) -> Wide {
    let table = &*INVERSE_FACTORIALS;
    let mut tail = 0.0;
    for i in (8..=13).rev() {
        tail = (-z.high).mul_add(tail, table[first + 2 * i].high);
    }
    let mut sum = Wide::from(tail);
    for i in (0..8).rev() {
        sum = table[first + 2 * i] - z * sum;
    }
    sum
}

/// Sine and cosine of at most an eighth of a turn.
fn near(r: Wide) -> (Wide, Wide) {
    let z = r.square();
    (r * series(z, 1), series(z, 0))
}

/// Sine and cosine of a sum of doubles, the first the largest.
pub(crate) fn sin_cos(parts: &[f64]) -> (Wide, Wide) {
    if let [x] = *parts
        && x.abs() < 0.785
    {
        return near(Wide::from(x));
    }
    let (remainder, quadrant) = reduce(parts);
    sin_cos_in(remainder, quadrant)
}

/// Sine and cosine of a remainder to a multiple of π/2.
pub(crate) fn sin_cos_in(remainder: Wide, quadrant: u64) -> (Wide, Wide) {
    let (s, c) = near(remainder);
    match quadrant & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// The angle of `(x, y)` in `(−π, π)`: the system's in double, then what is left of it.
pub(crate) fn atan2(y: Wide, x: Wide) -> Wide {
    let start = y.high.atan2(x.high);
    if start == 0.0 {
        return y / x;
    }
    let (s, c) = sin_cos(&[start]);
    let rest = (y * c - x * s) / (x * c + y * s);
    Wide::from(start) + (rest - rest * rest.square() * (1.0 / 3.0))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn the_digits_of_pi() {
        assert_eq!(*HALF_PI, Wide::new(FRAC_PI_2, 6.123_233_995_736_766e-17));
        assert_eq!(TWO_OVER_PI[0], 0xa2f9_836e_4e44_1529);
    }

    #[test]
    fn the_nearest_double_to_a_multiple_of_a_quarter_turn() {
        // The cosine from 60-digit arithmetic.
        let (_, cosine) = sin_cos(&[6_381_956_970_095_103.0 * 2_f64.powi(797)]);
        assert_eq!(cosine.high.abs(), 4.687_165_924_254_628e-19);
    }
}
