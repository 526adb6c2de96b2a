//! The fused multiply-add, which WebAssembly does not have, with the bits of the processors that do.
//!
//! The exact product is a sum of two doubles, and the addition is rounded once by way of rounding to
//! odd (S. Boldo and G. Melquiond, Emulation of a FMA and correctly rounded sums: proved algorithms
//! using rounding to odd, IEEE Transactions on Computers 57, 2008). Where a part might leave the
//! range of normal numbers, the crate `libm` computes with integers, which takes longer.

/// Exponents of factors, and of a summand, with which no part overflows or underflows.
const FACTORS: (u64, u64) = (1023 - 400, 1023 + 400);
const SUMMANDS: (u64, u64) = (1023 - 880, 1023 + 880);

/// `a·b + c`, rounded once.
#[inline]
pub fn fused(a: f64, b: f64, c: f64) -> f64 {
    let is_within = |x: f64, (least, most): (u64, u64)| {
        ((x.to_bits() >> 52) & 0x7ff).wrapping_sub(least) <= most - least
    };
    if !(is_within(a, FACTORS) && is_within(b, FACTORS)) {
        return outside(a, b, c);
    }
    if !is_within(c, SUMMANDS) {
        return if c == 0.0 { a * b } else { outside(a, b, c) };
    }
    let (product, error) = two_product(a, b);
    let (small, rest) = two_sum(c, error);
    let (sum, lost) = two_sum(product, small);
    sum + to_odd(rest, lost)
}

/// The same where an exponent is out of range. Zeros are frequent and need no care.
#[cold]
fn outside(a: f64, b: f64, c: f64) -> f64 {
    if a == 0.0 || b == 0.0 { a * b + c } else { libm::fma(a, b, c) }
}

/// The exact product by halves of the factors (T. J. Dekker, 1971).
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let halves = |x: f64| {
        let scaled = 134_217_729.0 * x;
        let high = scaled - (scaled - x);
        (high, x - high)
    };
    let (product, (a_high, a_low), (b_high, b_low)) = (a * b, halves(a), halves(b));
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, error)
}

/// The exact sum (D. E. Knuth).
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The sum, rounded to the neighbour with an odd last bit unless it is exact.
#[inline]
fn to_odd(a: f64, b: f64) -> f64 {
    let (sum, error) = two_sum(a, b);
    let bits = sum.to_bits();
    if error == 0.0 || bits & 1 == 1 {
        return sum;
    }
    // Away from zero if the error points there.
    let outwards = (error.to_bits() ^ bits) >> 63 == 0;
    f64::from_bits(if outwards { bits + 1 } else { bits - 1 })
}

/// Function that the compiler calls for `f64::mul_add`.
// SAFETY: the function has the meaning that its name has everywhere.
#[cfg(target_family = "wasm")]
#[unsafe(no_mangle)]
pub extern "C" fn fma(a: f64, b: f64, c: f64) -> f64 {
    fused(a, b, c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of all sizes from a linear congruential generator.
    struct Numbers(u64);

    impl Numbers {
        fn word(&mut self) -> u64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            self.0 ^ (self.0 >> 29)
        }

        /// A number with an exponent about this one, some of whose last bits are zero.
        fn about(&mut self, exponent: u64, spread: u64) -> f64 {
            let word = self.word();
            let exponent = exponent + word % spread;
            let mantissa = (self.word() >> 12) & (!0 << (self.word() % 53));
            f64::from_bits((word & (1 << 63)) | (exponent << 52) | mantissa)
        }
    }

    fn agree(a: f64, b: f64, c: f64) {
        let (found, wanted) = (fused(a, b, c), a.mul_add(b, c));
        let alike = found.to_bits() == wanted.to_bits() || found.is_nan() && wanted.is_nan();
        assert!(alike, "{a:e} {b:e} {c:e}: {found:e}, not {wanted:e}");
    }

    #[test]
    fn it_has_the_bits_of_the_processor() {
        let mut numbers = Numbers(1);
        for round in 0..1_000_000 {
            // The summand about the size of the product, of its error, and anywhere.
            let (a, b) = (numbers.about(1000, 40), numbers.about(1000, 40));
            let product = ((a * b).to_bits() >> 52) & 0x7ff;
            let c = match round % 4 {
                0 => numbers.about(product - 2, 5),
                1 => numbers.about(product - 60, 20),
                2 => -(a * b),
                _ => numbers.about(900, 200),
            };
            agree(a, b, c);
        }
    }

    #[test]
    fn it_has_them_at_the_ends_of_the_range() {
        let mut numbers = Numbers(7);
        for _ in 0..300_000 {
            let [a, b, c] = [(); 3].map(|()| numbers.about(0, 2047));
            agree(a, b, c);
            agree(a, 1.0 / a, -1.0);
        }
        let special = [0.0, -0.0, 1.0, -1.5, 5e-324, f64::MAX, f64::INFINITY, f64::NAN, 1e-300];
        for a in special {
            for b in special {
                for c in special {
                    agree(a, b, c);
                }
            }
        }
    }
}
