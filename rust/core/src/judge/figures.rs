//! The figures of a machine that have limits, in every state and step.

use crate::design::steering::carried;
use crate::design::tube::Tube;
use crate::design::{Excitations, Steering};
use crate::error::Result;
use crate::input::Drivelines;
use crate::input::batch::check_bearings;
use crate::judge::machine::{Arrays, Figured, LimitOf, Machine, SlidingShaft};
use crate::judge::turned::{Group, joined};
use crate::judge::{Kind, Limit, Look, Rank, Side, Stage};
use crate::mechanics::geometry::{Geometry, Vector, lengths};
use crate::run::execution::Execution;

/// One figure of a machine.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Its kind.
    pub kind: Kind,
    /// Its shaft, joint or bearing, if it is of one.
    pub item: Option<usize>,
    /// Its value in every state and then, where the kind has them, in every step of the duty cycle.
    pub values: Vec<f64>,
    /// Its limit.
    pub limit: Limit,
    /// How each value stands to it.
    pub ranks: Vec<Rank>,
    /// The place of the value that is nearest to the limit or farthest past it, or without a limit
    /// the largest or the least; none if no value is a number.
    pub worst: Option<usize>,
}

/// Quantity that may change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Variable {
    /// A joint centre or an end of the driveline, along an axis, alike in all states.
    Point {
        /// Its number from the upstream end.
        point: usize,
        /// 0 for x, 1 for y, 2 for z.
        axis: usize,
    },
    /// The phase of the yokes of a shaft between two joints.
    Phase(usize),
    /// The place of a bearing on its shaft.
    Bearing(usize),
    /// The engaged length of the spline of a shaft.
    Engaged(usize),
    /// The rating of a joint.
    Rating(usize),
}

/// A machine with one change, and what is known of its figures.
#[derive(Clone, Debug)]
pub(crate) struct Variant {
    /// The arrays of each group of cases.
    pub(crate) lines: Vec<Arrays>,
    pub(crate) ratings: Vec<f64>,
    /// Length in the drawing and engaged length of the spline.
    pub(crate) drawn: [f64; 2],
    /// Direction of shaft 0 and normal of the first bend plane in the drawing, if a steering column
    /// has one.
    column: Option<[Vector; 2]>,
    /// The stages that the change concerns.
    pub(crate) touched: &'static [Stage],
    pub(crate) values: Vec<f64>,
}

impl Machine {
    /// All figures of the machine with their ranks. A limit of what it does not have gives a figure
    /// without numbers.
    ///
    /// # Errors
    /// A plan that cannot be made.
    pub fn figures(&self, execution: Execution<'_>) -> Result<Vec<Figure>> {
        let mut variant = [self.unchanged()];
        for stage in Stage::ALL {
            let every = &mut variant.iter_mut().collect::<Vec<_>>();
            self.compute((stage, Look::Full), every, execution)?;
        }
        let mut figures = self.figures_of(&variant[0].values);
        figures.extend(self.absent.iter().map(|&LimitOf { kind, item, limit, maximum }| {
            let count = self.places(kind);
            Figure {
                kind,
                item,
                values: vec![f64::NAN; count],
                limit: Limit { limit, maximum, side: kind.row().side, size: 0.0 },
                ranks: vec![Rank::NotJudged; count],
                worst: None,
            }
        }));
        figures.sort_by_key(|figure| figure.kind);
        Ok(figures)
    }

    /// The figures with these values.
    pub(crate) fn figures_of(&self, values: &[f64]) -> Vec<Figure> {
        let of = |figured: &Figured| {
            let Figured { kind, item, limit, first, count } = *figured;
            let values = values[first..first + count].to_vec();
            let ranks = values.iter().map(|&value| limit.rank(value)).collect();
            let past = |&i: &usize| match limit.side {
                Side::Most => values[i],
                Side::Least => -values[i],
            };
            // The first of equal ones.
            let worst = (0..count)
                .filter(|&i| !values[i].is_nan())
                .rev()
                .max_by(|i, j| past(i).total_cmp(&past(j)));
            let item = kind.row().per.map(|_| item);
            Figure { kind, item, values, limit, ranks, worst }
        };
        self.figured.iter().map(of).collect()
    }

    /// The machine as it is, nothing of which is computed.
    pub(crate) fn unchanged(&self) -> Variant {
        let drawn = |spline: &SlidingShaft| [self.drawn_length(spline.shaft), spline.engaged];
        Variant {
            lines: self.cases.iter().map(|cases| cases.lines.clone()).collect(),
            ratings: self.parts.ratings.clone(),
            drawn: self.parts.spline.as_ref().map_or([0.0; 2], drawn),
            column: self.parts.drawn.as_ref().and_then(|drawn| self.column(&drawn.lines)),
            touched: &Stage::ALL,
            values: vec![f64::NAN; self.values()],
        }
    }

    /// Computes the figures of a stage for some variants, by a brief or a full look at the turn.
    pub(crate) fn compute(
        &self,
        (stage, look): (Stage, Look),
        variants: &mut [&mut Variant],
        execution: Execution<'_>,
    ) -> Result<()> {
        if variants.is_empty() || self.figured.iter().all(|one| one.kind.row().stage != stage) {
            return Ok(());
        }
        if stage == Stage::Closed {
            for variant in variants {
                self.closed(variant);
            }
            return Ok(());
        }
        for (group, cases) in self.cases.iter().enumerate() {
            let arrays = joined(variants, group);
            let lines = Drivelines::from_arrays(arrays.each_ref().map(Vec::as_slice));
            let shape = [variants.len(), cases.count];
            Group { machine: self, number: group, cases, lines, shape, look }
                .compute(stage, variants, execution)?;
        }
        Ok(())
    }

    /// Puts the value of each item of a kind in a case of a group into its place.
    pub(crate) fn put_in(
        &self,
        values: &mut [f64],
        kind: Kind,
        [group, case]: [usize; 2],
        of: impl Fn(usize) -> f64,
    ) {
        let place = if group == 0 { case } else { self.cases[0].count + case };
        for figured in self.of(kind).iter().filter(|figured| place < figured.count) {
            values[figured.first + place] = of(figured.item);
        }
    }

    fn closed(&self, variant: &mut Variant) {
        let Variant { lines, drawn, column, values, .. } = variant;
        let longest = |shaft: usize| longest(&lines[0][5], self.joints, shaft);
        for (group, cases) in self.cases.iter().enumerate() {
            let lines = Drivelines::from_arrays(lines[group].each_ref().map(Vec::as_slice));
            for case in 0..cases.count {
                let (bends, twists, phases) = lines.chain(self.joints, case);
                let (speed, at) = (cases.speed(case), [group, case]);
                let mut put = |kind, of: &dyn Fn(usize) -> f64| {
                    self.put_in(values, kind, at, of);
                };
                put(Kind::Bend, &|joint| bends[joint]);
                put(Kind::SpeedBend, &|joint| speed * bends[joint]);
                put(Kind::CriticalMargin, &|shaft| {
                    let tube = self.parts.tubes.iter().find(|tube| tube.0 == shaft);
                    tube.map_or(f64::NAN, |&(_, mut round)| {
                        if round.length.is_nan() {
                            // Steps that only turn the joints have no lengths of their own.
                            let own = lines.lengths.get(case * (self.joints + 1) + shaft);
                            round.length = own.copied().unwrap_or_else(|| longest(shaft));
                        }
                        Tube::new(round).critical_speed / speed
                    })
                });
                if group > 0 {
                    continue;
                }
                let found = Excitations::of_chain(bends, twists, phases);
                let square = speed * speed;
                put(Kind::EquivalentBend, &|_| found.bend);
                put(Kind::TorsionalExcitation, &|_| square * found.torsional);
                put(Kind::InertiaDriving, &|_| square * found.inertia_driving);
                put(Kind::InertiaCoasting, &|_| square * found.inertia_coasting);
                put(Kind::BendDifference, &|_| (bends[0] - bends[1]).abs());
                let centre = match self.parts.centres[..] {
                    [centre] => {
                        let drawn = column.unwrap_or_else(|| lines.column(self.joints, 0));
                        Some(carried(drawn, lines.column(self.joints, case), centre))
                    }
                    _ => self.parts.centres.get(case).copied(),
                };
                if let Some(centre) = centre {
                    let steering = Steering::of_chain(bends, twists, phases, centre);
                    put(Kind::SteeringOffset, &|_| steering.noticed.abs());
                    put(Kind::SteeringRatio, &|_| steering.difference);
                }
                let Some(spline) = &self.parts.spline else { continue };
                let pulled = lines.lengths[case * (self.joints + 1) + spline.shaft] - drawn[0];
                put(Kind::SplineEngaged, &|_| drawn[1] - pulled);
                put(Kind::SplinePushIn, &|_| spline.push_in + pulled);
            }
        }
        if let Some(spline) = &self.parts.spline {
            let lengths = lines[0][5].iter().skip(spline.shaft).step_by(self.joints + 1);
            let shortest = lengths.fold(f64::INFINITY, |least, &length| least.min(length));
            let travel = longest(spline.shaft) - shortest;
            self.put_in(values, Kind::SplineTravel, [0, 0], |_| travel);
        }
    }
}

impl Machine {
    /// Value of a variable in the first state.
    pub(crate) fn present(&self, variable: Variable) -> f64 {
        let lines = &self.cases[0].lines;
        match variable {
            Variable::Point { point, axis } => self.points(lines, 0)[point][axis],
            Variable::Phase(shaft) => lines[2][shaft - 1],
            Variable::Bearing(bearing) => lines[6][bearing],
            Variable::Engaged(_) => self.parts.spline.as_ref().map_or(f64::NAN, |one| one.engaged),
            Variable::Rating(joint) => self.parts.ratings[joint],
        }
    }

    /// The machine with one change; none if it cannot be made.
    pub(crate) fn changed(
        &self,
        present: &Variant,
        variable: Variable,
        by: f64,
    ) -> Option<Variant> {
        let mut variant = present.clone();
        match variable {
            Variable::Point { point, axis } => {
                for (group, arrays) in variant.lines.iter_mut().enumerate() {
                    if self.cases[group].has_lengths() {
                        self.move_point(arrays, self.cases[group].count, (point, axis, by))?;
                    }
                }
                if let Some(drawn) = self.parts.drawn.as_ref().filter(|drawn| drawn.has_lengths()) {
                    let mut arrays = drawn.lines.clone();
                    self.move_point(&mut arrays, 1, (point, axis, by))?;
                    variant.column = self.column(&arrays);
                    if let Some(spline) = &self.parts.spline {
                        variant.drawn[0] = arrays[5][spline.shaft];
                    }
                }
            }
            Variable::Phase(shaft) => {
                for arrays in &mut variant.lines {
                    arrays[2]
                        .iter_mut()
                        .skip(shaft - 1)
                        .step_by(self.joints - 1)
                        .for_each(|x| *x += by);
                }
            }
            Variable::Bearing(bearing) => {
                variant.touched = &[Stage::Forces];
                let arrays = &mut variant.lines[0];
                for position in arrays[6].iter_mut().skip(bearing).step_by(self.bearings.len()) {
                    *position += by;
                }
                let shape = [self.cases[0].count];
                check_bearings(self.joints, &shape, &self.bearings, &arrays[5], &arrays[6]).ok()?;
            }
            Variable::Engaged(_) => {
                variant.touched = &[Stage::Closed];
                variant.drawn[1] += by;
            }
            Variable::Rating(joint) => {
                variant.touched = &[Stage::Fatigue];
                variant.ratings[joint] += by;
            }
        }
        for figured in
            self.figured.iter().filter(|one| variant.touched.contains(&one.kind.row().stage))
        {
            variant.values[figured.first..figured.first + figured.count].fill(f64::NAN);
        }
        Some(variant)
    }

    /// The column of a drawing, if one angle straight ahead is for that.
    fn column(&self, drawn: &Arrays) -> Option<[Vector; 2]> {
        let lines = Drivelines::from_arrays(drawn.each_ref().map(Vec::as_slice));
        (self.parts.centres.len() == 1).then(|| lines.column(self.joints, 0))
    }

    /// Moves a point of every driveline along an axis; none if one of them cannot be so.
    fn move_point(
        &self,
        arrays: &mut Arrays,
        count: usize,
        (point, axis, by): (usize, usize, f64),
    ) -> Option<()> {
        let between = self.joints - 1;
        let mut moved: [Vec<f64>; 6] = Default::default();
        for case in 0..count {
            let mut points = self.points(arrays, case);
            points[point][axis] += by;
            let phases = &arrays[2][case * between..][..between];
            let line = Geometry::from_points(&points, phases).ok()?;
            moved[0].extend(line.bends);
            moved[1].extend(line.twists);
            moved[2].extend(line.phases);
            moved[3].extend(line.directions.iter().flatten());
            moved[4].extend(line.normals.iter().flatten());
            moved[5].extend(lengths(&points));
        }
        for (array, moved) in arrays.iter_mut().zip(moved) {
            *array = moved;
        }
        // The steps of a duty cycle may have no bearings.
        let bearings: &[usize] = if arrays[6].is_empty() { &[] } else { &self.bearings };
        check_bearings(self.joints, &[count], bearings, &arrays[5], &arrays[6]).ok()
    }

    /// Ends and joint centres of a driveline with lengths, from its upstream end.
    fn points(&self, arrays: &Arrays, case: usize) -> Vec<Vector> {
        let shafts = self.joints + 1;
        let mut at = Vector::zeros();
        let mut points = vec![at];
        for shaft in case * shafts..(case + 1) * shafts {
            at += Vector::from_column_slice(&arrays[3][3 * shaft..][..3]) * arrays[5][shaft];
            points.push(at);
        }
        points
    }
}

/// The largest length of a shaft; NaN without any.
fn longest(lengths: &[f64], joints: usize, shaft: usize) -> f64 {
    lengths.iter().skip(shaft).step_by(joints + 1).fold(f64::NAN, |most, &length| most.max(length))
}
