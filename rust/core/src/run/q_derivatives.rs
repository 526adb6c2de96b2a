//! The derivatives of `q` for a batch of drivelines, on several threads.

use nalgebra::Complex;

use crate::input::Drivelines;
use crate::mechanics::derivatives::{ChainGradient, ChainMaps, Layout, Map, by_points};
use crate::mechanics::phasing::is_set;
use crate::run::execution::Execution;
use crate::run::queue::{threads, work_off};

/// The fewest drivelines that use threads.
const MIN_PARALLEL: usize = 1024;

/// The parameters of a driveline by which its motion is differentiated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameters {
    /// The bend of each joint.
    Bends,
    /// The twist of each intermediate shaft.
    Twists,
    /// The phase of each intermediate shaft.
    Phases,
    /// The coordinates of both ends and of the joint centres, three per point.
    Points,
}

impl Parameters {
    /// The number of parameters of a driveline with so many joints.
    pub fn count(self, joints: usize) -> usize {
        match self {
            Self::Bends => joints,
            Self::Twists | Self::Phases => joints - 1,
            Self::Points => 3 * (joints + 2),
        }
    }
}

/// The derivatives of `q` of a shaft of every driveline by all parameters of a kind, per driveline
/// [`Parameters::count`] numbers of `out`. Those of joints behind the shaft are zero.
///
/// Points need the lengths of the shafts.
pub fn q_derivatives(
    joints: usize,
    shaft: usize,
    by: Parameters,
    lines: &Drivelines<'_>,
    out: &mut [Complex<f64>],
    execution: Execution<'_>,
) {
    let count = by.count(joints);
    if count == 0 {
        return;
    }
    let threads = threads(out.len() / count >= MIN_PARALLEL, execution.workers);
    let each = |(): &mut (), (line, out): (usize, &mut [Complex<f64>])| {
        if is_set(execution.stop) {
            return;
        }
        let between = shaft.saturating_sub(1);
        let of = |array: &'_ [f64], each: usize, used: usize| {
            array[line * each..line * each + used].to_vec()
        };
        let chain = ChainMaps::new(
            &of(lines.bends, joints, shaft),
            &of(lines.twists, joints - 1, between),
            &of(lines.phases, joints - 1, between),
        );
        let layout = || Layout {
            directions: &lines.directions[line * 3 * (joints + 1)..],
            normals: &lines.normals[line * 3 * joints..],
            lengths: &lines.lengths[line * (joints + 1)..(line + 1) * (joints + 1)],
        };
        let part = |weight: Complex<f64>| -> Vec<f64> {
            let mut adjoints = vec![Map::default(); shaft + 1];
            adjoints[shaft] = chain.adjoint_of_q(shaft, weight);
            match by {
                Parameters::Points => {
                    let layout = layout();
                    let points = by_points(&chain.by_directions(&adjoints, layout), layout);
                    points.iter().flat_map(|v| v.iter().copied()).collect()
                }
                Parameters::Bends => chain.gradient(&adjoints).bends,
                Parameters::Phases => chain.gradient(&adjoints).phases,
                Parameters::Twists => {
                    let ChainGradient { phases, .. } = chain.gradient(&adjoints);
                    phases.into_iter().map(|x| -x).collect()
                }
            }
        };
        out.fill(Complex::default());
        // The real part, and the imaginary part as the real part of −i q.
        let parts = [Complex::new(1.0, 0.0), Complex::new(0.0, -1.0)].map(part);
        for ((derivative, &re), &im) in out.iter_mut().zip(&parts[0]).zip(&parts[1]) {
            *derivative = Complex::new(re, im);
        }
    };
    work_off(out.chunks_mut(count).enumerate(), threads, || (), each);
}
