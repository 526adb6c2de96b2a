//! Running a plan: threads, blocks, chunks, loops over slices, and where results go.

mod block;
mod chunk;
pub mod execution;
pub mod explain;
mod extrema;
pub mod fold;
pub mod level;
mod map;
pub mod phases;
mod reduce;
mod scratch;
mod sink;
mod sweep_tables;
#[cfg(test)]
mod taken;
pub mod threads;
