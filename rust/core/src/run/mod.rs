//! Running a plan: threads, blocks, chunks, loops over slices, and sinks for the results.

mod angle_sink;
mod as_built;
mod as_built_constants;
mod block;
mod by_strips;
mod chunk_length;
mod constants;
mod evaluation;
pub mod execution;
pub mod explain;
mod extrema;
pub mod fold;
mod forces;
mod formula;
pub mod gradient;
mod kernels;
mod lanes;
pub mod level;
mod load;
mod map;
mod motion;
pub mod phases;
pub mod q_derivatives;
pub(crate) mod queue;
mod reduce;
mod scratch;
mod sines;
mod sink;
mod stores_as;
mod supports;
mod sweep_tables;
#[cfg(test)]
mod taken;
pub mod threads;
mod torsion_parts;
mod turned;
mod unwritten;
