//! The smallest single changes of a machine that bring everything within its limits.
//!
//! Every change is tried outwards from what the machine has, in equal steps to both sides, until
//! all figures keep their limits in all states. The boundary is then found by bisection. Where no
//! step suffices, the best one is searched between its neighbours, since what suffices may lie
//! between two steps. Changes of all kinds take their steps together, and a figure that decides
//! against a step spares it those that take longer.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::error::{Error, Result, Rule};
use crate::judge::figures::{Variable, Variant};
use crate::judge::machine::Machine;
use crate::judge::{Figure, Look, Rank, Stage};
use crate::run::execution::Execution;

/// Steps to either side.
const STEPS: usize = 24;

/// Halvings of a step about the best one, and of the interval in which the boundary is.
const HALVINGS: usize = 10;
const BISECTIONS: usize = 24;

/// The most teeth of a spline, whose turns are all tried.
const TEETH: usize = 1000;

/// Figures computed for a change, as long as none decides against it.
const LOOKS: [(Stage, Look); 9] = [
    (Stage::Closed, Look::Full),
    (Stage::Torque, Look::Brief),
    (Stage::Forces, Look::Brief),
    (Stage::Friction, Look::Full),
    (Stage::Fatigue, Look::Full),
    (Stage::Play, Look::Brief),
    (Stage::Torque, Look::Full),
    (Stage::Play, Look::Full),
    (Stage::Forces, Look::Full),
];

/// Range of the search.
#[derive(Clone, Debug, Default)]
pub struct Search {
    /// By how much a point, a bearing and the engaged length may change, in m.
    pub reach: f64,
    /// Teeth of the spline of each shaft between two joints, by which its yokes can be turned; 0 if
    /// they can be set at will. Empty if none has teeth.
    pub teeth: Vec<usize>,
    /// The ratings of the joints that there are, in N·m.
    pub ratings: Vec<f64>,
}

/// A single change.
#[derive(Clone, Debug)]
pub struct Change {
    /// The variable.
    pub variable: Variable,
    /// Its value in the first state; points count from the upstream end.
    pub from: f64,
    /// Its new value.
    pub to: f64,
    /// The size of the change as a part of what was tried.
    pub share: f64,
    /// The worst rank of all figures after it; all are within if this one is.
    pub verdict: Rank,
    /// The figure that is then nearest to its limit or farthest past it.
    pub worst: Option<Figure>,
}

/// One sense in which a variable changes.
struct Way {
    variable: Variable,
    sign: f64,
    /// Changes without their sign, ascending.
    steps: Vec<f64>,
    /// Whether what lies between two steps is possible.
    is_continuous: bool,
    /// The best change, and how far the worst figure is past its limit after it.
    best: (f64, f64),
    /// A change that does not suffice and a larger one that does.
    bracket: Option<[f64; 2]>,
}

impl Way {
    /// Takes note of a change; no change between the one `before` and it was tried.
    fn note(&mut self, before: f64, change: f64, excess: f64) {
        if excess < self.best.1 {
            self.best = (change, excess);
        }
        if excess <= 0.0 && self.bracket.is_none() {
            self.bracket = Some([before, change]);
        }
    }
}

impl Machine {
    /// The smallest single changes that bring everything within its limits, smallest first: their
    /// sizes are compared as parts of what was tried. If none does, the one change after which the
    /// worst figure is least past its limit, over this limit, if it is better than none. Nothing if
    /// everything is within.
    ///
    /// # Errors
    /// As for [`Machine::searching`].
    pub fn suggest(&self, search: &Search, execution: Execution<'_>) -> Result<Vec<Change>> {
        let mut searching = self.searching(search, execution)?;
        while searching.advance(execution)? {}
        searching.changes(execution)
    }

    /// The same search, which its caller advances.
    ///
    /// # Errors
    /// As for [`Machine::figures`], and splines of more than 1000 teeth.
    pub fn searching(&self, search: &Search, execution: Execution<'_>) -> Result<Searching> {
        if let Some(place) = search.teeth.iter().position(|&teeth| teeth > TEETH) {
            let rule = Rule::new("", "it must be at most 1000");
            return Err(Error::of_value("teeth", &[place], search.teeth[place] as f64, rule));
        }
        let machine = self.limited();
        let mut present = machine.unchanged();
        for stage in Stage::ALL {
            machine.compute((stage, Look::Full), &mut [&mut present], execution)?;
        }
        let excess = machine.excess(&present, &present, &Stage::ALL);
        let trials = Trials { machine, present, least: excess };
        let ways = if excess <= 0.0 { vec![] } else { trials.ways(search) };
        let outwards = ways.iter().map(|way| way.steps.len()).max().unwrap_or(0);
        Ok(Searching { trials, ways, excess, outwards, round: 0 })
    }

    /// How far the worst figure of some stages is past its limit, over this limit. What is known of
    /// the present machine and not of a variant makes this one impossible.
    fn excess(&self, variant: &Variant, present: &Variant, stages: &[Stage]) -> f64 {
        let mut worst = f64::NEG_INFINITY;
        for figured in self.figured.iter().filter(|one| stages.contains(&one.kind.row().stage)) {
            for place in figured.first..figured.first + figured.count {
                let value = variant.values[place];
                let lost = value.is_nan() && !present.values[place].is_nan();
                worst = worst.max(if lost { f64::INFINITY } else { figured.limit.excess(value) });
            }
        }
        worst
    }
}

/// A search in rounds of some milliseconds, between which its caller can do something else.
pub struct Searching {
    trials: Trials,
    ways: Vec<Way>,
    /// How far the worst figure is past its limit without a change, over this limit.
    excess: f64,
    /// Rounds in which steps are taken, and those that have passed.
    outwards: usize,
    round: usize,
}

impl Searching {
    /// Tries a change of each variable; false once there are none left to try.
    ///
    /// # Errors
    /// As for [`Machine::figures`].
    pub fn advance(&mut self, execution: Execution<'_>) -> Result<bool> {
        let Self { trials, ways, outwards, round, .. } = self;
        match *round {
            step if step < *outwards => trials.outwards(ways, step, execution)?,
            step if step < *outwards + HALVINGS => {
                trials.about_the_best(ways, step - *outwards + 1, execution)?;
            }
            step if step < *outwards + HALVINGS + BISECTIONS => trials.bisect(ways, execution)?,
            _ => return Ok(false),
        }
        *round += 1;
        Ok(!ways.is_empty())
    }

    /// The changes found.
    ///
    /// # Errors
    /// As for [`Machine::figures`].
    pub fn changes(&self, execution: Execution<'_>) -> Result<Vec<Change>> {
        let Self { trials, ways, excess, .. } = self;
        let mut found: Vec<(&Way, f64)> = vec![];
        for way in ways.iter().filter_map(|way| way.bracket.map(|[_, to]| (way, to))) {
            // Of both senses the smaller change.
            match found.iter_mut().find(|other| other.0.variable == way.0.variable) {
                Some(other) if way.1 < other.1 => *other = way,
                Some(_) => {}
                None => found.push(way),
            }
        }
        if found.is_empty() {
            let nearest = ways.iter().min_by(|a, b| a.best.1.total_cmp(&b.best.1));
            found.extend(nearest.filter(|way| way.best.1 < *excess).map(|way| (way, way.best.0)));
        }
        let change = |(way, by)| trials.change(way, by, execution);
        let mut changes: Vec<Change> = found.into_iter().map(change).collect::<Result<_>>()?;
        changes.sort_by(|a, b| a.share.total_cmp(&b.share));
        Ok(changes)
    }
}

/// The changes of one machine that are tried.
struct Trials {
    machine: Machine,
    present: Variant,
    /// The least excess of all changes so far; beyond it nobody needs to know.
    least: f64,
}

impl Trials {
    /// Every sense of every variable that the machine has.
    fn ways(&self, search: &Search) -> Vec<Way> {
        let Machine { joints, bearings, cases, parts, .. } = &self.machine;
        let states = &cases[0];
        let equal = |reach: f64| -> Vec<f64> {
            (1..=STEPS).map(|i| reach * i as f64 / STEPS as f64).collect()
        };
        let mut ways = vec![];
        let mut add = |variable, sign, steps: Vec<f64>, is_continuous| {
            if !steps.is_empty() {
                let best = (0.0, f64::INFINITY);
                ways.push(Way { variable, sign, steps, is_continuous, best, bracket: None });
            }
        };
        let signs = [1.0, -1.0];
        if states.has_lengths() && search.reach > 0.0 {
            for (point, axis) in
                (0..joints + 2).flat_map(|point| (0..3).map(move |axis| (point, axis)))
            {
                for sign in signs {
                    add(Variable::Point { point, axis }, sign, equal(search.reach), true);
                }
            }
            for (bearing, sign) in (0..bearings.len()).flat_map(|i| signs.map(|sign| (i, sign))) {
                add(Variable::Bearing(bearing), sign, equal(search.reach), true);
            }
            for spline in parts.spline.iter().filter(|spline| !spline.engaged.is_nan()) {
                for sign in signs {
                    add(Variable::Engaged(spline.shaft), sign, equal(search.reach), true);
                }
            }
        }
        for (shaft, sign) in (1..*joints).flat_map(|shaft| signs.map(|sign| (shaft, sign))) {
            // Half a turn of a yoke changes nothing.
            match search.teeth.get(shaft - 1) {
                Some(&teeth) if teeth > 0 => {
                    let pitch = 2.0 * PI / teeth as f64;
                    let turns = (1..=teeth / 2).map(|tooth| tooth as f64 * pitch).collect();
                    add(Variable::Phase(shaft), sign, turns, false);
                }
                _ => add(Variable::Phase(shaft), sign, equal(FRAC_PI_2), true),
            }
        }
        for (joint, &rating) in parts.ratings.iter().enumerate() {
            for sign in signs {
                let other = |&other: &f64| sign * (other - rating);
                let mut steps: Vec<f64> =
                    search.ratings.iter().map(other).filter(|&by| by > 0.0).collect();
                steps.sort_by(f64::total_cmp);
                add(Variable::Rating(joint), sign, steps, false);
            }
        }
        ways
    }

    /// Tries a step of all ways that do not suffice yet.
    fn outwards(&mut self, ways: &mut [Way], step: usize, execution: Execution<'_>) -> Result<()> {
        self.each(ways, execution, |way| {
            let change = way.steps.get(step).copied().filter(|_| way.bracket.is_none())?;
            Some([if step > 0 { way.steps[step - 1] } else { 0.0 }, change])
        })
    }

    /// Tries what lies about the best step of those that do not suffice.
    fn about_the_best(
        &mut self,
        ways: &mut [Way],
        halving: usize,
        execution: Execution<'_>,
    ) -> Result<()> {
        let half = 0.5_f64.powi(halving as i32);
        let centres: Vec<f64> = ways.iter().map(|way| way.best.0).collect();
        for side in [-1.0, 1.0] {
            let mut centres = centres.iter();
            self.each(ways, execution, |way| {
                let (centre, by) = (*centres.next()?, half * way.steps[0]);
                let tried = way.is_continuous && way.bracket.is_none();
                let change = centre + side * by;
                (tried && change > 0.0 && change < way.steps[way.steps.len() - 1])
                    .then_some([if side < 0.0 { centre - 2.0 * by } else { centre }, change])
            })?;
        }
        Ok(())
    }

    /// Bisects what lies between a change that does not suffice and one that does.
    fn bisect(&self, ways: &mut [Way], execution: Execution<'_>) -> Result<()> {
        let middle = |way: &Way| {
            let [short, enough] = way.bracket.filter(|_| way.is_continuous)?;
            Some(0.5 * (short + enough))
        };
        let changes: Vec<Option<f64>> = ways.iter().map(middle).collect();
        let found = self.tried(ways, &changes, execution)?;
        for ((way, change), excess) in ways.iter_mut().zip(changes).zip(found) {
            if let (Some([short, enough]), Some(change)) = (&mut way.bracket, change) {
                *(if excess <= 0.0 { enough } else { short }) = change;
            }
        }
        Ok(())
    }

    /// Tries a change of each way that has one, given behind the one before it.
    fn each(
        &mut self,
        ways: &mut [Way],
        execution: Execution<'_>,
        mut of: impl FnMut(&Way) -> Option<[f64; 2]>,
    ) -> Result<()> {
        let pairs: Vec<Option<[f64; 2]>> = ways.iter().map(&mut of).collect();
        let changes: Vec<Option<f64>> = pairs.iter().map(|pair| Some(pair.as_ref()?[1])).collect();
        let found = self.tried(ways, &changes, execution)?;
        for ((way, pair), excess) in ways.iter_mut().zip(pairs).zip(found) {
            if let Some([before, change]) = pair {
                way.note(before, change, excess);
                self.least = self.least.min(excess.max(0.0));
            }
        }
        Ok(())
    }

    /// How far the worst figure is past its limit after a change of each way that has one; of
    /// changes that are worse than the best one so far, how far some figure is.
    fn tried(
        &self,
        ways: &[Way],
        changes: &[Option<f64>],
        execution: Execution<'_>,
    ) -> Result<Vec<f64>> {
        let variant = |(way, change): (&Way, &Option<f64>)| {
            self.machine.changed(&self.present, way.variable, way.sign * (*change)?)
        };
        let mut variants: Vec<Option<Variant>> = ways.iter().zip(changes).map(variant).collect();
        let mut found = vec![f64::INFINITY; ways.len()];
        for (variant, found) in variants.iter().zip(&mut found) {
            if let Some(variant) = variant {
                let untouched: Vec<Stage> =
                    Stage::ALL.into_iter().filter(|one| !variant.touched.contains(one)).collect();
                *found = self.machine.excess(variant, &self.present, &untouched);
            }
        }
        for (stage, look) in LOOKS {
            let (mut alive, mut places) = (vec![], vec![]);
            for (place, variant) in variants.iter_mut().enumerate() {
                let touched = |one: &&mut Variant| one.touched.contains(&stage);
                if let Some(variant) = variant.as_mut().filter(touched)
                    && found[place] <= self.least
                {
                    alive.push(variant);
                    places.push(place);
                }
            }
            self.machine.compute((stage, look), &mut alive, execution)?;
            for (variant, place) in alive.into_iter().zip(places) {
                let excess = self.machine.excess(variant, &self.present, &[stage]);
                found[place] = found[place].max(excess);
            }
        }
        Ok(found)
    }

    /// A change with all that is known after it.
    fn change(&self, way: &Way, by: f64, execution: Execution<'_>) -> Result<Change> {
        let machine = &self.machine;
        let made = machine.changed(&self.present, way.variable, way.sign * by);
        let mut variant = made.unwrap_or_else(|| self.present.clone());
        for &stage in variant.touched {
            machine.compute((stage, Look::Full), &mut [&mut variant], execution)?;
        }
        let figures = machine.figures_of(&variant.values);
        let verdict = figures.iter().flat_map(|one| &one.ranks).max().copied().unwrap_or_default();
        let excess = |figure: &Figure| {
            figure
                .worst
                .map_or(f64::NEG_INFINITY, |worst| figure.limit.excess(figure.values[worst]))
        };
        let worst = figures.into_iter().max_by(|a, b| excess(a).total_cmp(&excess(b)));
        let from = machine.present(way.variable);
        Ok(Change {
            variable: way.variable,
            from,
            to: from + way.sign * by,
            share: by / way.steps[way.steps.len() - 1],
            verdict,
            worst,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::{Batch, Drivelines};
    use crate::judge::machine::{Cases, LimitOf, Parts};
    use crate::judge::{Kind, Limit};
    use crate::mechanics::geometry::{Geometry, Vector};
    use crate::number::elementary::{atan, tan};

    #[test]
    fn each_point_is_moved_to_the_limit() {
        let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.2]].map(|[x, y]| Vector::new(x, y, 0.0));
        let Geometry { bends, directions, normals, .. } =
            Geometry::from_points(&points, &[]).unwrap();
        let flat = |vectors: &[Vector]| vectors.iter().flatten().copied().collect::<Vec<f64>>();
        let (directions, normals) = (flat(&directions), flat(&normals));
        let lengths = [1.0, (points[2] - points[1]).norm()];
        let lines = Drivelines {
            bends: &bends,
            directions: &directions,
            normals: &normals,
            lengths: &lengths,
            ..Drivelines::default()
        };
        let batch = Batch::new(1, &[], &[], &lines).unwrap();
        let states = Cases::new(&batch, &lines, &[0.0], None).unwrap();
        let limit = LimitOf { kind: Kind::Bend, item: Some(0), limit: 0.1, maximum: 0.1 };
        let machine = Machine::new(1, &[], states, None, Parts::default(), &[limit]).unwrap();
        let search = Search { reach: 0.15, ..Search::default() };
        let found = machine.suggest(&search, Execution::default()).unwrap();
        let along_y: Vec<&Change> = found
            .iter()
            .filter(|one| matches!(one.variable, Variable::Point { axis: 1, .. }))
            .collect();
        let by: Vec<f64> = along_y.iter().map(|one| one.to - one.from).collect();
        assert!((atan(0.2 - by[0]) - atan(by[0]) - 0.1).abs() < 1e-8);
        assert!((by[1] + tan(atan(0.2) - 0.1)).abs() < 1e-8);
        assert!((by[2] + 0.2 - tan(0.1)).abs() < 1e-8);
        assert!(found.iter().all(|one| one.verdict == Rank::Within));
        let shares: Vec<f64> = found.iter().map(|one| one.share).collect();
        assert!(shares.is_sorted());
        let bend = found[0].worst.as_ref().unwrap();
        assert_eq!(bend.limit, Limit { limit: 0.1, maximum: 0.1, ..bend.limit });
    }
}
