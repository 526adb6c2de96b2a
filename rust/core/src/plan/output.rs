//! The quantities that can be requested: one row of a table each.

/// What there is one of an output for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Each shaft.
    Shaft,
    /// Each joint.
    Joint,
}

impl Per {
    /// The name by which users know it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shaft => "shaft",
            Self::Joint => "joint",
        }
    }
}

/// What an output needs, and so which part of a plan computes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Needs {
    /// The motion of a shaft; the value where it turns with the drive, except for its angle.
    Motion(Option<f64>),
    /// The sense of the pins at a joint.
    Tilt,
    /// The power that enters a shaft.
    Power,
    /// The parts of the moments at both ends of a shaft.
    Support,
    /// The torsion that a joint receives.
    Torsion,
}

/// What an output is.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The name by which users request it.
    pub name: &'static str,
    /// What there is one for.
    pub per: Per,
    /// Its SI unit, `"1"` for a ratio.
    pub unit: &'static str,
    /// The names of its components; a scalar has one without a name.
    pub components: &'static [&'static str],
    pub(crate) needs: Needs,
}

const SCALAR: &[&str] = &[""];
const VECTOR: &[&str] = &["x", "y", "z"];

/// The table: a variant, its meaning, and its row.
macro_rules! outputs {
    ($($(#[$meaning:meta])* $output:ident: $name:literal, $per:ident, $unit:literal, $components:ident,
        $needs:expr;)*) => {
        /// A quantity that can be requested.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Output {$($(#[$meaning])* $output,)*}

        impl Output {
            /// All of them, in the order of the documentation.
            pub const ALL: [Self; Self::COUNT] = [$(Self::$output),*];

            /// How many there are.
            pub const COUNT: usize = [$($name),*].len();

            /// What it is.
            pub const fn row(self) -> Row {
                match self {
                    $(Self::$output => Row {
                        name: $name,
                        per: Per::$per,
                        unit: $unit,
                        components: $components,
                        needs: $needs,
                    },)*
                }
            }
        }
    };
}

outputs! {
    /// Rotation of a shaft, continuous and mean-synchronous with the drive.
    Angle: "angle", Shaft, "rad", SCALAR, Needs::Motion(None);
    /// Angle of a shaft less the drive angle, mean zero.
    AngleError: "angle_error", Shaft, "rad", SCALAR, Needs::Motion(Some(0.0));
    /// `ω_i/ω_0`.
    SpeedRatio: "speed_ratio", Shaft, "1", SCALAR, Needs::Motion(Some(1.0));
    /// `d²(angle)/dα²`.
    AccelerationRatio: "acceleration_ratio", Shaft, "1", SCALAR, Needs::Motion(Some(0.0));
    /// `d³(angle)/dα³`.
    JerkRatio: "jerk_ratio", Shaft, "1", SCALAR, Needs::Motion(Some(0.0));
    /// Torsion entering a shaft.
    Torque: "torque", Shaft, "N m", SCALAR, Needs::Power;
    /// Moment vector that the bearings must give a shaft.
    SupportMoment: "support_moment", Shaft, "N m", VECTOR, Needs::Support;
    /// Moment vector that a joint exerts on its driven shaft.
    Moment: "moment", Joint, "N m", VECTOR, Needs::Torsion;
    /// Size of the bending moment in a joint's driving shaft.
    BendingDriving: "bending_driving", Joint, "N m", SCALAR, Needs::Torsion;
    /// Size of the bending moment in a joint's driven shaft.
    BendingDriven: "bending_driven", Joint, "N m", SCALAR, Needs::Torsion;
    /// Signed tilt `ψ₁` of the cross against the driving shaft.
    TiltDriving: "tilt_driving", Joint, "rad", SCALAR, Needs::Tilt;
    /// Signed tilt `ψ₂` of the cross against the driven shaft.
    TiltDriven: "tilt_driven", Joint, "rad", SCALAR, Needs::Tilt;
}

impl Output {
    /// Whether it needs a load.
    pub fn needs_load(self) -> bool {
        !matches!(self.row().needs, Needs::Motion(_) | Needs::Tilt)
    }

    /// Planes of the result per shaft or joint.
    pub fn components(self) -> usize {
        self.row().components.len()
    }
}

/// The first plane of each output of one shaft or joint that is requested.
#[derive(Clone, Debug, Default)]
pub(crate) struct OutputPlanes([Option<usize>; Output::COUNT]);

impl OutputPlanes {
    #[inline(always)]
    pub(crate) fn get(&self, output: Output) -> Option<usize> {
        self.0[output as usize]
    }

    pub(crate) fn set(&mut self, output: Output, plane: usize) {
        self.0[output as usize] = Some(plane);
    }
}
