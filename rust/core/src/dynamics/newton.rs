//! Periodic orbits by collocation: a step of Newton's method on all intervals of a period at once,
//! for several runs side by side.
//!
//! On every interval the second derivatives are polynomials through the collocation points, and so
//! are the slopes. The linearised equations of an interval are condensed to a map from the state at
//! its start to that at its end; the product of the maps closes the orbit, and its eigenvalues are
//! the Floquet multipliers. Work grows linearly with the number of intervals.
//!
//! The orbit of a free drive may begin anywhere: its mean torque is one more unknown, and that the
//! mean of the drive's angle error is zero one more equation.
#![allow(clippy::needless_range_loop, reason = "as in the kernels")]

use std::f64::consts::PI;

use crate::dynamics::gauss::{COLLOCATION, Collocation, STAGES};
use crate::dynamics::lanes::{LANES, Lanes, Pack, ZERO, all, make_room};
use crate::dynamics::orbit::Orbit;

/// Equations of the second order whose unknowns are coupled with their neighbours, in every lane.
pub(super) trait Equations {
    /// The equations at a drive angle, with unknowns, slopes and second derivatives.
    fn rows(&mut self, lanes: Lanes, angle: f64, state: [&[Pack]; 3], rows: &mut [EquationRow]);

    /// The unit of errors of the unknowns, from the rows since the last call.
    fn unit(&mut self, lanes: Lanes) -> Pack;

    /// Whether the first unknown is the angle of a free drive, whose mean torque is unknown.
    fn is_free(&self) -> bool;

    /// Takes the mean torque of a free drive in N m.
    fn set_mean_torque(&mut self, torque: &Pack);
}

/// An equation and its derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EquationRow {
    /// Residual of the equation.
    pub(super) residual: Pack,
    /// Derivative by the unknown's own second derivative.
    pub(super) by_acceleration: Pack,
    /// Derivatives by the slopes of the unknown before, of the unknown itself and of the one behind.
    pub(super) by_slope: [Pack; 3],
    /// Derivatives by these unknowns themselves.
    pub(super) by_angle: [Pack; 3],
}

/// A step of Newton's method.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewtonStep {
    /// The largest change of an unknown in rad.
    pub(super) change: f64,
    /// The unit of errors before the step, in rad: the largest twist of the compliant shaft that
    /// twists least.
    pub(super) unit: f64,
    /// The change of the parameter, if one changes.
    pub(super) parameter: f64,
}

/// A parameter of the equations that changes together with an orbit.
pub(super) struct Along<'a, E> {
    /// The equations with the parameter larger by `by`.
    pub(super) nearby: &'a mut E,
    pub(super) by: f64,
    /// The direction in which both change by a given length: of the state at drive angle 0, then of
    /// the parameter.
    pub(super) direction: &'a [f64],
    pub(super) length: f64,
}

/// The memory of a step.
#[derive(Debug, Default)]
pub(super) struct Newton {
    /// Unknowns and slopes at the start of each interval, `(intervals, 2, unknowns)`.
    pub(super) states: Vec<Pack>,
    /// Second derivatives at the collocation points, `(intervals, STAGES, unknowns)`.
    pub(super) accelerations: Vec<Pack>,
    /// Mean torque of a free drive, in N m.
    pub(super) mean_torque: Pack,
    /// Half turns of the drive in a period.
    pub(super) half_turns: usize,
    /// Their changes by the state at the start of the interval, by the constant and by the
    /// parameter, `(intervals, STAGES · unknowns, columns)`.
    pub(super) condensed: Vec<Pack>,
    /// Gaps between the end of each interval and the next one, then changes of the states.
    defects: Vec<Pack>,
    /// The maps of the intervals so far, multiplied.
    pub(super) product: Vec<Pack>,
    next_product: Vec<Pack>,
    map: Vec<Pack>,
    pub(super) table: Vec<Pack>,
    pub(super) state: Vec<Pack>,
    change: Vec<Pack>,
    /// Number of columns of the maps.
    pub(super) columns: usize,
    /// The sum of the angle errors of a free drive, by the same columns.
    pub(super) phase: Vec<Pack>,
    pub(super) rows: Vec<EquationRow>,
    nearby: Vec<EquationRow>,
}

impl Newton {
    /// Copies orbits on meshes of the same size. The last one also fills the lanes that are left.
    pub(super) fn load(&mut self, orbits: &[&Orbit]) {
        let lane = |l: usize| orbits[l.min(orbits.len() - 1)];
        self.half_turns = lane(0).half_turns;
        make_room(&mut self.states, lane(0).states.len());
        make_room(&mut self.accelerations, lane(0).accelerations.len());
        for l in 0..LANES {
            let Orbit { states, accelerations, mean_torque, .. } = lane(l);
            self.mean_torque[l] = *mean_torque;
            for (pack, x) in self.states.iter_mut().zip(states) {
                pack[l] = *x;
            }
            for (pack, x) in self.accelerations.iter_mut().zip(accelerations) {
                pack[l] = *x;
            }
        }
    }

    /// Length of each of so many intervals in rad.
    pub(super) fn width(&self, intervals: usize) -> f64 {
        PI * self.half_turns as f64 / intervals as f64
    }

    /// Copies the orbit of a lane back.
    pub(super) fn store(&self, l: usize, orbit: &mut Orbit) {
        for (x, pack) in orbit.states.iter_mut().zip(&self.states) {
            *x = pack[l];
        }
        for (x, pack) in orbit.accelerations.iter_mut().zip(&self.accelerations) {
            *x = pack[l];
        }
        (orbit.mean_torque, orbit.half_turns) = (self.mean_torque[l], self.half_turns);
        let m = orbit.unknowns;
        let columns = self.columns;
        let entry = |i: usize| self.product[i / (2 * m) * columns + i % (2 * m)][l];
        orbit.monodromy = (0..4 * m * m).map(entry).collect();
    }

    /// The same curves on intervals of half the length.
    #[inline(always)]
    pub(super) fn halve(&mut self, lanes: Lanes, m: usize) {
        let intervals = self.states.len() / (2 * m);
        let width = self.width(intervals);
        let rule: &Collocation = &COLLOCATION;
        make_room(&mut self.state, 2 * m);
        let (mut states, mut accelerations) =
            (std::mem::take(&mut self.defects), std::mem::take(&mut self.condensed));
        make_room(&mut states, 2 * self.states.len());
        make_room(&mut accelerations, 2 * self.accelerations.len());
        for k in 0..intervals {
            let (start, middle) = states[4 * k * m..][..4 * m].split_at_mut(2 * m);
            start.copy_from_slice(&self.states[2 * k * m..][..2 * m]);
            self.within(lanes, k, m, [0.5, width], [&rule.middle_position, &rule.middle_speed]);
            middle.copy_from_slice(&self.state);
            let fine = &mut accelerations[2 * k * STAGES * m..][..2 * STAGES * m];
            let stages = &self.accelerations[k * STAGES * m..][..STAGES * m];
            for (row, fine) in rule.halves.iter().flatten().zip(fine.chunks_exact_mut(m)) {
                for u in 0..m {
                    let mut sum = ZERO;
                    for j in 0..STAGES {
                        sum = lanes.plus_scaled(sum, row[j], stages[j * m + u]);
                    }
                    fine[u] = sum;
                }
            }
        }
        self.defects = std::mem::replace(&mut self.states, states);
        self.condensed = std::mem::replace(&mut self.accelerations, accelerations);
    }

    /// One step of Newton's method in every lane; `None` if the linear equations have no solution.
    #[inline(always)]
    pub(super) fn step<E: Equations>(
        &mut self,
        lanes: Lanes,
        equations: &mut E,
        mut along: Option<&mut Along<'_, E>>,
        m: usize,
    ) -> [Option<NewtonStep>; LANES] {
        let intervals = self.states.len() / (2 * m);
        let width = self.width(intervals);
        // By the state at drive angle 0, then the constant, then by the mean torque of a free drive
        // and by the parameter.
        let free = equations.is_free();
        let columns = 2 * m + 1 + usize::from(free) + usize::from(along.is_some());
        equations.set_mean_torque(&self.mean_torque);
        if let Some(Along { nearby, .. }) = &mut along {
            nearby.set_mean_torque(&self.mean_torque);
        }
        self.begin(intervals, m, columns);
        if free {
            make_room(&mut self.phase, columns);
            (self.phase[0], self.phase[2 * m]) = (all(1.0), self.states[0]);
        }
        // The last pass closes the orbit: its solution is the same elimination.
        let mut size = (0, 0);
        for k in 0..=intervals {
            if k < intervals {
                size = (STAGES * m, STAGES * m + columns);
                let start = width * k as f64;
                let mesh = (k, start, width, columns);
                self.linearise(lanes, mesh, equations, along.as_deref_mut(), m);
            } else {
                size = (columns - 1, columns);
                self.close(lanes, m, columns, along.as_deref());
            }
            lanes.solve(&mut self.table[..size.0 * size.1], size.0, size.1);
            if k < intervals {
                self.advance(lanes, k, intervals, width, columns, m);
            }
        }
        let solutions = &self.table;
        self.change.clear();
        self.change.extend((0..2 * m).map(|i| solutions[i * size.1 + size.0]));
        self.change.push(all(1.0));
        self.change.extend((2 * m..size.0).map(|i| solutions[i * size.1 + size.0]));
        let mean_torque = if free { self.change[2 * m + 1] } else { ZERO };
        let parameter = if along.is_some() { self.change[columns - 1] } else { ZERO };
        let change = self.changes(lanes, intervals, width, columns, m);
        let mut damped = ZERO;
        for l in lanes.each() {
            // No step turns a shaft by more than half a radian, where the joints' curves bend.
            let part = 0.5 / change[l];
            damped[l] = if part < 1.0 { part } else { 1.0 };
        }
        for k in 0..intervals {
            let condensed = &self.condensed[k * STAGES * m * columns..];
            let stages = &mut self.accelerations[k * STAGES * m..][..STAGES * m];
            for (stage, row) in stages.iter_mut().zip(condensed.chunks_exact(columns)) {
                *stage = lanes.plus_product(*stage, damped, row[0]);
            }
        }
        for (x, dx) in self.states.iter_mut().zip(&self.defects) {
            *x = lanes.plus_product(*x, damped, *dx);
        }
        self.mean_torque = lanes.plus_product(self.mean_torque, damped, mean_torque);
        let unit = equations.unit(lanes);
        let mut found = [None; LANES];
        for l in lanes.each() {
            let parameter = damped[l] * parameter[l];
            let finite = change[l].is_finite() && parameter.is_finite();
            let step = NewtonStep { change: change[l], unit: unit[l], parameter };
            found[l] = finite.then_some(step);
        }
        found
    }

    /// Makes room for maps with so many columns; the product of those so far is the identity.
    pub(super) fn begin(&mut self, intervals: usize, m: usize, columns: usize) {
        self.columns = columns;
        self.phase.clear();
        make_room(&mut self.condensed, intervals * STAGES * m * columns);
        make_room(&mut self.defects, intervals * 2 * m);
        make_room(&mut self.map, 2 * m * columns);
        make_room(&mut self.state, 2 * m);
        self.rows.resize(m, EquationRow::default());
        self.nearby.resize(m, EquationRow::default());
        make_room(&mut self.next_product, 2 * m * columns);
        self.product.clear();
        make_room(&mut self.product, 2 * m * columns);
        for i in 0..2 * m {
            self.product[i * columns + i] = all(1.0);
        }
    }

    /// The accelerations of a first interval from the state at its start, whatever its length.
    /// Returns whether they were found.
    #[inline(always)]
    pub(super) fn follow<E: Equations>(
        &mut self,
        lanes: Lanes,
        equations: &mut E,
        [start, width]: [f64; 2],
        m: usize,
    ) -> bool {
        const MOST: usize = 12;
        // The error is about the square of the last change, in rad.
        const ENOUGH: f64 = 1e-9;
        let (unknowns, columns) = (STAGES * m, self.columns);
        for _ in 0..MOST {
            self.linearise(lanes, (0, start, width, columns), equations, None, m);
            let size = unknowns + columns;
            lanes.solve(&mut self.table[..unknowns * size], unknowns, size);
            let mut most = 0.0;
            for (a, row) in self.accelerations.iter_mut().zip(self.table.chunks_exact(size)) {
                let change = row[unknowns + 2 * m];
                *a = lanes.plus_scaled(*a, 1.0, change);
                // NaN stays.
                most = if change[0].abs() <= most { most } else { change[0].abs() };
            }
            if most * width * width <= ENOUGH {
                return true;
            }
        }
        false
    }

    /// The linearised equations of an interval for the changes of its accelerations: by the state at
    /// its start, the constant, by the parameter.
    #[inline(always)]
    fn linearise<E: Equations>(
        &mut self,
        lanes: Lanes,
        (interval, start, width, of_maps): (usize, f64, f64, usize),
        equations: &mut E,
        mut along: Option<&mut Along<'_, E>>,
        m: usize,
    ) {
        let rule: &Collocation = &COLLOCATION;
        let unknowns = STAGES * m;
        let columns = unknowns + of_maps;
        let free = equations.is_free();
        make_room(&mut self.table, unknowns * columns);
        for (i, &node) in rule.nodes.iter().enumerate() {
            self.within(lanes, interval, m, [node, width], [&rule.position[i], &rule.speed[i]]);
            let angle = start + width * node;
            let (y, v) = self.state.split_at(m);
            let a = &self.accelerations[interval * unknowns + i * m..][..m];
            for aside in [false, true] {
                let (equations, rows) = match (&mut along, aside) {
                    (_, false) => (&mut *equations, &mut self.rows),
                    (Some(along), true) => (&mut *along.nearby, &mut self.nearby),
                    (None, true) => break,
                };
                equations.rows(lanes, angle, [y, v, a], rows);
            }
            for (s, row) in self.rows.iter().enumerate() {
                let entries = &mut self.table[(i * m + s) * columns..][..columns];
                // The rows differ by orders of magnitude between stiff and soft shafts.
                let mut scale = ZERO;
                let mut constant = ZERO;
                for l in lanes.each() {
                    scale[l] = 1.0 / row.by_acceleration[l];
                    constant[l] = -scale[l] * row.residual[l];
                }
                entries[unknowns + 2 * m] = constant;
                if free {
                    entries[unknowns + 2 * m + 1] = if s == 0 { scale } else { ZERO };
                }
                if let Some(Along { by, .. }) = along {
                    let nearby = &self.nearby[s].residual;
                    let entry = &mut entries[columns - 1];
                    for l in lanes.each() {
                        entry[l] = -scale[l] * (nearby[l] - row.residual[l]) / *by;
                    }
                }
                for u in 0..m {
                    // Others than its neighbours do not appear.
                    let c = (u + 1).wrapping_sub(s);
                    let (mut by_angle, mut by_slope) = (ZERO, ZERO);
                    if c < 3 {
                        by_angle = lanes.plus_product(ZERO, scale, row.by_angle[c]);
                        by_slope = lanes.plus_product(ZERO, scale, row.by_slope[c]);
                    }
                    for j in 0..STAGES {
                        let position = width * width * rule.position[i][j];
                        let sum = lanes.plus_scaled(ZERO, position, by_angle);
                        let entry = lanes.plus_scaled(sum, width * rule.speed[i][j], by_slope);
                        entries[j * m + u] = entry;
                    }
                    entries[unknowns + u] = lanes.plus_scaled(ZERO, -1.0, by_angle);
                    let entry = lanes.plus_scaled(ZERO, -width * node, by_angle);
                    entries[unknowns + m + u] = lanes.plus_scaled(entry, -1.0, by_slope);
                }
                let own = &mut entries[i * m + s];
                *own = lanes.plus_scaled(*own, 1.0, all(1.0));
            }
        }
    }

    /// Unknowns and slopes within an interval by the contributions of its stages.
    #[inline(always)]
    pub(super) fn within(
        &mut self,
        lanes: Lanes,
        interval: usize,
        m: usize,
        [time, width]: [f64; 2],
        [to_position, to_speed]: [&[f64; STAGES]; 2],
    ) {
        let (position, slope) = self.states[2 * interval * m..][..2 * m].split_at(m);
        let stages = &self.accelerations[interval * STAGES * m..][..STAGES * m];
        let (y, v) = self.state.split_at_mut(m);
        for u in 0..m {
            let (mut moved, mut turned) = (ZERO, ZERO);
            for j in 0..STAGES {
                moved = lanes.plus_scaled(moved, to_position[j], stages[j * m + u]);
                turned = lanes.plus_scaled(turned, to_speed[j], stages[j * m + u]);
            }
            let along = lanes.plus_scaled(position[u], width * time, slope[u]);
            y[u] = lanes.plus_scaled(along, width * width, moved);
            v[u] = lanes.plus_scaled(slope[u], width, turned);
        }
    }

    /// Keeps the solution for an interval, and extends the product of the maps by that of the
    /// interval: the change of the state at its end by that at its start, by its gap to the next
    /// interval and by the parameter.
    #[inline(always)]
    pub(super) fn advance(
        &mut self,
        lanes: Lanes,
        interval: usize,
        intervals: usize,
        width: f64,
        columns: usize,
        m: usize,
    ) {
        let rule: &Collocation = &COLLOCATION;
        let unknowns = STAGES * m;
        let condensed = &mut self.condensed[interval * unknowns * columns..][..unknowns * columns];
        let solved = self.table.chunks_exact(unknowns + columns);
        for (row, solved) in condensed.chunks_exact_mut(columns).zip(solved) {
            row.copy_from_slice(&solved[unknowns..]);
        }
        self.within(lanes, interval, m, [1.0, width], [&rule.end_position, &rule.end_speed]);
        let next = &self.states[(interval + 1) % intervals * 2 * m..][..2 * m];
        let defects = &mut self.defects[2 * interval * m..][..2 * m];
        for i in 0..2 * m {
            defects[i] = lanes.plus_scaled(self.state[i], -1.0, next[i]);
        }
        let condensed = &self.condensed[interval * unknowns * columns..][..unknowns * columns];
        for u in 0..m {
            for c in 0..columns {
                let (mut moved, mut turned) = (ZERO, ZERO);
                for j in 0..STAGES {
                    let entry = condensed[(j * m + u) * columns + c];
                    moved = lanes.plus_scaled(moved, width * width * rule.end_position[j], entry);
                    turned = lanes.plus_scaled(turned, width * rule.end_speed[j], entry);
                }
                self.map[u * columns + c] = moved;
                self.map[(m + u) * columns + c] = turned;
            }
            let along = &mut self.map[u * columns + m + u];
            *along = lanes.plus_scaled(*along, 1.0, all(width));
        }
        for i in 0..2 * m {
            let own = &mut self.map[i * columns + i];
            *own = lanes.plus_scaled(*own, 1.0, all(1.0));
            let gap = &mut self.map[i * columns + 2 * m];
            *gap = lanes.plus_scaled(*gap, 1.0, defects[i]);
        }
        for (row, map) in
            self.next_product.chunks_exact_mut(columns).zip(self.map.chunks_exact(columns))
        {
            for c in 0..columns {
                let mut sum = if c < 2 * m { ZERO } else { map[c] };
                for k in 0..2 * m {
                    sum = lanes.plus_product(sum, map[k], self.product[k * columns + c]);
                }
                row[c] = sum;
            }
        }
        std::mem::swap(&mut self.product, &mut self.next_product);
        if interval + 1 < intervals && !self.phase.is_empty() {
            for (sum, entry) in self.phase.iter_mut().zip(&self.product[..columns]) {
                *sum = lanes.plus_scaled(*sum, 1.0, *entry);
            }
            let error = self.states[(interval + 1) * 2 * m];
            self.phase[2 * m] = lanes.plus_scaled(self.phase[2 * m], 1.0, error);
        }
    }

    /// The equations of the state at drive angle 0, of the mean torque and of the parameter.
    #[inline(always)]
    pub(super) fn close<E>(
        &mut self,
        lanes: Lanes,
        m: usize,
        columns: usize,
        along: Option<&Along<'_, E>>,
    ) {
        self.table.clear();
        make_room(&mut self.table, (columns - 1) * columns);
        for i in 0..2 * m {
            let (row, from) = (&mut self.table[i * columns..], &self.product[i * columns..]);
            for c in 0..2 * m {
                row[c] = lanes.plus_scaled(all(f64::from(i == c)), -1.0, from[c]);
            }
            row[columns - 1] = from[2 * m];
            for (entry, x) in row[2 * m..columns - 1].iter_mut().zip(&from[2 * m + 1..columns]) {
                *entry = lanes.plus_scaled(ZERO, -1.0, *x);
            }
        }
        if !self.phase.is_empty() {
            let row = &mut self.table[2 * m * columns..][..columns];
            row[..2 * m].copy_from_slice(&self.phase[..2 * m]);
            row[2 * m..columns - 1].copy_from_slice(&self.phase[2 * m + 1..]);
            row[columns - 1] = lanes.plus_scaled(ZERO, -1.0, self.phase[2 * m]);
        }
        if let Some(Along { direction, length, .. }) = along {
            let (parameter, states) = direction.split_last().unwrap_or((&0.0, &[]));
            let row = &mut self.table[(columns - 2) * columns..];
            for (entry, x) in row.iter_mut().zip(states) {
                *entry = all(*x);
            }
            (row[columns - 2], row[columns - 1]) = (all(*parameter), all(*length));
        }
    }

    /// The changes of all states, in place of the gaps, and of all accelerations, in the first
    /// columns of their maps. Returns the largest change of an unknown.
    #[inline(always)]
    fn changes(
        &mut self,
        lanes: Lanes,
        intervals: usize,
        width: f64,
        columns: usize,
        m: usize,
    ) -> Pack {
        let rule: &Collocation = &COLLOCATION;
        let unknowns = STAGES * m;
        let mut size = ZERO;
        for k in 0..intervals {
            let condensed = &mut self.condensed[k * unknowns * columns..][..unknowns * columns];
            for row in condensed.chunks_exact_mut(columns) {
                let mut sum = ZERO;
                for c in 0..columns {
                    sum = lanes.plus_product(sum, row[c], self.change[c]);
                }
                row[0] = sum;
            }
            let own = &mut self.defects[2 * k * m..][..2 * m];
            for u in 0..m {
                let (mut moved, mut turned) = (own[u], own[m + u]);
                for j in 0..STAGES {
                    let entry = condensed[(j * m + u) * columns];
                    moved = lanes.plus_scaled(moved, width * width * rule.end_position[j], entry);
                    turned = lanes.plus_scaled(turned, width * rule.end_speed[j], entry);
                }
                let (position, slope) = (self.change[u], self.change[m + u]);
                (own[u], own[m + u]) = (position, slope);
                let along = lanes.plus_scaled(position, width, slope);
                self.change[u] = lanes.plus_scaled(along, 1.0, moved);
                self.change[m + u] = lanes.plus_scaled(slope, 1.0, turned);
                for l in lanes.each() {
                    // NaN stays.
                    let change = position[l].abs();
                    size[l] = if change <= size[l] { size[l] } else { change };
                }
            }
        }
        size
    }
}
