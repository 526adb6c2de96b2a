//! Sines and cosines of drive angles: of arrays, and of sweeps by tangent sums or rotations.

pub(crate) mod array;
pub(crate) mod fresh;
pub(crate) mod rotation;
pub(crate) mod tangent_sum;
