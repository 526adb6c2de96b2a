//! The directions and normals of a batch of drivelines from bends.

use crate::error::Result;
use crate::input::broadcast::unravel;
use crate::mechanics::geometry::{FIRST_DIRECTION, follow};
use crate::mechanics::phasing::is_set;
use crate::run::execution::Execution;
use crate::run::level::{Level, compiled_up_to_avx2};

/// The number of drivelines between two checks of the stop flag.
const PIECE: usize = 64;

/// Appends the directions `(…, joints + 1, 3)` and normals `(…, joints, 3)` of a batch of this shape
/// as [`crate::Geometry::from_bends`] finds them, from bends `(…, joints)`, twists and phases
/// `(…, joints − 1)` in rad.
///
/// ```
/// let mut frames = [vec![], vec![]];
/// cardan::frames_of_batch(1, &[2], [&[0.3, 0.0], &[], &[]], &mut frames, Default::default())?;
/// let [directions, normals] = frames;
/// assert_eq!(directions[6..], [1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
/// assert_eq!(normals, [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
/// # Ok::<(), cardan::Error>(())
/// ```
///
/// # Errors
/// Frames of [`crate::Geometry::from_bends`] at the place in the batch.
pub fn frames_of_batch(
    joints: usize,
    shape: &[usize],
    [bends, twists, phases]: [&[f64]; 3],
    [directions, normals]: &mut [Vec<f64>; 2],
    execution: Execution<'_>,
) -> Result<()> {
    let level = execution.level.unwrap_or_else(Level::new);
    let between = joints.saturating_sub(1);
    for line in 0..shape.iter().product() {
        if line.is_multiple_of(PIECE) && is_set(execution.stop) {
            break;
        }
        let (bends, twists) = (part(bends, line, joints), part(twists, line, between));
        let phases = part(phases, line, between);
        directions.extend(FIRST_DIRECTION.iter());
        compiled_up_to_avx2!(
            level,
            follow(bends, twists, phases, |normal, direction| {
                normals.extend(normal.iter());
                directions.extend(direction.iter());
            })
        )
        .map_err(|error| error.within(&unravel(line, shape)))?;
    }
    Ok(())
}

/// The part of a flat array for one driveline, empty if it is too short.
fn part(flat: &[f64], line: usize, each: usize) -> &[f64] {
    let first = line.saturating_mul(each);
    flat.get(first..first.saturating_add(each)).unwrap_or(&[])
}
