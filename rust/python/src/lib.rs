//! The native module `cardan._core`: it converts arguments, releases the interpreter, calls the
//! core and maps errors.
//!
//! `python/cardan` passes contiguous arrays of the right type. The core checks that they fit.

#![deny(unsafe_code)]
#![allow(clippy::needless_pass_by_value, reason = "arguments from Python arrive by value")]

mod convert;
mod derivatives;
mod design;
mod driveline;
mod judge;
mod lateral;
mod lines;
mod measured;
mod phases;
mod plan;
mod torsion;
mod transmission;
mod turns;
mod watch;

use pyo3::prelude::*;

/// Native kernels of cardan. Private: use `cardan.Driveline`.
///
/// The module has no unsynchronised shared state, so free-threaded Python runs it without its lock.
#[pymodule(gil_used = false)]
mod _core {
    #[pymodule_export]
    use super::derivatives::{differentiate, dq};
    #[pymodule_export]
    use super::design::{excitations, spline_forces, steering, tubes};
    #[pymodule_export]
    use super::driveline::{
        check_bearings, check_deviations, equivalent, from_bends, from_directions, from_points,
        mean_leads,
    };
    #[pymodule_export]
    use super::judge::{NativeMachine, kinds, ranks};
    #[pymodule_export]
    use super::lateral::{NativeLateral, largest_over_turn};
    #[pymodule_export]
    use super::lines::Lines;
    #[pymodule_export]
    use super::measured::{NativeIntegral, derivatives_at};
    #[pymodule_export]
    use super::phases::{common_phases, optimal_phases};
    #[pymodule_export]
    use super::plan::{DriveSweep, NativePlan, levels, outputs};
    #[pymodule_export]
    use super::torsion::{NativeTorsion, critical_speeds};
    #[pymodule_export]
    use super::transmission::NativeTransmission;
    #[pymodule_export]
    use super::turns::{free_drives, hours, least_drive_inertias, pin_means};

    use super::PyResult;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
