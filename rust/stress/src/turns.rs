//! What outputs do over a turn: orders, peaks, and the means behind losses and lives.
//!
//! The oracle is the vector picture of [`crate::exact`], integrated over the whole turn between the
//! angles at which a pin stops or a torque reverses, which bisection finds. The rule is the
//! double exponential one, whose nodes gather at the ends of an interval, where steep joints are
//! fastest.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use cardan::{Axes, Execution, Geometry, Output, Rows, Sought, Turns, Wear, hours, pin_means};

use crate::error_table::{ErrorTable, RowLimits};
use crate::exact::{Frames, OUTPUTS, Turn};
use crate::judge;
use crate::loading::{LoadedDriveline, Loading};
use crate::loads::LoadShape;
use crate::samples::Random;
use crate::shape_errors::ShapeErrors;
use crate::space::dot;
use crate::wide::Wide;

/// What the report says above the table.
const ABOUT: &str = r"Means and orders over a turn are judged in parts of the largest value of their output, of a vector in
parts of its length, and in parts of the bound that is returned with them; peaks in parts of the exact peak,
and so is what the output is less at their places; means of friction and fatigue in parts of the mean
magnitude; lives in parts of themselves. The oracle integrates the vector picture over the whole turn,
between the angles at which bisection finds a pin or a torque that reverses.
";

/// What is judged.
const NAMES: [&str; 8] = [
    "orders",
    "orders over the driven angle",
    "bound",
    "peaks",
    "places of peaks",
    "friction",
    "fatigue",
    "life",
];

const ORDERS: [usize; 3] = [1, 2, 4];

/// The worst errors of a kind of chain.
type TurnErrors = ShapeErrors<LoadShape, 2, 8>;

/// The largest errors of drivelines with and without a joint near 90°.
const ROWS: [&str; 2] = ["default", "default, steep"];

fn limits() -> [RowLimits<8>; 2] {
    let of = |column| {
        NAMES.map(|name| judge::limit("turn", name, column).unwrap_or_else(|| panic!("{name}")))
    };
    let row = |row: usize, limits| RowLimits { name: ROWS[row], single: true, limits };
    [row(0, of("worst")), row(1, of("worst_steep"))]
}

/// Judges a few drivelines of each kind: each takes some tenths of a second.
pub(crate) fn table(seed: u64, samples: u64) -> ErrorTable {
    let found = run(seed, samples / 2500);
    ErrorTable::of(("Turns", ABOUT), NAMES, &limits(), &found, LoadShape::name)
}

/// At least so many drivelines of each kind.
fn run(seed: u64, lines: u64) -> Vec<TurnErrors> {
    let mut random = Random::new(seed ^ 0x7042);
    ShapeErrors::of_each(&LoadShape::ALL, lines, |shape, found| {
        judge(&shape.line(&mut random), &mut random, found);
    })
}

/// A driveline and its load at a drive angle.
struct Instant {
    drive: f64,
    /// Of the last shaft.
    driven: f64,
    ratio: f64,
    /// The components of every shaft and joint, of speed ratios first, then of [`OUTPUTS`].
    items: Vec<Vec<f64>>,
    /// The sizes of the moments of the joints, and the rates of their crosses in both yokes.
    pins: Vec<[f64; 3]>,
    /// The torsion that enters each joint.
    torsions: Vec<f64>,
}

impl Instant {
    /// The rates of all crosses.
    fn swings(&self) -> Vec<f64> {
        self.pins.iter().flat_map(|&[_, driving, driven]| [driving, driven]).collect()
    }

    /// Each component with its orders, over the drive angle and over the driven one.
    fn orders(&self) -> Vec<f64> {
        let mut all = vec![];
        for (angle, weight) in [(self.drive, 1.0), (self.driven, self.ratio)] {
            let waves = ORDERS.map(|order| (order as f64 * angle).sin_cos());
            for x in self.items.iter().flatten().map(|x| x * weight) {
                all.push(x);
                all.extend(waves.iter().flat_map(|(s, c)| [2.0 * x * c, -2.0 * x * s]));
            }
        }
        all
    }

    /// The torque of the drive with its magnitude, then of each joint friction and way, and then of
    /// each joint torque, harm of the pins in both yokes, and their ways.
    fn wear(&self) -> Vec<f64> {
        // Behind the speed ratios, as many as shafts.
        let drive = self.items[self.pins.len() + 1][0];
        let mut all = vec![drive, drive.abs()];
        for [moment, driving, driven] in self.pins.iter().map(|own| own.map(f64::abs)) {
            all.extend([moment * (driving + driven), driving + driven]);
        }
        for (torsion, own) in self.torsions.iter().zip(&self.pins) {
            let [moment, driving, driven] = own.map(f64::abs);
            let harm = moment.powf(10.0 / 3.0);
            all.extend([torsion.abs(), harm * driving, harm * driven, driving, driven]);
        }
        all
    }
}

/// A driveline with its load.
struct TurnOracle<'a> {
    frames: Frames,
    loading: &'a Loading,
}

/// A drive angle, and what is there.
type Node = (Wide, Instant);

/// An interval of the drive angle.
type Panel = [Wide; 2];

/// A place in an interval and its weight in the double exponential rule.
fn node([start, end]: Panel, t: f64) -> (Wide, f64) {
    let width = (end - start).high;
    let y = FRAC_PI_2 * t.sinh();
    let inside = width / (1.0 + (2.0 * y.abs()).exp());
    let place = if t < 0.0 { start + Wide::from(inside) } else { end - Wide::from(inside) };
    (place, width * FRAC_PI_2 * t.cosh() / (2.0 * y.cosh() * y.cosh()))
}

/// The finest steps of the rule are `2^−FINEST`.
const FINEST: i32 = 8;

/// Beyond this the rule has no weight.
const FAR: f64 = 3.5;

impl TurnOracle<'_> {
    fn at(&self, angle: Wide) -> Instant {
        let at = Turn::by(&[angle.high, angle.low]);
        let motions = self.frames.motions(&at);
        let outputs = self.frames.outputs(self.loading, &at);
        let of = |output| {
            let place = OUTPUTS.iter().position(|&own| own == output).expect("it is judged");
            &outputs[place]
        };
        let directions = &self.frames.axes.directions;
        let torsion =
            |(moment, &u): (&Vec<Wide>, _)| dot([moment[0], moment[1], moment[2]], u).high;
        let torsions = of(Output::Moment).iter().zip(directions).map(torsion).collect();
        let pins = [Output::PinMoment, Output::SwingDriving, Output::SwingDriven].map(of);
        let joints = 0..directions.len() - 1;
        let pins = joints.map(|joint| pins.map(|items| items[joint][0].high)).collect();
        let last = motions.last().expect("there are shafts");
        let ratios = motions.iter().map(|own| vec![own.ratio]);
        let high = |item: &Vec<Wide>| item.iter().map(|x| x.high).collect();
        Instant {
            drive: angle.high,
            driven: last.angle.high,
            ratio: last.ratio.high,
            items: ratios
                .chain(outputs.iter().flatten().cloned())
                .map(|item| high(&item))
                .collect(),
            torsions,
            pins,
        }
    }

    /// Where any of several functions changes its sign between neighbouring places.
    fn zeros(&self, places: &[Wide], of: impl Fn(&Instant) -> Vec<f64>) -> Vec<Wide> {
        let values: Vec<Vec<f64>> = places.iter().map(|&place| of(&self.at(place))).collect();
        let mut zeros = vec![];
        for (ends, both) in places.windows(2).zip(values.windows(2)) {
            for (i, (&before, &after)) in both[0].iter().zip(&both[1]).enumerate() {
                if (before > 0.0) == (after > 0.0) {
                    continue;
                }
                let [mut start, mut end] = [ends[0], ends[1]];
                while (end - start).high > 1e-13 {
                    let middle = (start + end).scaled(0.5);
                    let same = (of(&self.at(middle))[i] > 0.0) == (before > 0.0);
                    if same { start = middle } else { end = middle }
                }
                zeros.push(start);
            }
        }
        zeros
    }

    /// The intervals of a turn within which nothing has a kink.
    fn panels(&self) -> Vec<Panel> {
        let step = |i: i32| Wide::from(0.1 + f64::from(i) * TAU / 64.0);
        let mut cuts = self.zeros(&(0..=64).map(step).collect::<Vec<_>>(), Instant::swings);
        // A torque may reverse twice where a steep joint is fast: near the ends.
        let within = |panel| (-48..=48).map(move |i| node(panel, f64::from(i) / 16.0).0);
        let steps: Vec<Wide> = panels_of(&mut cuts).into_iter().flat_map(within).collect();
        cuts.extend(self.zeros(&steps, |at| at.torsions.clone()));
        panels_of(&mut cuts)
    }

    /// The means of functions over panels that are a turn, and the instants at all nodes. There are none
    /// where a torque reverses twice between the places at which zeros are looked for.
    fn means(&self, panels: &[Panel]) -> Option<(Vec<f64>, Vec<Node>)> {
        let of = |at: &Instant| [at.orders(), at.wear()].concat();
        let (mut means, mut instants) = (vec![], vec![]);
        for &panel in panels {
            let mut sums: Vec<[Wide; 2]> = vec![];
            for level in 1..=FINEST {
                let (step, before) = (0.5_f64.powi(level), sums.clone());
                let last = (FAR / step).floor() as i32;
                for i in (-last..=last).filter(|i| level == 1 || i % 2 != 0) {
                    let (place, weight) = node(panel, f64::from(i) * step);
                    let at = self.at(place);
                    let values = of(&at);
                    sums.resize(values.len(), [Wide::ZERO; 2]);
                    for (sum, value) in sums.iter_mut().zip(values) {
                        let part = value * weight;
                        *sum = [sum[0] + Wide::from(part), sum[1] + Wide::from(part.abs())];
                    }
                    instants.push((place, at));
                }
                // Each level has twice the digits of the one before.
                let settled = |(now, before): (&[Wide; 2], &[Wide; 2])| {
                    (now[0].high - 2.0 * before[0].high).abs() <= 1e-12 * now[1].high
                };
                if level > 1 && sums.iter().zip(&before).all(settled) {
                    means.resize(sums.len(), Wide::ZERO);
                    for (mean, sum) in means.iter_mut().zip(&sums) {
                        *mean = *mean + sum[0] * (step / TAU);
                    }
                    break;
                }
                if level == FINEST {
                    return None;
                }
            }
        }
        instants.sort_by(|(a, _), (b, _)| (*a - *b).high.total_cmp(&0.0));
        Some((means.into_iter().map(|mean| mean.high).collect(), instants))
    }

    /// The largest of the sizes of an item over half a turn, to which it repeats.
    fn peak(&self, instants: &[Node], size: impl Fn(&Instant) -> f64) -> [f64; 2] {
        let half = instants[0].0 + Wide::from(PI + 0.2);
        let own = instants.iter().take_while(|(place, _)| (*place - half).high < 0.0);
        let sizes: Vec<(Wide, f64)> = own.map(|(place, at)| (*place, size(at))).collect();
        let mut top = sizes.iter().fold(0.0_f64, |top, one| top.max(one.1));
        let low = sizes.iter().fold(top, |low, one| low.min(one.1));
        let least = 0.95 * top;
        for near in sizes.windows(3) {
            let is_peak = near[1].1 >= near[0].1 && near[1].1 >= near[2].1 && near[1].1 > least;
            let mut ends = [near[0].0, near[2].0];
            // By the golden section; nearer places differ by less than rounding.
            while is_peak && low < (1.0 - 1e-9) * top && (ends[1] - ends[0]).high > 1e-9 {
                let part = (ends[1] - ends[0]) * 0.381_966_011_250_105;
                let inner = [ends[0] + part, ends[1] - part];
                let [left, right] = inner.map(|place| size(&self.at(place)));
                top = top.max(left).max(right);
                if left > right { ends[1] = inner[1] } else { ends[0] = inner[0] }
            }
        }
        [top, low]
    }
}

/// The intervals of a turn between some places, of which those that are alike count once.
fn panels_of(cuts: &mut Vec<Wide>) -> Vec<Panel> {
    cuts.sort_by(|a, b| (*a - *b).high.total_cmp(&0.0));
    cuts.dedup_by(|next, cut| (*next - *cut).high < 1e-9);
    let end = cuts[0] + Wide::from(TAU);
    let ends: Vec<Wide> = cuts.iter().copied().chain([end]).collect();
    ends.windows(2).map(|ends| [ends[0], ends[1]]).collect()
}

/// The length of a vector, or the magnitude of a number.
fn length(item: &[f64]) -> f64 {
    item.iter().fold(0.0, |length: f64, x| length.hypot(*x))
}

/// The life of a joint in hours, from the means of its torque, harms and ways.
fn life(means: &[f64], bend: f64, rpm: f64, rating: f64) -> f64 {
    let of = |harm: f64, way: f64| {
        let equivalent = (harm / way).powf(0.3);
        1.5e6 / (bend.to_degrees().max(3.0) * rpm) * (rating / equivalent).powf(10.0 / 3.0)
    };
    let lives = [of(means[1], means[3]), of(means[2], means[4])];
    let failing = lives.map(|life| 0.5 * life.powf(-9.0 / 8.0));
    (failing[0] + failing[1]).powf(-8.0 / 9.0)
}

fn judge(line: &Geometry, random: &mut Random, found: &mut TurnErrors) {
    let n = line.bends.len();
    let steep = usize::from(found.shape == LoadShape::Steep);
    let (loading, rating) = (Loading::of(random, n + 1), random.between(1.0, 9.0));
    let outputs = [&[Output::SpeedRatio], &OUTPUTS[..]].concat();
    let loaded = LoadedDriveline {
        line,
        loading: &loading,
        angles: &[],
        outputs: &outputs,
        layout: None,
        deviations: &[],
        repeated: false,
        axes: Axes::Space,
    };
    let oracle = TurnOracle { frames: Frames::of(line), loading: &loading };
    let Some((means, instants)) = oracle.means(&oracle.panels()) else { return };
    let items = &instants[0].1.items;
    let (planes, each) = (items.iter().flatten().count(), 1 + 2 * ORDERS.len());
    let place = |what: &str, got: f64, want: f64| {
        let Geometry { bends, twists, phases, .. } = line;
        format!(
            "{what} at bends {bends:?}, twists {twists:?}, phases {phases:?}, {loading:?}: \
             {got:e} instead of {want:e}"
        )
    };
    let core = |outputs: &[Output], turn: &mut dyn FnMut(&Turns<'_>, &Rows<'_>)| {
        let loaded = LoadedDriveline { outputs, ..loaded };
        let planned = loaded.planned(|plan, lines, load| {
            let rows = Rows { shape: &[1], lines, line_strides: &[0], load: Some(load) };
            turn(&Turns::new(plan, &rows), &rows);
        });
        planned.expect("the request is sound");
    };
    let largest: Vec<[f64; 2]> =
        (0..items.len()).map(|i| oracle.peak(&instants, |at| length(&at.items[i]))).collect();
    let slowest: Vec<f64> =
        (0..=n).map(|i| 1.0 / oracle.peak(&instants, |at| 1.0 / at.items[i][0])[0]).collect();
    core(&outputs, &mut |turns, rows| {
        for (driven, wanted) in means[..2 * planes * each].chunks(planes * each).enumerate() {
            let orders = turns.orders(&ORDERS, driven == 1, 0.0, alone()).expect("they fit");
            let mut plane = 0;
            for (item, components) in items.iter().enumerate() {
                for component in 0..components.len() {
                    let amplitudes = &orders.amplitudes[plane * ORDERS.len()..][..ORDERS.len()];
                    let got = [&[orders.mean[plane]], amplitudes.as_flattened()].concat();
                    for (i, (got, want)) in got.iter().zip(&wanted[plane * each..]).enumerate() {
                        let what = || {
                            let what = format!("item {item}, component {component}, part {i}");
                            place(&what, *got, *want)
                        };
                        let off = (got - want).abs();
                        found.take(steep, driven, part(off, largest[item][0]), what);
                        found.take(steep, 2, part(off, orders.error[plane]), what);
                    }
                    plane += 1;
                }
            }
        }
        for (item, (peak, &[top, low])) in turns
            .peaks(Sought::Largest, alone())
            .expect("they fit")
            .iter()
            .zip(&largest)
            .enumerate()
        {
            let what = || place(&format!("peak of item {item}"), peak.value, top);
            found.take(steep, 3, part((peak.value - top).abs(), top), what);
            for &angle in &peak.places {
                let there = length(&oracle.at(Wide::from(angle)).items[item]);
                let what = || place(&format!("item {item} at {angle:?}"), there, top);
                found.take(steep, 4, part(top - there, top), what);
            }
            if peak.places.is_empty() {
                found.take(steep, 4, part((top - low - 2e-9 * top).max(0.0), 0.0), what);
            }
        }
        judge_wear(rows, (line, &loading), &means[2 * planes * each..], rating, found, place);
    });
    core(&outputs[..1], &mut |turns, _| {
        let peaks = turns.peaks(Sought::Least, alone()).expect("they fit");
        for (shaft, (peak, &least)) in peaks.iter().zip(&slowest).enumerate() {
            let what = || place(&format!("least speed ratio {shaft}"), peak.value, least);
            found.take(steep, 3, part((peak.value - least).abs(), least), what);
        }
    });
    found.judged += 1;
}

/// One thread.
fn alone() -> Execution<'static> {
    Execution { workers: Some(1), ..Execution::default() }
}

/// Judges the means of friction and fatigue, and the lives that follow.
fn judge_wear(
    rows: &Rows<'_>,
    (line, loading): (&Geometry, &Loading),
    wanted: &[f64],
    rating: f64,
    found: &mut TurnErrors,
    place: impl Fn(&str, f64, f64) -> String,
) {
    let (n, steep) = (line.bends.len(), usize::from(found.shape == LoadShape::Steep));
    let [friction, fatigue] = [Wear::Friction, Wear::Fatigue].map(|wear| {
        let mut out = vec![f64::NAN; wear.count(n)];
        let end = loading.end;
        pin_means(rows, &line.bends, end, wear, &mut out, alone()).expect("they fit");
        out
    });
    let (ways, harms) = wanted[1..].split_at(1 + 2 * n);
    found.take(steep, 5, part((friction[0] - wanted[0]).abs(), ways[0]), || {
        place("torque of the drive", friction[0], wanted[0])
    });
    for (kind, got, wanted) in [(5, &friction[1..], &ways[1..]), (6, &fatigue[..], harms)] {
        for (i, (&got, &want)) in got.iter().zip(wanted).enumerate() {
            let what = || place(&format!("{} {i}", NAMES[kind]), got, want);
            found.take(steep, kind, part((got - want).abs(), want), what);
        }
    }
    for ((got, want), &bend) in
        fatigue.as_chunks::<5>().0.iter().zip(harms.chunks(5)).zip(&line.bends)
    {
        let [got, want] = [hours(*got, bend, 1500.0, rating)[0], life(want, bend, 1500.0, rating)];
        found.take(steep, 7, part((got - want).abs(), want), || place("life", got, want));
    }
}

/// An error in parts of a size; nothing is off by no part of anything.
fn part(off: f64, size: f64) -> f64 {
    if off == 0.0 { 0.0 } else { off / size }
}
