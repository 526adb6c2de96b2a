//! Batches of drivelines with their shape and bearings, and the rules that their arrays obey.

use crate::error::{Error, Result, Rule, Shown};
use crate::input::broadcast::unravel;
use crate::input::drivelines::Drivelines;
use crate::mechanics::as_built::DEVIATIONS;

/// The rule for lengths.
const LENGTH_RULE: Rule = Rule::new("", "a length must be positive and finite");

/// A batch of drivelines whose arrays fit together, as a plan reads it.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// The shape of the batch; empty for one driveline.
    pub shape: Vec<usize>,
    /// The largest bend of each joint in rad.
    pub largest_bends: Vec<f64>,
    /// The shaft of each bearing, if the lengths of the shafts are known.
    pub bearings: Option<Vec<usize>>,
    /// Whether the joints have deviations.
    pub as_built: bool,
}

impl Batch {
    /// Checks drivelines with `joints` joints each in a batch of this shape. Lengths may be empty
    /// if there are no bearings, and deviations if all joints are ideal.
    ///
    /// # Errors
    /// No joints or too many, an array of another length, and a bearing on a shaft that does not exist.
    pub fn new(
        joints: usize,
        shape: &[usize],
        bearings: &[usize],
        lines: &Drivelines<'_>,
    ) -> Result<Self> {
        let count = shape.iter().product();
        lines.check_geometry(joints, count)?;
        let has_lengths = count == 0 || !lines.lengths.is_empty();
        if has_lengths || !bearings.is_empty() {
            check_length("lengths", lines.lengths.len(), count, joints + 1)?;
        }
        check_length("positions", lines.positions.len(), count, bearings.len())?;
        let as_built = !lines.deviations.is_empty();
        if as_built {
            check_length("deviations", lines.deviations.len(), count, joints * DEVIATIONS)?;
        }
        check_shafts(joints, bearings)?;
        Ok(Self {
            shape: shape.to_vec(),
            largest_bends: lines.largest_bends(joints),
            bearings: has_lengths.then(|| bearings.to_vec()),
            as_built,
        })
    }

    /// The number of joints of each driveline.
    pub fn joints(&self) -> usize {
        self.largest_bends.len()
    }

    /// Refuses joints with deviations; `what` has its verb.
    ///
    /// # Errors
    /// Joints with deviations.
    pub fn check_ideal(&self, what: &str) -> Result<()> {
        if !self.as_built {
            return Ok(());
        }
        let problem = format!("has joints with deviations; {what} for ideal joints only");
        Err(Error::new("driveline", &[], problem))
    }
}

/// Refuses a shaft that drivelines with so many joints do not have.
///
/// # Errors
/// A shaft behind the last one.
pub fn check_shaft(joints: usize, shaft: usize) -> Result<()> {
    if shaft <= joints {
        return Ok(());
    }
    Err(Error::new("shaft", &[], format!("is {shaft}; there are {}", joints + 1)))
}

/// Refuses bearings on shafts that drivelines with so many joints do not have.
pub(crate) fn check_shafts(joints: usize, bearings: &[usize]) -> Result<()> {
    let Some(place) = bearings.iter().position(|&shaft| shaft > joints) else { return Ok(()) };
    let problem = format!("is on shaft {}; there are {}", bearings[place], joints + 1);
    Err(Error::new("bearings", &[place], problem))
}

/// Checks that bearings on these shafts lie between the ends of their shafts, not at a joint and
/// not in one place. Lengths are `(…, joints + 1)` and positions `(…, bearings)`, each for a batch
/// of this shape.
///
/// # Errors
/// A shaft that does not exist, an array of another length, a length that is not positive and
/// finite, and a position that breaks the rule, at `[bearing, 1, …]` with its place in the batch.
pub fn check_bearings(
    joints: usize,
    shape: &[usize],
    bearings: &[usize],
    lengths: &[f64],
    positions: &[f64],
) -> Result<()> {
    let (count, shafts) = (shape.iter().product(), joints.saturating_add(1));
    let each = bearings.len();
    check_shafts(joints, bearings)?;
    check_length("lengths", lengths.len(), count, shafts)?;
    check_length("positions", positions.len(), count, each)?;
    if let Some(i) = lengths.iter().position(|&x| !(x > 0.0 && x < f64::INFINITY)) {
        let mut place = unravel(i / shafts, shape);
        place.push(i % shafts);
        return Err(Error::of_value("lengths", &place, lengths[i], LENGTH_RULE));
    }
    for (bearing, &shaft) in bearings.iter().enumerate() {
        for line in 0..count {
            let own = &positions[line * each..][..each];
            let (position, length) = (own[bearing], lengths[line * shafts + shaft]);
            let upstream = if shaft > 0 { position > 0.0 } else { position >= 0.0 };
            let downstream = if shaft < joints { position < length } else { position <= length };
            if !(upstream && downstream) {
                let inner = 0 < shaft && shaft < joints;
                let ends = if inner { "the joints" } else { "the end and the joint" };
                let problem = format!(
                    "is {} on shaft {shaft} of length {}; a bearing must lie between {ends} of its \
                     shaft",
                    Shown(position),
                    Shown(length)
                );
                return Err(
                    Error::new("bearings", &[bearing, 1], problem).behind(&unravel(line, shape))
                );
            }
            let in_place = |&other: &usize| bearings[other] == shaft && own[other] == position;
            if let Some(other) = (0..bearing).find(in_place) {
                let problem = format!("is in the place of bearings[{other}] on shaft {shaft}");
                return Err(Error::new("bearings", &[bearing], problem));
            }
        }
    }
    Ok(())
}

/// Checks that a flat array holds `each` values for each of `lines` drivelines.
///
/// # Errors
/// An array of another length.
pub fn check_length(argument: &'static str, found: usize, lines: usize, each: usize) -> Result<()> {
    if lines.checked_mul(each) == Some(found) {
        return Ok(());
    }
    let problem = format!("has {found} values; {lines} drivelines need {each} each");
    Err(Error::new(argument, &[], problem))
}

#[cfg(test)]
mod tests {
    use super::*;

    const VECTORS: [f64; 18] = [0.0; 18];

    /// Two drivelines with two joints each.
    fn lines() -> Drivelines<'static> {
        Drivelines {
            bends: &[0.1, 0.4, 0.3, 0.2],
            twists: &[0.0; 2],
            phases: &[0.0; 2],
            directions: &VECTORS,
            normals: &VECTORS[..12],
            ..Drivelines::default()
        }
    }

    fn refused(lines: &Drivelines<'_>, bearings: &[usize]) -> String {
        Batch::new(2, &[2], bearings, lines).unwrap_err().to_string()
    }

    #[test]
    fn a_batch_knows_what_plans_need() {
        let batch = Batch::new(2, &[2, 1], &[], &lines()).unwrap();
        assert_eq!(batch.largest_bends, [0.3, 0.4]);
        assert_eq!((batch.joints(), batch.shape.as_slice()), (2, &[2, 1][..]));
        assert_eq!(batch.bearings, None);
        assert_eq!(batch.check_ideal("orders are"), Ok(()));
        let mounted = Drivelines { lengths: &[1.0; 6], positions: &[0.5; 4], ..lines() };
        let batch = Batch::new(2, &[2], &[1, 1], &mounted).unwrap();
        assert_eq!(batch.bearings, Some(vec![1, 1]));
        let built = Drivelines { deviations: &VECTORS[..12], ..lines() };
        let error = Batch::new(2, &[2], &[], &built).unwrap().check_ideal("orders are");
        let problem = "has joints with deviations; orders are for ideal joints only";
        assert_eq!(error.unwrap_err().to_string(), format!("driveline {problem}"));
    }

    #[test]
    fn an_empty_batch_has_lengths() {
        let batch = Batch::new(2, &[0, 3], &[1], &Drivelines::default()).unwrap();
        assert_eq!(batch.bearings, Some(vec![1]));
    }

    #[test]
    fn arrays_of_other_lengths_are_refused() {
        let error = Batch::new(0, &[], &[], &Drivelines::default()).unwrap_err();
        assert_eq!(error.to_string(), "a driveline has no joint; it needs at least one");
        let all = lines();
        for (lines, name, needed) in [
            (Drivelines { bends: &[0.1], ..all }, "bends has 1", 2),
            (Drivelines { twists: &[], ..all }, "twists has 0", 1),
            (Drivelines { phases: &[0.0], ..all }, "phases has 1", 1),
            (Drivelines { directions: &[], ..all }, "directions has 0", 9),
            (Drivelines { normals: &[], ..all }, "normals has 0", 6),
            (Drivelines { lengths: &[1.0], ..all }, "lengths has 1", 3),
            (Drivelines { positions: &[1.0], ..all }, "positions has 1", 0),
            (Drivelines { deviations: &[1.0], ..all }, "deviations has 1", 6),
        ] {
            let rule = format!("{name} values; 2 drivelines need {needed} each");
            assert_eq!(refused(&lines, &[]), rule);
        }
        assert_eq!(refused(&all, &[1]), "lengths has 0 values; 2 drivelines need 3 each");
    }

    #[test]
    fn bearings_are_on_shafts_that_exist() {
        let mounted = Drivelines { lengths: &[1.0; 6], positions: &[0.5; 4], ..lines() };
        let problem = "bearings[1] is on shaft 3; there are 3";
        assert_eq!(refused(&mounted, &[2, 3]), problem);
        let error = check_bearings(2, &[2], &[2, 3], &[1.0; 6], &[0.5; 4]).unwrap_err();
        assert_eq!(error.to_string(), problem);
        assert_eq!(check_shaft(2, 2), Ok(()));
        assert_eq!(check_shaft(2, 3).unwrap_err().to_string(), "shaft is 3; there are 3");
    }

    #[test]
    fn bearings_lie_between_the_ends_of_their_shafts() {
        let check = |shafts: [usize; 2], positions: [f64; 2]| {
            let lengths = [1.0, 1.0, 1.0, 0.5, 0.75, 0.5];
            let both = [0.25, 0.3, positions[0], positions[1]];
            check_bearings(2, &[1, 2], &shafts, &lengths, &both).map_err(|error| error.to_string())
        };
        // The ends of the driveline are no joints.
        assert_eq!(check([0, 2], [0.0, 0.5]), Ok(()));
        assert_eq!(check([1, 1], [0.1, 0.7]), Ok(()));
        assert_eq!(check([0, 1], [0.4, 0.4]), Ok(()));
        let rule = |of: &str, ends: &str| {
            Err(format!("bearings{of}; a bearing must lie between {ends} of its shaft"))
        };
        let (joints, end) = ("the joints", "the end and the joint");
        let at = "[1, 1, 0, 1] is";
        assert_eq!(
            check([0, 0], [0.1, 0.5]),
            rule(&format!("{at} 0.5 on shaft 0 of length 0.5"), end)
        );
        assert_eq!(
            check([2, 2], [0.1, 0.0]),
            rule(&format!("{at} 0.0 on shaft 2 of length 0.5"), end)
        );
        let inner = |x: f64| rule(&format!("{at} {} on shaft 1 of length 0.75", Shown(x)), joints);
        for position in [0.0, 0.75, -0.1, f64::NAN, f64::INFINITY] {
            assert_eq!(check([0, 1], [0.1, position]), inner(position));
        }
        let twice = "bearings[1] is in the place of bearings[0] on shaft 1";
        assert_eq!(check([1, 1], [0.5, 0.5]), Err(twice.to_owned()));
    }

    #[test]
    fn lengths_are_positive_and_finite() {
        for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let lengths = [1.0, 1.0, 1.0, 1.0, length, 1.0];
            let error = check_bearings(2, &[2], &[], &lengths, &[]).unwrap_err();
            let rule = "a length must be positive and finite";
            assert_eq!(error.to_string(), format!("lengths[1, 1] is {}; {rule}", Shown(length)));
        }
    }
}
