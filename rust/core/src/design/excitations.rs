//! Effects of a driveline on its surroundings: the figures that catalogues and practice judge.

use crate::design::records::fill_records;
use crate::input::Drivelines;
use crate::mechanics::chain::{Complex, Equivalent, Transfer, shaft_turn};
use crate::mechanics::joint::Joint;
use crate::number::DoubleDouble;
use crate::number::elementary::norm;
use crate::run::execution::Execution;

/// The excitations of one driveline. Times the square of the speed of the drive they are
/// accelerations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitations {
    /// Equivalent bend of the whole driveline in rad.
    pub bend: f64,
    /// The largest acceleration ratio of the last shaft, which excites torsion.
    pub torsional: f64,
    /// Amplitude of the second order of the acceleration ratios of all intermediate shafts
    /// together, which the inertia of these shafts excites.
    pub inertia_driving: f64,
    /// The same where the output drives.
    pub inertia_coasting: f64,
}

impl Excitations {
    /// The number of fields.
    pub const COUNT: usize = 4;

    /// From `n` bends, `n − 1` twists and `n − 1` phases in rad.
    ///
    /// Practice sums `(n − i) β_i²` with signs over the joints `i`: every joint shakes each
    /// intermediate shaft behind it. In space the parts add as vectors, and `4 |q|` is the exact
    /// amplitude of the second order of a shaft's acceleration ratio where practice writes `β²`.
    ///
    /// ```
    /// // Two equal bends, compensated: only the shaft between them is shaken.
    /// let half_turn = std::f64::consts::FRAC_PI_2;
    /// let found = cardan::Excitations::of_chain(&[0.1, 0.1], &[half_turn], &[half_turn]);
    /// assert!((found.inertia_driving - 0.01).abs() < 2e-5);
    /// assert_eq!(found.inertia_driving, found.inertia_coasting);
    /// ```
    pub fn of_chain(bends: &[f64], twists: &[f64], phases: &[f64]) -> Self {
        let constants = |&bend: &f64| {
            let joint = Joint::with_error_terms(bend);
            (joint.k, joint.complement())
        };
        let joints: Vec<_> = bends.iter().map(constants).collect();
        let turns: Vec<_> =
            phases.iter().zip(twists).map(|(&phase, &twist)| shaft_turn(phase, twist)).collect();
        let (last, inertia_driving) = carried(joints.iter(), turns.iter());
        let (_, inertia_coasting) = carried(joints.iter().rev(), turns.iter().rev());
        let Equivalent { joint, .. } = Equivalent::of_transfer(&last, bends);
        Self {
            bend: joint.bend(),
            torsional: joint.max_acceleration_ratio(),
            inertia_driving,
            inertia_coasting,
        }
    }
}

/// The map of a chain with joints of these `k` and `1 − k²`, and `4 |Σ q|` over its intermediate
/// shafts.
fn carried<'a>(
    joints: impl Iterator<Item = &'a (DoubleDouble, DoubleDouble)>,
    mut turns: impl Iterator<Item = &'a Complex>,
) -> (Transfer, f64) {
    let mut transfer = Transfer::default();
    let mut sum = nalgebra::Complex::default();
    for &(k, complement) in joints {
        transfer.pass(k, complement);
        if let Some(&turn) = turns.next() {
            sum += transfer.q();
            transfer.pass_shaft(turn);
        }
    }
    (transfer, 4.0 * norm(sum))
}

/// The excitations of every driveline of a batch with `joints` joints each, as records of
/// [`Excitations::COUNT`] numbers in the order of the fields.
pub fn excitations_of_batch(
    joints: usize,
    lines: &Drivelines<'_>,
    out: &mut [f64],
    execution: Execution<'_>,
) {
    fill_records(Excitations::COUNT, out, execution, |line, record| {
        let (bends, twists, phases) = lines.chain(joints, line);
        let Excitations { bend, torsional, inertia_driving, inertia_coasting } =
            Excitations::of_chain(bends, twists, phases);
        record.copy_from_slice(&[bend, torsional, inertia_driving, inertia_coasting]);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::transmission::Ideal;

    const CHAINS: [(&[f64], &[f64], &[f64]); 5] = [
        (&[0.5], &[], &[]),
        (&[0.3, 0.2], &[0.4], &[-1.1]),
        (&[0.17, 0.0, 0.4, 0.3], &[0.3, 2.0, -0.7], &[1.0, 0.2, 0.9]),
        (&[1.3, 0.9, 1.5], &[-0.5, 0.1], &[0.8, 7.0]),
        (&[0.0, 1e-200], &[-0.5], &[0.8]),
    ];

    /// The second order of the summed accelerations of the intermediate shafts, from samples.
    fn second_order(bends: &[f64], twists: &[f64], phases: &[f64]) -> f64 {
        let count = 4096;
        let (mut cosine, mut sine) = (0.0, 0.0);
        for shaft in 1..bends.len() {
            let between = shaft - 1;
            let ideal = Ideal::of_chain(&bends[..shaft], &twists[..between], &phases[..between]);
            for i in 0..count {
                let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
                let ratio = ideal.motion(angle).acceleration_ratio;
                cosine += ratio * (2.0 * angle).cos();
                sine += ratio * (2.0 * angle).sin();
            }
        }
        2.0 * cosine.hypot(sine) / f64::from(count)
    }

    #[test]
    fn intermediate_shafts_shake_with_the_second_order() {
        for (bends, twists, phases) in CHAINS {
            let found = Excitations::of_chain(bends, twists, phases);
            let expected = second_order(bends, twists, phases);
            assert!(
                (found.inertia_driving - expected).abs() < 1e-12 * (1.0 + expected),
                "{bends:?}"
            );
            let turned = |of: &[f64]| of.iter().rev().copied().collect::<Vec<_>>();
            let expected = second_order(&turned(bends), &turned(twists), &turned(phases));
            let found = found.inertia_coasting;
            assert!((found - expected).abs() < 1e-12 * (1.0 + expected), "{bends:?}");
        }
    }

    #[test]
    fn the_last_shaft_is_that_of_the_equivalent_joint() {
        for (bends, twists, phases) in CHAINS {
            let found = Excitations::of_chain(bends, twists, phases);
            let joint = Equivalent::of_chain(bends, twists, phases).joint;
            assert_eq!(found.bend, joint.bend());
            assert_eq!(found.torsional, joint.max_acceleration_ratio());
        }
    }

    #[test]
    fn a_batch_is_its_drivelines() {
        let bends: Vec<f64> = (0..6000).map(|i| 1e-4 * f64::from(i)).collect();
        let (twists, phases) = (vec![0.3; 3000], vec![-0.7; 3000]);
        let lines =
            Drivelines { bends: &bends, twists: &twists, phases: &phases, ..Drivelines::default() };
        let mut out = vec![0.0; 3000 * Excitations::COUNT];
        excitations_of_batch(2, &lines, &mut out, Execution::default());
        for (record, bends) in out.chunks(4).zip(bends.chunks(2)) {
            let one = Excitations::of_chain(bends, &[0.3], &[-0.7]);
            let fields = [one.bend, one.torsional, one.inertia_driving, one.inertia_coasting];
            assert_eq!(record, fields);
        }
    }
}
