//! Speed and acceleration of a shaft behind a chain, with all digits of a double-double.
//!
//! Torques of drive and inertias, and the moments of a shaft's two joints, may cancel. Their terms
//! then need more digits than the result.

use crate::mechanics::chain::Transfer;
use crate::mechanics::joint::Joint;
use crate::number::double_double::DoubleDouble;
use crate::number::float::{Real, inverse_power_of_two};

/// The motion of a shaft from sine and cosine of the drive angle. With `w = e^{iα}` the squared
/// length of `A w + B w̄` is `|A|² + |B|² + 2 Re(A B̄ w²)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turning<T> {
    /// The map of the chain.
    matrix: TurnMatrix<T>,
    /// `|A|² − |B|²`.
    complement: T,
    /// `8 Re(A B̄)` and `4 Im(A B̄)`.
    swing: [T; 2],
}

impl<T: Real> Turning<T> {
    pub(crate) fn new(transfer: &Transfer) -> Self {
        let product = transfer.a * transfer.b.conj();
        Self {
            matrix: TurnMatrix::new(transfer.matrix()),
            complement: T::from_double_double(transfer.complement),
            swing: [product.re.scaled(8.0), product.im.scaled(4.0)]
                .map(|x| apart(T::from_double_double(x))),
        }
    }

    /// Behind a joint on the drive shaft.
    pub(crate) fn of_joint(bend: f64) -> Self {
        let mut transfer = Transfer::default();
        transfer.pass_joint(&Joint::of_chain(bend));
        Self::new(&transfer)
    }

    /// Speed ratio, `(|A|² − |B|²)/|A w + B w̄|²`.
    #[inline(always)]
    pub(crate) fn ratio(&self, s: T, c: T) -> T {
        self.rates(s, c).0
    }

    /// Speed ratio and its derivative, the acceleration ratio.
    #[inline(always)]
    pub(crate) fn rates(&self, s: T, c: T) -> (T, T) {
        let (y, x) = self.matrix.turn(s, c);
        let square = x.mul_add(x, y.square());
        let ratio = self.complement / square;
        let [re, im] = self.swing;
        let slope = apart(re.mul_add(s * c, im * apart((c - s) * (c + s))));
        (ratio, ratio * slope / square)
    }

    /// Whether an acceleration ratio has lost digits. Sine and cosine of the drive angle keep those of
    /// their product.
    #[inline(always)]
    pub(crate) fn loses_digits(&self, ratio: T, acceleration: T) -> bool {
        let [re, im] = self.swing;
        let slope = acceleration * self.complement / ratio.square();
        DoubleDouble::of(im).high != 0.0 && is_small(slope, re, im)
    }

    /// The acceleration ratio from the speed ratio and the sine of twice the equivalent joint's input
    /// angle.
    pub(crate) fn acceleration(&self, ratio: T, double_sine: DoubleDouble) -> T {
        let [re, im] = self.swing.map(DoubleDouble::of);
        // Squares of small numbers would underflow.
        let scale = inverse_power_of_two(re.high.abs().max(im.high.abs()));
        let square = re.scaled(0.5 * scale).square() + im.scaled(scale).square();
        let swing = square.sqrt().scaled(1.0 / scale);
        -(ratio.square() * T::from_double_double(swing * double_sine) / self.complement)
    }
}

/// The map of a chain as a matrix on `(cos α, sin α)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TurnMatrix<T>(pub(crate) [T; 4]);

impl<T: Real> TurnMatrix<T> {
    pub(crate) fn new(matrix: [DoubleDouble; 4]) -> Self {
        Self(matrix.map(T::from_double_double))
    }

    pub(crate) fn identity() -> Self {
        Self([1.0, 0.0, 0.0, 1.0].map(T::from_f64))
    }

    /// Sine and cosine of the angle to which it maps a unit vector, multiplied by a common length.
    #[inline(always)]
    pub(crate) fn turn(self, s: T, c: T) -> (T, T) {
        let Self([cc, cs, sc, ss]) = self;
        (apart(sc.mul_add(c, ss * s)), apart(cc.mul_add(c, cs * s)))
    }

    /// Whether either has lost digits: it is the sum of two terms, and the elements of a row are as
    /// exact as the larger of both.
    #[inline(always)]
    pub(crate) fn loses_digits(self, (sine, cosine): (T, T)) -> bool {
        let Self([cc, cs, sc, ss]) = self;
        let has_both =
            |a: T, b: T| DoubleDouble::of(a).high != 0.0 && DoubleDouble::of(b).high != 0.0;
        has_both(sc, ss) & is_small(sine, sc, ss) | has_both(cc, cs) & is_small(cosine, cc, cs)
    }
}

/// The part of its terms below which a sum has too few digits of a double-double.
const LEAST: f64 = 1.0 / (1_u64 << 24) as f64;

/// Whether a sum is so much smaller than its terms that it has lost digits, given two numbers of which
/// the larger has their size.
#[inline(always)]
fn is_small<T: Real>(sum: T, a: T, b: T) -> bool {
    let size = |x: T| DoubleDouble::of(x).high.abs();
    size(sum) < LEAST * if size(a) > size(b) { size(a) } else { size(b) }
}

/// The same number in words that do not overlap, as they do after a sum that cancels. Products drop
/// the product of both error terms, which is then too large.
#[inline(always)]
fn apart<T: Real>(number: T) -> T {
    if !T::LOW {
        return number;
    }
    let [high, low] = number.words();
    T::from_double_double(DoubleDouble::two_sum(high.into(), low.into()))
}
