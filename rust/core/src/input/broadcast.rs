//! How arrays are broadcast over the samples.

use std::borrow::Cow;

use crate::error::{Error, Result};

/// Strides, in elements, of the array of an argument in C order over samples of this shape. An axis
/// of length 1 and an axis that the array does not have serve all samples.
///
/// ```
/// assert_eq!(*cardan::strides("angle", &[3, 1], &[2, 3, 5])?, [0, 1, 0]);
/// # Ok::<(), cardan::Error>(())
/// ```
///
/// # Errors
/// A shape that does not broadcast to that of the samples.
pub fn strides(
    argument: &'static str,
    own: &[usize],
    shape: &[usize],
) -> Result<Cow<'static, [usize]>> {
    match (own, shape) {
        // Small calls need no allocation.
        ([], [_]) => return Ok(Cow::Borrowed(&[0])),
        ([own], [count]) if own == count && *own > 1 => return Ok(Cow::Borrowed(&[1])),
        _ => {}
    }
    let misfit = || {
        let (own, shape) = (shown(own), shown(shape));
        let problem = format!("has shape {own}, which does not broadcast to the samples' {shape}");
        Error::new(argument, &[], problem)
    };
    let before = shape.len().checked_sub(own.len()).ok_or_else(misfit)?;
    let mut strides = vec![0; shape.len()];
    let mut step = 1_usize;
    for (axis, &length) in own.iter().enumerate().rev() {
        if length != 1 {
            if length != shape[before + axis] {
                return Err(misfit());
            }
            strides[before + axis] = step;
        }
        step = step.saturating_mul(length);
    }
    Ok(Cow::Owned(strides))
}

/// A shape as Python shows it.
fn shown(shape: &[usize]) -> String {
    if let [only] = shape {
        return format!("({only},)");
    }
    let lengths: Vec<String> = shape.iter().map(ToString::to_string).collect();
    format!("({})", lengths.join(", "))
}

/// The index of one driveline in a batch of the given shape.
pub fn unravel(mut flat: usize, shape: &[usize]) -> Vec<usize> {
    let mut index = vec![0; shape.len()];
    for (place, &length) in index.iter_mut().zip(shape).rev() {
        *place = flat % length.max(1);
        flat /= length.max(1);
    }
    index
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_broadcast_as_those_of_numpy() {
        let of = |own: &[usize], shape: &[usize]| strides("angle", own, shape).unwrap().to_vec();
        assert_eq!(of(&[], &[7]), [0]);
        assert_eq!(of(&[7], &[7]), [1]);
        assert_eq!(of(&[1], &[1]), [0]);
        assert_eq!(of(&[], &[2, 3]), [0, 0]);
        assert_eq!(of(&[3], &[2, 3]), [0, 1]);
        assert_eq!(of(&[2, 1], &[2, 3]), [1, 0]);
        assert_eq!(of(&[4, 2, 3], &[4, 2, 3]), [6, 3, 1]);
        assert_eq!(of(&[0, 3], &[0, 3]), [3, 1]);
        assert_eq!(of(&[], &[]), [0; 0]);
    }

    #[test]
    fn shapes_that_do_not_fit_are_shown() {
        for (own, shape, shown) in [
            (&[3][..], &[2][..], "(3,), which does not broadcast to the samples' (2,)"),
            (&[2, 1], &[3, 4], "(2, 1), which does not broadcast to the samples' (3, 4)"),
            (&[1], &[], "(1,), which does not broadcast to the samples' ()"),
        ] {
            let error = strides("speed", own, shape).unwrap_err();
            assert_eq!(error.to_string(), format!("speed has shape {shown}"));
        }
    }

    #[test]
    fn places_in_a_batch_are_in_c_order() {
        assert_eq!(unravel(17, &[2, 3, 4]), [1, 1, 1]);
        assert_eq!(unravel(0, &[]), [0; 0]);
        assert_eq!(unravel(0, &[0, 2]), [0, 0]);
    }
}
