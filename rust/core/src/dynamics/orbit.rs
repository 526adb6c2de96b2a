//! Periodic orbits by collocation: Newton's method on all intervals of half a turn at once.
//!
//! On every interval the second derivatives are polynomials through the collocation points, and so
//! are the slopes. The linearised equations of an interval are condensed to a map from the state at its start to that
//! at its end; the product of the maps closes the orbit, and its eigenvalues are the Floquet
//! multipliers. Work grows linearly with the number of intervals.

use std::cmp::Ordering;
use std::f64::consts::PI;
use std::ops::AddAssign;

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
    /// The change of the parameter, if one changes.
    pub(super) parameter: f64,
}

/// A parameter of the equations that changes together with an orbit.
pub(super) struct Along<'a, 'b> {
    /// The equations with the parameter larger by `by`.
    pub(super) nearby: &'a mut MotionEquation<'b>,
    pub(super) by: f64,
    /// The direction in which both change by a given length: of the state at drive angle 0, then of
    /// the parameter.
    pub(super) direction: &'a [f64],
    pub(super) length: f64,
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
            monodromy: DMatrix::zeros(0, 0),
            ..*self
        }
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
    pub(super) fn improve(
        &mut self,
        equation: &mut MotionEquation<'_>,
        mut along: Option<Along<'_, '_>>,
    ) -> Option<NewtonStep> {
        let m = self.unknowns;
        // By the state at drive angle 0, then the constant, then by the parameter.
        let columns = 2 * m + 1 + usize::from(along.is_some());
        let mut product = DMatrix::<f64>::identity(2 * m, columns);
        let mut maps = Vec::with_capacity(self.intervals);
        let mut scratch = OrbitScratch::new(m);
        for k in 0..self.intervals {
            let condensed = self.condense(k, equation, along.as_mut(), &mut scratch)?;
            let map = self.transfer(k, &condensed, &mut scratch);
            product = map.columns(0, 2 * m) * &product;
            for c in 2 * m..columns {
                product.column_mut(c).add_assign(&map.column(c));
            }
            maps.push((condensed, map));
        }
        self.monodromy = product.columns(0, 2 * m).into_owned();
        // Without the column of the constant, which is the right side.
        let mut closing = -product.clone().remove_column(2 * m);
        let mut right = product.column(2 * m).into_owned();
        for i in 0..2 * m {
            closing[(i, i)] += 1.0;
        }
        if let Some(Along { direction, length, .. }) = along {
            closing = closing.insert_row(2 * m, 0.0);
            closing.row_mut(2 * m).copy_from_slice(direction);
            right = right.insert_row(2 * m, length);
        }
        let solved = closing.lu().solve(&right)?;
        if !solved.iter().all(|x| x.is_finite()) {
            return None;
        }
        let parameter = solved.get(2 * m).copied().unwrap_or_default();
        // The change of the state, the factor of the constant, and the change of the parameter.
        let mut change = solved.insert_row(2 * m, 1.0);
        let changes: Vec<DVector<f64>> = maps
            .iter()
            .map(|(_, map)| {
                let (next, own) = (map * &change, change.clone());
                change.rows_mut(0, 2 * m).copy_from(&next);
                own
            })
            .collect();
        let largest = |most: f64, x: &f64| x.abs().max(most);
        let size = changes.iter().flat_map(|dz| dz.iter().take(m)).fold(0.0, largest);
        // No step turns a shaft by more than half a radian, where the joints' curves bend.
        let damped = (0.5 / size).min(1.0);
        for (k, ((condensed, _), change)) in maps.iter().zip(&changes).enumerate() {
            let stages = &mut self.accelerations[k * STAGES * m..][..STAGES * m];
            for (i, stage) in stages.iter_mut().enumerate() {
                *stage += damped * condensed.row(i).transpose().dot(change);
            }
            for (x, dx) in self.states[2 * k * m..][..2 * m].iter_mut().zip(change.iter()) {
                *x += damped * dx;
            }
        }
        let springs = equation.system.springs.iter().zip(&scratch.torques);
        let twist = springs.map(|(spring, torque)| torque / spring.stiffness);
        let twist = twist.fold(f64::INFINITY, f64::min);
        let parameter = damped * parameter;
        size.is_finite().then_some(NewtonStep { change: size, twist, parameter })
    }

    /// The linearised equations of an interval, solved for the changes of its accelerations: by the
    /// state at its start, the constant, by the parameter.
    fn condense(
        &self,
        interval: usize,
        equation: &mut MotionEquation<'_>,
        mut along: Option<&mut Along<'_, '_>>,
        scratch: &mut OrbitScratch,
    ) -> Option<DMatrix<f64>> {
        let m = self.unknowns;
        let width = self.width();
        let rule: &Collocation = &COLLOCATION;
        let mut matrix = DMatrix::<f64>::zeros(STAGES * m, STAGES * m);
        let columns = 2 * m + 1 + usize::from(along.is_some());
        let mut right = DMatrix::<f64>::zeros(STAGES * m, columns);
        let stages = self.stages(interval);
        for (i, &node) in rule.nodes.iter().enumerate() {
            let weights = [&rule.position[i], &rule.speed[i]];
            let (y, v) = scratch.state.split_at_mut(m);
            self.within(interval, [node, width], weights, [y, v]);
            let angle = width * (interval as f64 + node);
            let at = [&*y, &*v, &stages[i * m..][..m]];
            equation.rows(angle, at, &mut scratch.rows);
            if let Some(Along { nearby, .. }) = &mut along {
                nearby.rows(angle, at, &mut scratch.nearby);
            }
            for (most, torque) in scratch.torques.iter_mut().zip(equation.last_torques()) {
                *most = most.max(torque.abs());
            }
            for (s, row) in scratch.rows.iter().enumerate() {
                let at = i * m + s;
                // The rows differ by orders of magnitude between stiff and soft shafts.
                let scale = 1.0 / row.by_acceleration;
                matrix[(at, at)] += 1.0;
                right[(at, 2 * m)] = -scale * row.residual;
                if let Some(Along { by, .. }) = along {
                    let change = scratch.nearby[s].residual - row.residual;
                    right[(at, 2 * m + 1)] = -scale * change / *by;
                }
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
        matrix.lu().solve_mut(&mut right).then_some(right)
    }

    /// The change of the state at the end of an interval by that at its start, by its defect and by
    /// the parameter.
    fn transfer(
        &self,
        interval: usize,
        condensed: &DMatrix<f64>,
        scratch: &mut OrbitScratch,
    ) -> DMatrix<f64> {
        let m = self.unknowns;
        let width = self.width();
        let rule: &Collocation = &COLLOCATION;
        let (y, v) = scratch.state.split_at_mut(m);
        self.within(interval, [1.0, width], [&rule.end_position, &rule.end_speed], [y, v]);
        let (position, slope) = self.state((interval + 1) % self.intervals);
        let sum = |weights: &[f64; STAGES], u: usize, c: usize| -> f64 {
            (0..STAGES).map(|j| weights[j] * condensed[(j * m + u, c)]).sum()
        };
        let entry = |row: usize, c: usize| {
            if row < m {
                width * width * sum(&rule.end_position, row, c)
            } else {
                width * sum(&rule.end_speed, row - m, c)
            }
        };
        DMatrix::from_fn(2 * m, condensed.ncols(), |row, c| {
            let moved = match c.cmp(&(2 * m)) {
                Ordering::Less if row + m == c => width,
                Ordering::Less => f64::from(row == c),
                Ordering::Equal if row < m => y[row] - position[row],
                Ordering::Equal => v[row - m] - slope[row - m],
                Ordering::Greater => 0.0,
            };
            moved + entry(row, c)
        })
    }
}

/// Memory that the intervals share.
struct OrbitScratch {
    state: Vec<f64>,
    rows: Vec<EquationRow>,
    /// The equations with another parameter.
    nearby: Vec<EquationRow>,
    /// The largest torque of every compliant shaft.
    torques: Vec<f64>,
}

impl OrbitScratch {
    fn new(unknowns: usize) -> Self {
        Self {
            state: vec![0.0; 2 * unknowns],
            rows: vec![EquationRow::default(); unknowns],
            nearby: vec![EquationRow::default(); unknowns],
            torques: vec![0.0; unknowns],
        }
    }
}
