//! The figures of several variants of a machine that need a turn of the drive.

use std::f64::consts::PI;

use crate::design::tube::Tube;
use crate::error::Result;
use crate::input::Drivelines;
use crate::judge::figures::Variant;
use crate::judge::machine::{Arrays, Cases, Machine};
use crate::judge::{Kind, Look, Stage};
use crate::mechanics::chain::Equivalent;
use crate::mechanics::general::General;
use crate::plan::output::Output;
use crate::plan::reduction::Reduction;
use crate::plan::request::{Axes, End, Request};
use crate::plan::steps::Plan;
use crate::run::execution::Execution;
use crate::turns::Turns;
use crate::turns::peaks::Sought;
use crate::wear::life::{hours, miner};
use crate::wear::pins::{Wear, heat, pin_means};

/// Steps of half a turn in which the largest lash is looked for.
const STEPS: usize = 360;

/// Steps of half a turn for a brief look.
const FEW: usize = 24;

/// Drive angles in equal steps of half a turn.
fn half_turn(steps: usize) -> Vec<f64> {
    (0..steps).map(|i| i as f64 * (PI / steps as f64)).collect()
}

/// The arrays of one group of several variants, one after another.
pub(crate) fn joined(variants: &[&mut Variant], group: usize) -> Arrays {
    std::array::from_fn(|array| {
        let each = variants.iter().flat_map(|variant| &variant.lines[group][array]);
        each.copied().collect()
    })
}

/// One group of cases of several variants.
pub(crate) struct Group<'a> {
    pub(crate) machine: &'a Machine,
    /// 0 for the states, 1 for the steps of the duty cycle.
    pub(crate) number: usize,
    pub(crate) cases: &'a Cases,
    /// All cases of the first variant, then those of the next one.
    pub(crate) lines: Drivelines<'a>,
    /// The numbers of variants and of cases.
    pub(crate) shape: [usize; 2],
    pub(crate) look: Look,
}

impl Group<'_> {
    /// Computes the figures of a stage that is not of closed forms.
    pub(crate) fn compute(
        &self,
        stage: Stage,
        variants: &mut [&mut Variant],
        execution: Execution<'_>,
    ) -> Result<()> {
        match stage {
            Stage::Fatigue if self.number == 1 => self.life(variants, execution),
            Stage::Friction => self.heat(variants, execution),
            Stage::Torque => self.torques(variants, execution),
            Stage::Play if self.number == 0 => self.lash(variants),
            Stage::Forces if self.number == 0 => {
                self.forces(variants, execution);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Puts values of every case of every variant, one after another with `each` numbers, into
    /// their places.
    fn put(
        &self,
        variants: &mut [&mut Variant],
        kind: Kind,
        (found, each): (&[f64], usize),
        of: impl Fn(&[f64], usize, usize) -> f64,
    ) {
        let mut records = found.chunks_exact(each);
        for variant in variants {
            for case in 0..self.cases.count {
                let record = records.next().unwrap_or_default();
                let at = [self.number, case];
                self.machine.put_in(&mut variant.values, kind, at, |item| of(record, case, item));
            }
        }
    }

    fn means(&self, wear: Wear, execution: Execution<'_>) -> Result<Vec<f64>> {
        let joints = self.machine.joints;
        let mut means = vec![f64::NAN; self.shape[0] * self.shape[1] * wear.count(joints)];
        if let Some(load) = &self.cases.load {
            let largest = self.lines.largest_bends(joints);
            let rows = self.cases.rows(self.lines, &self.shape);
            pin_means(&rows, &largest, load.end, wear, &mut means, execution)?;
        }
        Ok(means)
    }

    /// The lives of the joints over the steps of the duty cycle.
    fn life(&self, variants: &mut [&mut Variant], execution: Execution<'_>) -> Result<()> {
        let (joints, shares) = (self.machine.joints, &self.machine.parts.shares);
        let means = self.means(Wear::Fatigue, execution)?;
        let (means, _) = means.as_chunks::<5>();
        for (means, variant) in means.chunks(joints * self.cases.count).zip(variants) {
            for figured in self.machine.of(Kind::Life) {
                let joint = figured.item;
                let each = shares.iter().enumerate().map(|(step, &share)| {
                    let bend = variant.lines[1][0][step * joints + joint];
                    let rpm = self.cases.speed(step) * (30.0 / PI);
                    let own = means[step * joints + joint];
                    (share, hours(own, bend, rpm, variant.ratings[joint])[0])
                });
                variant.values[figured.first] = miner(each);
            }
        }
        Ok(())
    }

    fn heat(&self, variants: &mut [&mut Variant], execution: Execution<'_>) -> Result<()> {
        let means = self.means(Wear::Friction, execution)?;
        let record = (means.as_slice(), Wear::Friction.count(self.machine.joints));
        self.put(variants, Kind::Heat, record, |means, case, joint| {
            let [lost, way] = [means[1 + 2 * joint], means[2 + 2 * joint]];
            heat([lost, way], self.machine.parts.friction[joint]) * self.cases.speed(case)
        });
        Ok(())
    }

    /// Stresses of tubes and force of the spline, from the largest torques over a turn.
    fn torques(&self, variants: &mut [&mut Variant], execution: Execution<'_>) -> Result<()> {
        let machine = self.machine;
        let kinds = [Kind::ShearStress, Kind::SplineForce];
        let mut shafts: Vec<usize> =
            kinds.iter().flat_map(|&kind| machine.of(kind)).map(|one| one.item).collect();
        shafts.sort_unstable();
        shafts.dedup();
        let found = self.largest_torques(&shafts, execution)?;
        let record = (found.as_slice(), shafts.len());
        let of = |torques: &[f64], shaft: usize| {
            let place = shafts.binary_search(&shaft).unwrap_or_default();
            torques.get(place).copied().unwrap_or(f64::NAN)
        };
        self.put(variants, Kind::ShearStress, record, |torques, _, shaft| {
            let tube = machine.parts.tubes.iter().find(|tube| tube.0 == shaft);
            let tube = tube.map_or(f64::NAN, |tube| Tube::new(tube.1).shear_per_torque);
            tube * of(torques, shaft)
        });
        self.put(variants, Kind::SplineForce, record, |torques, _, shaft| {
            let spline = machine.parts.spline.as_ref();
            spline.map_or(f64::NAN, |one| one.friction * of(torques, shaft) / one.radius)
        });
        Ok(())
    }

    /// The largest torques of shafts over a turn in every case.
    fn largest_torques(&self, shafts: &[usize], execution: Execution<'_>) -> Result<Vec<f64>> {
        let (joints, rows) = (self.machine.joints, self.shape[0] * self.shape[1]);
        let Some(load) = &self.cases.load else { return Ok(vec![f64::NAN; rows * shafts.len()]) };
        if load.inertias.iter().any(|(_, each)| each.iter().any(|&inertia| inertia != 0.0)) {
            return self.peaks(Output::Torque, shafts, &[], execution);
        }
        // Without inertias one power passes all shafts, and those between a shaft and the end of
        // the load act as one joint.
        let mut found = Vec::with_capacity(rows * shafts.len());
        for row in 0..rows {
            let (bends, twists, phases) = self.lines.chain(joints, row);
            let torque = load.torque[row % self.cases.count].abs();
            for &shaft in shafts {
                let (first, last) = match load.end {
                    End::Drive => (0, shaft),
                    End::Output => (shaft, joints),
                };
                let ratio = if first == last {
                    1.0
                } else {
                    let between = first..last - 1;
                    let (twists, phases) = (&twists[between.clone()], &phases[between]);
                    Equivalent::of_chain(&bends[first..last], twists, phases)
                        .joint
                        .max_speed_ratio()
                };
                found.push(torque * ratio);
            }
        }
        Ok(found)
    }

    /// The largest magnitudes of an output over a turn in every case.
    fn peaks(
        &self,
        output: Output,
        shafts: &[usize],
        joints: &[usize],
        execution: Execution<'_>,
    ) -> Result<Vec<f64>> {
        let plan = Plan::new(&Request {
            largest_bends: &self.lines.largest_bends(self.machine.joints),
            outputs: &[output],
            shafts,
            joints,
            load: self.cases.load.as_ref().map(|load| load.end),
            inertias: &self.inertias(),
            bearings: (output != Output::Torque).then_some(&self.machine.bearings),
            as_built: false,
            axes: Axes::Space,
        })?;
        if self.look == Look::Brief {
            return self.sampled(&plan, execution);
        }
        let rows = self.cases.rows(self.lines, &self.shape);
        let peaks = Turns::new(&plan, &rows).peaks(Sought::Largest, execution)?;
        Ok(peaks.into_iter().map(|peak| peak.value).collect())
    }

    /// The largest magnitudes at a few angles, which are at most the largest.
    fn sampled(&self, plan: &Plan, execution: Execution<'_>) -> Result<Vec<f64>> {
        let rows = self.shape[0] * self.shape[1];
        let (angles, shape) = (half_turn(FEW), [self.shape[0], self.shape[1], FEW]);
        let samples = self.cases.samples(self.lines, &shape, &angles);
        let results = Reduction::Peak.results(plan);
        let mut found = vec![0.0; results * rows];
        let mut planes: Vec<&mut [f64]> = found.chunks_mut(rows).collect();
        let precision = plan.precision(None, false);
        plan.reduce(&samples, None, precision, Reduction::Peak, &mut planes, execution)?;
        Ok((0..found.len()).map(|i| found[i % results * rows + i / results]).collect())
    }

    fn inertias(&self) -> Vec<usize> {
        let inertias = self.cases.load.iter().flat_map(|load| &load.inertias);
        inertias.map(|&(shaft, _)| shaft).collect()
    }

    /// The forces of joints and bearings in the states; those that are not determinate stay
    /// unknown.
    fn forces(&self, variants: &mut [&mut Variant], execution: Execution<'_>) {
        let joints: Vec<usize> = (0..self.machine.joints).collect();
        let bearings = self.machine.bearings.len();
        for (kind, output, count) in [
            (Kind::JointForce, Output::JointForce, joints.len()),
            (Kind::BearingForce, Output::BearingForce, bearings),
        ] {
            if self.machine.of(kind).is_empty() {
                continue;
            }
            if let Ok(found) = self.peaks(output, &[], &joints, execution) {
                self.put(variants, kind, (&found, count), |forces, _, item| forces[item]);
            }
        }
    }

    /// The largest angle over a turn between the two flanks of the play.
    fn lash(&self, variants: &mut [&mut Variant]) -> Result<()> {
        let [driven, coasting] = [1.0, -1.0].map(|flank| self.on_flank(flank));
        let (driven, coasting) = (driven?, coasting?);
        let apart: Vec<f64> =
            coasting.iter().zip(driven).map(|(after, before)| after - before).collect();
        let largest = |turn: &[f64]| turn.iter().fold(f64::NEG_INFINITY, |most, &x| most.max(x));
        let found: Vec<f64> = apart.chunks_exact(self.steps()).map(largest).collect();
        self.put(variants, Kind::Lash, (&found, 1), |lash, _, _| lash[0]);
        Ok(())
    }

    fn steps(&self) -> usize {
        if self.look == Look::Brief { FEW } else { STEPS }
    }

    /// How far the last shaft is ahead of the drive on one flank of the play, over half a turn of
    /// each row. The play of both yokes is a deviation of the cross, after half a turn of which all
    /// is the same.
    fn on_flank(&self, flank: f64) -> Result<Vec<f64>> {
        let joints = self.machine.joints;
        let play = self.machine.parts.play.iter();
        let own: Vec<f64> = play.flat_map(|play| [0.0, 2.0 * flank * play, 0.0]).collect();
        let angles = half_turn(self.steps());
        let mut ahead = vec![];
        for row in 0..self.shape[0] * self.shape[1] {
            let (bends, twists, phases) = self.lines.chain(joints, row);
            let shaft = General::as_built(bends, twists, phases, &own)?;
            let lead = shaft.mean_lead();
            ahead.extend(angles.iter().map(|&angle| shaft.motion(angle).angle_error + lead));
        }
        Ok(ahead)
    }
}
