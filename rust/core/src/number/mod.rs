//! Number types, their storage, range reduction and elementary functions.

pub mod atan;
pub mod double_double;
pub(crate) mod dual;
pub(crate) mod elementary;
pub(crate) mod fixed;
pub mod float;
pub mod precision;
pub(crate) mod reduction;
pub(crate) mod series;
pub(crate) mod storage;
pub(crate) mod strips;
pub mod trig;

pub use double_double::DoubleDouble;
pub use precision::Precision;

use atan::Atan;
use trig::Angle;

/// All traits that a kernel requires of its number type.
pub(crate) trait Number: Angle + Atan {}
impl<T: Angle + Atan> Number for T {}
