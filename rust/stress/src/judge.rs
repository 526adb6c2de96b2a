//! How far results are from the exact ones, and how far they may be.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use cardan::Output;

use crate::samples::{JointSample, Kind};

/// What is judged of one joint: an output of the core's table, of torques and support moments those of
/// each shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Quantity {
    TorqueDriven,
    TorqueDriving,
    TorqueFlywheel,
    SupportDriving,
    SupportDriven,
    Of(Output),
}

static QUANTITIES: LazyLock<Vec<Quantity>> = LazyLock::new(|| {
    let of = |output| match output {
        Output::Torque => {
            vec![Quantity::TorqueDriven, Quantity::TorqueDriving, Quantity::TorqueFlywheel]
        }
        Output::SupportMoment => vec![Quantity::SupportDriving, Quantity::SupportDriven],
        // Of drivelines with bearings.
        Output::JointForce | Output::BearingForce => vec![],
        _ => vec![Quantity::Of(output)],
    };
    Output::ALL.into_iter().flat_map(of).collect()
});

impl Quantity {
    /// All of them, in the order of the table.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        QUANTITIES.iter().copied()
    }

    /// Its number among all.
    pub(crate) fn number(self) -> usize {
        Self::all().position(|own| own == self).expect("all are listed")
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::TorqueDriven => "torque of the driven shaft",
            Self::TorqueDriving => "torque of the driving shaft",
            Self::TorqueFlywheel => "torque of a flywheel",
            Self::SupportDriving => "support of the driving shaft",
            Self::SupportDriven => "support of the driven shaft",
            Self::Of(output) => output.row().name,
        }
    }
}

/// The accuracy asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Tier {
    Faithful,
    Default,
    Loose,
    Float32,
}

impl Tier {
    pub(crate) const ALL: [Self; 4] = [Self::Faithful, Self::Default, Self::Loose, Self::Float32];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Faithful => "tolerance=0",
            Self::Default => "default",
            Self::Loose => "tolerance=1e-6",
            Self::Float32 => "float32",
        }
    }

    /// Whether errors are parts of the largest over a turn instead of ulp.
    pub(crate) fn is_single(self) -> bool {
        matches!(self, Self::Loose | Self::Float32)
    }

    /// The largest error of one joint that is accepted.
    pub(crate) fn limit(self, quantity: Quantity) -> f64 {
        self.limit_in("output", quantity.name())
    }

    /// The largest error that a row of a table of limits accepts.
    pub(crate) fn limit_in(self, table: &str, row: &str) -> f64 {
        let column = match self {
            Self::Faithful => "tolerance_0",
            Self::Default => "worst",
            Self::Loose | Self::Float32 => "single",
        };
        limit(table, row, column).unwrap_or_else(|| panic!("{row} has no limit {column:?}"))
    }

    /// The same of chains, in their units.
    pub(crate) fn chain_limit(self, quantity: Quantity) -> f64 {
        let column = match self {
            Self::Faithful => "tolerance_0_chain",
            Self::Default => "worst_chain",
            Self::Loose | Self::Float32 => return self.limit(quantity),
        };
        limit("output", quantity.name(), column).unwrap_or_else(|| self.limit(quantity))
    }
}

/// The one table of limits, which the Python tests read too; it explains its columns. The texts of
/// the values by table, row and column; a table without rows has an empty one.
static LIMITS: LazyLock<BTreeMap<[&str; 3], &str>> = LazyLock::new(|| {
    let (mut table, mut row) = ("", "");
    let mut limits = BTreeMap::new();
    for line in include_str!("../../../tests/data/limits.toml").lines() {
        if let Some(header) = line.strip_prefix('[') {
            let header = header.trim_end_matches(']');
            (table, row) = header.split_once('.').unwrap_or((header, ""));
            row = row.trim_matches('"');
        } else if let Some((column, value)) = line.split_once(" = ")
            && !line.starts_with('#')
        {
            limits.insert([table, row, column], value);
        }
    }
    limits
});

/// A limit of the table.
pub(crate) fn limit(table: &str, row: &str, column: &str) -> Option<f64> {
    let value = LIMITS.get(&[table, row, column])?;
    Some(value.parse().expect("a limit is a number"))
}

/// Ends of the ranges of bends that the table shows apart, in rad; the last ones from 90°.
const BENDS: [(f64, &str); 14] = [
    (1e-10, "below 1e-10"),
    (1e-6, "1e-10 to 1e-6"),
    (1e-4, "1e-6 to 1e-4"),
    (1e-3, "1e-4 to 1e-3"),
    (1e-2, "1e-3 to 1e-2"),
    (1e-1, "1e-2 to 0.1"),
    (0.5, "0.1 to 0.5"),
    (1.0, "0.5 to 1"),
    (RIGHT - 1e-1, "1 to π/2 − 0.1"),
    (RIGHT - 1e-2, "π/2 − 0.1 to − 1e-2"),
    (RIGHT - 1e-4, "π/2 − 1e-2 to − 1e-4"),
    (RIGHT - 1e-8, "π/2 − 1e-4 to − 1e-8"),
    (RIGHT - 1e-12, "π/2 − 1e-8 to − 1e-12"),
    (RIGHT, "π/2 − 1e-12 to the last"),
];
const RIGHT: f64 = std::f64::consts::FRAC_PI_2;

/// The same of angles, in rad.
const ANGLES: [(f64, &str); 16] = [
    (1e-100, "below 1e-100"),
    (1e-10, "1e-100 to 1e-10"),
    (1e-6, "1e-10 to 1e-6"),
    (1e-4, "1e-6 to 1e-4"),
    (1e-3, "1e-4 to 1e-3"),
    (1e-2, "1e-3 to 1e-2"),
    (1e-1, "1e-2 to 0.1"),
    (1e0, "0.1 to 1"),
    (1e1, "1 to 10"),
    (1e2, "10 to 100"),
    (1e3, "100 to 1e3"),
    (1e6, "1e3 to 1e6"),
    (1e12, "1e6 to 1e12"),
    (1e20, "1e12 to 1e20"),
    (1e100, "1e20 to 1e100"),
    (f64::INFINITY, "from 1e100"),
];

/// By what the table shows errors apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum By {
    Kind,
    Bend,
    Angle,
}

impl By {
    pub(crate) fn rows(self) -> Vec<&'static str> {
        let names = |ranges: &[(f64, &'static str)]| ranges.iter().map(|&(_, name)| name).collect();
        match self {
            Self::Kind => Kind::ALL.iter().map(|kind| kind.name()).collect(),
            Self::Bend => names(&BENDS),
            Self::Angle => names(&ANGLES),
        }
    }
}

/// The rows that samples belong to.
pub(crate) fn rows_of(sample: &JointSample, kind: Kind) -> [usize; 3] {
    let row = |ranges: &[(f64, &str)], x: f64| ranges.partition_point(|&(end, _)| end <= x);
    [
        kind as usize,
        row(&BENDS, sample.bend),
        row(&ANGLES, sample.angle.abs()).min(ANGLES.len() - 1),
    ]
}

/// The worst error of one quantity, and where.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Worst {
    pub(crate) off: f64,
    pub(crate) sample: JointSample,
    pub(crate) got: f64,
    pub(crate) want: f64,
}

/// Errors of one quantity in one tier.
#[derive(Clone, Debug)]
pub(crate) struct Errors {
    pub(crate) judged: u64,
    pub(crate) worst: Worst,
    /// The worst of those that a driveline and an angle give again: not of sweeps.
    pub(crate) again: Worst,
    pub(crate) by: [Vec<f64>; 3],
}

impl Errors {
    fn new() -> Self {
        let by = [By::Kind, By::Bend, By::Angle].map(|by| vec![0.0; by.rows().len()]);
        Self { judged: 0, worst: Worst::default(), again: Worst::default(), by }
    }

    #[inline]
    pub(crate) fn take(&mut self, found: Worst, kind: Kind, rows: [usize; 3]) {
        self.judged += 1;
        // A result that is not a number is as wrong as can be.
        let found =
            Worst { off: if found.off.is_nan() { f64::INFINITY } else { found.off }, ..found };
        for (column, row) in self.by.iter_mut().zip(rows) {
            column[row] = column[row].max(found.off);
        }
        if found.off > self.worst.off {
            self.worst = found;
        }
        if found.off > self.again.off && kind != Kind::Sweep {
            self.again = found;
        }
    }

    fn join(&mut self, other: &Self) {
        self.judged += other.judged;
        for (mine, found) in [(&mut self.worst, other.worst), (&mut self.again, other.again)] {
            if found.off > mine.off {
                *mine = found;
            }
        }
        for (column, other) in self.by.iter_mut().zip(&other.by) {
            for (off, &other) in column.iter_mut().zip(other) {
                *off = off.max(other);
            }
        }
    }
}

/// Errors of all quantities in all tiers.
#[derive(Clone, Debug)]
pub(crate) struct Ledger(pub(crate) Vec<Vec<Errors>>);

impl Ledger {
    pub(crate) fn new() -> Self {
        Self(vec![vec![Errors::new(); QUANTITIES.len()]; Tier::ALL.len()])
    }

    pub(crate) fn of(&self, tier: Tier, quantity: Quantity) -> &Errors {
        &self.0[tier as usize][quantity.number()]
    }

    pub(crate) fn of_mut(&mut self, tier: Tier, quantity: Quantity) -> &mut Errors {
        &mut self.0[tier as usize][quantity.number()]
    }

    pub(crate) fn join(&mut self, other: &Self) {
        for (mine, other) in self.0.iter_mut().flatten().zip(other.0.iter().flatten()) {
            mine.join(other);
        }
    }

    /// The samples around which to search.
    pub(crate) fn worst(&self) -> Vec<JointSample> {
        let errors = self.0[..2].iter().flatten();
        errors.filter(|e| e.again.off > 0.0).map(|e| e.again.sample).collect()
    }

    /// What is beyond its limit.
    pub(crate) fn failures(&self) -> Vec<(Tier, Quantity, Worst)> {
        let all = Tier::ALL.iter().flat_map(|&t| Quantity::all().map(move |q| (t, q)));
        all.map(|(t, q)| (t, q, self.of(t, q).worst))
            .filter(|&(t, q, worst)| worst.off > t.limit(q))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_quantity_has_its_limits_and_every_row_is_judged() {
        let mut rows: Vec<&str> =
            LIMITS.keys().filter(|[table, ..]| *table == "output").map(|key| key[1]).collect();
        rows.dedup();
        let mut names: Vec<&str> = Quantity::all().map(Quantity::name).collect();
        names.sort_unstable();
        assert_eq!(rows, names);
        for quantity in Quantity::all() {
            assert!(Tier::Faithful.limit(quantity) <= 2.0);
            for (tier, least) in [(Tier::Default, 3.0), (Tier::Loose, 1e-7), (Tier::Float32, 1e-7)]
            {
                assert!(tier.limit(quantity) >= least, "{} {}", tier.name(), quantity.name());
                assert!(tier.chain_limit(quantity) >= tier.limit(quantity));
            }
        }
        assert!(Tier::Default.chain_limit(Quantity::Of(Output::AngleError)) > 9.0);
    }
}
