//! What a run found, in words.

use std::fmt::Write;

use crate::chains::{ChainErrors, MOTION};
use crate::derivatives::{self, DerivativeErrors};
use crate::forces::{self, ForceErrors};
use crate::judge::{By, Ledger, Quantity, Tier, Worst};
use crate::loads::{self, LoadErrors};
use crate::points::{self, PointErrors};
use crate::wide::hex;

pub(crate) struct Report<'a> {
    pub(crate) ledger: &'a Ledger,
    pub(crate) chains: &'a [ChainErrors],
    pub(crate) loads: &'a [LoadErrors],
    pub(crate) forces: &'a [ForceErrors],
    pub(crate) derivatives: &'a [DerivativeErrors],
    pub(crate) points: &'a [PointErrors],
    pub(crate) seconds: f64,
}

fn shown(tier: Tier, off: f64) -> String {
    if off == 0.0 {
        "–".into()
    } else if tier.is_single() {
        format!("{off:.1e}")
    } else {
        format!("{off:.2}")
    }
}

/// A count, in groups of digits.
fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let start = digits.len() % 3;
    let mut groups: Vec<&str> = vec![];
    if start > 0 {
        groups.push(&digits[..start]);
    }
    groups.extend((start..digits.len()).step_by(3).map(|i| &digits[i..i + 3]));
    groups.join(" ")
}

fn row(first: &str, cells: impl IntoIterator<Item = String>) -> String {
    let cells: Vec<String> = cells.into_iter().collect();
    format!("| {first} | {} |\n", cells.join(" | "))
}

fn head(first: &str, names: impl IntoIterator<Item = String>) -> String {
    let names: Vec<String> = names.into_iter().collect();
    format!("{}|---|{}\n", row(first, names.clone()), "---|".repeat(names.len()))
}

impl Report<'_> {
    fn judged(&self) -> u64 {
        self.ledger.0.iter().flatten().map(|errors| errors.judged).sum()
    }

    /// What is beyond its limit, a line each.
    fn failures(&self) -> Vec<String> {
        let mut lines = vec![];
        for (tier, quantity, Worst { off, sample, got, want }) in self.ledger.failures() {
            lines.push(format!(
                "{} {}: {off:.3e} is more than {} at bend {} = {:?}, angle {} = {:?}, torque {:?}: \
                 {got:e} instead of {want:e}",
                tier.name(),
                quantity.name(),
                tier.limit(quantity),
                hex(sample.bend),
                sample.bend,
                hex(sample.angle),
                sample.angle,
                sample.torque,
            ));
        }
        for tier in Tier::ALL {
            let (row, units) = (tier as usize, format!("units, {}", tier.name()));
            let chain_limits = MOTION.map(|(quantity, _)| tier.chain_limit(quantity));
            lines.extend(self.chains.iter().flat_map(|own| own.beyond(row, chain_limits, &units)));
            let limits = forces::limits(tier);
            lines.extend(self.forces.iter().flat_map(|own| own.beyond(row, limits, &units)));
        }
        lines.extend(self.loads.iter().flat_map(|own| own.beyond(0, loads::limits(), "ulp")));
        for (row, limit) in derivatives::limits().into_iter().enumerate() {
            let beyond = |own: &DerivativeErrors| own.beyond(row, [limit; 5], "units");
            lines.extend(self.derivatives.iter().flat_map(beyond));
        }
        lines.extend(self.points.iter().flat_map(|own| own.beyond(0, points::limits(), "units")));
        lines
    }

    pub(crate) fn passes(&self) -> bool {
        self.failures().is_empty()
    }

    /// A page for the terminal.
    pub(crate) fn summary(&self) -> String {
        let judged = self.judged();
        let rate = judged as f64 / self.seconds;
        let mut text = format!(
            "{} results of single joints judged in {:.1} s, {rate:.2e} per second\n\n{:30}",
            grouped(judged),
            self.seconds,
            "worst error"
        );
        for tier in Tier::ALL {
            write!(text, "{:>16}", tier.name()).expect("text grows");
        }
        text.push('\n');
        for quantity in Quantity::ALL {
            write!(text, "{:30}", quantity.name()).expect("text grows");
            for tier in Tier::ALL {
                let off = shown(tier, self.ledger.of(tier, quantity).worst.off);
                write!(text, "{off:>16}").expect("text grows");
            }
            text.push('\n');
        }
        text.push_str("\nchains, in the units of the documentation\n");
        for chains in self.chains {
            writeln!(text, "{} ({} samples)", chains.shape.name(), chains.judged)
                .expect("text grows");
            for tier in &Tier::ALL[..3] {
                let off = chains.off[*tier as usize].map(|off| shown(*tier, off));
                writeln!(text, "{:>30} {}", tier.name(), off.join("  ")).expect("text grows");
            }
        }
        writeln!(text, "\nloads of chains with tolerance=0, in ulp: {}", loads::names().join(", "))
            .expect("text grows");
        for found in self.loads {
            let off = found.off[0].map(|off| shown(Tier::Faithful, off)).join("  ");
            writeln!(text, "{:50} {off} ({} samples)", found.shape.name(), found.judged)
                .expect("text grows");
        }
        writeln!(
            text,
            "\nforces, in the units of the documentation: {}",
            forces::names().join(", ")
        )
        .expect("text grows");
        for found in self.forces {
            writeln!(text, "{} ({} samples)", found.shape.name(), found.judged)
                .expect("text grows");
            for tier in Tier::ALL {
                let off = found.off[tier as usize].map(|off| shown(tier, off)).join("  ");
                writeln!(text, "{:>30} {off}", tier.name()).expect("text grows");
            }
        }
        writeln!(
            text,
            "\nderivatives, in the units of the documentation: {}",
            derivatives::names().join(", ")
        )
        .expect("text grows");
        for found in self.derivatives {
            writeln!(text, "{} ({} samples)", found.shape.name(), found.judged)
                .expect("text grows");
            for (by, off) in derivatives::BY.iter().zip(found.off) {
                let off = off.map(|off| format!("{off:.3}")).join("  ");
                writeln!(text, "{by:>30} {off}").expect("text grows");
            }
        }
        text.push_str("\npoints: bends and twists, in the units of the documentation\n");
        for points in self.points {
            let [[bends, twists]] = points.off;
            writeln!(text, "{:50} {bends:.2} {twists:.2}", points.shape.name())
                .expect("text grows");
        }
        for failure in self.failures() {
            writeln!(text, "\n{failure}").expect("text grows");
        }
        text
    }

    fn by(&self, by: By, tier: Tier) -> String {
        let short = |q: &Quantity| q.name().replace("of the ", "").replace("of a ", "");
        let mut text = head("", Quantity::ALL.iter().map(short));
        for (i, name) in by.rows().iter().enumerate() {
            let cells =
                Quantity::ALL.map(|q| shown(tier, self.ledger.of(tier, q).by[by as usize][i]));
            text.push_str(&row(name, cells));
        }
        text
    }

    /// The derivatives, as a part of the record.
    fn derivatives_table(&self) -> String {
        let mut text = String::from("\n## Derivatives\n\n");
        text.push_str(include_str!("../derivatives.md"));
        text.push('\n');
        text.push_str(&head(
            "chains",
            ["by"].into_iter().chain(derivatives::names()).map(String::from),
        ));
        for (which, by) in derivatives::BY.iter().enumerate() {
            let cells = |off: [String; 5]| [by.to_string()].into_iter().chain(off);
            for found in self.derivatives {
                let off = found.off[which].map(|off| format!("{off:.3}"));
                text.push_str(&row(found.shape.name(), cells(off)));
            }
            let limit = derivatives::limits()[which].to_string();
            text.push_str(&row("limit", cells(derivatives::names().map(|_| limit.clone()))));
        }
        text
    }

    /// The record of a run, as Markdown.
    pub(crate) fn table(&self, threads: u64) -> String {
        let mut text = String::from(include_str!("../head.md"));
        let least = self.ledger.0.iter().flat_map(|tier| tier.iter().map(|e| e.judged)).min();
        write!(
            text,
            "\n{} results were judged, at least {} of each output in each tier, {:.1e} per second \
             on {threads} thread{}.\n\n",
            grouped(self.judged()),
            grouped(least.unwrap_or(0)),
            self.judged() as f64 / self.seconds,
            if threads == 1 { "" } else { "s" }
        )
        .expect("text grows");
        // The single tiers have one limit, behind the second of them.
        let names = Tier::ALL.iter().flat_map(|tier| match tier {
            Tier::Loose => vec![tier.name().into()],
            _ => vec![tier.name().to_string(), "limit".into()],
        });
        text.push_str(&head("one joint", names));
        for quantity in Quantity::ALL {
            let cells = Tier::ALL.iter().flat_map(|&tier| {
                let off = shown(tier, self.ledger.of(tier, quantity).worst.off);
                match tier {
                    Tier::Loose => vec![off],
                    Tier::Float32 => vec![off, format!("{:e}", tier.limit(quantity))],
                    _ => vec![off, tier.limit(quantity).to_string()],
                }
            });
            text.push_str(&row(quantity.name(), cells));
        }
        text.push_str("\n## Chains\n\n");
        text.push_str(include_str!("../chains.md"));
        text.push('\n');
        let motion = MOTION.iter().map(|(quantity, _)| quantity.name().to_string());
        text.push_str(&head("chains", ["tier".to_string()].into_iter().chain(motion)));
        for chains in self.chains {
            for tier in &Tier::ALL[..3] {
                let off = chains.off[*tier as usize].map(|off| shown(*tier, off));
                let cells = [tier.name().to_string()].into_iter().chain(off);
                text.push_str(&row(chains.shape.name(), cells));
            }
        }
        text.push_str("\n## Loads of chains\n\n");
        text.push_str(include_str!("../loads.md"));
        text.push('\n');
        text.push_str(&head("chains", loads::names().map(String::from)));
        for found in self.loads {
            let off = found.off[0].map(|off| shown(Tier::Faithful, off));
            text.push_str(&row(found.shape.name(), off));
        }
        text.push_str(&row("limit", loads::limits().map(|limit| limit.to_string())));
        text.push_str("\n## Forces\n\n");
        text.push_str(include_str!("../forces.md"));
        text.push('\n');
        text.push_str(&head(
            "chains",
            ["tier"].into_iter().chain(forces::names()).map(String::from),
        ));
        for tier in Tier::ALL {
            let cells = |off: [String; 2]| [tier.name().to_string()].into_iter().chain(off);
            for found in self.forces {
                let off = found.off[tier as usize].map(|off| shown(tier, off));
                text.push_str(&row(found.shape.name(), cells(off)));
            }
            let limits = forces::limits(tier).map(|limit| format!("{limit}"));
            text.push_str(&row("limit", cells(limits)));
        }
        text.push_str(&self.derivatives_table());
        text.push_str("\n## Points\n\n");
        text.push_str(include_str!("../points.md"));
        text.push('\n');
        text.push_str(&head("points", ["bends", "twists"].map(String::from)));
        for points in self.points {
            let off = points.off[0].map(|off| format!("{off:.2}"));
            text.push_str(&row(points.shape.name(), off));
        }
        let limits = points::limits().map(|limit| format!("{limit}"));
        text.push_str(&row("limit", limits));
        for tier in [Tier::Default, Tier::Faithful] {
            for (by, what) in [
                (By::Kind, "kind of sample"),
                (By::Bend, "bend in rad"),
                (By::Angle, "drive angle in rad"),
            ] {
                write!(text, "\n## One joint, {}, by {what}\n\n", tier.name()).expect("text grows");
                text.push_str(&self.by(by, tier));
            }
        }
        text
    }

    /// The worst samples with the digits that they have.
    pub(crate) fn worst(&self) -> String {
        let mut cases = vec![];
        for tier in [Tier::Faithful, Tier::Default] {
            for quantity in Quantity::ALL {
                let Worst { off, sample, .. } = self.ledger.of(tier, quantity).again;
                cases.push(format!(
                    "  {{\"tier\": {:?}, \"output\": {:?}, \"bend\": {:?}, \"angle\": {:?}, \
                     \"torque\": {:?}, \"ulp\": {off:.3}}}",
                    tier.name(),
                    quantity.name(),
                    hex(sample.bend),
                    hex(sample.angle),
                    hex(sample.torque)
                ));
            }
        }
        format!("{{\"cases\": [\n{}\n]}}\n", cases.join(",\n"))
    }
}
