//! Searches that are at the same step go through it side by side.
#![allow(clippy::needless_range_loop, reason = "as in the kernels")]

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

use nalgebra::Complex;

use crate::dynamics::lanes::{LANES, Lanes, Pack, ZERO, all, make_room};
use crate::dynamics::newton::{Along, Newton, NewtonStep};
use crate::dynamics::orbit::{Failure, Orbit, Quadrature};
use crate::dynamics::periodic::{FourierSeries, SeriesSideBySide, multiple, roots_of_unity};
use crate::dynamics::search::{DriveMotion, Found, Need, Search, State};
use crate::dynamics::side_by_side::{RunsSideBySide, sines};
use crate::dynamics::system::TorsionalSystem;
use crate::mechanics::phasing::is_set;
use crate::number::elementary::turn;
use crate::run::level::{Level, compiled_up_to_avx2};

/// The memory of searches in one thread, and how they are computed.
#[derive(Debug)]
pub(super) struct Pool<'a> {
    pub(super) level: Level,
    stop: Option<&'a AtomicBool>,
    pub(super) newton: Newton,
    pub(super) runs: RunsSideBySide,
    nearby: RunsSideBySide,
    samples: Vec<Pack>,
    pub(super) series: SeriesSideBySide,
    /// The roots of unity of every number so far.
    roots: BTreeMap<usize, Vec<Complex<f64>>>,
}

/// A parameter on which systems depend.
pub(super) struct Parameter<'a> {
    /// The system with the parameter larger by `by`.
    pub(super) nearby: &'a TorsionalSystem,
    pub(super) by: f64,
    /// As of [`Along`].
    pub(super) direction: &'a [f64],
    pub(super) length: f64,
}

impl<'a> Pool<'a> {
    pub(super) fn new(level: Level, stop: Option<&'a AtomicBool>) -> Self {
        Self {
            level,
            stop,
            newton: Newton::default(),
            runs: RunsSideBySide::default(),
            nearby: RunsSideBySide::default(),
            samples: vec![],
            series: SeriesSideBySide::default(),
            roots: BTreeMap::new(),
        }
    }

    /// Results of searches. Those left when the run is stopped find nothing.
    pub(super) fn run(&mut self, mut searches: Vec<Search<'_>>) -> Vec<Result<Found, Failure>> {
        while !is_set(self.stop) {
            // Those with the same need, in order; what nearly all wait for comes last.
            let mut groups = BTreeMap::<(Need, usize), Vec<usize>>::new();
            for (i, search) in searches.iter_mut().enumerate() {
                if matches!(search.state, State::Follow) {
                    let found = search.system.followed(search.speed, self);
                    search.take_found(found);
                }
                if let State::Next(need, intervals) = search.state {
                    groups.entry((need, intervals)).or_default().push(i);
                }
            }
            let full = groups.values().find(|group| group.len() >= LANES);
            let Some(group) = full.or(groups.values().next()) else { break };
            let group = &group[..group.len().min(LANES)];
            let mut lanes: Vec<&mut Search<'_>> = searches
                .iter_mut()
                .enumerate()
                .filter(|(i, _)| group.binary_search(i).is_ok())
                .map(|(_, search)| search)
                .collect();
            self.advance(&mut lanes);
        }
        let result = |search: Search<'_>| match search.state {
            State::Ended(result) => *result,
            _ => Err(Failure::NotFound),
        };
        searches.into_iter().map(result).collect()
    }

    /// Gives searches with the same need what they need.
    fn advance(&mut self, lanes: &mut [&mut Search<'_>]) {
        let State::Next(need, intervals) = lanes[0].state else { return };
        let count = lanes.len();
        {
            let orbits: Vec<&Orbit> = lanes
                .iter()
                .map(|search| if need == Need::Halved { search.coarse() } else { &search.orbit })
                .collect();
            let runs: Vec<_> = lanes.iter().map(|search| (search.system, search.speed)).collect();
            self.runs.load(&runs);
            if need != Need::Rigid {
                self.newton.load(&orbits);
            }
        }
        if need == Need::Torques {
            let losses = self.find_torques(intervals, count);
            for (l, search) in lanes.iter_mut().enumerate() {
                let half_turns = search.system.half_turns;
                let compliant = search.system.compliant();
                let free = search.system.is_free();
                let drive = DriveMotion {
                    torque: losses[l],
                    slope: free.then(|| self.series.of(half_turns, compliant, l)),
                    torque_slope: None,
                };
                let series = (0..compliant).map(|s| self.series.of(half_turns, s, l));
                search.take_torques(series.collect(), drive);
            }
        } else {
            let steps = self.improve((need, intervals), count, None);
            for (l, search) in lanes.iter_mut().enumerate() {
                search.orbit.resize(search.system.unknowns(), intervals);
                self.newton.store(l, &mut search.orbit);
                search.take_step(steps[l]);
            }
        }
    }

    /// A step of Newton's method for one orbit and a parameter.
    pub(super) fn improve_along(
        &mut self,
        orbit: &mut Orbit,
        (system, speed): (&TorsionalSystem, f64),
        parameter: &Parameter<'_>,
    ) -> Option<NewtonStep> {
        self.newton.load(&[orbit]);
        self.runs.load(&[(system, speed)]);
        self.nearby.load(&[(parameter.nearby, speed)]);
        let [step, ..] = self.improve((Need::Step, orbit.intervals), 1, Some(parameter));
        self.newton.store(0, orbit);
        step
    }

    /// The same orbit on intervals of half the length.
    pub(super) fn halved(&mut self, orbit: &Orbit) -> Orbit {
        let lanes = Lanes::of(true, 1);
        self.newton.load(&[orbit]);
        self.newton.halve(lanes, orbit.unknowns);
        let mut fine = Orbit::at_rest(orbit.unknowns, 2 * orbit.intervals, orbit.half_turns);
        self.newton.store(0, &mut fine);
        fine
    }

    /// A step of Newton's method in so many lanes, after what is needed before it.
    fn improve(
        &mut self,
        (need, intervals): (Need, usize),
        used: usize,
        parameter: Option<&Parameter<'_>>,
    ) -> [Option<NewtonStep>; LANES] {
        let Self { level, newton, runs, nearby, .. } = self;
        let mut along = parameter.map(|&Parameter { by, direction, length, .. }| Along {
            nearby,
            by,
            direction,
            length,
        });
        let m = runs.unknowns();
        compiled_up_to_avx2!(*level, (compact, _stores) => {
            let lanes = Lanes::of(compact, used);
            match need {
                Need::Rigid => runs.rigid(lanes, newton, intervals),
                Need::Halved => newton.halve(lanes, m),
                Need::Step | Need::Torques => {}
            }
            newton.step(lanes, runs, along.as_mut(), m)
        })
    }

    /// Finds the roots of unity of this number.
    pub(super) fn roots(&mut self, count: usize) {
        self.roots.entry(count).or_insert_with(|| roots_of_unity(count));
    }

    /// Finds the series of the torques of the orbits at hand, then that of the slope of a free drive,
    /// in so many lanes. Returns the mean torques of the drives.
    fn find_torques(&mut self, intervals: usize, used: usize) -> Pack {
        self.roots(intervals);
        let Self { newton, runs, samples, series, roots, .. } = self;
        compiled_up_to_avx2!(self.level, (compact, _stores) => {
            torque_series(Lanes::of(compact, used), newton, runs, samples, series, &roots[&intervals])
        })
    }

    /// The derivatives of the mean torques of free drives by their mean speeds in N m s/rad, about
    /// orbits on meshes of the same size: what one step of Newton's method at a speed a little
    /// higher and a little lower changes.
    pub(super) fn torque_slopes(
        &mut self,
        runs: &[(&TorsionalSystem, f64)],
        orbits: &[&Orbit],
    ) -> Pack {
        const ASIDE: f64 = 1e-5;
        let mut found = ZERO;
        for side in [ASIDE, -ASIDE] {
            let aside: Vec<_> = runs.iter().map(|(s, speed)| (*s, speed * (1.0 + side))).collect();
            self.runs.load(&aside);
            self.newton.load(orbits);
            self.improve((Need::Step, orbits[0].intervals), runs.len(), None);
            for (l, (orbit, (_, speed))) in orbits.iter().zip(runs).enumerate() {
                let change = self.newton.mean_torque[l] - orbit.mean_torque;
                found[l] += 0.5 * change / (side * speed);
            }
        }
        found
    }

    /// Least and largest values of series with the same number of terms, one per lane.
    pub(super) fn extremes(&mut self, of: &[&FourierSeries]) -> [Pack; 2] {
        let count = self.series.load(of);
        self.roots(8 * count);
        let Self { series, samples, roots, .. } = self;
        let roots = &roots[&(8 * count)];
        compiled_up_to_avx2!(self.level, (compact, _stores) => {
            series.extremes(Lanes::of(compact, of.len()), samples, roots)
        })
    }

    /// The orders of the angle errors of all shaft ends of runs on meshes of the same size.
    pub(super) fn angle_orders(
        &mut self,
        runs: &[(&TorsionalSystem, f64)],
        orbits: &[&Orbit],
        orders: &[f64],
        put: &mut dyn FnMut(usize, usize, usize, Complex<f64>),
    ) {
        if orbits.len() > 1 && orbits.iter().any(|orbit| orbit.quadrature.is_some()) {
            for l in 0..orbits.len() {
                self.angle_orders(&runs[l..=l], &orbits[l..=l], orders, &mut |_, end, o, x| {
                    put(l, end, o, x);
                });
            }
            return;
        }
        self.runs.load(runs);
        self.newton.load(orbits);
        let Orbit { half_turns, intervals, .. } = *orbits[0];
        // The orders that repeat in a period; the others are zero.
        let (places, multiples): (Vec<usize>, Vec<usize>) = orders
            .iter()
            .enumerate()
            .filter_map(|(o, order)| Some((o, multiple(*order, half_turns)?)))
            .unzip();
        let (angles, turns, scale): (Vec<f64>, Vec<Complex<f64>>, f64);
        if let Some(Quadrature { nodes, states }) = orbits[0].quadrature.as_deref() {
            self.newton.states = states.iter().map(|x| all(*x)).collect();
            angles = nodes.iter().map(|[angle, _]| *angle).collect();
            let base = 2.0 / half_turns as f64;
            let weighted = |n: usize| {
                nodes.iter().map(move |[angle, weight]| turn(base * n as f64 * angle) * *weight)
            };
            turns = multiples.into_iter().flat_map(weighted).collect();
            scale = 2.0 / (PI * half_turns as f64);
        } else {
            self.roots(intervals);
            let (roots, width) = (&self.roots[&intervals], orbits[0].width());
            angles = (0..intervals).map(|k| width * k as f64).collect();
            let turned = |n: usize| (0..intervals).map(move |k| roots[n * k % intervals]);
            turns = multiples.into_iter().flat_map(turned).collect();
            scale = 2.0 / intervals as f64;
        }
        let Self { newton, runs: equations, samples, .. } = self;
        compiled_up_to_avx2!(self.level, (compact, _stores) => {
            let lanes = Lanes::of(compact, runs.len());
            angle_orders(lanes, newton, equations, samples, &angles, (&places, &turns), orders.len());
        });
        for (curve, ends) in runs[0].0.ends_of_curves().into_iter().enumerate() {
            for (o, parts) in
                samples[2 * curve * orders.len()..][..2 * orders.len()].chunks_exact(2).enumerate()
            {
                for l in 0..runs.len() {
                    let found = Complex::new(scale * parts[0][l], -scale * parts[1][l]);
                    ends.into_iter().flatten().for_each(|end| put(l, end, o, found));
                }
            }
        }
    }
}

/// The series of the torques of all compliant shafts and of the slope of a free drive. Returns the
/// mean torques of the drives.
#[inline(always)]
fn torque_series(
    lanes: Lanes,
    newton: &Newton,
    runs: &mut RunsSideBySide,
    samples: &mut Vec<Pack>,
    series: &mut SeriesSideBySide,
    roots: &[Complex<f64>],
) -> Pack {
    let (m, intervals) = (runs.unknowns(), roots.len());
    let width = newton.width(intervals);
    let mut losses = ZERO;
    samples.clear();
    make_room(samples, m * intervals);
    for (k, state) in newton.states.chunks_exact(2 * m).enumerate() {
        let (y, v) = state.split_at(m);
        runs.prepare(lanes, width * k as f64, y, v);
        for (s, torque) in runs.torques.iter().enumerate() {
            samples[s * intervals + k] = *torque;
        }
        if runs.free {
            samples[(m - 1) * intervals + k] = v[0];
        }
        runs.add_losses(lanes, v, &mut losses);
    }
    series.through(lanes, samples, roots);
    lanes.plus_scaled(ZERO, 1.0 / intervals as f64, losses)
}

/// The sums of the angle errors of all curves at given drive angles, for so many orders. Those at the
/// places given are times the cosines and the sines `(places, angles)`; the others are zero.
#[inline(always)]
fn angle_orders(
    lanes: Lanes,
    newton: &Newton,
    runs: &RunsSideBySide,
    sums: &mut Vec<Pack>,
    angles: &[f64],
    (places, turns): (&[usize], &[Complex<f64>]),
    orders: usize,
) {
    let m = runs.unknowns();
    let free = usize::from(runs.free);
    let curves = runs.pieces.len() + runs.followers.len();
    sums.clear();
    make_room(sums, 2 * curves * orders);
    if orders == 0 {
        return;
    }
    for (k, (state, angle)) in newton.states.chunks_exact(2 * m).zip(angles).enumerate() {
        let mut of_curves = sums.chunks_exact_mut(2 * orders);
        for (p, piece) in runs.pieces.iter().enumerate() {
            let error = if p + free == 0 { &ZERO } else { &state[p + free - 1] };
            let sines = sines(lanes, *angle, &piece.offset, error);
            for j in 0..=piece.followers.len() {
                let curve = match piece.followers.clone().nth(j.wrapping_sub(1)) {
                    Some(f) => {
                        lanes.plus_scaled(*error, 1.0, runs.followers[f].angle_error(lanes, &sines))
                    }
                    None => *error,
                };
                let Some(sums) = of_curves.next() else { continue };
                for (o, turns) in places.iter().zip(turns.chunks_exact(angles.len())) {
                    sums[2 * o] = lanes.plus_scaled(sums[2 * o], turns[k].re, curve);
                    sums[2 * o + 1] = lanes.plus_scaled(sums[2 * o + 1], turns[k].im, curve);
                }
            }
        }
    }
}
