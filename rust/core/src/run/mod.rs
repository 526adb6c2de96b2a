//! Running a plan: threads, blocks, chunks, loops over slices, and where results go.

mod block;
mod chunk;
pub mod execution;
mod extrema;
mod fold;
pub mod level;
mod long_sweep;
mod map;
pub mod phases;
mod reduce;
mod scratch;
mod sink;
