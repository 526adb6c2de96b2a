//! Periodic orbits by collocation: Newton's method on all intervals of half a turn at once.
//!
//! On every interval the second derivatives are polynomials through the collocation points, and so
//! are the slopes. The linearised equations of an interval are condensed to a map from the state at its start to that
//! at its end; the product of the maps closes the orbit, and its eigenvalues are the Floquet
//! multipliers. Work grows linearly with the number of intervals.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use crate::dynamics::gauss::{COLLOCATION, Collocation, STAGES};
use crate::dynamics::motion_equation::{EquationRow, MotionEquation};

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

/// A periodic orbit on a mesh of half a turn: the unknowns at the start of every interval and
/// their second derivatives at the collocation points.
#[derive(Clone, Debug)]
pub(super) struct Orbit {
    pub(super) unknowns: usize,
    pub(super) intervals: usize,
    /// Unknowns and slopes at the start of each interval, `(intervals, 2, unknowns)`.
    states: Vec<f64>,
    /// `(intervals, STAGES, unknowns)`.
    accelerations: Vec<f64>,
    /// The linear map of half a turn about the orbit, on unknowns and slopes.
    pub(super) monodromy: DMatrix<f64>,
}

/// A step of Newton's method.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewtonStep {
    /// The largest change of an unknown in rad.
    pub(super) change: f64,
    /// The largest twist before the step of the compliant shaft that twists least, in rad: the unit
    /// of errors.
    pub(super) twist: f64,
}

/// The linearised equations of one interval, solved for the accelerations: `constant + by_state ·
/// change of the state`.
struct Condensed {
    solution: DMatrix<f64>,
}

impl Orbit {
    /// A mesh with unknowns, slopes and second derivatives given as functions of the drive angle.
    pub(super) fn start(
        unknowns: usize,
        intervals: usize,
        mut at: impl FnMut(f64, [&mut [f64]; 3]),
    ) -> Self {
        let mut states = vec![0.0; 2 * intervals * unknowns];
        let mut accelerations = vec![0.0; intervals * STAGES * unknowns];
        let width = PI / intervals as f64;
        let (mut y, mut v) = (vec![0.0; unknowns], vec![0.0; unknowns]);
        for (k, state) in states.chunks_mut(2 * unknowns).enumerate() {
            let (position, slope) = state.split_at_mut(unknowns);
            at(width * k as f64, [position, slope, &mut y]);
            let stages = accelerations[k * STAGES * unknowns..].chunks_mut(unknowns);
            for (node, stage) in COLLOCATION.nodes.iter().zip(stages) {
                at(width * (k as f64 + node), [&mut y, &mut v, stage]);
            }
        }
        let monodromy = DMatrix::zeros(0, 0);
        Self { unknowns, intervals, states, accelerations, monodromy }
    }

    /// Length of an interval in rad.
    pub(super) fn width(&self) -> f64 {
        PI / self.intervals as f64
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
        let pairs = self.states.iter().zip(&other.states).take(2 * self.unknowns);
        pairs.into_iter().any(|(x, y)| (x - y).abs() > by)
    }

    fn stages(&self, interval: usize) -> &[f64] {
        let size = STAGES * self.unknowns;
        &self.accelerations[interval * size..][..size]
    }

    /// Position and slope within an interval by the contributions of its stages.
    fn within(
        &self,
        interval: usize,
        [time, width]: [f64; 2],
        [to_position, to_speed]: [&[f64; STAGES]; 2],
        [y, v]: [&mut [f64]; 2],
    ) {
        let m = self.unknowns;
        let (position, slope) = self.state(interval);
        let stages = self.stages(interval);
        let sum = |weights: &[f64; STAGES], u: usize| -> f64 {
            weights.iter().enumerate().map(|(j, weight)| weight * stages[j * m + u]).sum()
        };
        for (u, (y, v)) in y.iter_mut().zip(v).enumerate() {
            *y = position[u] + width * (time * slope[u] + width * sum(to_position, u));
            *v = slope[u] + width * sum(to_speed, u);
        }
    }

    /// The same curve on intervals of half the length.
    pub(super) fn halved(&self) -> Self {
        let m = self.unknowns;
        let width = self.width();
        let rule: &Collocation = &COLLOCATION;
        let mut states = Vec::with_capacity(2 * self.states.len());
        let mut accelerations = Vec::with_capacity(2 * self.accelerations.len());
        let mut middle = vec![0.0; 2 * m];
        for k in 0..self.intervals {
            states.extend_from_slice(&self.states[2 * k * m..][..2 * m]);
            let (y, v) = middle.split_at_mut(m);
            self.within(k, [0.5, width], [&rule.middle_position, &rule.middle_speed], [y, v]);
            states.extend_from_slice(&middle);
            let stages = self.stages(k);
            for row in rule.halves.iter().flatten() {
                let value = |u| (0..STAGES).map(|j| row[j] * stages[j * m + u]).sum::<f64>();
                accelerations.extend((0..m).map(value));
            }
        }
        Self {
            intervals: 2 * self.intervals,
            states,
            accelerations,
            monodromy: DMatrix::zeros(0, 0),
            ..*self
        }
    }

    /// One step of Newton's method; `None` if the linear equations have no solution.
    pub(super) fn improve(&mut self, equation: &mut MotionEquation<'_>) -> Option<NewtonStep> {
        let m = self.unknowns;
        let mut product = DMatrix::<f64>::identity(2 * m, 2 * m);
        let mut constant = DVector::<f64>::zeros(2 * m);
        let mut maps = Vec::with_capacity(self.intervals);
        let mut scratch = OrbitScratch::new(m);
        for k in 0..self.intervals {
            let condensed = self.condense(k, equation, &mut scratch)?;
            let (map, defect) = self.transfer(k, &condensed, &mut scratch);
            product = &map * product;
            constant = &map * constant + &defect;
            maps.push((condensed, map, defect));
        }
        let closing = DMatrix::<f64>::identity(2 * m, 2 * m) - &product;
        self.monodromy = product;
        let mut change = closing.lu().solve(&constant)?;
        if !change.iter().all(|x| x.is_finite()) {
            return None;
        }
        let changes: Vec<DVector<f64>> = maps
            .iter()
            .map(|(_, map, defect)| {
                let next = map * &change + defect;
                std::mem::replace(&mut change, next)
            })
            .collect();
        let largest = |most: f64, x: &f64| x.abs().max(most);
        let size = changes.iter().flat_map(|dz| dz.iter().take(m)).fold(0.0, largest);
        // No step turns a shaft by more than half a radian, where the joints' curves bend.
        let damped = (0.5 / size).min(1.0);
        for (k, ((condensed, ..), change)) in maps.iter().zip(&changes).enumerate() {
            let stages = &mut self.accelerations[k * STAGES * m..][..STAGES * m];
            for (i, stage) in stages.iter_mut().enumerate() {
                let by_state: f64 =
                    (0..2 * m).map(|c| condensed.solution[(i, c)] * change[c]).sum();
                *stage += damped * (condensed.solution[(i, 2 * m)] + by_state);
            }
            for (x, dx) in self.states[2 * k * m..][..2 * m].iter_mut().zip(change.iter()) {
                *x += damped * dx;
            }
        }
        let springs = equation.system.springs.iter().zip(&scratch.torques);
        let twist = springs.map(|(spring, torque)| torque / spring.stiffness);
        let twist = twist.fold(f64::INFINITY, f64::min);
        size.is_finite().then_some(NewtonStep { change: size, twist })
    }

    /// Solves the linearised equations of an interval for the changes of its accelerations.
    fn condense(
        &self,
        interval: usize,
        equation: &mut MotionEquation<'_>,
        scratch: &mut OrbitScratch,
    ) -> Option<Condensed> {
        let m = self.unknowns;
        let width = self.width();
        let rule: &Collocation = &COLLOCATION;
        let mut matrix = DMatrix::<f64>::zeros(STAGES * m, STAGES * m);
        // By the state at the start, then the constant.
        let mut right = DMatrix::<f64>::zeros(STAGES * m, 2 * m + 1);
        let stages = self.stages(interval);
        for (i, &node) in rule.nodes.iter().enumerate() {
            let weights = [&rule.position[i], &rule.speed[i]];
            let (y, v) = scratch.state.split_at_mut(m);
            self.within(interval, [node, width], weights, [y, v]);
            let angle = width * (interval as f64 + node);
            equation.rows(angle, [y, v, &stages[i * m..][..m]], &mut scratch.rows);
            for (most, torque) in scratch.torques.iter_mut().zip(equation.last_torques()) {
                *most = most.max(torque.abs());
            }
            for (s, row) in scratch.rows.iter().enumerate() {
                let at = i * m + s;
                // The rows differ by orders of magnitude between stiff and soft shafts.
                let scale = 1.0 / row.by_acceleration;
                matrix[(at, at)] += 1.0;
                right[(at, 2 * m)] = -scale * row.residual;
                for (c, (by_angle, by_slope)) in row.by_angle.iter().zip(row.by_slope).enumerate() {
                    let Some(u) = (s + c).checked_sub(1).filter(|&u| u < m) else { continue };
                    let (by_angle, by_slope) = (scale * by_angle, scale * by_slope);
                    right[(at, u)] = -by_angle;
                    right[(at, m + u)] = -(width * node * by_angle + by_slope);
                    let weights = rule.position[i].iter().zip(rule.speed[i]);
                    for (j, (position, speed)) in weights.enumerate() {
                        matrix[(at, j * m + u)] +=
                            width * (width * position * by_angle + speed * by_slope);
                    }
                }
            }
        }
        matrix.lu().solve_mut(&mut right).then_some(Condensed { solution: right })
    }

    /// The map of an interval on changes of its state, and its defect at the end.
    fn transfer(
        &self,
        interval: usize,
        condensed: &Condensed,
        scratch: &mut OrbitScratch,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let m = self.unknowns;
        let width = self.width();
        let rule: &Collocation = &COLLOCATION;
        let (y, v) = scratch.state.split_at_mut(m);
        self.within(interval, [1.0, width], [&rule.end_position, &rule.end_speed], [y, v]);
        let (position, slope) = self.state((interval + 1) % self.intervals);
        let sum = |weights: &[f64; STAGES], u: usize, c: usize| -> f64 {
            (0..STAGES).map(|j| weights[j] * condensed.solution[(j * m + u, c)]).sum()
        };
        let entry = |row: usize, c: usize| {
            if row < m {
                width * width * sum(&rule.end_position, row, c)
            } else {
                width * sum(&rule.end_speed, row - m, c)
            }
        };
        let map = DMatrix::from_fn(2 * m, 2 * m, |row, c| {
            let drift = if row + m == c { width } else { 0.0 };
            f64::from(row == c) + drift + entry(row, c)
        });
        let defect = DVector::from_fn(2 * m, |row, _| {
            let gap = if row < m { y[row] - position[row] } else { v[row - m] - slope[row - m] };
            gap + entry(row, 2 * m)
        });
        (map, defect)
    }
}

/// Memory that the intervals share.
struct OrbitScratch {
    state: Vec<f64>,
    rows: Vec<EquationRow>,
    /// The largest torque of every compliant shaft.
    torques: Vec<f64>,
}

impl OrbitScratch {
    fn new(unknowns: usize) -> Self {
        Self {
            state: vec![0.0; 2 * unknowns],
            rows: vec![EquationRow::default(); unknowns],
            torques: vec![0.0; unknowns],
        }
    }
}
