//! How a run uses the machine, and where its results go.

use std::sync::atomic::AtomicBool;

use crate::run::level::Level;

/// How a run uses the machine. Results do not depend on it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Execution<'a> {
    /// The instruction set; by default the best of the machine.
    pub level: Option<Level>,
    /// The most threads to use; by default all of rayon's if there is enough work for them.
    pub workers: Option<usize>,
    /// Once this is set, every thread skips the chunks that it has not begun, and the results are
    /// incomplete.
    pub stop: Option<&'a AtomicBool>,
    /// Whether the memory of the results was allocated for this run.
    pub new_memory: bool,
}

/// The planes of a result, each with one element per sample.
#[derive(Debug)]
pub enum Planes<'a, 'b> {
    /// Planes of doubles.
    Double(&'a mut [&'b mut [f64]]),
    /// Planes of single-precision numbers.
    #[cfg(feature = "single")]
    Single(&'a mut [&'b mut [f32]]),
}
