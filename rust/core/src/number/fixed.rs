//! Fixed-point numbers of any length, for the few results that need more digits than a
//! double-double has.

use std::ops::{Add, Mul, Neg, Sub};

use crate::number::double_double::DoubleDouble;

/// A number in two's complement, lowest word first; the last word is the integer part.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fixed(Vec<u64>);

impl Fixed {
    /// Zero with `words` words after the point.
    pub(crate) fn zero(words: usize) -> Self {
        Self(vec![0; words + 1])
    }

    fn one(words: usize) -> Self {
        let mut one = Self::zero(words);
        one.0[words] = 1;
        one
    }

    /// `x · 2ᵖᵒʷᵉʳ`, cut after the last word, for a product below 2⁶².
    fn of(x: f64, power: i64, words: usize) -> Self {
        let bits = x.abs().to_bits();
        let (exponent, fraction) = ((bits >> 52) as i64, bits & ((1 << 52) - 1));
        let mantissa = if exponent == 0 { fraction } else { fraction | 1 << 52 };
        // The place of the mantissa's lowest bit, counted from the number's.
        let place = exponent.max(1) - 1075 + power + 64 * words as i64;
        let mut number = Self::zero(words);
        let mantissa = if place < 0 { mantissa >> (-place).min(63) } else { mantissa };
        let (word, shift) = ((place.max(0) / 64) as usize, place.max(0) % 64);
        let spread = u128::from(mantissa) << shift;
        number.0[word] = spread as u64;
        if let Some(next) = number.0.get_mut(word + 1) {
            *next = (spread >> 64) as u64;
        }
        if x < 0.0 { -&number } else { number }
    }

    fn words(&self) -> usize {
        self.0.len() - 1
    }

    fn is_negative(&self) -> bool {
        self.0[self.words()] >> 63 == 1
    }

    fn is_zero(&self) -> bool {
        self.0.iter().all(|&word| word == 0)
    }

    fn abs(&self) -> Self {
        if self.is_negative() { -self } else { self.clone() }
    }

    /// The quotient by a small number that is not zero.
    fn over(&self, divisor: u64) -> Self {
        let mut quotient = self.abs();
        let mut rest = 0_u128;
        for word in quotient.0.iter_mut().rev() {
            let dividend = rest << 64 | u128::from(*word);
            *word = (dividend / u128::from(divisor)) as u64;
            rest = dividend % u128::from(divisor);
        }
        if self.is_negative() { -&quotient } else { quotient }
    }

    /// The same number with `words` words after the point, fewer than it has.
    fn cut(&self, words: usize) -> Self {
        Self(self.0[self.words() - words..].to_vec())
    }

    /// The number of digits from the first one that is not zero.
    pub(crate) fn digits(&self) -> i64 {
        let size = self.abs();
        let top = size.0.iter().rposition(|&word| word != 0);
        top.map_or(0, |top| 64 * (top as i64 + 1) - i64::from(size.0[top].leading_zeros()))
    }

    /// The number multiplied by `2ᵖᵒʷᵉʳ`, as a double-double.
    pub(crate) fn scaled(&self, power: i64) -> DoubleDouble {
        let size = self.abs();
        let digits = self.digits();
        // 106 digits from the first one on, in two integers.
        let digit_run = |from: i64, count: i64| {
            (from - count..from).rev().fold(0_u64, |sum, place| {
                let bit = match usize::try_from(place) {
                    Ok(place) => size.0[place / 64] >> (place % 64) & 1,
                    Err(_) => 0,
                };
                sum << 1 | bit
            })
        };
        let place = digits - 64 * self.words() as i64 + power;
        let part = |run: u64, end: i64| run as f64 * 2_f64.powi((place - end) as i32);
        let number = DoubleDouble::new(
            part(digit_run(digits, 53), 53),
            part(digit_run(digits - 53, 53), 106),
        );
        if self.is_negative() { -number } else { number }
    }
}

impl Neg for &Fixed {
    type Output = Fixed;

    fn neg(self) -> Fixed {
        let mut carry = true;
        let words = self.0.iter().map(|word| {
            let (word, more) = (!word).overflowing_add(u64::from(carry));
            carry = more;
            word
        });
        Fixed(words.collect())
    }
}

impl Add for &Fixed {
    type Output = Fixed;

    fn add(self, other: Self) -> Fixed {
        let mut carry = 0;
        let words = self.0.iter().zip(&other.0).map(|(&a, &b)| {
            let sum = u128::from(a) + u128::from(b) + carry;
            carry = sum >> 64;
            sum as u64
        });
        Fixed(words.collect())
    }
}

impl Sub for &Fixed {
    type Output = Fixed;

    fn sub(self, other: Self) -> Fixed {
        self + &-other
    }
}

impl Mul for &Fixed {
    type Output = Fixed;

    fn mul(self, other: Self) -> Fixed {
        let (a, b) = (self.abs(), other.abs());
        let length = a.0.len();
        let mut product = vec![0; 2 * length];
        for (i, &x) in a.0.iter().enumerate() {
            let mut carry = 0;
            for (j, &y) in b.0.iter().enumerate() {
                let sum = u128::from(x) * u128::from(y) + u128::from(product[i + j]) + carry;
                product[i + j] = sum as u64;
                carry = sum >> 64;
            }
            product[i + length] = carry as u64;
        }
        let product = Fixed(product[length - 1..2 * length - 1].to_vec());
        if self.is_negative() == other.is_negative() { product } else { -&product }
    }
}

/// A complex number of two.
#[derive(Clone, Debug)]
pub(crate) struct FixedComplex {
    pub(crate) re: Fixed,
    pub(crate) im: Fixed,
}

impl FixedComplex {
    pub(crate) fn one(words: usize) -> Self {
        Self { re: Fixed::one(words), im: Fixed::zero(words) }
    }

    pub(crate) fn zero(words: usize) -> Self {
        Self { re: Fixed::zero(words), im: Fixed::zero(words) }
    }

    pub(crate) fn conj(&self) -> Self {
        Self { re: self.re.clone(), im: -&self.im }
    }

    pub(crate) fn times(&self, factor: &Fixed) -> Self {
        Self { re: &self.re * factor, im: &self.im * factor }
    }

    /// The digits of the larger part.
    pub(crate) fn digits(&self) -> i64 {
        self.re.digits().max(self.im.digits())
    }

    /// `eⁱˣ` of a sum of finite doubles, to within 2⁻⁶⁴ʷᵒʳᵈˢ or a little more.
    pub(crate) fn turn(angles: &[f64], words: usize) -> Self {
        // A power of two makes the angle small; each doubling of it costs two digits.
        let largest = angles.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let exponent = ((largest.to_bits() >> 52) as i64 - 1022).max(0);
        let halvings = exponent + 8 + angles.len() as i64;
        let inside = words + 2 * halvings as usize / 64 + 2;
        let angle = angles
            .iter()
            .map(|&x| Fixed::of(x, -halvings, inside))
            .reduce(|sum, x| &sum + &x)
            .expect("there is an angle");
        let square = &angle * &angle;
        let (mut sine, mut versine) = (angle.clone(), Fixed::zero(inside));
        let (mut odd, mut even) = (angle, -&Fixed::one(inside));
        for k in 1.. {
            even = -&(&even * &square).over(2 * k * (2 * k - 1));
            odd = -&(&odd * &square).over(2 * k * (2 * k + 1));
            if even.is_zero() && odd.is_zero() {
                break;
            }
            versine = &versine + &even;
            sine = &sine + &odd;
        }
        for _ in 0..halvings {
            // sin 2x = 2 sin x (1 − v), 1 − cos 2x = 2 sin² x.
            let half = &sine - &(&sine * &versine);
            let square = &sine * &sine;
            (sine, versine) = (&half + &half, &square + &square);
        }
        Self { re: (&Fixed::one(inside) - &versine).cut(words), im: sine.cut(words) }
    }
}

impl Add for &FixedComplex {
    type Output = FixedComplex;

    fn add(self, other: Self) -> FixedComplex {
        FixedComplex { re: &self.re + &other.re, im: &self.im + &other.im }
    }
}

impl Sub for &FixedComplex {
    type Output = FixedComplex;

    fn sub(self, other: Self) -> FixedComplex {
        FixedComplex { re: &self.re - &other.re, im: &self.im - &other.im }
    }
}

impl Mul for &FixedComplex {
    type Output = FixedComplex;

    fn mul(self, other: Self) -> FixedComplex {
        FixedComplex {
            re: &(&self.re * &other.re) - &(&self.im * &other.im),
            im: &(&self.re * &other.im) + &(&self.im * &other.re),
        }
    }
}
