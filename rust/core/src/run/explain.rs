//! What a run of a plan does for each sample, and what it leaves out and why, in words.

use crate::error::{Error, Result};
use crate::input::Samples;
use crate::input::table::{GeometryVariation, Table};
use crate::mechanics::moment::Pose;
use crate::number::atan::AtanRange;
use crate::number::double_double::DoubleDouble;
use crate::number::{Number, Precision};
use crate::plan::output::Output;
use crate::plan::reduction::Reduction;
use crate::plan::route::{Route, Routes};
use crate::plan::steps::{Plan, ShaftStep};
use crate::run::fold::{Folded, GeometryIndex, fold_first};

/// How a plan is called, apart from its samples.
#[derive(Clone, Copy, Debug)]
pub struct Call {
    /// The arithmetic.
    pub precision: Precision,
    /// What rows are reduced to, if they are.
    pub reduction: Option<Reduction>,
    /// Whether results are in single precision.
    pub single: bool,
}

/// The routes of a run, and what the first of its drivelines makes of them.
struct Choices {
    routes: Routes,
    /// Whether the angles come from a sweep.
    sweep: bool,
    /// Route and reach of each shaft of the plan.
    shafts: Vec<(Route, AtanRange)>,
}

impl Choices {
    fn new<T: Number>(plan: &Plan, table: &Table<'_>) -> Self {
        let routes = Routes::of_run(plan, table, T::PRECISION);
        let per_sample = table.geometry_variation() == GeometryVariation::BySample;
        let mut folded = Folded::<T>::new(plan, 1, per_sample, &routes);
        folded.fold(plan, &table.lines, 1, |_| 0);
        let geometry = if per_sample { GeometryIndex::PerSample } else { GeometryIndex::Shared(0) };
        let of = |step: &ShaftStep| folded.route(&routes, step.shaft, geometry);
        Self { routes, sweep: table.sweep.is_some(), shafts: plan.shafts.iter().map(of).collect() }
    }

    fn any(&self, route: Route) -> bool {
        self.shafts.iter().any(|&(taken, _)| taken == route)
    }
}

impl Plan {
    /// The steps taken and those skipped with the reason, and bytes per sample, as text. The steps are
    /// those of the first of the drivelines.
    ///
    /// # Errors
    /// Arrays whose lengths do not fit together, or no sample.
    pub fn explain(&self, samples: &Samples<'_>, call: Call) -> Result<String> {
        samples.lines.check(self.joint_count)?;
        if samples.shape.contains(&0) {
            return Err(Error::new("samples", &[], "are none; there is nothing to explain"));
        }
        let (joints, loaded) = (self.joint_count, self.load.is_some());
        let table = match call.reduction {
            Some(_) => Table::by_rows(joints, loaded, samples)?,
            None => Table::new(joints, loaded, samples)?,
        };
        let choices = self.choices(&table, call.precision);
        let kind = match call.precision {
            Precision::Single => "single precision after a reduction in double",
            Precision::Double => "double precision",
            Precision::DoubleDouble => "double precision with error terms",
        };
        let mut text = format!("arithmetic: {kind}\nsteps:");
        for words in self.steps(&choices, call) {
            text.extend(["\n  ", &words]);
        }
        let skipped = self.skipped(&table, &choices);
        if !skipped.is_empty() {
            text += "\nskipped:";
        }
        for words in skipped {
            text.extend(["\n  ", &words]);
        }
        let read = if choices.sweep { 0 } else { 8 };
        let word = if call.single { 4 } else { 8 };
        let written = if call.reduction.is_some() { 0 } else { word * self.planes };
        Ok(text + &format!("\nper sample: {read} bytes read, {written} bytes written"))
    }

    fn choices(&self, table: &Table<'_>, precision: Precision) -> Choices {
        match precision {
            Precision::Single => Choices::new::<f32>(self, table),
            Precision::Double => Choices::new::<f64>(self, table),
            Precision::DoubleDouble => Choices::new::<DoubleDouble>(self, table),
        }
    }

    /// How sines and cosines are found.
    fn sines(&self, choices: &Choices) -> Vec<String> {
        let Choices { routes, sweep, .. } = choices;
        let mut steps = vec![];
        let from = if *sweep { "sample number" } else { "angle" };
        let by_steps = if routes.needs_rotations() {
            ", turned by whole steps from the middle of groups of samples"
        } else {
            ""
        };
        if choices.any(Route::DoubleAngle) || choices.any(Route::Rotation) {
            steps.push(format!("{from} to sine and cosine of twice the angle{by_steps}"));
        }
        if self.needs_poses() || choices.any(Route::Tangent) {
            let sense = if self.needs_sense() { "" } else { ", sign left open" };
            let sums = match routes.tangent_sum {
                Some(length) => {
                    format!(", by the addition theorem within groups of {length} samples")
                }
                None => String::new(),
            };
            steps.push(format!(
                "{from} to unnormalised sine and cosine (tangent form{sense}){sums}"
            ));
        }
        steps
    }

    /// The steps in the order in which they run.
    fn steps(&self, choices: &Choices, call: Call) -> Vec<String> {
        let mut steps = self.sines(choices);
        for (step, &(route, range)) in self.shafts.iter().zip(&choices.shafts) {
            let shaft = step.shaft;
            let found = found(step);
            if route == Route::Drive {
                steps.push(format!("shaft {shaft}: {found}, those of the drive"));
                continue;
            }
            if shaft > 1 && route == Route::Tangent {
                steps
                    .push(format!("shaft {shaft}: sine and cosine turned to its equivalent joint"));
            }
            let mut how = String::new();
            let rotates = |output| step.planes.get(output).is_some();
            if rotates(Output::Angle) || rotates(Output::AngleError) {
                let terms = range.terms()[call.precision as usize];
                how = format!(" (inverse tangent of {terms} terms)");
            }
            if step.together().is_some() && range.is_moderate() {
                how += ", in one loop";
            }
            steps.push(format!("shaft {shaft}: {found}{how}"));
        }
        for (j, step) in self.joints.iter().enumerate() {
            if step.needs_tilt {
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
                    (step.planes.get(Output::Moment).is_some(), "moment"),
                    (step.needs_support(), "support moments"),
                    (step.planes.get(Output::BendingDriving).is_some(), "bending, driving side"),
                    (step.planes.get(Output::BendingDriven).is_some(), "bending, driven side"),
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
    fn skipped(&self, table: &Table<'_>, choices: &Choices) -> Vec<String> {
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
        skipped.extend(self.vanishing(table));
        if choices.sweep {
            skipped.push("array of angles: a sweep needs none".into());
        }
        if let Some(period) = choices.routes.period {
            skipped.push(format!(
                "samples after the first {period} of a row: results repeat and are copied"
            ));
        }
        skipped
    }

    /// Terms of vectors that vanish all over the first driveline, because of where it lies.
    fn vanishing(&self, table: &Table<'_>) -> Vec<String> {
        let folded = fold_first::<f64>(self, &table.lines);
        let mut vanishing = vec![];
        for (j, step) in self.joints.iter().enumerate() {
            let Some([.., normal]) = folded.poses[j].first().and_then(Pose::plane) else {
                continue;
            };
            let plane = ["yz", "zx", "xy"][normal];
            let why = format!("zero because its shafts lie along the {plane} plane");
            if step.planes.get(Output::Moment).is_some() {
                vanishing.push(format!("joint {j}: 4 of the moment's 9 terms, {why}"));
            }
            for support in step.support.iter().flatten() {
                let shaft = if support.driving { j } else { j + 1 };
                let what = format!("3 of 6 terms of its part of shaft {shaft}'s support");
                vanishing.push(format!("joint {j}: {what}, {why}"));
            }
        }
        vanishing
    }
}

/// What is wanted of a shaft.
fn found(step: &ShaftStep) -> String {
    let wanted = |output: &Output| {
        step.planes.get(*output).is_some()
            || *output == Output::SpeedRatio && step.keep_ratio
            || *output == Output::AccelerationRatio && step.keep_acceleration
    };
    let names: Vec<String> =
        Output::ALL.iter().filter(|o| wanted(o)).map(|o| o.row().name.replace('_', " ")).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::{Angles, Drivelines, Source, Sweep};
    use crate::plan::steps::Request;
    use crate::run::execution::{Execution, Planes};
    use crate::run::taken;

    /// Drivelines of three joints.
    struct Batch {
        bends: Vec<f64>,
        between: Vec<f64>,
        frame: Vec<f64>,
    }

    impl Batch {
        fn new(bends: &[[f64; 3]]) -> Self {
            let count = bends.len();
            let between = [0.3, 0.4].repeat(count);
            Self { bends: bends.concat(), between, frame: vec![0.0; 12 * count] }
        }

        fn lines(&self) -> Drivelines<'_> {
            Drivelines {
                bends: &self.bends,
                twists: &self.between,
                phases: &self.between,
                directions: &self.frame,
                normals: &self.frame[..self.bends.len() * 3],
            }
        }

        fn plan(&self, outputs: &[Output], shafts: &[usize]) -> Plan {
            let request = Request {
                largest_bends: &self.lines().largest_bends(3),
                outputs,
                shafts,
                joints: &[],
                load: None,
                inertias: &[],
            };
            Plan::new(&request).unwrap()
        }
    }

    const MOTION: &[Output] = &[Output::AngleError, Output::SpeedRatio, Output::AccelerationRatio];

    fn text(
        outputs: &[Output],
        shafts: &[usize],
        precision: Precision,
        angle: Angles<'_>,
    ) -> String {
        let batch = Batch::new(&[[0.1, 0.0, 0.2]]);
        let count = if let Angles::Sweep(sweep) = &angle { sweep.count() } else { 2 };
        let shape = &[count];
        let samples =
            Samples { shape, lines: batch.lines(), line_strides: &[0], angle, load: None };
        let call = Call { precision, reduction: None, single: false };
        batch.plan(outputs, shafts).explain(&samples, call).unwrap()
    }

    fn array() -> Angles<'static> {
        Angles::Array(Source { data: &[0.5], strides: &[0] })
    }

    fn has(text: &str, lines: &[&str]) {
        for line in lines {
            assert!(text.lines().any(|found| found.trim() == *line), "{line}: {text}");
        }
    }

    #[test]
    fn what_runs_and_what_does_not() {
        let last = text(MOTION, &[3], Precision::Double, array());
        has(
            &last,
            &[
                "angle to unnormalised sine and cosine (tangent form, sign left open)",
                "shaft 3: sine and cosine turned to its equivalent joint",
                "joint 1: straight, it passes its rotation on",
                "joints one by one: the 3 before shaft 3 act as one",
                "shafts 0, 1, 2: motion not asked for",
                "torques and moments: not asked for",
            ],
        );
        assert!(last.contains("bytes read, 24 bytes written"), "{last}");
        assert!(!last.contains("twice the angle") && !last.contains("beyond"), "{last}");
        let twice = text(MOTION, &[3], Precision::DoubleDouble, array());
        has(&twice, &["angle to sine and cosine of twice the angle"]);
        assert!(!twice.contains("tangent form") && !twice.contains("turned to"), "{twice}");
        let first = text(&[Output::SpeedRatio], &[1], Precision::Double, array());
        has(&first, &["shaft 1: speed ratio", "joint 1 to 2: beyond everything asked for"]);
        assert!(!first.contains("turned to") && !first.contains("one by one"), "{first}");
        let second = text(&[Output::SpeedRatio], &[0, 1, 2], Precision::Double, array());
        has(&second, &["joint 2: beyond everything asked for", "shaft 3: motion not asked for"]);
        let drive = text(&[Output::SpeedRatio], &[0], Precision::Double, array());
        has(&drive, &["sine and cosine: everything turns with the drive"]);
        has(&drive, &["shaft 0: speed ratio, those of the drive"]);
    }

    #[test]
    fn sweeps_have_steps_of_their_own() {
        let turns = Angles::Sweep(Sweep::of_turns(7200, 720).unwrap());
        let repeated = text(MOTION, &[3], Precision::Double, turns);
        has(
            &repeated,
            &[
                "sample number to unnormalised sine and cosine (tangent form, sign left open)",
                "samples after the first 360 of a row: results repeat and are copied",
                "array of angles: a sweep needs none",
            ],
        );
        let long = || Angles::Sweep(Sweep::new(0.0, 30.0, 10_000).unwrap());
        let rotated = text(MOTION, &[3], Precision::Double, long());
        has(
            &rotated,
            &[
                "sample number to sine and cosine of twice the angle, turned by whole steps from the \
               middle of groups of samples",
            ],
        );
        assert!(!rotated.contains("tangent form") && !rotated.contains("copied"), "{rotated}");
    }

    /// Every kind of samples and arithmetic runs by the routes that are explained.
    #[test]
    fn what_is_explained_is_what_runs() {
        let moderate = [0.1, 0.0, 0.2];
        let batches = [
            Batch::new(&[moderate]),
            Batch::new(&[[1.5, 0.3, 0.8]]),
            Batch::new(&[[0.0, 0.0, 0.4]]),
            // Alone the first two are moderate; the bound of the batch is steep.
            Batch::new(&[[0.6, 0.6, 0.0], moderate, [1.2, 0.9, 0.2]]),
        ];
        let array: Vec<f64> = (0..5000).map(|i| f64::from(i) * 0.01).collect();
        let sweeps = [
            Sweep::of_turns(5000, 720).unwrap(),
            Sweep::new(0.0, 30.0, 5000).unwrap(),
            Sweep::new(0.0, 3e6, 5000).unwrap(),
            Sweep::new(0.0, 30.0, 700).unwrap(),
        ];
        let mut compared = std::collections::BTreeSet::new();
        for batch in &batches {
            let rows = batch.bends.len() / 3;
            let plan = batch.plan(MOTION, &[0, 1, 2, 3]);
            for (angle, count) in std::iter::once((None, 5000))
                .chain(sweeps.iter().map(|sweep| (Some(*sweep), sweep.count())))
            {
                for line_strides in [[1, 0], [0, 0], [0, 1]] {
                    let along = line_strides[1] == 1;
                    let shape = if along { [1, rows] } else { [rows, count] };
                    let angle = match angle {
                        Some(_) if along => continue,
                        Some(sweep) => Angles::Sweep(sweep),
                        None => Angles::Array(Source { data: &array, strides: &[0, 1] }),
                    };
                    let lines = batch.lines();
                    let samples = Samples {
                        shape: &shape,
                        lines,
                        line_strides: &line_strides,
                        angle,
                        load: None,
                    };
                    for precision in [Precision::Single, Precision::Double, Precision::DoubleDouble]
                    {
                        let table = Table::new(3, false, &samples).unwrap();
                        let choices = plan.choices(&table, precision);
                        let one = table.geometry_variation() == GeometryVariation::One;
                        let folded = one.then(|| plan.fold(&lines, precision).unwrap());
                        let mut results = vec![vec![0.0; shape[0] * shape[1]]; plan.planes()];
                        let mut planes: Vec<&mut [f64]> =
                            results.iter_mut().map(Vec::as_mut_slice).collect();
                        taken::take();
                        let execution = Execution { workers: Some(1), ..Execution::default() };
                        plan.run(
                            &samples,
                            folded.as_ref(),
                            precision,
                            Planes::Double(&mut planes),
                            execution,
                        )
                        .unwrap();
                        let ran = taken::take();
                        for (step, &(route, range)) in plan.shafts.iter().zip(&choices.shafts) {
                            let own = (step.shaft, route, range);
                            assert!(ran.contains(&own), "{own:?} is not among {ran:?}");
                            compared.insert(route);
                        }
                        if table.geometry_variation() != GeometryVariation::ByRow {
                            assert_eq!(ran.len(), plan.shafts.len());
                        }
                    }
                }
            }
        }
        assert_eq!(
            compared.into_iter().collect::<Vec<_>>(),
            [Route::Drive, Route::Tangent, Route::DoubleAngle, Route::Rotation]
        );
    }
}
