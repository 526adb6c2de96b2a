//! The search for the orbit of one run: starts and refinement of the mesh.

use std::f64::consts::{PI, TAU};

use crate::dynamics::newton::NewtonStep;
use crate::dynamics::orbit::{Failure, Orbit};
use crate::dynamics::periodic::FourierSeries;
use crate::dynamics::system::TorsionalSystem;
use crate::number::trig;

/// The fewest and the most intervals of a period of half a turn. Longer periods have more, in
/// proportion to a power of two.
const FEWEST: usize = 8;
const MOST: usize = 1024;

/// The most steps of Newton's method from one start.
const STEPS: usize = 20;

/// Newton's method ends when its next step would be smaller than this, relative to the twist of the
/// shafts and to the permitted error.
const MARGIN: f64 = 0.01;

/// Permitted error relative to the twist on the mesh from which the refinement begins.
const COARSE: f64 = 1e-6;

/// The largest unknown in rad: sines of larger angles need another reduction.
const FARTHEST: f64 = 1e12;

/// A change of an unknown in rad that is rounding.
const ROUNDING: f64 = 1e-14;

/// The accuracy that an orbit must have, and what is found with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct OrbitGoal {
    /// Permitted error relative to the largest value.
    pub(super) tolerance: f64,
    /// The highest order of the drive's rotation that the mesh must resolve.
    pub(super) order: f64,
    /// Whether the multipliers count.
    pub(super) stability: bool,
}

/// Where Newton's method begins, on a mesh of so many intervals for half a turn.
#[derive(Clone, Copy, Debug)]
pub(super) enum Start {
    /// As if every shaft were rigid.
    Rigid(usize),
    /// Uniform rotation behind every compliant shaft.
    Uniform(usize),
    /// The orbit that is followed from the straight driveline while its bends grow.
    Followed,
}

/// In the order in which they are tried. If an orbit has no counterpart on finer meshes, only the
/// last one is left.
const STARTS: [Start; 5] = [
    Start::Rigid(FEWEST),
    Start::Uniform(FEWEST),
    Start::Rigid(4 * FEWEST),
    Start::Uniform(4 * FEWEST),
    Start::Followed,
];

/// An orbit to which Newton's method has converged.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) orbit: Orbit,
    /// The last step of Newton's method divided by the square of the one before it, per rad.
    pub(super) contraction: f64,
    /// The torques of the compliant shafts in N m, of an orbit that has its accuracy.
    pub(super) torques: Vec<FourierSeries>,
    pub(super) drive: DriveMotion,
    /// The least and the largest torques of the compliant shafts and slopes of a free drive, where
    /// kinks make their series converge slowly.
    pub(super) extremes: Option<Vec<[f64; 2]>>,
}

/// Motion of the drive.
#[derive(Debug, Default)]
pub(super) struct DriveMotion {
    /// Its mean torque in N m.
    pub(super) torque: f64,
    /// The slope of the angle error of a free drive.
    pub(super) slope: Option<FourierSeries>,
    /// The derivative of the mean torque by the mean speed, if it is known.
    pub(super) torque_slope: Option<f64>,
}

/// The work that a search asks for next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Need {
    /// A step of Newton's method from rigid shafts.
    Rigid,
    /// A step from the orbit.
    Step,
    /// A step from the coarse orbit, on intervals of half the length.
    Halved,
    /// The series of the torques.
    Torques,
}

/// Where a search is.
#[derive(Debug)]
pub(super) enum State {
    /// It needs something on a mesh of so many intervals.
    Next(Need, usize),
    /// It needs the orbit that is followed from the straight driveline.
    Follow,
    Ended(Box<Result<Found, Failure>>),
}

/// The search for the orbit of one run, step by step.
#[derive(Debug)]
pub(super) struct Search<'a> {
    pub(super) system: &'a TorsionalSystem,
    pub(super) speed: f64,
    /// Nothing if any orbit on the mesh of the start will do.
    goal: Option<OrbitGoal>,
    /// Starts left to be tried.
    starts: &'static [Start],
    pub(super) state: State,
    pub(super) orbit: Orbit,
    /// The orbit on intervals of twice the length.
    coarse: Option<Orbit>,
    steps: usize,
    /// The change of the last step.
    last: Option<f64>,
    contraction: Option<f64>,
    /// Changes by the last halving.
    changes: [f64; 3],
    failure: Failure,
}

impl<'a> Search<'a> {
    fn new(system: &'a TorsionalSystem, speed: f64, goal: Option<OrbitGoal>) -> Self {
        Self {
            system,
            speed,
            goal,
            starts: &[],
            state: State::Ended(Box::new(Err(Failure::NotFound))),
            orbit: Orbit::default(),
            coarse: None,
            steps: 0,
            last: None,
            contraction: None,
            changes: [f64::NAN; 3],
            failure: Failure::NotFound,
        }
    }

    /// The search for the orbit at a speed of the drive in rad/s.
    pub(super) fn at(system: &'a TorsionalSystem, speed: f64, goal: OrbitGoal) -> Self {
        let mut search = Self::new(system, speed, Some(goal));
        if speed > 0.0 && speed < f64::INFINITY {
            search.starts = &STARTS;
            search.begin();
        } else {
            search.state = State::Ended(Box::new(Err(Failure::Speed)));
        }
        search
    }

    /// The orbit to which Newton's method converges from a start.
    pub(super) fn near(system: &'a TorsionalSystem, speed: f64, start: Orbit) -> Self {
        let mut search = Self::new(system, speed, None);
        search.state = State::Next(Need::Step, start.intervals);
        search.orbit = start;
        search
    }

    /// The same from rigid shafts.
    pub(super) fn near_rigid(system: &'a TorsionalSystem, speed: f64, intervals: usize) -> Self {
        let state = State::Next(Need::Rigid, intervals * system.mesh());
        Self { state, ..Self::new(system, speed, None) }
    }

    /// The refinement of an orbit.
    pub(super) fn refining(
        system: &'a TorsionalSystem,
        speed: f64,
        goal: OrbitGoal,
        found: Found,
    ) -> Self {
        let mut search = Self::new(system, speed, Some(goal));
        search.take_found(Some(found));
        search
    }

    /// Goes on with the next start.
    fn begin(&mut self) {
        let Some((start, rest)) = self.starts.split_first() else {
            self.state = State::Ended(Box::new(Err(self.failure)));
            return;
        };
        self.starts = rest;
        (self.steps, self.last, self.contraction) = (0, None, None);
        self.state = match *start {
            Start::Rigid(intervals) => State::Next(Need::Rigid, intervals * self.system.mesh()),
            Start::Uniform(intervals) => {
                let Self { system, speed, .. } = self;
                let intervals = intervals * system.mesh();
                self.orbit = Orbit::at_rest(system.unknowns(), intervals, system.half_turns);
                self.orbit.mean_torque = system.static_load(*speed);
                State::Next(Need::Step, intervals)
            }
            Start::Followed => State::Follow,
        };
    }

    /// Goes on with an orbit that was found elsewhere, if there is one.
    pub(super) fn take_found(&mut self, found: Option<Found>) {
        match found {
            Some(Found { orbit, contraction, .. }) => {
                (self.orbit, self.contraction) = (orbit, Some(contraction));
                self.changes = [f64::NAN; 3];
                self.halve();
            }
            None => self.begin(),
        }
    }

    /// The orbit at hand has no counterpart on finer meshes, or needs too many intervals.
    fn abandon(&mut self, failure: Failure) {
        if self.coarse.take().is_some() {
            self.failure = failure;
            // Starts on other meshes lead to the same orbit.
            self.starts = &self.starts[self.starts.len().saturating_sub(1)..];
        }
        self.begin();
    }

    /// Takes what a step of Newton's method has changed.
    pub(super) fn take_step(&mut self, step: Option<NewtonStep>) {
        const SAFETY: f64 = 10.0;
        let Some(NewtonStep { change, unit, .. }) = step else {
            return self.abandon(Failure::NotFound);
        };
        let tolerance = match (&self.coarse, self.goal) {
            (Some(_), Some(goal)) => goal.tolerance,
            _ => COARSE,
        };
        if let Some(last) = self.last {
            self.contraction = Some(change / (last * last));
        }
        self.last = Some(change);
        self.steps += 1;
        // The contraction, if it is known, saves the step that would only confirm the one before.
        let next =
            self.contraction.map_or(f64::INFINITY, |factor| SAFETY * factor * change * change);
        if change <= ROUNDING || next <= MARGIN * tolerance * unit {
            self.converged(unit);
        } else if self.steps == STEPS {
            self.abandon(Failure::NotFound);
        } else {
            self.state = State::Next(Need::Step, self.orbit.intervals);
        }
    }

    /// Compares the orbit with the one on intervals of twice the length.
    ///
    /// The intervals are halved until the orbit, its slopes, its harmonics and its multipliers no
    /// longer change. A fast free vibration shows in the slopes, multiplied by its order, before it
    /// shows in the orbit.
    fn converged(&mut self, unit: f64) {
        // Halving divides the error at least by the first. It divides it by the second if that was
        // observed and no free vibration is too fast for the intervals: what they leave of one
        // decreases later, when it may be all that is left.
        const GAINS: (f64, f64) = (16.0, 128.0);
        self.contraction = self.contraction.or(Some(0.0));
        if self.orbit.states.iter().any(|x| x.abs() > FARTHEST) {
            return self.abandon(Failure::NotFound);
        }
        let Some(goal) = self.goal else { return self.end(vec![], DriveMotion::default()) };
        let Some(coarse) = &self.coarse else { return self.halve() };
        let fine = &self.orbit;
        let largest = |map: &[f64]| map.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let scales = [unit, fine.largest_slope(), largest(&fine.monodromy).max(1.0)];
        let [angles, slopes] = coarse.differences(fine);
        let maps = fine.monodromy.iter().zip(&coarse.monodromy);
        let maps = maps.fold(0.0, |most: f64, (x, y)| most.max((x - y).abs()));
        let changes = [angles, slopes, if goal.stability { maps } else { 0.0 }];
        let settled_by = |most: f64| {
            (0..3).all(|i| {
                // NaN, at first, counts as no gain.
                let gain = (self.changes[i] / changes[i]).max(GAINS.0).min(most);
                changes[i] <= (gain * goal.tolerance * scales[i]).max(10.0 * ROUNDING)
            })
        };
        let settled = settled_by(GAINS.0) || settled_by(GAINS.1) && self.follows_free_vibrations();
        self.changes = changes;
        let needed = goal.order * self.system.half_turns as f64;
        if settled && self.orbit.intervals as f64 > needed {
            self.state = State::Next(Need::Torques, self.orbit.intervals);
        } else {
            self.halve();
        }
    }

    /// Whether the intervals are shorter than half a period of every free vibration.
    fn follows_free_vibrations(&self) -> bool {
        self.orbit.width() * self.system.highest_frequency() <= PI * self.speed
    }

    /// Takes the torques at the ends of the intervals, which must resolve their own harmonics.
    pub(super) fn take_torques(&mut self, torques: Vec<FourierSeries>, drive: DriveMotion) {
        let tolerance = self.goal.map_or(COARSE, |goal| goal.tolerance);
        let resolved = self.system.springs.iter().zip(&torques).all(|(spring, series)| {
            let permitted = tolerance * series.largest();
            series.tail() <= permitted.max(10.0 * ROUNDING * spring.law.stiffness_at(0.0))
        });
        if resolved { self.end(torques, drive) } else { self.halve() }
    }

    /// Goes on with intervals of half the length.
    fn halve(&mut self) {
        (self.steps, self.last) = (0, None);
        if 2 * self.orbit.intervals > MOST * self.system.mesh() {
            self.coarse = Some(Orbit::default());
            self.abandon(Failure::NotResolved);
        } else {
            self.coarse = Some(std::mem::take(&mut self.orbit));
            self.state = State::Next(Need::Halved, 2 * self.coarse().intervals);
        }
    }

    /// The orbit whose intervals are halved.
    pub(super) fn coarse(&self) -> &Orbit {
        self.coarse.as_ref().unwrap_or(&self.orbit)
    }

    fn end(&mut self, torques: Vec<FourierSeries>, drive: DriveMotion) {
        let orbit = std::mem::take(&mut self.orbit);
        let contraction = self.contraction.unwrap_or_default();
        self.state = State::Ended(Box::new(Ok(Found {
            orbit,
            contraction,
            torques,
            drive,
            extremes: None,
        })));
    }
}

impl TorsionalSystem {
    /// How many times as many intervals a mesh has as one of half a turn; a power of two.
    pub(super) fn mesh(&self) -> usize {
        self.half_turns.next_power_of_two()
    }

    /// Oscillations of the second order of several amplitudes, largest first, and phases, of all
    /// unknowns from each one on.
    pub(super) fn oscillations(&self) -> impl Iterator<Item = Orbit> {
        const AMPLITUDES: [f64; 4] = [2.0, 1.0, 0.5, 0.25];
        const PHASES: u32 = 8;
        let (m, mesh) = (self.unknowns(), (8 * FEWEST * self.mesh(), self.half_turns));
        let sizes = (0..m).flat_map(|from| AMPLITUDES.map(|size| (from, size)));
        sizes.flat_map(move |(from, size)| {
            (0..PHASES).map(move |i| {
                let phase = TAU * f64::from(i) / f64::from(PHASES);
                Orbit::start(m, mesh, |angle, [y, v, a]| {
                    let (sine, cosine) = trig::sin_cos(2.0 * angle + phase);
                    for (values, value) in [(y, sine), (v, 2.0 * cosine), (a, -4.0 * sine)] {
                        values[from..].fill(size * value);
                    }
                })
            })
        })
    }
}
