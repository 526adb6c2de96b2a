//! What is within its limits: ranks, the figures of a machine in all of its states, and the single
//! changes that bring everything within.

/// What counts as rounding, of a limit or of the size of what is judged.
///
/// A bend that is entered as 3° comes back with a rounding error, and limits have two digits.
pub const ROUNDING: f64 = 1e-9;

/// Whether a limit is the most that a figure may be, or the least.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The most.
    Most,
    /// The least.
    Least,
}

/// How a figure stands to its limits, from the best to the worst.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    /// There is no limit, or the figure is not a number.
    #[default]
    NotJudged,
    /// It keeps its limit.
    Within,
    /// It is past its limit, but not past its maximum.
    Tolerable,
    /// It is past its maximum.
    Beyond,
}

/// A limit, how far past it a figure is tolerable, and the side on which both are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Up to here a figure is within; NaN if there is no limit.
    pub limit: f64,
    /// Up to here it is tolerable; the limit itself where there is nothing between.
    pub maximum: f64,
    /// On which side.
    pub side: Side,
    /// The size of what is judged, of which rounding is a part where the limit is nearer to 0.
    pub size: f64,
}

impl Limit {
    /// No limit.
    pub const NONE: Self = Self { limit: f64::NAN, maximum: f64::NAN, side: Side::Most, size: 0.0 };

    /// The rank of a figure.
    ///
    /// ```
    /// use cardan::judge::{Limit, Rank, Side};
    ///
    /// let limit = Limit { limit: 3.0, maximum: 4.0, side: Side::Most, size: 0.0 };
    /// assert_eq!(limit.rank(3.0 + 1e-12), Rank::Within);
    /// assert_eq!(limit.rank(3.1), Rank::Tolerable);
    /// assert_eq!(limit.rank(4.1), Rank::Beyond);
    /// assert_eq!(limit.rank(f64::NAN), Rank::NotJudged);
    /// ```
    pub fn rank(&self, value: f64) -> Rank {
        if value.is_nan() || self.limit.is_nan() {
            Rank::NotJudged
        } else if self.keeps(value, self.limit) {
            Rank::Within
        } else if self.keeps(value, self.maximum) {
            Rank::Tolerable
        } else {
            Rank::Beyond
        }
    }

    /// By how much a figure is past its limit, over the limit or the size; negative within, and
    /// `−∞` where it is not judged.
    pub fn excess(&self, value: f64) -> f64 {
        let past = match self.side {
            Side::Most => value - self.limit,
            Side::Least => self.limit - value,
        };
        if past.is_nan() { f64::NEG_INFINITY } else { past / self.limit.abs().max(self.size) }
    }

    fn keeps(&self, value: f64, bound: f64) -> bool {
        let rounding = ROUNDING * bound.abs().max(self.size);
        // A bound that is infinite keeps what is infinite.
        match self.side {
            Side::Most => value <= bound || value <= bound + rounding,
            Side::Least => value >= bound || value >= bound - rounding,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rank(value: f64, [limit, maximum]: [f64; 2], side: Side, size: f64) -> Rank {
        Limit { limit, maximum, side, size }.rank(value)
    }

    #[test]
    fn rounding_is_a_part_of_the_limit_or_of_the_size() {
        let most = |value| rank(value, [3.0, 4.0], Side::Most, 0.0);
        for (value, expected) in [
            (3.0 * (1.0 + 0.9e-9), Rank::Within),
            (3.0 * (1.0 + 1.1e-9), Rank::Tolerable),
            (4.0 * (1.0 + 0.9e-9), Rank::Tolerable),
            (4.0 * (1.0 + 1.1e-9), Rank::Beyond),
            (-f64::INFINITY, Rank::Within),
            (f64::INFINITY, Rank::Beyond),
        ] {
            assert_eq!(most(value), expected, "{value:e}");
        }
        let least = |value, size| rank(value, [0.0; 2], Side::Least, size);
        assert_eq!(least(-0.9e-9, 1.0), Rank::Within);
        assert_eq!(least(-1.1e-9, 1.0), Rank::Beyond);
        assert_eq!(least(-1e-300, 0.0), Rank::Beyond);
        assert_eq!(least(0.0, 0.0), Rank::Within);
        assert_eq!(rank(2.0, [3.0, 2.0], Side::Least, 0.0), Rank::Tolerable);
        let infinite = [f64::INFINITY; 2];
        assert_eq!(rank(f64::INFINITY, infinite, Side::Least, 0.0), Rank::Within);
    }

    #[test]
    fn nothing_is_judged_without_a_limit_or_a_number() {
        assert_eq!(Limit::NONE.rank(1.0), Rank::NotJudged);
        assert_eq!(rank(f64::NAN, [3.0; 2], Side::Most, 0.0), Rank::NotJudged);
        assert_eq!(Limit::NONE.excess(1.0), f64::NEG_INFINITY);
    }
}
