//! What numbers of a lateral system must be.

use crate::mechanics::geometry::Vector;

/// Refuses values that are negative or not finite.
pub(super) fn check_each(values: &[(&str, f64)]) -> std::result::Result<(), String> {
    match values.iter().find(|(_, value)| !(0.0..f64::INFINITY).contains(value)) {
        None => Ok(()),
        Some((name, value)) => {
            Err(format!("has the {name} {value:?}; it must be finite and not negative"))
        }
    }
}

/// A vector that must have a part across a shaft with this direction.
pub(super) fn check_axis(
    name: &str,
    axis: Vector,
    direction: Vector,
) -> std::result::Result<(), String> {
    let across = axis.cross(&direction).norm();
    if across > 1e-9 * axis.norm() && across.is_finite() {
        return Ok(());
    }
    let [x, y, z] = [axis.x, axis.y, axis.z];
    Err(format!("has the {name} ({x:?}, {y:?}, {z:?}); it must have a part across the shaft"))
}
