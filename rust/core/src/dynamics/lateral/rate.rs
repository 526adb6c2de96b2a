//! How fast a vibration and the shafts turn, and what loses energy meanwhile.

/// A vibration at an order of the drive's rotation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rate {
    /// `ω` in rad/s.
    pub(super) omega: f64,
    /// `Ω` in rad/s.
    pub(super) speed: f64,
    /// Whether bearings lose energy.
    pub(super) damped: bool,
    /// Whether shafts that bend do so as well.
    pub(super) lossy: bool,
}

impl Rate {
    /// Rate of an order of the drive's rotation at a speed in rad/s.
    pub(super) fn of_order(order: f64, speed: f64) -> Self {
        Self { omega: order * speed, speed, damped: true, lossy: order >= 2.0 }
    }

    /// At rest and without damping.
    pub(super) fn at_rest(omega: f64) -> Self {
        Self { omega, speed: 0.0, damped: false, lossy: false }
    }

    /// Coefficient of the slope by moments of inertia across and along the axis.
    pub(super) fn rotary(self, across: f64, along: f64, turn: f64) -> f64 {
        across * self.omega * self.omega - turn * along * self.omega * self.speed
    }

    /// The sign of `ω`, 0 for none.
    pub(super) fn sign(self) -> f64 {
        if self.omega == 0.0 { 0.0 } else { self.omega.signum() }
    }
}
