//! The number types of the kernels and the words of their results.

use cardan_memory::Plane;

use crate::number::Number;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Float;
use crate::run::fold::{Folded, FoldedAs, FoldedDriveline};
use crate::run::level::Compiled;

/// A number type whose results are stored in words of type `W`.
pub(crate) trait StoresAs<W: Float>: Number + Compiled {
    /// The words that the kernels store.
    type Plane: Float;

    /// The constants of a driveline, if it was folded for this type.
    fn folded(driveline: &FoldedDriveline) -> Option<&Folded<Self>>;

    /// The planes themselves, if the kernels store their words directly.
    fn direct<'a, 'b>(planes: &'a mut [Plane<'b, W>]) -> Option<&'a mut [Plane<'b, Self::Plane>]>;
}

macro_rules! stores_as {
    ($($number:ident as $precision:ident by $plane:ident to $word:ident:
        $planes:ident => $direct:expr;)*) => {$(
        impl StoresAs<$word> for $number {
            type Plane = $plane;

            fn folded(driveline: &FoldedDriveline) -> Option<&Folded<Self>> {
                if let FoldedAs::$precision(folded) = &driveline.0 { Some(folded) } else { None }
            }

            fn direct<'a, 'b>(
                $planes: &'a mut [Plane<'b, $word>],
            ) -> Option<&'a mut [Plane<'b, $plane>]> {
                $direct
            }
        }
    )*};
}

stores_as! {
    f32 as Single by f32 to f32: planes => Some(planes);
    f32 as Single by f64 to f64: planes => Some(planes);
    f64 as Double by f64 to f64: planes => Some(planes);
    f64 as Double by f64 to f32: _planes => None;
    DoubleDouble as DoubleDouble by f64 to f64: planes => Some(planes);
    DoubleDouble as DoubleDouble by f64 to f32: _planes => None;
}
