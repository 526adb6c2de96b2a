//! The geometry of a driveline, from points, directions or bends.
//!
//! A driveline of `n` joints has `n + 1` shaft directions `u_i`, `n` bend-plane normals
//! `m_j = unit(u_j × u_{j+1})`, `n` bends and `n − 1` twists between successive normals.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector3;

use crate::error::{BEND_RULE, Error, FINITE, Result};
use crate::number::elementary::atan2;
use crate::number::float::inverse_power_of_two;
use crate::number::trig;

/// A vector in space.
pub type Vector = Vector3<f64>;

/// Two directions with at most this sine of the angle between them count as parallel. They come
/// from rounded coordinates, and the normal of such a joint would be noise.
const STRAIGHT: f64 = 4.0 * f64::EPSILON;

/// The most joints of a driveline. Some answers look at every joint for each of the joints, and take
/// seconds with so many.
pub const MOST_JOINTS: usize = 256;

/// The geometry of one driveline.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// Bend of each joint in rad, in `[0, π/2)`.
    pub bends: Vec<f64>,
    /// Angle in rad about each intermediate shaft from the previous bend-plane normal to the next.
    pub twists: Vec<f64>,
    /// Angle in rad of each intermediate shaft's output yoke relative to its input yoke.
    pub phases: Vec<f64>,
    /// Unit vector along each shaft, in the direction of power flow.
    pub directions: Vec<Vector>,
    /// Unit normal of each bend plane.
    pub normals: Vec<Vector>,
}

impl Geometry {
    /// From bends, twists and phases in rad, in the frame `u_0 = +x`, `m_0 = +z`.
    ///
    /// # Errors
    /// No joint or more than [`MOST_JOINTS`], a bend outside `[0, π/2)`, a twist or phase that is not
    /// finite, or lengths other than `n`, `n − 1` and `n − 1`.
    pub fn from_bends(bends: &[f64], twists: &[f64], phases: &[f64]) -> Result<Self> {
        let mut directions = vec![FIRST_DIRECTION];
        let mut normals = vec![];
        follow(bends, twists, phases, |normal, direction| {
            normals.push(normal);
            directions.push(direction);
        })?;
        let (bends, twists, phases) = (bends.to_vec(), twists.to_vec(), phases.to_vec());
        Ok(Self { bends, twists, phases, directions, normals })
    }

    /// From one direction per shaft, of any length.
    ///
    /// A straight joint takes the normal of the previous joint, and a straight first joint that of
    /// the next bent joint. A straight driveline takes the perpendicular nearest to `+z`, or `+x`
    /// if it lies along `z`. Phases are in rad.
    ///
    /// # Errors
    /// No joint or more than [`MOST_JOINTS`], a direction that is zero or not finite, a bend of 90° or
    /// more, a wrong number of phases, or a phase that is not finite.
    pub fn from_directions(directions: &[Vector], phases: &[f64]) -> Result<Self> {
        Self::from_spans("directions", directions, phases, |i, v| {
            let rule = "a direction must be finite and not zero";
            Error::new("directions", &[i], format!("is ({}, {}, {}); {rule}", v.x, v.y, v.z))
        })
    }

    /// From `n + 2` points, the two ends of the driveline and the joint centres between them, and
    /// phases in rad.
    ///
    /// ```
    /// use cardan::{Geometry, Vector};
    /// let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [3.0, 1.0]];
    /// let line = Geometry::from_points(&points.map(|[x, y]| Vector::new(x, y, 0.0)), &[0.0])?;
    /// assert!(line.bends.iter().all(|bend| (bend.to_degrees() - 45.0).abs() < 1e-12));
    /// # Ok::<(), cardan::Error>(())
    /// ```
    ///
    /// # Errors
    /// Two successive points that are equal or not finite; otherwise as
    /// [`Geometry::from_directions`].
    pub fn from_points(points: &[Vector], phases: &[f64]) -> Result<Self> {
        for (i, p) in points.iter().enumerate() {
            if !p.iter().all(|x| x.is_finite()) {
                let problem = format!("is ({}, {}, {}); a point must be finite", p.x, p.y, p.z);
                return Err(Error::new("points", &[i], problem));
            }
        }
        let spans: Vec<Vector> = points.windows(2).map(|pair| pair[1] - pair[0]).collect();
        Self::from_spans("points", &spans, phases, |i, _| {
            let p = points[i + 1];
            let rule = "two successive points must differ by a finite distance";
            let problem = format!(
                "is ({}, {}, {}) after ({}, {}, {}); {rule}",
                p.x, p.y, p.z, points[i].x, points[i].y, points[i].z
            );
            Error::new("points", &[i + 1], problem)
        })
    }

    fn from_spans(
        argument: &'static str,
        spans: &[Vector],
        phases: &[f64],
        degenerate: impl Fn(usize, &Vector) -> Error,
    ) -> Result<Self> {
        check_count(argument, spans.len().saturating_sub(1))?;
        let n = spans.len() - 1;
        check_between("phases", phases, n)?;
        let mut scaled = Vec::with_capacity(n + 1);
        for (i, span) in spans.iter().enumerate() {
            scaled.push(scaled_by_power_of_two(span).ok_or_else(|| degenerate(i, span))?);
        }
        let directions: Vec<Vector> = scaled.iter().map(Vector::normalize).collect();
        let mut bends = Vec::with_capacity(n);
        let mut normals: Vec<Option<Vector>> = Vec::with_capacity(n);
        for j in 0..n {
            let cross = accurate_cross(&scaled[j], &scaled[j + 1]);
            let (sine, cosine) = (cross.norm(), scaled[j].dot(&scaled[j + 1]));
            let straight = cosine > 0.0 && sine <= STRAIGHT * cosine;
            let bend = if straight { 0.0 } else { atan2(sine, cosine) };
            if bend >= FRAC_PI_2 {
                let rule = BEND_RULE.text;
                let problem = format!("give bends[{j}] = {bend} rad; {rule}");
                return Err(Error::new(argument, &[], problem));
            }
            bends.push(bend);
            normals.push((!straight).then(|| cross / sine));
        }
        let first = normals
            .iter()
            .flatten()
            .next()
            .copied()
            .unwrap_or_else(|| any_perpendicular(directions[0]));
        // Projects each normal again. A normal taken from a neighbour belongs to a shaft whose
        // direction differs by rounding, and that of two nearly parallel shafts is largely
        // rounding.
        let normals: Vec<Vector> = normals
            .into_iter()
            .zip(&directions)
            .scan(first, |last, (normal, u)| {
                *last = perpendicular_part(normal.unwrap_or(*last), *u).normalize();
                Some(*last)
            })
            .collect();
        let twists = (1..n).map(|j| twist(normals[j - 1], normals[j], directions[j])).collect();
        Ok(Self { bends, twists, phases: phases.to_vec(), directions, normals })
    }
}

/// The direction of shaft 0 of a driveline from bends.
pub(crate) const FIRST_DIRECTION: Vector = Vector::new(1.0, 0.0, 0.0);

/// Calls `each` with the normal of every joint and the direction of the shaft behind it. Bends,
/// twists and phases are checked as by [`Geometry::from_bends`].
#[inline(always)]
pub(crate) fn follow(
    bends: &[f64],
    twists: &[f64],
    phases: &[f64],
    mut each: impl FnMut(Vector, Vector),
) -> Result<()> {
    check_count("bends", bends.len())?;
    check_between("twists", twists, bends.len())?;
    check_between("phases", phases, bends.len())?;
    let mut u = FIRST_DIRECTION;
    let mut m = Vector::z();
    for (j, &bend) in bends.iter().enumerate() {
        check_bend(j, bend)?;
        if j > 0 {
            m = rotated(m, u, twists[j - 1]);
        }
        u = rotated(u, m, bend);
        // Rotations accumulate rounding errors; normalising keeps the frame orthonormal.
        u.normalize_mut();
        m = perpendicular_part(m, u).normalize();
        each(m, u);
    }
    Ok(())
}

/// Refuses a driveline without joints or with too many, of which the argument is at fault.
pub(crate) fn check_count(argument: &'static str, joints: usize) -> Result<()> {
    if joints == 0 {
        return Err(Error::new("a driveline", &[], "has no joint; it needs at least one"));
    }
    if joints > MOST_JOINTS {
        let problem = format!("has {joints} joints; a driveline has at most {MOST_JOINTS}");
        return Err(Error::new(argument, &[], problem));
    }
    Ok(())
}

fn check_bend(joint: usize, bend: f64) -> Result<()> {
    if (0.0..FRAC_PI_2).contains(&bend) {
        return Ok(());
    }
    Err(Error::of_value("bends", &[joint], bend, BEND_RULE))
}

/// Checks twists or phases: one finite value per intermediate shaft.
fn check_between(argument: &'static str, values: &[f64], joints: usize) -> Result<()> {
    if values.len() + 1 != joints {
        let (given, needed) = (values.len(), joints - 1);
        let problem = format!("has {given} values; {joints} joints need {needed}");
        return Err(Error::new(argument, &[], problem));
    }
    match values.iter().position(|x| !x.is_finite()) {
        Some(i) => Err(Error::of_value(argument, &[i], values[i], FINITE)),
        None => Ok(()),
    }
}

/// Rotates `v` about the unit vector `axis`, which is perpendicular to it.
#[inline(always)]
fn rotated(v: Vector, axis: Vector, angle: f64) -> Vector {
    let (sine, cosine) = trig::inlined_sin_cos(angle);
    v * cosine + axis.cross(&v) * sine
}

/// The vector divided exactly by the power of two of its largest component, so that its squares
/// neither overflow nor underflow; `None` if it is zero or not finite.
fn scaled_by_power_of_two(v: &Vector) -> Option<Vector> {
    const EXPONENT: u64 = 0x7ff << 52;
    // Subnormal numbers are scaled first, because their exponent bits are zero.
    let v = if v.amax() < f64::MIN_POSITIVE { v * (1_u64 << 60) as f64 } else { *v };
    let power = f64::from_bits(v.amax().to_bits() & EXPONENT);
    (power > 0.0 && v.iter().all(|x| x.is_finite())).then(|| v / power)
}

/// The distance between two points, from the vector between them, without overflow or underflow of
/// its square.
pub(crate) fn length(v: &Vector) -> f64 {
    let of = |v: &Vector| (v.x * v.x + v.y * v.y + v.z * v.z).sqrt();
    let length = of(v);
    if (1e-140..f64::INFINITY).contains(&length) {
        return length;
    }
    let scale = inverse_power_of_two(v.amax());
    of(&(v * scale)) / scale
}

/// The lengths of the shafts between ends and joint centres.
pub fn lengths(points: &[Vector]) -> impl Iterator<Item = f64> {
    points.windows(2).map(|pair| length(&(pair[1] - pair[0])))
}

/// The cross product with each component within 1.5 ulp (W. Kahan's difference of products). A
/// small bend keeps its relative accuracy.
fn accurate_cross(a: &Vector, b: &Vector) -> Vector {
    let component = |i: usize, j: usize| {
        let product = a[j] * b[i];
        let error = (-a[j]).mul_add(b[i], product);
        a[i].mul_add(b[j], -product) + error
    };
    Vector::new(component(1, 2), component(2, 0), component(0, 1))
}

/// The angle about `axis` from `from` to `to`, both perpendicular to it.
fn twist(from: Vector, to: Vector, axis: Vector) -> f64 {
    atan2(from.cross(&to).dot(&axis), from.dot(&to))
}

/// The part of `v` perpendicular to the unit vector `u`.
#[inline(always)]
fn perpendicular_part(v: Vector, u: Vector) -> Vector {
    v - u * v.dot(&u)
}

/// The unit vector perpendicular to `u` and nearest to `+z`; to `+x` if `u` lies along `z`.
fn any_perpendicular(u: Vector) -> Vector {
    let z = perpendicular_part(Vector::z(), u);
    if z.norm() > STRAIGHT { z.normalize() } else { perpendicular_part(Vector::x(), u).normalize() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_within_rounding_whatever_the_lengths() {
        for [first, second] in [[1.0, 1.0], [1.9, 1.9], [1e-3, 7.0], [3e8, 1.9]] {
            let line = |sine: f64| {
                let spans = [Vector::new(first, 0.0, 0.0), Vector::new(second, second * sine, 0.0)];
                Geometry::from_directions(&spans, &[]).unwrap()
            };
            assert_eq!(line(0.9 * STRAIGHT).bends, [0.0]);
            assert!((line(1.1 * STRAIGHT).bends[0] / STRAIGHT - 1.1).abs() < 1e-12);
        }
    }

    #[test]
    fn a_span_of_no_length_is_named_by_both_its_points() {
        let at = |x: f64| Vector::new(x, 0.0, 0.0);
        let error =
            Geometry::from_points(&[at(0.0), at(1.0), at(2.0), at(2.0)], &[0.0]).unwrap_err();
        let problem = "is (2, 0, 0) after (2, 0, 0); two successive points must differ";
        assert!(error.to_string().contains(&format!("points[3] {problem}")), "{error}");
        let error =
            Geometry::from_points(&[at(0.0), at(f64::MAX), at(-f64::MAX)], &[]).unwrap_err();
        assert!(error.to_string().contains("points[2] is (-1797"), "{error}");
        assert!(error.to_string().contains(") after (1797"), "{error}");
    }

    #[test]
    fn no_driveline_has_more_than_the_most_joints() {
        let made =
            |n: usize| Geometry::from_bends(&vec![0.1; n], &vec![0.2; n - 1], &vec![0.3; n - 1]);
        assert!(made(MOST_JOINTS).is_ok());
        let error = made(MOST_JOINTS + 1).unwrap_err();
        assert_eq!(error.to_string(), "bends has 257 joints; a driveline has at most 256");
        let points: Vec<_> = (0..300).map(|i| Vector::new(f64::from(i), 0.0, 0.0)).collect();
        let error = Geometry::from_points(&points, &[0.0; 297]).unwrap_err();
        assert_eq!(error.to_string(), "points has 298 joints; a driveline has at most 256");
    }

    #[test]
    fn one_angle_for_each_intermediate_shaft() {
        let error = Geometry::from_bends(&[0.1; 3], &[0.2], &[0.3; 2]).unwrap_err();
        assert_eq!(error.to_string(), "twists has 1 values; 3 joints need 2");
        let error = Geometry::from_directions(&[Vector::x(); 3], &[0.3; 2]).unwrap_err();
        assert_eq!(error.to_string(), "phases has 2 values; 2 joints need 1");
        let error = Geometry::from_bends(&[0.1; 2], &[f64::NAN], &[0.3]).unwrap_err();
        assert_eq!(error.to_string(), "twists[0] is nan; it must be finite");
    }
}
