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

/// Output about the cross of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OfCross {
    Tilt,
    Swing,
    Pin,
}

/// Property of some outputs.
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

/// The table: each row has a variant, a name, the part described, a unit, the components, the needs,
/// what else is true of it, its meaning in a line, and its equation.
macro_rules! outputs {
    ($($output:ident: $name:literal, $per:ident, $unit:literal, $components:ident, $needs:expr,
        [$($trait:ident),*], $meaning:literal, $source:literal;)*) => {
        /// A quantity that can be requested.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Output {$(#[doc = $meaning] $output,)*}

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

            /// Meaning of the output in a line.
            pub const fn meaning(self) -> &'static str {
                match self {
                    $(Self::$output => $meaning,)*
                }
            }

            /// Its equation, with where it comes from; `a` is the input angle of the joint, or of the
            /// single joint equivalent to the chain, `b` its bend, and `D` the torsion that enters it.
            pub const fn source(self) -> &'static str {
                match self {
                    $(Self::$output => $source,)*
                }
            }
        }
    };
}

outputs! {
    Angle: "angle", Shaft, "rad", SCALAR, Needs::Motion(None), [],
        "rotation, mean-synchronous with the drive",
        "tan angle = tan a / cos b (Thoma 4, Grossmann 1)";
    AngleError: "angle_error", Shaft, "rad", SCALAR, Needs::Motion(Some(0.0)), [],
        "rotation minus the drive angle, with mean zero",
        "atan2((1 - cos b) sin a cos a, cos b cos² a + sin² a) (from Thoma 4; Bild 11)";
    SpeedRatio: "speed_ratio", Shaft, "1", SCALAR, Needs::Motion(Some(1.0)), [],
        "speed over that of the drive",
        "cos b / (cos² b cos² a + sin² a) (from Thoma 4)";
    AccelerationRatio: "acceleration_ratio", Shaft, "1", SCALAR, Needs::Motion(Some(0.0)), [],
        "second derivative of the rotation by the drive angle; times the square of the drive \
         speed it is the acceleration at constant drive speed",
        "-2 cos b sin² b sin a cos a / (cos² b cos² a + sin² a)² (from Thoma 4)";
    JerkRatio: "jerk_ratio", Shaft, "1", SCALAR, Needs::Motion(Some(0.0)), [],
        "third derivative of the rotation by the drive angle; times the cube of the drive speed \
         it is the jerk at constant drive speed",
        "2 cos b sin² b (sin⁴ a + 3 sin² b sin² a cos² a - cos² b cos⁴ a) / (cos² b cos² a + \
         sin² a)³ (derived here from Thoma 4)";
    Torque: "torque", Shaft, "N m", SCALAR, Needs::Power, [],
        "torsion entering the shaft",
        "D / speed ratio of the joint (Grossmann 7), minus the share of the inertias (Thoma 8)";
    SupportMoment: "support_moment", Shaft, "N m", VECTOR, Needs::Support, [],
        "moment vector that the bearings must exert on the shaft",
        "moment of the joint at its end minus that at its start, without the part along the \
         shaft";
    Moment: "moment", Joint, "N m", VECTOR, Needs::Torsion, [],
        "moment vector that the joint exerts on its driven shaft",
        "D (u_in + tan b sin a (sin a e_in - cos a m)), perpendicular to both pins (Thoma 5)";
    BendingDriving: "bending_driving", Joint, "N m", SCALAR, Needs::Torsion, [Kinks],
        "magnitude of the bending moment in the driving shaft",
        "D tan b |sin a| (Grossmann 6)";
    BendingDriven: "bending_driven", Joint, "N m", SCALAR, Needs::Torsion, [Kinks],
        "magnitude of the bending moment in the driven shaft",
        "D sin b |cos a| √(1 + tan² b sin² a) (Grossmann 8)";
    PinMoment: "pin_moment", Joint, "N m", SCALAR, Needs::Torsion, [Ideal, Kinks],
        "magnitude of the moment vector, which the pins of both yokes bear",
        "D √(1 + tan² b sin² a), the length of the moment (Thoma 5)";
    JointForce: "joint_force", Joint, "N", VECTOR, Needs::Force, [],
        "force vector that the joint exerts on its driven shaft, across the shaft that it \
         supports",
        "balance of that shaft; for a floating shaft of length L: (u x support moment) / L";
    BearingForce: "bearing_force", Bearing, "N", VECTOR, Needs::Force, [],
        "force vector that the bearing exerts on its shaft, across the shaft",
        "balance of the shaft: moments about its other support";
    TiltDriving: "tilt_driving", Joint, "rad", SCALAR, Needs::Cross(OfCross::Tilt), [],
        "signed tilt of the cross, driving shaft",
        "tan tilt = tan b sin a (Grossmann 3)";
    TiltDriven: "tilt_driven", Joint, "rad", SCALAR, Needs::Cross(OfCross::Tilt), [],
        "signed tilt of the cross, driven shaft",
        "sin tilt = sin b cos a (Grossmann 5)";
    SwingDriving: "swing_driving", Joint, "1", SCALAR, Needs::Cross(OfCross::Swing), [Ideal],
        "rate of the cross in the driving yoke per radian of the drive; the derivative of \
         tilt_driving by the drive angle",
        "speed ratio of the driven shaft times sin tilt_driven (derived here from Grossmann 3)";
    SwingDriven: "swing_driven", Joint, "1", SCALAR, Needs::Cross(OfCross::Swing), [Ideal],
        "rate of the cross in the driven yoke per radian of the drive; the derivative of \
         tilt_driven by the drive angle",
        "-(speed ratio of the driving shaft) sin tilt_driving (derived here from Grossmann 5)";
    DrivingPin: "driving_pin", Joint, "1", VECTOR, Needs::Cross(OfCross::Pin), [Ideal],
        "unit vector along the pin of the driving yoke",
        "cos a e_in + sin a m (Thoma, before 1)";
    DrivenPin: "driven_pin", Joint, "1", VECTOR, Needs::Cross(OfCross::Pin), [Ideal],
        "unit vector along the pin of the driven yoke",
        "unit(u_out x driving_pin)";
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

    /// Name in texts: `bending, driving side`.
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
