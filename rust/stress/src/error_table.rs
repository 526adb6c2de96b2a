//! The worst errors of one surface, as a table with its limits.

use std::fmt::Write;

use crate::judge::Tier;
use crate::shape_errors::ShapeErrors;

/// What the rows of a kind of driveline are: tiers, or what a result is differentiated by.
#[derive(Clone, Debug)]
pub(crate) struct RowLimits<const OUTPUTS: usize> {
    pub(crate) name: &'static str,
    /// Whether errors are parts of the largest result instead of ulp or units.
    pub(crate) single: bool,
    pub(crate) limits: [f64; OUTPUTS],
}

impl<const OUTPUTS: usize> RowLimits<OUTPUTS> {
    /// Those of each tier.
    pub(crate) fn of_tiers(limits: impl Fn(Tier) -> [f64; OUTPUTS]) -> [Self; 4] {
        Tier::ALL.map(|tier| Self {
            name: tier.name(),
            single: tier.is_single(),
            limits: limits(tier),
        })
    }
}

/// A table of errors.
#[derive(Clone, Debug)]
pub(crate) struct ErrorTable {
    pub(crate) title: &'static str,
    /// What the units are, as Markdown.
    pub(crate) note: &'static str,
    columns: Vec<&'static str>,
    /// Kind, row and cells.
    rows: Vec<(&'static str, &'static str, Vec<String>)>,
    /// Kind, samples and results.
    counts: Vec<(&'static str, u64, u64)>,
    /// What is beyond its limit, a line each.
    pub(crate) failures: Vec<String>,
    /// The worst of each row and column, a line each.
    pub(crate) worst: Vec<String>,
}

impl ErrorTable {
    pub(crate) fn of<S: Copy, const ROWS: usize, const OUTPUTS: usize>(
        (title, note): (&'static str, &'static str),
        columns: [&'static str; OUTPUTS],
        limits: &[RowLimits<OUTPUTS>; ROWS],
        found: &[ShapeErrors<S, ROWS, OUTPUTS>],
        name: impl Fn(S) -> &'static str,
    ) -> Self {
        let (mut rows, mut failures, mut worst) = (vec![], vec![], vec![]);
        for (row, own) in limits.iter().enumerate() {
            for found in found {
                if found.off[row].iter().all(|&off| off == 0.0) {
                    continue;
                }
                let cells = found.off[row].iter().map(|&off| shown(off, own.single));
                rows.push((name(found.shape), own.name, cells.collect()));
                failures.extend(found.beyond(row, own.limits, own.name));
            }
            rows.push(("limit", own.name, own.limits.iter().map(f64::to_string).collect()));
            worst.extend((0..OUTPUTS).filter_map(|output| {
                let of = |found: &&ShapeErrors<S, ROWS, OUTPUTS>| found.off[row][output];
                let found = found.iter().max_by(|a, b| of(a).total_cmp(&of(b)))?;
                let place = &found.place[row][output];
                (!place.is_empty()).then(|| format!("{:.3e} {}: {place}", of(&found), own.name))
            }));
        }
        let count =
            |own: &ShapeErrors<S, ROWS, OUTPUTS>| (name(own.shape), own.judged, own.results);
        let counts = found.iter().map(count).collect();
        Self { title, note, columns: columns.to_vec(), rows, counts, failures, worst }
    }

    /// For the terminal.
    pub(crate) fn summary(&self) -> String {
        let mut text = format!("\n{}: {}\n", self.title, self.columns.join(", "));
        for (kind, samples, results) in &self.counts {
            writeln!(text, "{kind} ({} samples, {} results)", grouped(*samples), grouped(*results))
                .expect("text grows");
            for (_, row, cells) in self.rows.iter().filter(|(own, ..)| own == kind) {
                writeln!(text, "{row:>30} {}", cells.join("  ")).expect("text grows");
            }
        }
        text
    }

    /// For the record, as Markdown.
    pub(crate) fn markdown(&self) -> String {
        let results: u64 = self.counts.iter().map(|(.., results)| results).sum();
        let mut text = format!("\n## {}\n\n{}\n", self.title, self.note);
        writeln!(text, "{} results were judged.\n", grouped(results)).expect("text grows");
        let columns = ["of"].iter().chain(&self.columns).map(ToString::to_string);
        text.push_str(&head("kind", columns));
        for (kind, row, cells) in &self.rows {
            let cells = [row.to_string()].into_iter().chain(cells.iter().cloned());
            text.push_str(&table_row(kind, cells));
        }
        text
    }
}

/// An error in a table.
pub(crate) fn shown(off: f64, single: bool) -> String {
    match (off, single) {
        (0.0, _) => "–".into(),
        (off, true) => format!("{off:.1e}"),
        (off, false) => format!("{off:.2}"),
    }
}

/// A count, in groups of digits.
pub(crate) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let start = digits.len() % 3;
    let mut groups: Vec<&str> = vec![];
    if start > 0 {
        groups.push(&digits[..start]);
    }
    groups.extend((start..digits.len()).step_by(3).map(|i| &digits[i..i + 3]));
    groups.join(" ")
}

/// A row of a table.
pub(crate) fn table_row(first: &str, cells: impl IntoIterator<Item = String>) -> String {
    let cells: Vec<String> = cells.into_iter().collect();
    format!("| {first} | {} |\n", cells.join(" | "))
}

/// The head of a table.
pub(crate) fn head(first: &str, names: impl IntoIterator<Item = String>) -> String {
    let names: Vec<String> = names.into_iter().collect();
    format!("{}|---|{}\n", table_row(first, names.clone()), "---|".repeat(names.len()))
}
