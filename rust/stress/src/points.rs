//! Geometry from nearly equal points and nearly straight lines of points.
//!
//! A span between two points is a rounded difference: its direction is known to `e`, the rounding
//! that really occurred over its length. A bend is then known to `ulp + e + e'` of its two spans, a
//! twist to `2⁻⁵²` and the same over the sines of the bends on both sides.

use cardan::{Geometry, Vector};

use crate::angle::atan2;
use crate::error_table::{ErrorTable, RowLimits};
use crate::judge::limit;
use crate::samples::Random;
use crate::shape_errors::ShapeErrors;
use crate::space::{Span, cross, dot};
use crate::wide::two_sum;

/// What the table of the report is about.
const ABOUT: &str = "The span between two points is a rounded difference, so its direction is known to `e`, the rounding \
    error divided by the length of the span. Bends are in units of `ulp + e + e'`, and twists in units \
    of `2⁻⁵² + Σ e/sin β`, for the adjacent spans and bends.\n";

/// The largest errors of bends and of twists, in these units.
fn limits() -> [f64; 2] {
    ["bends", "twists"].map(|name| limit("points", "", name).expect("the table has it"))
}

/// A kind of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PointsShape {
    NearlyEqual,
    NearlyStraight,
    Anywhere,
}

impl PointsShape {
    const ALL: [Self; 3] = [Self::NearlyEqual, Self::NearlyStraight, Self::Anywhere];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::NearlyEqual => "points some ulp apart, far from the origin",
            Self::NearlyStraight => "points along a line, aside by 1e-15 to 0.01",
            Self::Anywhere => "points 1e-6 to 1e6 apart",
        }
    }

    fn points(self, random: &mut Random) -> Vec<Vector> {
        let count = 4 + random.below(5);
        let mut vector = |size: f64| {
            let mut part = || random.between(-size, size);
            Vector::new(part(), part(), part())
        };
        let (start, along) = (vector(10.0), vector(1.0));
        match self {
            Self::NearlyEqual => {
                let mut walk = vec![start];
                for i in 0..count - 1 {
                    let last: Vector = walk[i];
                    walk.push(last.map(|x| random.beside(x, 1000)));
                }
                walk
            }
            Self::NearlyStraight => {
                let aside = random.power(-15.0, -2.0);
                (0..count)
                    .map(|i| {
                        let mut part = || random.between(-aside, aside);
                        start + along * i as f64 + Vector::new(part(), part(), part())
                    })
                    .collect()
            }
            Self::Anywhere => {
                let mut walk = vec![start];
                for i in 0..count - 1 {
                    let size = random.power(-6.0, 6.0);
                    let mut part = || random.between(-size, size);
                    walk.push(walk[i] + Vector::new(part(), part(), part()));
                }
                walk
            }
        }
    }
}

/// The worst errors of bends and twists of a kind of points.
type PointErrors = ShapeErrors<PointsShape, 1, 2>;

/// Judges at least so many samples of each kind.
pub(crate) fn table(seed: u64, samples: u64) -> ErrorTable {
    let head = ("Points", ABOUT);
    ErrorTable::of(
        head,
        ["bends", "twists"],
        &[RowLimits { name: "default", single: false, limits: limits() }],
        &run(seed, samples),
        PointsShape::name,
    )
}

/// At least so many bends of each kind.
fn run(seed: u64, count: u64) -> Vec<PointErrors> {
    let mut random = Random::new(seed ^ 0x9017);
    ShapeErrors::of_each(&PointsShape::ALL, count, |shape, found| {
        judge(&shape.points(&mut random), found);
    })
}

fn judge(points: &[Vector], found: &mut PointErrors) {
    // Equal points and right angles are refused.
    let phases = vec![0.0; points.len() - 3];
    let Ok(line) = Geometry::from_points(points, &phases) else { return };
    let mut spans: Vec<Span> = vec![];
    let mut rounding = vec![];
    for pair in points.windows(2) {
        let span = [0, 1, 2].map(|i| two_sum(pair[1][i], -pair[0][i]));
        let lost = span.iter().map(|x| x.low.powi(2)).sum::<f64>().sqrt();
        rounding.push(lost / dot(span, span).high.sqrt());
        // Like numbers, so that no square leaves the range.
        spans.push(span);
    }
    let crosses: Vec<Span> = spans.windows(2).map(|pair| cross(pair[0], pair[1])).collect();
    let mut sines = vec![];
    for (j, cross) in crosses.iter().enumerate() {
        let (y, x) = (dot(*cross, *cross).sqrt(), dot(spans[j], spans[j + 1]));
        let want = atan2(y, x);
        sines.push(want.high.sin());
        let known = rounding[j] + rounding[j + 1];
        // What is straight within rounding counts as straight.
        if want.high < 1.5e-15 + known {
            continue;
        }
        found.judged += 1;
        let off = want.distance(line.bends[j]) / (want.ulp() + known);
        found.take(0, 0, off, || format!("bends[{j}] of {points:?}: {:e}", line.bends[j]));
    }
    if sines.iter().any(|&sine| sine < 1e-14) {
        return;
    }
    for j in 1..crosses.len() {
        let length = dot(spans[j], spans[j]).sqrt();
        let want = atan2(length * dot(spans[j - 1], crosses[j]), dot(crosses[j - 1], crosses[j]));
        let known = [(j - 1, j - 1), (j, j - 1), (j, j), (j + 1, j)]
            .map(|(span, joint)| rounding[span] / sines[joint]);
        let unit = f64::EPSILON + known.iter().sum::<f64>();
        let turn = 2.0 * std::f64::consts::PI;
        let off = want.distance(line.twists[j - 1]);
        let off = off.min((turn - off).abs()) / unit;
        found.take(0, 1, off, || {
            format!("twists[{}] of {points:?}: {:e}", j - 1, line.twists[j - 1])
        });
    }
}
