//! The table of outputs: one row for each quantity that can be requested.

use crate::error::{Error, Result};
use crate::plan::request::Axes;

/// The part of a driveline that an output describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Each shaft.
    Shaft,
    /// Each joint.
    Joint,
    /// Each bearing.
    Bearing,
}

impl Per {
    /// The name used in the Python interface.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shaft => "shaft",
            Self::Joint => "joint",
            Self::Bearing => "bearing",
        }
    }
}

/// The part of a plan that computes an output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Needs {
    /// The motion of a shaft, with the value for a shaft that turns with the drive; the angle has
    /// none.
    Motion(Option<f64>),
    /// Where the cross stands, which depends on the sense of the pins; its rates also need the speed
    /// ratio of the driving shaft.
    Cross(OfCross),
    /// The power entering a shaft.
    Power,
    /// The moments of the joints at both ends of a shaft.
    Support,
    /// The torsion entering a joint.
    Torsion,
    /// The balance of forces of a shaft.
    Force,
}

/// What an output says of the cross of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OfCross {
    Tilt,
    Swing,
    Pin,
}

/// What is true of some outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Trait {
    /// Only ideal joints have it.
    Ideal,
    /// It is a magnitude, which has kinks where a torque reverses or a pin is in the bend plane or
    /// normal to it.
    Kinks,
}

/// The properties of an output.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The name in requests.
    pub name: &'static str,
    /// Whether the output describes shafts, joints or bearings.
    pub per: Per,
    /// Its SI unit, `"1"` for a ratio.
    pub unit: &'static str,
    /// The names of the components; a scalar has one component with an empty name.
    pub components: &'static [&'static str],
    pub(crate) needs: Needs,
    pub(crate) traits: &'static [Trait],
}

const SCALAR: &[&str] = &[""];
const VECTOR: &[&str] = &["x", "y", "z"];

/// The table: each row has a description, a variant, a name, the part described, a unit, the
/// components, the needs, and what else is true of it.
macro_rules! outputs {
    ($($(#[$meaning:meta])* $output:ident: $name:literal, $per:ident, $unit:literal,
        $components:ident, $needs:expr, [$($trait:ident),*];)*) => {
        /// A quantity that can be requested.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Output {$($(#[$meaning])* $output,)*}

        impl Output {
            /// All outputs, in the order of the documentation.
            pub const ALL: [Self; Self::COUNT] = [$(Self::$output),*];

            /// The number of outputs.
            pub const COUNT: usize = [$($name),*].len();

            /// The properties of the output.
            pub const fn row(self) -> Row {
                match self {
                    $(Self::$output => Row {
                        name: $name,
                        per: Per::$per,
                        unit: $unit,
                        components: $components,
                        needs: $needs,
                        traits: &[$(Trait::$trait),*],
                    },)*
                }
            }
        }
    };
}

outputs! {
    /// Rotation of a shaft, continuous and mean-synchronous with the drive.
    Angle: "angle", Shaft, "rad", SCALAR, Needs::Motion(None), [];
    /// Angle of a shaft minus the drive angle, mean zero.
    AngleError: "angle_error", Shaft, "rad", SCALAR, Needs::Motion(Some(0.0)), [];
    /// Speed of a shaft over the speed of the drive, `ω_i/ω_0`.
    SpeedRatio: "speed_ratio", Shaft, "1", SCALAR, Needs::Motion(Some(1.0)), [];
    /// `d²(angle)/dα²`.
    AccelerationRatio: "acceleration_ratio", Shaft, "1", SCALAR, Needs::Motion(Some(0.0)), [];
    /// `d³(angle)/dα³`.
    JerkRatio: "jerk_ratio", Shaft, "1", SCALAR, Needs::Motion(Some(0.0)), [];
    /// Torsional moment entering a shaft.
    Torque: "torque", Shaft, "N m", SCALAR, Needs::Power, [];
    /// Moment vector that the bearings exert on a shaft.
    SupportMoment: "support_moment", Shaft, "N m", VECTOR, Needs::Support, [];
    /// Moment vector that a joint exerts on its driven shaft.
    Moment: "moment", Joint, "N m", VECTOR, Needs::Torsion, [];
    /// Magnitude of the bending moment in a joint's driving shaft.
    BendingDriving: "bending_driving", Joint, "N m", SCALAR, Needs::Torsion, [Kinks];
    /// Magnitude of the bending moment in a joint's driven shaft.
    BendingDriven: "bending_driven", Joint, "N m", SCALAR, Needs::Torsion, [Kinks];
    /// Magnitude of the moment vector, which the pins bear in both yokes.
    PinMoment: "pin_moment", Joint, "N m", SCALAR, Needs::Torsion, [Ideal, Kinks];
    /// Force that a joint exerts on its driven shaft.
    JointForce: "joint_force", Joint, "N", VECTOR, Needs::Force, [];
    /// Force that a bearing exerts on its shaft.
    BearingForce: "bearing_force", Bearing, "N", VECTOR, Needs::Force, [];
    /// Signed tilt `ψ₁` of the cross against the driving shaft.
    TiltDriving: "tilt_driving", Joint, "rad", SCALAR, Needs::Cross(OfCross::Tilt), [];
    /// Signed tilt `ψ₂` of the cross against the driven shaft.
    TiltDriven: "tilt_driven", Joint, "rad", SCALAR, Needs::Cross(OfCross::Tilt), [];
    /// Rate of the cross in the driving yoke per radian of the drive.
    SwingDriving: "swing_driving", Joint, "1", SCALAR, Needs::Cross(OfCross::Swing), [Ideal];
    /// Rate of the cross in the driven yoke per radian of the drive.
    SwingDriven: "swing_driven", Joint, "1", SCALAR, Needs::Cross(OfCross::Swing), [Ideal];
    /// Unit vector along the pin of the driving yoke.
    DrivingPin: "driving_pin", Joint, "1", VECTOR, Needs::Cross(OfCross::Pin), [Ideal];
    /// Unit vector along the pin of the driven yoke.
    DrivenPin: "driven_pin", Joint, "1", VECTOR, Needs::Cross(OfCross::Pin), [Ideal];
}

/// The outputs that are formulas of one sample of a joint, each with its formula: magnitudes of moments
/// in [`crate::mechanics::moment::Pose`], the others in [`crate::mechanics::cross::Cross`]. Each macro
/// passes its list to another one.
macro_rules! magnitudes {
    ($to:ident) => {
        $to! { BendingDriving: bending_driving, BendingDriven: bending_driven, PinMoment: pin_moment }
    };
}
macro_rules! tilts {
    ($to:ident) => {
        $to! { TiltDriving: tilt_driving, TiltDriven: tilt_driven }
    };
}
macro_rules! swings {
    ($to:ident) => {
        $to! { SwingDriving: swing_driving, SwingDriven: swing_driven }
    };
}
macro_rules! pins {
    ($to:ident) => {
        $to! { DrivingPin: driving_pin, DrivenPin: driven_pin }
    };
}
pub(crate) use {magnitudes, pins, swings, tilts};

impl Output {
    /// The output with this name.
    ///
    /// # Errors
    /// An unknown name.
    pub fn named(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|output| output.row().name == name);
        found.ok_or_else(|| Error::new("outputs", &[], format!("holds {name:?}, which is unknown")))
    }

    /// Whether the output needs a load.
    pub fn needs_load(self) -> bool {
        !matches!(self.row().needs, Needs::Motion(_) | Needs::Cross(_))
    }

    /// Whether only ideal joints have it.
    pub fn is_ideal(self) -> bool {
        self.row().traits.contains(&Trait::Ideal)
    }

    /// Whether half a turn, after which ideal joints look the same but for the sense of their pins,
    /// reverses a component.
    pub(crate) fn reverses(self, component: usize, axes: Axes) -> bool {
        // The axes y and z of a shaft follow its pin.
        let follows_pin = axes == Axes::Shaft && self.is_vector() && component > 0;
        follows_pin || matches!(self.row().needs, Needs::Cross(_))
    }

    /// Whether it has kinks.
    pub(crate) fn has_kinks(self) -> bool {
        self.row().traits.contains(&Trait::Kinks)
    }

    /// Whether the output is a vector.
    pub(crate) fn is_vector(self) -> bool {
        self.components() > 1
    }

    /// What to call it in texts: `bending, driving side`.
    pub(crate) fn label(self) -> String {
        let name = self.row().name;
        let sides = name.replace("_driving", ", driving side").replace("_driven", ", driven side");
        sides.replace('_', " ")
    }

    /// The number of planes per shaft, joint or bearing: one for a scalar, three for a vector.
    pub fn components(self) -> usize {
        self.row().components.len()
    }
}

/// The first plane of each requested output of one shaft or joint.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_output_has_a_name() {
        for output in Output::ALL {
            assert_eq!(Output::named(output.row().name), Ok(output));
        }
        let error = Output::named("angel").unwrap_err();
        assert_eq!(error.to_string(), "outputs holds \"angel\", which is unknown");
    }
}
