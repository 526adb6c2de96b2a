//! The number of samples that a block computes at a time.

use crate::number::Number;
use crate::plan::route::Routes;
use crate::plan::steps::Plan;

/// Samples per chunk. The buffers for so many samples stay in the first-level cache, or nearly.
pub(crate) const CHUNK: usize = 1024;

/// Samples per chunk with a load, which has more buffers, and where a chunk with a very large angle is
/// repeated.
pub(crate) const SHORT_CHUNK: usize = CHUNK / 2;

/// Doubles per chunk if one loop finds its pins itself, which has few buffers or none.
const FRESH_CHUNK: usize = 2 * CHUNK;

/// Samples per chunk of a long sweep that is computed by rotations without staging buffers.
const LONG_CHUNK: usize = 16 * CHUNK;

/// The samples per chunk of a run; `is_fresh` if one loop finds its pins itself.
pub(crate) fn chunk_length<T: Number>(
    plan: &Plan,
    routes: &Routes,
    is_fresh: bool,
    staging: bool,
) -> usize {
    if is_fresh {
        FRESH_CHUNK * size_of::<f64>() / size_of::<T::Float>()
    } else if plan.load.is_some() {
        SHORT_CHUNK
    } else if routes.has_rotation() && plan.moderate && !plan.needs_poses() && !staging {
        LONG_CHUNK
    } else if T::LOW {
        // Starting these long loops costs more than results that leave the first-level cache.
        2 * CHUNK
    } else {
        CHUNK
    }
}
