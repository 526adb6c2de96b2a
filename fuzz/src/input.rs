//! Inputs from bytes: numbers that matter more often than chance would give them.

use std::f64::consts::FRAC_PI_2;

use arbitrary::{Result, Unstructured};

/// The largest number of joints: enough for every way of folding.
pub const JOINTS: usize = 9;

/// Any double, with those at the edges often among them.
pub fn number(u: &mut Unstructured<'_>) -> Result<f64> {
    Ok(match u.arbitrary::<u8>()? % 16 {
        0 => 0.0,
        1 => -0.0,
        2 => f64::NAN,
        3 => f64::INFINITY,
        4 => f64::MIN_POSITIVE,
        5 => f64::MAX,
        6 => f64::from(u.arbitrary::<i16>()?) * FRAC_PI_2,
        7..12 => f64::from(u.arbitrary::<i16>()?) / 4096.0,
        _ => u.arbitrary()?,
    })
}

/// A bend within its range, unless the bytes say otherwise.
pub fn bend(u: &mut Unstructured<'_>) -> Result<f64> {
    Ok(match u.arbitrary::<u8>()? % 8 {
        0 => 0.0,
        1 => FRAC_PI_2.next_down(),
        2 => f64::from_bits(u.arbitrary::<u64>()? % FRAC_PI_2.to_bits()),
        3 => number(u)?,
        _ => f64::from(u.arbitrary::<u16>()?) / 65536.0 * FRAC_PI_2,
    })
}

/// So many values.
pub fn several<T>(
    u: &mut Unstructured<'_>,
    count: usize,
    each: fn(&mut Unstructured<'_>) -> Result<T>,
) -> Result<Vec<T>> {
    (0..count).map(|_| each(u)).collect()
}

/// Now and then a count that is one too many or too few.
pub fn about(u: &mut Unstructured<'_>, count: usize) -> Result<usize> {
    Ok(match u.arbitrary::<u8>()? {
        255 => count + 1,
        254 => count.saturating_sub(1),
        _ => count,
    })
}
