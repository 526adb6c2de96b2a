//! What a plan does for each sample, and what it leaves out and why, in words.

use crate::error::{Error, Result};
use crate::input::drivelines::Drivelines;
use crate::number::Precision;
use crate::number::atan::AtanRange;
use crate::plan::reduction::Reduction;
use crate::plan::steps::{Plan, ShaftStep};

/// How a plan is called.
#[derive(Clone, Copy, Debug)]
pub struct Call {
    /// The arithmetic.
    pub precision: Precision,
    /// What rows are reduced to, if they are.
    pub reduction: Option<Reduction>,
    /// Whether the angles come from a sweep.
    pub sweep: bool,
    /// Whether results are in single precision.
    pub single: bool,
}

impl Plan {
    /// The steps taken and those skipped with the reason, and bytes per sample, as text.
    ///
    /// # Errors
    /// Arrays of other lengths than the drivelines have, or no driveline.
    pub fn explain(&self, lines: &Drivelines<'_>, call: Call) -> Result<String> {
        if lines.check(self.joint_count)? == 0 {
            return Err(Error::new("drivelines", &[], "is empty; there is nothing to explain"));
        }
        let kind = match call.precision {
            Precision::Single => "single precision after a reduction in double",
            Precision::Double => "double precision",
            Precision::DoubleDouble => "double precision with error terms",
        };
        let mut text = format!("arithmetic: {kind}\nsteps:");
        for words in self.steps(lines, call) {
            text.extend(["\n  ", &words]);
        }
        let skipped = self.skipped(lines, call);
        if !skipped.is_empty() {
            text += "\nskipped:";
        }
        for words in skipped {
            text.extend(["\n  ", &words]);
        }
        let read = if call.sweep { 0 } else { 8 };
        let word = if call.single { 4 } else { 8 };
        let written = if call.reduction.is_some() { 0 } else { word * self.planes };
        Ok(text + &format!("\nper sample: {read} bytes read, {written} bytes written"))
    }

    /// The steps in the order in which they run.
    fn steps(&self, lines: &Drivelines<'_>, call: Call) -> Vec<String> {
        let mut steps = vec![];
        let from = if call.sweep { "sample number" } else { "angle" };
        let by_twice =
            |range: AtanRange| call.precision == Precision::DoubleDouble && range.is_moderate();
        let ranges = || self.moving().map(|step| Self::range_of_first(lines, step.shaft));
        if ranges().any(by_twice) {
            steps.push(format!("{from} to sine and cosine of twice the angle"));
        }
        if self.needs_poses() || !ranges().all(by_twice) {
            let sense = if self.needs_sense() { "" } else { ", up to their sign" };
            steps.push(format!("{from} to sine and cosine times a common factor{sense}"));
        }
        let bent = self.first_bent();
        for step in &self.shafts {
            let shaft = step.shaft;
            let found = found(step);
            if shaft <= bent {
                steps.push(format!("shaft {shaft}: {found}, those of the drive"));
                continue;
            }
            let range = Self::range_of_first(lines, shaft);
            if shaft > 1 && !by_twice(range) {
                steps
                    .push(format!("shaft {shaft}: sine and cosine turned to its equivalent joint"));
            }
            let mut how = String::new();
            if step.angle.is_some() || step.angle_error.is_some() {
                let terms = range.terms()[call.precision as usize];
                how = format!(" (inverse tangent of {terms} terms)");
            }
            if step.together().is_some() && range.is_moderate() {
                how += ", in one loop";
            }
            steps.push(format!("shaft {shaft}: {found}{how}"));
        }
        for (j, step) in self.joints.iter().enumerate() {
            if step.needs_tilt() {
                steps.push(format!("joint {j}: tilts of the cross"));
            }
        }
        for station in self.load.iter().flat_map(|load| &load.stations) {
            let shaft = station.shaft;
            if station.absorbs {
                steps.push(format!("shaft {shaft}: power that its inertia takes"));
            }
            if station.torque.is_some() {
                steps.push(format!("shaft {shaft}: torque from the power"));
            }
            if station.torsion {
                let step = &self.joints[shaft - 1];
                let parts = [
                    (step.moment.is_some(), "moment"),
                    (step.needs_support(), "support moments"),
                    (step.bending_driving.is_some(), "bending, driving side"),
                    (step.bending_driven.is_some(), "bending, driven side"),
                ];
                let names: Vec<&str> =
                    parts.iter().filter(|(wanted, _)| *wanted).map(|(_, name)| *name).collect();
                steps.push(format!("joint {}: {} from the torsion", shaft - 1, names.join(", ")));
            }
        }
        if let Some(reduction) = call.reduction {
            steps.push(format!("each row to its {}; no sample is stored", reduction.name()));
        }
        steps
    }

    /// What is left out, and why.
    fn skipped(&self, lines: &Drivelines<'_>, call: Call) -> Vec<String> {
        let n = self.joint_count;
        let mut skipped = vec![];
        for (j, &bend) in self.largest_bends.iter().enumerate() {
            if bend == 0.0 {
                skipped.push(format!("joint {j}: straight, it passes its rotation on"));
            }
        }
        if let Some(step) = self.shafts.last().filter(|step| step.shaft > 1) {
            skipped.push(format!(
                "joints one by one: the {} before shaft {} act as one",
                step.shaft, step.shaft
            ));
        }
        let reach = self.reach();
        if reach < n {
            let last = if reach + 1 == n { String::new() } else { format!(" to {}", n - 1) };
            skipped.push(format!("joint {reach}{last}: beyond everything asked for"));
        }
        let idle: Vec<String> = (0..=n)
            .filter(|&shaft| self.shafts.iter().all(|step| step.shaft != shaft))
            .map(|shaft| shaft.to_string())
            .collect();
        if !idle.is_empty() {
            let plural = if idle.len() > 1 { "s" } else { "" };
            skipped.push(format!("shaft{plural} {}: motion not asked for", idle.join(", ")));
        }
        if self.load.is_none() {
            skipped.push("torques and moments: not asked for".into());
        }
        if !self.needs_poses() && self.moving().next().is_none() {
            skipped.push("sine and cosine: everything turns with the drive".into());
        }
        skipped.extend(self.vanishing(lines));
        if call.sweep {
            skipped.push(
                "array of angles: a sweep needs none; whole turns of it are repeated, and long ones \
                 that are not turn from sample to sample, without a sine each"
                    .into(),
            );
        }
        skipped
    }
}

/// What is wanted of a shaft.
fn found(step: &ShaftStep) -> String {
    let names = [
        (step.angle.is_some(), "angle"),
        (step.angle_error.is_some(), "angle error"),
        (step.speed_ratio.is_some() || step.keep_ratio, "speed ratio"),
        (step.acceleration_ratio.is_some() || step.keep_acceleration, "acceleration ratio"),
    ];
    let names: Vec<&str> = names.iter().filter(|(wanted, _)| *wanted).map(|(_, n)| *n).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::geometry::Geometry;
    use crate::plan::output::Output;
    use crate::plan::steps::Request;

    /// The text for a driveline of three joints, the second straight.
    fn text(outputs: &[Output], shafts: &[usize], precision: Precision) -> String {
        let line = Geometry::from_bends(&[0.1, 0.0, 0.2], &[0.3; 2], &[0.4; 2]).unwrap();
        let request = Request {
            largest_bends: &line.bends,
            outputs,
            shafts,
            joints: &[],
            load: None,
            inertias: &[],
        };
        let Geometry { bends, twists, phases, .. } = &line;
        let lines =
            Drivelines { bends, twists, phases, directions: &[0.0; 12], normals: &[0.0; 9] };
        let call = Call { precision, reduction: None, sweep: false, single: false };
        Plan::new(&request).unwrap().explain(&lines, call).unwrap()
    }

    fn has(text: &str, lines: &[&str]) {
        for line in lines {
            assert!(text.lines().any(|found| found.trim() == *line), "{line}: {text}");
        }
    }

    #[test]
    fn what_runs_and_what_does_not() {
        let motion = &[Output::AngleError, Output::SpeedRatio, Output::AccelerationRatio];
        let last = text(motion, &[3], Precision::Double);
        has(
            &last,
            &[
                "angle to sine and cosine times a common factor, up to their sign",
                "shaft 3: sine and cosine turned to its equivalent joint",
                "joint 1: straight, it passes its rotation on",
                "joints one by one: the 3 before shaft 3 act as one",
                "shafts 0, 1, 2: motion not asked for",
                "torques and moments: not asked for",
            ],
        );
        assert!(last.contains("bytes read, 24 bytes written"), "{last}");
        assert!(!last.contains("twice the angle") && !last.contains("beyond"), "{last}");
        let twice = text(motion, &[3], Precision::DoubleDouble);
        has(&twice, &["angle to sine and cosine of twice the angle"]);
        assert!(!twice.contains("common factor") && !twice.contains("turned to"), "{twice}");
        let first = text(&[Output::SpeedRatio], &[1], Precision::Double);
        has(&first, &["shaft 1: speed ratio", "joint 1 to 2: beyond everything asked for"]);
        assert!(!first.contains("turned to") && !first.contains("one by one"), "{first}");
        let second = text(&[Output::SpeedRatio], &[0, 1, 2], Precision::Double);
        has(&second, &["joint 2: beyond everything asked for", "shaft 3: motion not asked for"]);
        let drive = text(&[Output::SpeedRatio], &[0], Precision::Double);
        has(&drive, &["sine and cosine: everything turns with the drive"]);
        has(&drive, &["shaft 0: speed ratio, those of the drive"]);
    }
}
