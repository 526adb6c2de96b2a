//! Periodic orbits of systems with couplings that have kinks, by shooting.

use crate::dynamics::orbit::Failure;
use crate::dynamics::pool::Pool;
use crate::dynamics::search::{Found, OrbitGoal};
use crate::dynamics::system::TorsionalSystem;

impl TorsionalSystem {
    /// The orbit at a mean speed in rad/s.
    pub(super) fn shoot(
        &self,
        _speed: f64,
        _goal: OrbitGoal,
        _pool: &mut Pool<'_>,
    ) -> Result<Found, Failure> {
        Err(Failure::NotFound)
    }
}
