//! The native module `cardan._core`: convert, release the interpreter, call the core, map errors.
//!
//! Arrays arrive contiguous and of the right type: `python/cardan` converts, this module checks that
//! they fit, spreads them over the samples and fills.

#![deny(unsafe_code)]
#![allow(clippy::needless_pass_by_value, reason = "arguments from Python arrive by value")]

mod convert;
mod driveline;
mod lines;
mod plan;
mod transmission;
mod watch;

use pyo3::prelude::*;

/// Native kernels of cardan. Private: use `cardan.Driveline`.
///
/// Holds no state that threads could share unseen, so free-threaded Python keeps its lock off.
#[pymodule(gil_used = false)]
mod _core {
    #[pymodule_export]
    use super::driveline::{equivalent, from_bends, from_directions, from_points, optimal_phases};
    #[pymodule_export]
    use super::lines::Lines;
    #[pymodule_export]
    use super::plan::{DriveSweep, NativePlan, levels, outputs};
    #[pymodule_export]
    use super::transmission::Transmission;

    use super::PyResult;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
