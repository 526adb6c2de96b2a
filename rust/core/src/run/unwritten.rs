//! Results that nobody has written, which builds with debug assertions look for: a new output whose
//! formula was forgotten is named by the first test that evaluates it.

use crate::number::float::Float;

/// A NaN that no computation makes. Single precision keeps its digits.
const UNWRITTEN: f64 = f64::from_bits(0x7ffa_bcde_0000_0000);

/// Marks every element.
pub(crate) fn mark<W: Float>(planes: &mut [&mut [W]]) {
    for plane in planes {
        plane.fill(W::near(UNWRITTEN));
    }
}

/// The first plane that still has a mark.
pub(crate) fn first<W: Float>(planes: &[&mut [W]]) -> Option<usize> {
    let is_marked = |word: &W| -> bool { (*word).into().to_bits() == UNWRITTEN.to_bits() };
    planes.iter().position(|plane| plane.iter().any(is_marked))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks<W: Float>() {
        let (mut one, mut other) = (vec![W::near(1.0); 5], vec![W::near(f64::NAN); 5]);
        let mut planes = [&mut one[..], &mut other[..]];
        assert_eq!(first(&planes), None);
        mark(&mut planes);
        planes[0].fill(W::near(0.0));
        planes[1][..4].fill(W::near(f64::NAN));
        assert_eq!(first(&planes), Some(1));
        planes[1][4] = W::near(-f64::NAN);
        assert_eq!(first(&planes), None);
    }

    #[test]
    fn what_nobody_wrote_is_found() {
        marks::<f64>();
        marks::<f32>();
    }
}
