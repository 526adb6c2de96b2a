//! Chains of joints that are evaluated joint by joint.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::error::Result;
use crate::mechanics::as_built::{DEVIATIONS, JointAsBuilt, check_deviations};
use crate::mechanics::motion::Motion;
use crate::number::double_double::DoubleDouble;
use crate::number::elementary::atan2;
use crate::number::trig;

/// A chain that is evaluated joint by joint. It serves joints that no single `q` describes.
#[derive(Clone, Debug)]
pub struct General {
    /// Each joint, with sine and cosine of the turn of the shaft before it.
    stages: Vec<((f64, f64), JointAsBuilt)>,
    /// The mean of the sum of the joints' own angle errors.
    mean: f64,
}

impl General {
    /// The transmission to the output of the last of `n` ideal joints, from `n` bends, `n − 1`
    /// twists and `n − 1` phases in rad.
    pub fn of_chain(bends: &[f64], twists: &[f64], phases: &[f64]) -> Self {
        let ideal = vec![[0.0; DEVIATIONS]; bends.len()];
        Self::of_joints(bends, twists, phases, &ideal)
    }

    /// The same for joints as built: with the deviations of driving yoke, cross and driven yoke of
    /// each joint in rad, `(n, 3)`.
    ///
    /// # Errors
    /// A joint that cannot turn.
    ///
    /// ```
    /// use cardan::General;
    /// use std::f64::consts::FRAC_PI_2;
    ///
    /// let leaning = General::as_built(&[0.2], &[], &[], &[0.001, 0.0, 0.0])?;
    /// // To first order the driving yoke adds e sin β at a right angle, and subtracts it half a
    /// // turn later.
    /// let [one, other] = [FRAC_PI_2, -FRAC_PI_2].map(|angle| leaning.motion(angle).angle_error);
    /// assert!((0.5 * (one - other) - 0.001 * 0.2_f64.sin()).abs() < 1e-9);
    /// assert!(General::as_built(&[1.5], &[], &[], &[0.1, 0.0, 0.0]).is_err());
    /// # Ok::<(), cardan::Error>(())
    /// ```
    pub fn as_built(
        bends: &[f64],
        twists: &[f64],
        phases: &[f64],
        deviations: &[f64],
    ) -> Result<Self> {
        check_deviations(bends, deviations)?;
        Ok(Self::of_joints(bends, twists, phases, deviations.as_chunks().0))
    }

    /// The mean over a turn of the sum of the joints' angle errors, each without its value at a
    /// right angle.
    pub(crate) fn mean(&self) -> f64 {
        self.mean
    }

    /// The mean over a turn by which the shaft is ahead of the drive, in rad: the sum of what each
    /// joint's driven angle is ahead of its input angle. The angle of the shaft leaves it out.
    pub fn mean_lead(&self) -> f64 {
        self.mean - self.stages.iter().map(|(_, joint)| joint.lag_at_right_angle()).sum::<f64>()
    }

    /// The transmission of joints as built whose deviations were checked.
    pub(crate) fn of_joints(
        bends: &[f64],
        twists: &[f64],
        phases: &[f64],
        deviations: &[[f64; DEVIATIONS]],
    ) -> Self {
        let turns = phases.iter().zip(twists).map(|(phase, twist)| phase - twist + FRAC_PI_2);
        let turns = std::iter::once((0.0, 1.0)).chain(turns.map(trig::sin_cos));
        let joints = bends.iter().zip(deviations).map(|(&bend, &own)| {
            JointAsBuilt::nearest(&JointAsBuilt::<DoubleDouble>::with_error_terms(bend, own))
        });
        let mut general = Self { stages: turns.zip(joints).collect(), mean: 0.0 };
        general.mean = mean_over_turn(|angle| general.motion(angle).angle_error);
        general
    }

    /// The motion at a drive angle in rad; NaN if it is not finite.
    pub fn motion(&self, angle: f64) -> Motion {
        let (mut s, mut c) = trig::sin_cos(angle);
        let mut total = Motion {
            angle_error: -self.mean,
            speed_ratio: 1.0,
            acceleration_ratio: 0.0,
            jerk_ratio: 0.0,
        };
        for (turn, joint) in &self.stages {
            (s, c) = turned((s, c), *turn);
            let [speed_ratio, acceleration_ratio, jerk_ratio] = joint.rates::<true>(s, c);
            let (y, x) = joint.error_tangent(s, c);
            let angle_error = atan2(y, x);
            let own = Motion { angle_error, speed_ratio, acceleration_ratio, jerk_ratio };
            total = own.compose(&total);
            (s, c) = joint.driven(s, c);
        }
        total
    }
}

/// The mean of a periodic function over a turn by the trapezoidal rule, whose error decreases
/// geometrically. The sums are exact, so that the mean of small numbers keeps its digits.
///
/// The mean of the square tells when there are samples enough. The errors of the function itself
/// nearly cancel where half a turn, or a reflection, nearly changes its sign, and say nothing then.
fn mean_over_turn(error: impl Fn(f64) -> f64) -> f64 {
    const MOST: u32 = 1 << 16;
    /// Twice as many samples square a relative error of this size.
    const SMALL: f64 = 1e-10;
    let mut count = 16;
    let (mut sum, mut squares) = (DoubleDouble::default(), 0.0);
    let mut add = |i: u32, count: u32| {
        let value = error(TAU * f64::from(i) / f64::from(count));
        sum = sum + DoubleDouble::exact(value);
        squares += value * value;
        (sum.value() / f64::from(count), squares / f64::from(count))
    };
    let mut means = (0.0, 0.0);
    for i in 0..count {
        means = add(i, count);
    }
    loop {
        let (_, before) = means;
        // Adds the samples halfway between the previous ones.
        count *= 2;
        for i in (1..count).step_by(2) {
            means = add(i, count);
        }
        let (mean, square) = means;
        if (square - before).abs() <= SMALL * square || count >= MOST {
            return mean;
        }
    }
}

/// Sine and cosine of a sum of angles.
fn turned((s, c): (f64, f64), (by_s, by_c): (f64, f64)) -> (f64, f64) {
    (s * by_c + c * by_s, c * by_c - s * by_s)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// Bend, deviations, drive angle, driven angle, speed ratio and acceleration ratio of single
    /// joints, from a loop of hinges with 40 digits.
    const SINGLE: [(f64, [f64; 3], f64, [f64; 3]); 3] = [
        (
            0.923_366_890_692_588_1,
            [-0.024_022_333_922_090_38, 0.010_354_953_857_299_105, -0.004_682_133_413_021_055_5],
            -1.281_202_984_120_542_8,
            [-1.385_296_015_727_666_8, 0.631_584_044_276_551, 0.229_093_906_900_331_37],
        ),
        (
            0.033_716_396_013_739_33,
            [0.066_831_606_264_465_9, 0.002_773_514_604_070_273_3, 0.001_267_680_539_485_365_6],
            2.769_195_290_178_659,
            [2.767_092_265_376_530_5, 0.998_304_349_254_019, -0.000_011_823_187_934_417_54],
        ),
        (
            0.578_888_741_768_134_9,
            [-0.012_154_218_382_463_895, 0.024_331_603_692_760_55, 0.003_932_507_116_307_048],
            1.564_591_103_667_187_3,
            [1.534_593_625_775_615_2, 0.834_784_896_593_857_5, -0.007_762_917_869_675_064],
        ),
    ];

    #[test]
    fn single_joints_are_those_of_the_loop_of_hinges() {
        for (bend, deviations, angle, [driven, ratio, acceleration]) in SINGLE {
            let joint = General::as_built(&[bend], &[], &[], &deviations).unwrap();
            let motion = joint.motion(angle);
            let found = angle + motion.angle_error + joint.mean_lead();
            assert!((found - driven).abs() < 2e-15, "{bend}: {found}");
            assert!((motion.speed_ratio - ratio).abs() < 2e-15, "{bend}: {motion:?}");
            assert!((motion.acceleration_ratio - acceleration).abs() < 3e-15, "{bend}: {motion:?}");
        }
    }

    #[test]
    fn rates_are_the_slopes_of_the_angle() {
        const STEP: f64 = 1e-3;
        let deviations = [0.02, -0.01, 0.03, -0.015, 0.02, 0.01];
        let chain = General::as_built(&[0.6, 0.9], &[0.4], &[-0.3], &deviations).unwrap();
        for i in 0..40 {
            let angle = 0.17 * f64::from(i);
            let at = |steps: f64| chain.motion(angle + steps * STEP);
            let slope = |of: fn(&Motion) -> f64| {
                let (near, far) = (of(&at(1.0)) - of(&at(-1.0)), of(&at(2.0)) - of(&at(-2.0)));
                (8.0 * near - far) / (12.0 * STEP)
            };
            let motion = chain.motion(angle);
            for (found, wanted) in [
                (motion.speed_ratio, 1.0 + slope(|at| at.angle_error)),
                (motion.acceleration_ratio, slope(|at| at.speed_ratio)),
                (motion.jerk_ratio, slope(|at| at.acceleration_ratio)),
            ] {
                assert!((found - wanted).abs() < 1e-8 * (1.0 + wanted.abs()), "{angle}: {found}");
            }
        }
    }

    #[test]
    fn the_mean_of_the_error_is_zero() {
        let joint = General::as_built(&[0.7], &[], &[], &[0.05, 0.08, -0.04]).unwrap();
        let mean: f64 =
            (0..1000).map(|i| joint.motion(PI * f64::from(i) / 500.0).angle_error).sum();
        assert!(mean.abs() < 1e-13);
    }

    #[test]
    fn joints_that_block_are_refused() {
        let error =
            General::as_built(&[0.1, 1.5], &[0.0], &[0.0], &[0.0, 0.0, 0.0, 0.0, 0.08, 0.0]);
        let message = error.unwrap_err().to_string();
        assert!(message.starts_with("deviations[1] are 0 deg (driving yoke)"), "{message}");
        assert!(message.contains("cannot turn"), "{message}");
    }
}
