//! The number types of the kernels, the words of their results, and marks on those that nobody has
//! written: builds with debug assertions look for these, so that a new output whose formula was
//! forgotten is named by the first test that evaluates it.

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
    ($($(#[$on:meta])? $number:ident as $precision:ident by $plane:ident to $word:ident:
        $planes:ident => $direct:expr;)*) => {$(
        $(#[$on])?
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
    #[cfg(feature = "single")]
    f32 as Single by f32 to f32: planes => Some(planes);
    #[cfg(feature = "single")]
    f32 as Single by f64 to f64: planes => Some(planes);
    f64 as Double by f64 to f64: planes => Some(planes);
    #[cfg(feature = "single")]
    f64 as Double by f64 to f32: _planes => None;
    DoubleDouble as DoubleDouble by f64 to f64: planes => Some(planes);
    #[cfg(feature = "single")]
    DoubleDouble as DoubleDouble by f64 to f32: _planes => None;
}

/// A NaN that no computation makes. Single precision keeps its digits.
const UNWRITTEN: f64 = f64::from_bits(0x7ffa_bcde_0000_0000);

/// Marks every element.
pub(crate) fn mark_unwritten<W: Float>(planes: &mut [&mut [W]]) {
    for plane in planes {
        plane.fill(W::near(UNWRITTEN));
    }
}

/// The first plane that still has a mark.
pub(crate) fn first_unwritten<W: Float>(planes: &[&mut [W]]) -> Option<usize> {
    let is_marked = |word: &W| -> bool { (*word).into().to_bits() == UNWRITTEN.to_bits() };
    planes.iter().position(|plane| plane.iter().any(is_marked))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks<W: Float>() {
        let (mut one, mut other) = (vec![W::near(1.0); 5], vec![W::near(f64::NAN); 5]);
        let mut planes = [&mut one[..], &mut other[..]];
        assert_eq!(first_unwritten(&planes), None);
        mark_unwritten(&mut planes);
        planes[0].fill(W::near(0.0));
        planes[1][..4].fill(W::near(f64::NAN));
        assert_eq!(first_unwritten(&planes), Some(1));
        planes[1][4] = W::near(-f64::NAN);
        assert_eq!(first_unwritten(&planes), None);
    }

    #[test]
    fn what_nobody_wrote_is_found() {
        marks::<f64>();
        marks::<f32>();
    }
}
