//! A periodic orbit on a mesh of one period.

use std::f64::consts::PI;

use crate::dynamics::gauss::{COLLOCATION, STAGES};

/// Why there is no orbit at a speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The speed is not a positive finite number.
    Speed,
    /// Newton's method found no periodic orbit from any start.
    NotFound,
    /// The orbit needs more intervals than are allowed.
    NotResolved,
}

/// The unknowns at the start of every interval and their second derivatives at the collocation
/// points.
#[derive(Clone, Debug, Default)]
pub(super) struct Orbit {
    pub(super) unknowns: usize,
    pub(super) intervals: usize,
    /// Half turns of the drive in a period.
    pub(super) half_turns: usize,
    /// The mean torque of a free drive in N m.
    pub(super) mean_torque: f64,
    /// Unknowns and slopes at the start of each interval, `(intervals, 2, unknowns)`.
    pub(super) states: Vec<f64>,
    /// `(intervals, STAGES, unknowns)`.
    pub(super) accelerations: Vec<f64>,
    /// The linear map of a period about the orbit, on unknowns and slopes, row by row.
    pub(super) monodromy: Vec<f64>,
    /// Where kinks make sums over the mesh converge slowly.
    pub(super) quadrature: Option<Box<Quadrature>>,
}

/// States of an orbit whose weighted sums are integrals over the period.
#[derive(Clone, Debug, Default)]
pub(super) struct Quadrature {
    /// Drive angles in rad, and the weights, which add up to the period.
    pub(super) nodes: Vec<[f64; 2]>,
    /// Unknowns and slopes, `(nodes, 2, unknowns)`.
    pub(super) states: Vec<f64>,
}

impl Orbit {
    /// Uniform rotation.
    pub(super) fn at_rest(unknowns: usize, intervals: usize, half_turns: usize) -> Self {
        let mut orbit = Self { half_turns, ..Self::default() };
        orbit.resize(unknowns, intervals);
        orbit
    }

    /// A mesh with unknowns, slopes and second derivatives given as functions of the drive angle,
    /// which may leave zeros.
    pub(super) fn start(
        unknowns: usize,
        (intervals, half_turns): (usize, usize),
        mut at: impl FnMut(f64, [&mut [f64]; 3]),
    ) -> Self {
        let mut orbit = Self::at_rest(unknowns, intervals, half_turns);
        let width = orbit.width();
        let (mut y, mut v) = (vec![0.0; unknowns], vec![0.0; unknowns]);
        for (k, state) in orbit.states.chunks_mut(2 * unknowns).enumerate() {
            let (position, slope) = state.split_at_mut(unknowns);
            at(width * k as f64, [position, slope, &mut y]);
            let stages = orbit.accelerations[k * STAGES * unknowns..].chunks_mut(unknowns);
            for (node, stage) in COLLOCATION.nodes.iter().zip(stages) {
                at(width * (k as f64 + node), [&mut y, &mut v, stage]);
            }
        }
        orbit
    }

    /// Makes room for another mesh.
    pub(super) fn resize(&mut self, unknowns: usize, intervals: usize) {
        (self.unknowns, self.intervals) = (unknowns, intervals);
        self.states.resize(2 * intervals * unknowns, 0.0);
        self.accelerations.resize(intervals * STAGES * unknowns, 0.0);
    }

    /// Length of an interval in rad.
    pub(super) fn width(&self) -> f64 {
        PI * self.half_turns as f64 / self.intervals as f64
    }

    /// Unknowns and slopes at the start of an interval.
    pub(super) fn state(&self, interval: usize) -> (&[f64], &[f64]) {
        let m = self.unknowns;
        self.states[2 * interval * m..][..2 * m].split_at(m)
    }

    /// The largest slope at the ends of the intervals.
    pub(super) fn largest_slope(&self) -> f64 {
        let slopes = (0..self.intervals).flat_map(|k| self.state(k).1);
        slopes.fold(0.0, |most, slope| most.max(slope.abs()))
    }

    /// Whether the states at drive angle 0 differ by more than this, in rad and in slopes.
    pub(super) fn differs(&self, other: &Self, by: f64) -> bool {
        self.first_state_minus(other).iter().any(|difference| difference.abs() > by)
    }

    /// The state at drive angle 0, unknowns and slopes, without that of another orbit.
    pub(super) fn first_state_minus(&self, other: &Self) -> Vec<f64> {
        let pairs = self.states.iter().zip(&other.states).take(2 * self.unknowns);
        pairs.map(|(x, y)| x - y).collect()
    }

    /// The orbit at a part of the way to another one.
    pub(super) fn towards(&self, other: &Self, part: f64) -> Self {
        let line = |here: &[f64], there: &[f64]| -> Vec<f64> {
            here.iter().zip(there).map(|(x, y)| part.mul_add(y - x, *x)).collect()
        };
        Self {
            states: line(&self.states, &other.states),
            accelerations: line(&self.accelerations, &other.accelerations),
            mean_torque: part.mul_add(other.mean_torque - self.mean_torque, self.mean_torque),
            monodromy: vec![],
            quadrature: None,
            ..*self
        }
    }

    /// The largest differences of unknowns, in rad, and of slopes from an orbit on intervals of half
    /// the length, at the points that both meshes share.
    pub(super) fn differences(&self, fine: &Self) -> [f64; 2] {
        let largest = |x: &[f64], y: &[f64]| -> f64 {
            x.iter().zip(y).fold(0.0, |most, (x, y)| most.max((x - y).abs()))
        };
        (0..self.intervals).fold([0.0, 0.0], |[angles, slopes]: [f64; 2], k| {
            let (near, exact) = (self.state(k), fine.state(2 * k));
            [angles.max(largest(near.0, exact.0)), slopes.max(largest(near.1, exact.1))]
        })
    }
}
