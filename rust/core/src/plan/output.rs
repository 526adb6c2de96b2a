//! The quantities that can be requested.

/// A quantity that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Output {
    /// Rotation of a shaft in rad, continuous and mean-synchronous with the drive.
    Angle,
    /// Angle of a shaft less the drive angle, in rad, mean zero.
    AngleError,
    /// `ω_i/ω_0`.
    SpeedRatio,
    /// `d²(angle)/dα²`.
    AccelerationRatio,
    /// Torsion entering a shaft, in N·m.
    Torque,
    /// Moment vector that the bearings must give a shaft, in N·m.
    SupportMoment,
    /// Moment vector that a joint exerts on its driven shaft, in N·m.
    Moment,
    /// Size of the bending moment in a joint's driving shaft, in N·m.
    BendingDriving,
    /// Size of the bending moment in a joint's driven shaft, in N·m.
    BendingDriven,
    /// Signed tilt `ψ₁` of the cross against the driving shaft, in rad.
    TiltDriving,
    /// Signed tilt `ψ₂` of the cross against the driven shaft, in rad.
    TiltDriven,
}

impl Output {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 11] = [
        Self::Angle,
        Self::AngleError,
        Self::SpeedRatio,
        Self::AccelerationRatio,
        Self::Torque,
        Self::SupportMoment,
        Self::Moment,
        Self::BendingDriving,
        Self::BendingDriven,
        Self::TiltDriving,
        Self::TiltDriven,
    ];

    /// The name by which users ask for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::AngleError => "angle_error",
            Self::SpeedRatio => "speed_ratio",
            Self::AccelerationRatio => "acceleration_ratio",
            Self::Torque => "torque",
            Self::SupportMoment => "support_moment",
            Self::Moment => "moment",
            Self::BendingDriving => "bending_driving",
            Self::BendingDriven => "bending_driven",
            Self::TiltDriving => "tilt_driving",
            Self::TiltDriven => "tilt_driven",
        }
    }

    /// Whether there is one per joint; otherwise there is one per shaft.
    pub fn per_joint(self) -> bool {
        self >= Self::Moment
    }

    /// Whether it needs a load.
    pub fn needs_load(self) -> bool {
        (Self::Torque..=Self::BendingDriven).contains(&self)
    }

    /// Planes of the result per shaft or joint: 3 for a vector.
    pub fn components(self) -> usize {
        if matches!(self, Self::SupportMoment | Self::Moment) { 3 } else { 1 }
    }
}
