//! Speed and acceleration of a shaft behind a chain, with all digits of a double-double.
//!
//! Torques of drive and inertias, and the moments of a shaft's two joints, may cancel. Their terms
//! then need more digits than the result.

use crate::mechanics::chain::Transfer;
use crate::mechanics::joint::Joint;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;

/// The motion of a shaft from sine and cosine of the drive angle. With `w = e^{iα}` the squared
/// length of `A w + B w̄` is `|A|² + |B|² + 2 Re(A B̄ w²)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turning<T> {
    /// The map of the chain as a matrix on `(cos α, sin α)`.
    matrix: [T; 4],
    /// `|A|² − |B|²`.
    complement: T,
    /// `8 Re(A B̄)` and `4 Im(A B̄)`.
    swing: [T; 2],
}

impl<T: Real> Turning<T> {
    pub(crate) fn new(transfer: &Transfer) -> Self {
        let product = transfer.a * transfer.b.conj();
        Self {
            matrix: transfer.matrix().map(T::from_double_double),
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
        let (y, x) = turned(self.matrix, s, c);
        let square = x.mul_add(x, y.square());
        let ratio = self.complement / square;
        let [re, im] = self.swing;
        let slope = apart(re.mul_add(s * c, im * apart((c - s) * (c + s))));
        (ratio, ratio * slope / square)
    }
}

/// Sine and cosine of the angle to which a matrix maps a unit vector, multiplied by a common
/// length.
#[inline(always)]
pub(crate) fn turned<T: Real>([cc, cs, sc, ss]: [T; 4], s: T, c: T) -> (T, T) {
    (apart(sc.mul_add(c, ss * s)), apart(cc.mul_add(c, cs * s)))
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
