//! Numbers that carry their derivatives through the formulas of joints as built.

use crate::number::dual::Dual;

/// The derivatives that one pass over the samples finds.
pub(super) const WIDTH: usize = 4;

/// A number with its derivatives by the parameters of a pass.
pub(super) type Carried = Dual<WIDTH>;
/// A vector of such numbers.
pub(super) type Direction = [Carried; 3];
