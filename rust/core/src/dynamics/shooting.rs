//! Periodic orbits of systems with couplings that have kinks, by shooting.
//!
//! The motion is followed from kink to kink: on every piece between them the equations are smooth,
//! and one interval of the collocation after the other is solved from the state at its start. The
//! product of their maps closes the orbit by Newton's method. Where the torque of a coupling jumps
//! at a kink, a neighbouring motion that meets the kink later keeps the old acceleration for this
//! time.

use std::borrow::Cow;
use std::f64::consts::PI;

use nalgebra::Complex;

use crate::dynamics::gauss::{COLLOCATION, STAGES};
use crate::dynamics::lanes::{Lanes, Pack, ZERO, all, make_room};
use crate::dynamics::newton::{EquationRow, Equations};
use crate::dynamics::orbit::{Failure, Orbit, Quadrature};
use crate::dynamics::periodic::FourierSeries;
use crate::dynamics::pool::Pool;
use crate::dynamics::search::{DriveMotion, Found, OrbitGoal, Search};
use crate::dynamics::side_by_side::RunsSideBySide;
use crate::dynamics::system::TorsionalSystem;
use crate::number::elementary::turn;
use crate::run::level::compiled_up_to_avx2;

/// The fewest and the most intervals of a period of half a turn.
const INTERVALS: [usize; 2] = [32, 1024];

/// The most steps of Newton's method from one start.
const STEPS: usize = 16;

/// Permitted error relative to the twist on the mesh from which the refinement begins.
const COARSE: f64 = 1e-5;

/// The largest change of an unknown in one step of Newton's method, in rad.
const LONGEST: f64 = 0.5;

/// The most kinks that are met in one interval.
const KINKS: usize = 32;

/// Relative change of the speed by which the derivative of the mean torque is found.
const ASIDE: f64 = 1e-5;

/// Part of an interval that is rounding.
const ROUNDING: f64 = 1e-13;

/// Where a motion begins: unknowns and slopes at drive angle 0, and the mean torque of a free drive.
#[derive(Clone, Debug)]
struct Start {
    state: Vec<f64>,
    mean_torque: f64,
}

impl Start {
    fn of(orbit: &Orbit) -> Self {
        let state = orbit.states[..2 * orbit.unknowns].to_vec();
        Self { state, mean_torque: orbit.mean_torque }
    }

    /// The start at a multiple of the way from another one to this one.
    fn beyond(&self, other: &Self, times: f64) -> Self {
        let at = |here: f64, there: f64| there + times * (here - there);
        let pairs = self.state.iter().zip(&other.state);
        Self {
            state: pairs.map(|(here, there)| at(*here, *there)).collect(),
            mean_torque: at(self.mean_torque, other.mean_torque),
        }
    }
}

/// A coupling that meets a kink.
#[derive(Clone, Copy, Debug)]
struct Exit {
    spring: usize,
    /// Whether its twist rises there.
    rises: bool,
    /// When, in intervals.
    time: f64,
}

/// Results along an orbit: sums over the period of all torques and of the slope of a free
/// drive, their least and their largest values, and the losses.
#[derive(Debug, Default)]
struct OrbitSums {
    means: Vec<f64>,
    orders: Vec<Vec<Complex<f64>>>,
    extremes: Vec<[f64; 2]>,
    losses: f64,
    quadrature: Quadrature,
}

/// The motion of a system from a start.
struct Flow<'f, 'p> {
    system: &'f TorsionalSystem,
    speed: f64,
    pool: &'f mut Pool<'p>,
    /// In which range of twists every compliant shaft is.
    ranges: Vec<usize>,
    /// The largest twists so far, in rad.
    twists: Vec<f64>,
}

impl<'f, 'p> Flow<'f, 'p> {
    fn new(system: &'f TorsionalSystem, speed: f64, pool: &'f mut Pool<'p>) -> Self {
        let compliant = system.compliant();
        let mut flow =
            Self { system, speed, pool, ranges: vec![0; compliant], twists: vec![0.0; compliant] };
        flow.set_speed(speed);
        flow
    }

    fn set_speed(&mut self, speed: f64) {
        self.speed = speed;
        self.pool.runs.load(&[(self.system, speed)]);
    }

    /// Solves the equations of an interval from the state at its start.
    fn follow(&mut self, start: f64, width: f64) -> Option<()> {
        let Pool { level, newton, runs, .. } = &mut *self.pool;
        let m = runs.unknowns();
        let found = compiled_up_to_avx2!(*level, (compact, _stores) => {
            newton.follow(Lanes::of(compact, 1), runs, [start, width], m)
        });
        found.then_some(())
    }

    /// Finds state, twists and torques at a time within the interval that was followed last.
    fn look(&mut self, start: f64, width: f64, time: f64) {
        let [positions, speeds] = COLLOCATION.to(time);
        let Pool { level, newton, runs, .. } = &mut *self.pool;
        let m = runs.unknowns();
        compiled_up_to_avx2!(*level, (compact, _stores) => {
            let lanes = Lanes::of(compact, 1);
            newton.within(lanes, 0, m, [time, width], [&positions, &speeds]);
            let (y, v) = newton.state.split_at(m);
            runs.prepare(lanes, time.mul_add(width, start), y, v);
        });
    }

    /// Extends the product of the maps by that of the interval, whose end state is left.
    fn advance(&mut self, width: f64) {
        let Pool { level, newton, runs, .. } = &mut *self.pool;
        let (m, columns) = (runs.unknowns(), newton.columns);
        compiled_up_to_avx2!(*level, (compact, _stores) => {
            newton.advance(Lanes::of(compact, 1), 0, 1, width, columns, m);
        });
    }

    /// Makes a coupling follow the law of its range.
    fn enter(&mut self, spring: usize, range: usize) {
        self.ranges[spring] = range;
        self.pool.runs.enter(spring, &self.system.springs[spring], range, self.speed);
    }

    /// Begins at a start. A coupling on a kink follows the law of the range that it moves to.
    fn begin(&mut self, from: &Start) {
        let Pool { newton, runs, .. } = &mut *self.pool;
        let m = runs.unknowns();
        let columns = 2 * m + 1 + usize::from(runs.free);
        newton.half_turns = self.system.half_turns;
        newton.mean_torque = all(from.mean_torque);
        runs.set_mean_torque(&newton.mean_torque);
        newton.begin(1, m, columns);
        make_room(&mut newton.phase, if runs.free { columns } else { 0 });
        newton.states.clear();
        newton.states.extend(from.state.iter().map(|x| all(*x)));
        newton.accelerations.clear();
        make_room(&mut newton.accelerations, STAGES * m);
        runs.prepare(Lanes::of(true, 1), 0.0, &newton.states[..m], &newton.states[m..]);
        for (s, spring) in self.system.springs.iter().enumerate() {
            let (twist, rate) = (self.pool.runs.twists[s][0], self.pool.runs.rates[s][0]);
            let mut range = spring.law.range(twist);
            if rate > 0.0 && spring.law.kinks.get(range).is_some_and(|kink| kink[0] == twist) {
                range += 1;
            }
            self.enter(s, range);
            self.twists[s] = twist.abs();
        }
    }

    /// The motion over a period from a start: its states on a mesh and, with all lanes equal, the
    /// product of the maps of its intervals and their phase condition.
    fn period(
        &mut self,
        from: &Start,
        intervals: usize,
        mut gathered: Option<&mut OrbitSums>,
    ) -> Option<Orbit> {
        let (m, half_turns) = (self.system.unknowns(), self.system.half_turns);
        let mut orbit = Orbit::at_rest(m, intervals, half_turns);
        orbit.mean_torque = from.mean_torque;
        self.begin(from);
        let width = orbit.width();
        for k in 0..intervals {
            let put = |places: &mut [f64], packs: &[Pack]| {
                places.iter_mut().zip(packs).for_each(|(place, pack)| *place = pack[0]);
            };
            put(&mut orbit.states[2 * k * m..][..2 * m], &self.pool.newton.states);
            let (mut start, mut left) = (width * k as f64, width);
            for kink in 0..=KINKS {
                self.follow(start, left)?;
                if kink == 0 {
                    // In an interval with a kink those of the law before it.
                    let stages = &self.pool.newton.accelerations;
                    put(&mut orbit.accelerations[k * STAGES * m..][..STAGES * m], stages);
                }
                let exit = self.exit(start, left);
                let passed = match exit {
                    Some(exit) => self.meet(start, left, exit)?,
                    None => left,
                };
                self.pass(start, passed, gathered.as_deref_mut())?;
                start += passed;
                left -= passed;
                if let Some(exit) = exit {
                    self.cross(start, exit);
                }
                if exit.is_none() || left <= ROUNDING * width {
                    break;
                }
                if kink == KINKS {
                    return None;
                }
            }
        }
        let columns = self.pool.newton.columns;
        let product = &self.pool.newton.product;
        let entry = |i: usize| product[i / (2 * m) * columns + i % (2 * m)][0];
        orbit.monodromy = (0..4 * m * m).map(entry).collect();
        Some(orbit)
    }

    /// Passes the interval that was followed: its map, its part of the phase condition, what is
    /// gathered. Its end is the next start.
    fn pass(&mut self, start: f64, width: f64, gathered: Option<&mut OrbitSums>) -> Option<()> {
        let before = self.pool.newton.product.clone();
        self.advance(width);
        let end = self.pool.newton.state.clone();
        if !end.iter().all(|x| x[0].is_finite()) {
            return None;
        }
        self.add_phase(width, &before);
        if let Some(gathered) = gathered {
            self.gather(start, width, gathered)?;
        }
        self.pool.newton.states.copy_from_slice(&end);
        Some(())
    }

    /// Adds what an interval, which has been passed, adds to the integral of the angle error of a free
    /// drive, from the product of the maps before it.
    fn add_phase(&mut self, width: f64, before: &[Pack]) {
        let Pool { newton, runs, .. } = &mut *self.pool;
        let (m, columns) = (runs.unknowns(), newton.columns);
        let rule = &*COLLOCATION;
        let share = |j: usize| -> f64 {
            (0..STAGES).map(|i| rule.end_speed[i] * rule.position[i][j]).sum()
        };
        let shares: [f64; STAGES] = std::array::from_fn(share);
        for c in 0..newton.phase.len() {
            let entry = |row: usize| match c {
                _ if c == 2 * m => newton.states[row][0],
                _ => before[row * columns + c][0],
            };
            let acceleration = |j: usize| {
                let row = &newton.condensed[j * m * columns..][..columns];
                match c {
                    _ if c == 2 * m => newton.accelerations[j * m][0],
                    _ => {
                        let own = if c > 2 * m { row[c][0] } else { 0.0 };
                        (0..2 * m).map(|k| row[k][0] * entry(k)).sum::<f64>() + own
                    }
                }
            };
            let curved: f64 = (0..STAGES).map(|j| shares[j] * acceleration(j)).sum();
            let integral = width * (entry(0) + width * (0.5 * entry(m) + width * curved));
            newton.phase[c] = all(newton.phase[c][0] + integral);
        }
    }

    /// The first kink that a coupling meets within the interval.
    fn exit(&mut self, start: f64, width: f64) -> Option<Exit> {
        const TIMES: usize = STAGES + 2;
        let count = self.ranges.len();
        let seen = |flow: &mut Self, time: f64| -> Vec<[f64; 2]> {
            flow.look(start, width, time);
            let RunsSideBySide { twists, rates, .. } = &flow.pool.runs;
            twists.iter().zip(rates).map(|(x, v)| [x[0], width * v[0]]).collect()
        };
        let ends = [seen(self, 0.0), seen(self, 1.0)];
        let mut all_seen: Option<Vec<Vec<[f64; 2]>>> = None;
        let mut first: Option<Exit> = None;
        for s in 0..count {
            let [from, to] = [ends[0][s], ends[1][s]];
            self.twists[s] = self.twists[s].max(to[0].abs());
            let kinks = &self.system.springs[s].law.kinks;
            let range = self.ranges[s];
            let bounds = [(range.checked_sub(1), false), (Some(range), true)];
            for (bound, rises) in bounds {
                let Some(kink) = bound.and_then(|k| kinks.get(k)).map(|kink| kink[0]) else {
                    continue;
                };
                // How far the twist is from the kink, and the rate of that.
                let inside = |[twist, rate]: [f64; 2]| {
                    if rises { [kink - twist, -rate] } else { [twist - kink, rate] }
                };
                let [near, far] = [inside(from), inside(to)];
                let fastest = near[1].abs().max(far[1].abs());
                if near[0].min(far[0]) > 2.0 * fastest {
                    continue;
                }
                let seen_there = all_seen.get_or_insert_with(|| {
                    let inner = COLLOCATION.nodes.iter().map(|&time| seen(self, time));
                    std::iter::once(ends[0].clone())
                        .chain(inner.collect::<Vec<_>>())
                        .chain([ends[1].clone()])
                        .collect()
                });
                let time_of = |i: usize| match i {
                    0 => 0.0,
                    _ if i + 1 == TIMES => 1.0,
                    _ => COLLOCATION.nodes[i - 1],
                };
                let values: Vec<[f64; 2]> = seen_there.iter().map(|of| inside(of[s])).collect();
                for i in 1..TIMES {
                    let (mut low, mut high) = (time_of(i - 1), time_of(i));
                    let [before, after] = [values[i - 1], values[i]];
                    let at = |flow: &mut Self, time: f64| inside(seen(flow, time)[s]);
                    if after[0] >= 0.0 {
                        // It may leave the range and come back.
                        let dips = before[1] < 0.0 && after[1] > 0.0;
                        if !dips || before[0] + before[1] * (high - low) >= 0.0 {
                            continue;
                        }
                        let (mut left, mut right) = (low, high);
                        for _ in 0..40 {
                            let middle = 0.5 * (left + right);
                            if at(self, middle)[1] < 0.0 { left = middle } else { right = middle }
                        }
                        if at(self, left)[0] >= 0.0 {
                            continue;
                        }
                        high = left;
                    }
                    // Newton's method between bounds.
                    let mut time = high;
                    for _ in 0..60 {
                        let [distance, rate] = at(self, time);
                        if distance < 0.0 {
                            high = time;
                        } else {
                            low = time;
                        }
                        let next = time - distance / rate;
                        let next =
                            if next > low && next < high { next } else { 0.5 * (low + high) };
                        let step = (next - time).abs();
                        time = next;
                        if step < 1e-9 {
                            break;
                        }
                    }
                    if first.is_none_or(|first| time < first.time) {
                        first = Some(Exit { spring: s, rises, time });
                    }
                    break;
                }
            }
        }
        first
    }

    /// Follows the interval to the kink that a coupling meets in it; returns its length.
    fn meet(&mut self, start: f64, width: f64, exit: Exit) -> Option<f64> {
        let Exit { spring, rises, time } = exit;
        let range = self.ranges[spring];
        let place = if rises { range } else { range - 1 };
        let kink = self.system.springs[spring].law.kinks[place][0];
        let mut passed = time * width;
        for _ in 0..8 {
            self.follow(start, passed)?;
            self.look(start, passed, 1.0);
            let RunsSideBySide { twists, rates, .. } = &self.pool.runs;
            let step = (kink - twists[spring][0]) / rates[spring][0];
            if step.is_nan() || step.abs() <= ROUNDING * width {
                break;
            }
            passed = (passed + step).clamp(0.5 * passed, width.min(2.0 * passed));
        }
        Some(passed)
    }

    /// Lets a coupling enter the range behind a kink.
    fn cross(&mut self, angle: f64, exit: Exit) {
        let Exit { spring, rises, .. } = exit;
        let law = &self.system.springs[spring].law;
        let old = self.ranges[spring];
        let new = if rises { old + 1 } else { old - 1 };
        let jumps = law.in_range(old).damping != law.in_range(new).damping;
        let before = if jumps { self.accelerations(angle) } else { vec![] };
        self.enter(spring, new);
        if !jumps {
            return;
        }
        let after = self.accelerations(angle);
        let Pool { newton, runs, .. } = &mut *self.pool;
        let (m, columns) = (runs.unknowns(), newton.columns);
        let own = spring + usize::from(runs.free);
        let (by_before, rate) = (runs.ratio(spring), runs.rates[spring][0]);
        for c in 0..columns {
            let entry = |row: usize| newton.product[row * columns + c][0];
            let of_before = own.checked_sub(1).map_or(0.0, |row| by_before * entry(row));
            let later = (entry(own) - of_before) / rate;
            for u in 0..m {
                let place = &mut newton.product[(m + u) * columns + c];
                *place = all(place[0] + (before[u] - after[u]) * later);
            }
        }
    }

    /// The second derivatives of the unknowns at the start of the next interval.
    fn accelerations(&mut self, angle: f64) -> Vec<f64> {
        let Pool { newton, runs, .. } = &mut *self.pool;
        let m = runs.unknowns();
        let (y, v) = newton.states.split_at(m);
        let mut rows = vec![EquationRow::default(); m];
        runs.rows(Lanes::of(true, 1), angle, [y, v, &vec![ZERO; m]], &mut rows);
        rows.iter().map(|row| -row.residual[0] / row.by_acceleration[0]).collect()
    }

    /// The torques, then the slope of a free drive, at a time within the interval.
    fn signals(&mut self, start: f64, width: f64, time: f64) -> Vec<f64> {
        self.look(start, width, time);
        let Pool { newton, runs, .. } = &*self.pool;
        let slope = runs.free.then(|| newton.state[runs.unknowns()][0]);
        runs.torques.iter().map(|torque| torque[0]).chain(slope).collect()
    }

    /// Gathers what an interval adds.
    fn gather(&mut self, start: f64, width: f64, gathered: &mut OrbitSums) -> Option<()> {
        let base = 2.0 / self.system.half_turns as f64;
        let mut seen = vec![self.signals(start, width, 0.0)];
        for (node, weight) in COLLOCATION.nodes.iter().zip(COLLOCATION.end_speed) {
            let values = self.signals(start, width, *node);
            let Pool { newton, runs, .. } = &*self.pool;
            let mut losses = ZERO;
            runs.add_losses(Lanes::of(true, 1), &newton.state[runs.unknowns()..], &mut losses);
            gathered.losses += width * weight * losses[0];
            let angle = node.mul_add(width, start);
            gathered.quadrature.nodes.push([angle, width * weight]);
            gathered.quadrature.states.extend(newton.state.iter().map(|x| x[0]));
            let step = turn(-base * angle);
            for (i, value) in values.iter().enumerate() {
                let mut term = Complex::new(width * weight * value, 0.0);
                gathered.means[i] += term.re;
                for sum in &mut gathered.orders[i] {
                    term *= step;
                    *sum += term;
                }
            }
            seen.push(values);
        }
        seen.push(self.signals(start, width, 1.0));
        let time_of = |i: usize| match i {
            0 => 0.0,
            _ if i > STAGES => 1.0,
            _ => COLLOCATION.nodes[i - 1],
        };
        for i in 0..gathered.extremes.len() {
            for (side, sign) in [(0, -1.0), (1, 1.0)] {
                let value = |j: usize| sign * seen[j][i];
                let at_ends = value(0).max(value(STAGES + 1));
                let place = &mut gathered.extremes[i][side];
                *place = sign * (sign * *place).max(at_ends);
                let best = (0..seen.len()).fold(0, |j, k| if value(k) > value(j) { k } else { j });
                // The vertex of the parabola through three values.
                let middle = best.clamp(1, STAGES);
                let [a, b, c] = [middle - 1, middle, middle + 1].map(time_of);
                let [rise, fall] = [
                    (value(middle) - value(middle - 1)) / (b - a),
                    (value(middle + 1) - value(middle)) / (c - b),
                ];
                let bend = (fall - rise) / (c - a);
                let vertex = 0.5 * (a + b) - 0.5 * rise / bend;
                if !(bend < 0.0 && vertex > 0.0 && vertex < 1.0) {
                    continue;
                }
                let top = value(middle) - bend * (b - vertex) * (b - vertex);
                let spread = gathered.extremes[i][1] - gathered.extremes[i][0];
                if top > sign * gathered.extremes[i][side] - 1e-3 * spread {
                    let exact = sign * self.extreme(start, width, [a, c], (i, sign))?;
                    let place = &mut gathered.extremes[i][side];
                    *place = sign * (sign * *place).max(exact);
                }
            }
        }
        Some(())
    }

    /// The extreme value of a signal between two times within the interval.
    fn extreme(
        &mut self,
        start: f64,
        width: f64,
        [mut low, mut high]: [f64; 2],
        (signal, sign): (usize, f64),
    ) -> Option<f64> {
        // The golden section.
        const SHARE: f64 = 0.618_033_988_749_894_9;
        const ENOUGH: f64 = 1e-5;
        let at = |flow: &mut Self, time: f64| sign * flow.signals(start, width, time)[signal];
        let mut times = [high - SHARE * (high - low), low + SHARE * (high - low)];
        let mut values = times.map(|time| at(self, time));
        while high - low > ENOUGH {
            if values[0] > values[1] {
                (high, times[1], values[1]) = (times[1], times[0], values[0]);
                times[0] = high - SHARE * (high - low);
                values[0] = at(self, times[0]);
            } else {
                (low, times[0], values[0]) = (times[0], times[1], values[1]);
                times[1] = low + SHARE * (high - low);
                values[1] = at(self, times[1]);
            }
        }
        // Only at the end of an interval is the motion as accurate as the orbit.
        let passed = 0.5 * (low + high) * width;
        let kept = self.pool.newton.accelerations.clone();
        self.follow(start, passed)?;
        let exact = self.signals(start, passed, 1.0)[signal];
        self.pool.newton.accelerations = kept;
        Some(exact)
    }

    /// Changes of a start by Newton's method so that the orbit of the last period closes: the
    /// state and the mean torque.
    fn closing(&mut self, from: &Start) -> Option<Vec<f64>> {
        let Pool { newton, runs, .. } = &mut *self.pool;
        let (m, columns) = (runs.unknowns(), newton.columns);
        for (i, x) in from.state.iter().enumerate() {
            newton.product[i * columns + 2 * m] = all(newton.states[i][0] - x);
        }
        let lanes = Lanes::of(true, 1);
        newton.close::<RunsSideBySide>(lanes, m, columns, None);
        let rows = columns - 1;
        lanes.solve(&mut newton.table[..rows * columns], rows, columns);
        let change: Vec<f64> =
            (0..rows).map(|i| newton.table[i * columns + columns - 1][0]).collect();
        change.iter().all(|x| x.is_finite()).then_some(change)
    }

    /// The twist in rad of the shaft that twists least.
    fn unit(&self) -> f64 {
        self.twists.iter().fold(f64::INFINITY, |least, twist| least.min(*twist))
    }

    /// Brings a start onto an orbit on a mesh by Newton's method. The error is relative to the
    /// twists.
    fn converge(&mut self, from: &mut Start, intervals: usize, tolerance: f64) -> Option<Orbit> {
        const MARGIN: f64 = 0.01;
        let m = self.system.unknowns();
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            let orbit = self.period(from, intervals, None)?;
            let change = self.closing(from)?;
            let largest = change[..m].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let unit = self.unit();
            // What rounding leaves does not get smaller.
            let stays = largest > 0.1 * last && largest <= 1e-8 * unit;
            if largest <= MARGIN * tolerance * unit || stays {
                return Some(orbit);
            }
            last = largest;
            let part = (LONGEST / largest).min(1.0);
            for (x, change) in from.state.iter_mut().zip(&change) {
                *x += part * change;
            }
            from.mean_torque += part * change.get(2 * m).copied().unwrap_or_default();
        }
        None
    }

    /// The motion after many periods from a start. A governor keeps the mean speed of a free drive.
    fn settled(mut self, mut from: Start) -> Option<Start> {
        const PERIODS: usize = 64;
        let Self { system, speed, .. } = self;
        let (m, half_turns) = (system.unknowns(), system.half_turns);
        let intervals = INTERVALS[0] * system.mesh();
        // It brings the speed back within about half a turn.
        let governor = system.total_inertia() * speed * speed / PI;
        if system.is_free() {
            self.pool.runs.govern(governor);
        }
        let mut orbit = Orbit::default();
        for _ in 0..PERIODS {
            orbit = self.period(&from, intervals, None)?;
            let end = &self.pool.newton.states;
            let slope = (end[0][0] - from.state[0]) / (PI * half_turns as f64);
            from.state = end.iter().map(|x| x[0]).collect();
            if system.is_free() {
                from.mean_torque -= governor * slope;
            }
        }
        if system.is_free() {
            // The origin of time where the mean of the drive's angle error is about zero.
            let sum: f64 = (0..intervals).map(|k| orbit.state(k).0[0]).sum();
            let places = (-sum / (orbit.width() * intervals as f64)).round();
            let place = places.rem_euclid(intervals as f64) as usize;
            from.state = orbit.states[2 * place * m..][..2 * m].to_vec();
            from.state[..m].iter_mut().for_each(|y| *y += places * orbit.width());
        }
        Some(from)
    }

    /// The orbit with its accuracy, from a start on the coarsest mesh.
    fn refine(&mut self, mut from: Start, goal: OrbitGoal) -> Result<Found, Failure> {
        // As in the search by collocation.
        const GAINS: [f64; 2] = [16.0, 128.0];
        let mesh = self.system.mesh();
        let needed = 4.0 * goal.order * self.system.half_turns as f64;
        let mut coarse: Option<Orbit> = None;
        let mut last = f64::NAN;
        let mut intervals = INTERVALS[0] * mesh;
        loop {
            let tolerance = if coarse.is_some() { goal.tolerance } else { COARSE };
            let fine = self.converge(&mut from, intervals, tolerance).ok_or(Failure::NotFound)?;
            if let Some(coarse) = &coarse {
                let [angles, slopes] = coarse.differences(&fine);
                let largest = |map: &[f64]| map.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
                let pairs = fine.monodromy.iter().zip(&coarse.monodromy);
                let maps = pairs.fold(0.0, |most: f64, (x, y)| most.max((x - y).abs()));
                let maps = if goal.stability { maps / largest(&fine.monodromy) } else { 0.0 };
                let change = (angles / self.unit()).max(slopes / fine.largest_slope()).max(maps);
                let gain = (last / change).clamp(GAINS[0], GAINS[1]);
                let gain = if gain.is_nan() { GAINS[0] } else { gain };
                if change <= gain * goal.tolerance && intervals as f64 > needed {
                    return self.finish(&from, intervals, goal).ok_or(Failure::NotFound);
                }
                last = change;
            }
            if 2 * intervals > INTERVALS[1] * mesh {
                return Err(Failure::NotResolved);
            }
            intervals *= 2;
            coarse = Some(fine);
        }
    }

    /// Results along an orbit.
    fn finish(&mut self, from: &Start, intervals: usize, goal: OrbitGoal) -> Option<Found> {
        let (m, free) = (self.system.unknowns(), self.system.is_free());
        let half_turns = self.system.half_turns;
        let signals = self.system.compliant() + usize::from(free);
        let mut gathered = OrbitSums {
            means: vec![0.0; signals],
            orders: vec![vec![Complex::default(); intervals / 2 - 1]; signals],
            extremes: vec![[f64::INFINITY, f64::NEG_INFINITY]; signals],
            losses: 0.0,
            quadrature: Quadrature::default(),
        };
        let mut orbit = self.period(from, intervals, Some(&mut gathered))?;
        let OrbitSums { means, orders, extremes, losses, quadrature } = gathered;
        orbit.quadrature = Some(Box::new(quadrature));
        let scale = 1.0 / (PI * half_turns as f64);
        let mut series = means.iter().zip(orders).map(|(mean, sums)| FourierSeries {
            half_turns,
            mean: scale * mean,
            amplitudes: sums.into_iter().map(|sum| sum * (2.0 * scale)).collect(),
        });
        let torques = series.by_ref().take(self.system.compliant()).collect();
        let slope = series.next();
        let mut torque_slope = None;
        if free && goal.stability {
            let speed = self.speed;
            let mut changes = [0.0; 2];
            for (change, side) in changes.iter_mut().zip([ASIDE, -ASIDE]) {
                self.set_speed(speed * (1.0 + side));
                self.period(from, intervals, None)?;
                *change = self.closing(from)?[2 * m];
            }
            self.set_speed(speed);
            torque_slope = Some(0.5 * (changes[0] - changes[1]) / (ASIDE * speed));
        }
        let drive = DriveMotion { torque: scale * losses, slope, torque_slope };
        Some(Found { orbit, contraction: 0.0, torques, drive, extremes: Some(extremes) })
    }
}

impl TorsionalSystem {
    /// The orbit at a mean speed in rad/s: the first of those that [`Self::starts`] lead to.
    pub(super) fn shoot(
        &self,
        speed: f64,
        goal: OrbitGoal,
        pool: &mut Pool<'_>,
    ) -> Result<Found, Failure> {
        if !(speed > 0.0 && speed < f64::INFINITY) {
            return Err(Failure::Speed);
        }
        let mut failure = Failure::NotFound;
        for way in WAYS {
            if let Some(start) = self.start(way, speed, pool) {
                match Flow::new(self, speed, pool).refine(start, goal) {
                    Err(Failure::NotResolved) => failure = Failure::NotResolved,
                    Err(_) => {}
                    found => return found,
                }
            }
        }
        Err(failure)
    }

    /// The orbit near one on a coarse mesh.
    pub(super) fn shoot_from(
        &self,
        coarse: &Orbit,
        speed: f64,
        goal: OrbitGoal,
        pool: &mut Pool<'_>,
    ) -> Result<Found, Failure> {
        Flow::new(self, speed, pool).refine(Start::of(coarse), goal)
    }

    /// Orbits on a coarse mesh, each perhaps several times: those that are followed in speed from
    /// lower and from higher ones, then those from the starts of a single orbit and from
    /// oscillations.
    pub(super) fn shot_nearby(&self, speed: f64, pool: &mut Pool<'_>) -> Vec<Orbit> {
        // Relative to the speed.
        const FROM: [f64; 4] = [0.6, 0.85, 1.15, 1.4];
        const STEP: f64 = 0.03;
        let at = |share: f64| (Cow::Borrowed(self), share * speed);
        let mut starts = vec![];
        for from in FROM {
            let first = self.start(Way::Static, from * speed, pool);
            let traced = first.and_then(|start| Self::traced(at, [from, 1.0], STEP, start, pool));
            starts.extend(traced);
        }
        starts.extend(WAYS.iter().filter_map(|way| self.start(*way, speed, pool)));
        let mean_torque = self.static_load(speed);
        starts.extend(self.oscillations().map(|orbit| Start { mean_torque, ..Start::of(&orbit) }));
        let intervals = INTERVALS[0] * self.mesh();
        let mut flow = Flow::new(self, speed, pool);
        starts.iter_mut().filter_map(|start| flow.converge(start, intervals, COARSE)).collect()
    }

    /// Unknowns and slopes of an orbit at equally spaced drive angles.
    pub(super) fn sampled(
        &self,
        orbit: &Orbit,
        speed: f64,
        samples: usize,
        pool: &mut Pool<'_>,
    ) -> Vec<f64> {
        let each = orbit.intervals.div_ceil(samples);
        let fine = Flow::new(self, speed, pool).period(&Start::of(orbit), each * samples, None);
        let size = 2 * orbit.unknowns;
        let states = fine.iter().flat_map(|fine| fine.states.chunks_exact(size * each));
        let mut found: Vec<f64> = states.flat_map(|states| &states[..size]).copied().collect();
        found.resize(size * samples, f64::NAN);
        found
    }

    /// A start, close to an orbit or not.
    fn start(&self, way: Way, speed: f64, pool: &mut Pool<'_>) -> Option<Start> {
        match way {
            Way::Static => {
                let search = Search::near_rigid(self, speed, INTERVALS[0]);
                let found = pool.run(vec![search]).pop()?.ok()?;
                Some(Start::of(&found.orbit))
            }
            Way::Rest => Some(Start {
                state: vec![0.0; 2 * self.unknowns()],
                mean_torque: self.static_load(speed),
            }),
            Way::Settled => {
                let start = self.start(Way::Static, speed, pool);
                let start = start.or_else(|| self.start(Way::Rest, speed, pool))?;
                Flow::new(self, speed, pool).settled(start)
            }
            Way::Bends => {
                let bent = |share: f64| (Cow::<Self>::Owned(self.bent(share)), speed);
                let first = bent(0.1);
                let start = first.0.start(Way::Static, speed, pool)?;
                Self::traced(bent, [0.1, 1.0], 0.1, start, pool)
            }
        }
    }

    /// The start of the orbit that is followed while a parameter changes from one value to another.
    fn traced<'a>(
        at: impl Fn(f64) -> (Cow<'a, Self>, f64),
        [from, to]: [f64; 2],
        longest: f64,
        start: Start,
        pool: &mut Pool<'_>,
    ) -> Option<Start> {
        const SHORTEST: f64 = 1.0 / 64.0;
        let mut orbit = |parameter: f64, mut start: Start| {
            let (system, speed) = at(parameter);
            let intervals = INTERVALS[0] * system.mesh();
            let found = Flow::new(&system, speed, pool).converge(&mut start, intervals, COARSE);
            found.map(|_| start)
        };
        let mut here = (from, orbit(from, start)?);
        let mut before: Option<(f64, Start)> = None;
        let mut length = longest;
        while here.0 != to {
            let left = to - here.0;
            let next =
                if left.abs() <= 1.01 * length { to } else { here.0 + length.copysign(left) };
            let guess = match &before {
                Some((parameter, start)) => {
                    here.1.beyond(start, (next - parameter) / (here.0 - parameter))
                }
                None => here.1.clone(),
            };
            match orbit(next, guess) {
                Some(found) => {
                    before = Some(std::mem::replace(&mut here, (next, found)));
                    length = (2.0 * length).min(longest);
                }
                None => length *= 0.5,
            }
            if length < SHORTEST * longest {
                return None;
            }
        }
        Some(here.1)
    }
}

/// Ways to a start.
#[derive(Clone, Copy, Debug)]
enum Way {
    /// The orbit with the laws of the static torque.
    Static,
    /// Uniform rotation.
    Rest,
    /// The motion after many periods.
    Settled,
    /// The orbit that is followed while bends and harmonic torques grow.
    Bends,
}

/// In the order in which they are tried.
const WAYS: [Way; 4] = [Way::Static, Way::Rest, Way::Settled, Way::Bends];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::coupling::Coupling;
    use crate::dynamics::system::{ShaftEnds, TorqueHarmonic};
    use crate::number::elementary::{asin, atan};
    use crate::run::level::Level;

    /// A held drive, a joint, a coupling, and an inertia.
    fn system(bend: f64, damping: f64, load: f64, coupling: Coupling) -> TorsionalSystem {
        let shafts = ShaftEnds {
            inertias: &[0.0, 0.0, 0.0, 0.05],
            stiffnesses: &[f64::INFINITY, 8000.0],
            dampings: &[0.0, damping],
        };
        let system = TorsionalSystem::new(&[bend], &[], &[], shafts, [load, 0.0]).unwrap();
        system.with_couplings(&[Coupling { shaft: 1, ..coupling }]).unwrap()
    }

    /// The period of free vibrations of a symmetric oscillator of two stiffnesses.
    #[test]
    fn a_free_vibration_over_four_kinks_has_its_period() {
        let ([soft, hard], kink, fastest) = ([5000.0, 15000.0], 0.02, 12.0_f64);
        let table = vec![[0.0, 0.0], [kink, soft * kink], [2.0 * kink, (soft + hard) * kink]];
        let coupling = Coupling { twist_torque: table, ..Coupling::default() };
        let system = system(0.0, 0.0, 0.0, coupling);
        let [slow, fast] = [soft, hard].map(|stiffness| (stiffness / 0.05_f64).sqrt());
        let at_kink = (fastest * fastest - (slow * kink) * (slow * kink)).sqrt();
        let inner = asin(slow * kink / fastest) / slow;
        let outer = atan(at_kink / (fast * kink * soft / hard)) / fast;
        let speed = PI / (4.0 * (inner + outer));
        let start = Start { state: vec![0.0, -fastest / speed], mean_torque: 0.0 };
        let mut pool = Pool::new(Level::new(), None);
        let mut flow = Flow::new(&system, speed, &mut pool);
        flow.period(&start, 64, None).unwrap();
        let end = &flow.pool.newton.states;
        assert!(end[0][0].abs() < 1e-12, "{:e}", end[0][0]);
        assert!((end[1][0] - start.state[1]).abs() < 1e-11 * start.state[1].abs());
    }

    #[test]
    fn play_that_is_not_crossed_shifts_the_linear_orbit() {
        let goal = OrbitGoal { tolerance: 1e-11, order: 4.0, stability: true };
        let mut pool = Pool::new(Level::new(), None);
        let one = Coupling { stiffness: Some(8000.0), ..Coupling::default() };
        let linear = system(0.3, 1.0, 60.0, one.clone());
        let search = Search::at(&linear, 60.0, goal);
        let expected = pool.run(vec![search]).pop().unwrap().unwrap();
        let with_play = system(0.3, 1.0, 60.0, Coupling { play: 0.02, ..one });
        let found = with_play.shoot(60.0, goal, &mut pool).unwrap();
        for order in [2.0, 4.0] {
            let apart = found.torques[0].order(order) - expected.torques[0].order(order);
            assert!(apart.norm_sqr().sqrt() < 1e-9);
        }
        let maps = found.orbit.monodromy.iter().zip(&expected.orbit.monodromy);
        assert!(maps.into_iter().all(|(x, y)| (x - y).abs() < 1e-9));
        let shift = expected.orbit.states[0] - found.orbit.states[0];
        assert!((shift - 0.01).abs() < 1e-11, "{shift}");
    }

    /// A coupling that is crossed several times within an interval.
    #[test]
    fn kinks_beside_each_other_are_all_met() {
        let table = vec![[0.0, 0.0], [0.0125, 100.0], [0.0126, 103.0], [0.02, 162.2]];
        let coupling = Coupling { twist_torque: table, ..Coupling::default() };
        let harmonic = TorqueHarmonic { end: 3, order: 4.0, cos: 60.0, sin: 0.0 };
        let system = system(0.3, 2.0, 100.0, coupling).with_harmonics(&[harmonic]).unwrap();
        let start = Start { state: vec![-0.012_5, 0.0], mean_torque: 0.0 };
        let mut pool = Pool::new(Level::new(), None);
        let ends = [16, 128].map(|intervals| {
            let mut flow = Flow::new(&system, 100.0, &mut pool);
            flow.period(&start, intervals, None).unwrap();
            [flow.pool.newton.states[0][0], 0.1 * flow.pool.newton.states[1][0]]
        });
        assert!((ends[0][0] - ends[1][0]).abs() < 1e-9, "{ends:?}");
        assert!((ends[0][1] - ends[1][1]).abs() < 1e-9, "{ends:?}");
    }
}
