//! What a run found, in words.

use std::fmt::Write;

use crate::error_table::{ErrorTable, grouped, head, shown, table_row};
use crate::judge::{By, Ledger, Quantity, Tier, Worst};
use crate::wide::hex;

pub(crate) struct Report<'a> {
    /// Of single joints, with the seconds that they took.
    pub(crate) joints: Option<(&'a Ledger, f64)>,
    pub(crate) tables: &'a [ErrorTable],
}

fn judged(ledger: &Ledger) -> u64 {
    ledger.0.iter().flatten().map(|errors| errors.judged).sum()
}

impl Report<'_> {
    /// What is beyond its limit, a line each.
    fn failures(&self) -> Vec<String> {
        let mut lines = vec![];
        let found = self.joints.map(|(ledger, _)| ledger.failures()).unwrap_or_default();
        for (tier, quantity, Worst { off, sample, got, want }) in found {
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
        lines.extend(self.tables.iter().flat_map(|table| table.failures.iter().cloned()));
        lines
    }

    pub(crate) fn passes(&self) -> bool {
        self.failures().is_empty()
    }

    /// A page for the terminal.
    pub(crate) fn summary(&self) -> String {
        let mut text = String::new();
        if let Some((ledger, seconds)) = self.joints {
            let judged = judged(ledger);
            write!(
                text,
                "{} results of single joints judged in {seconds:.1} s, {:.2e} per second\n\n{:30}",
                grouped(judged),
                judged as f64 / seconds,
                "worst error"
            )
            .expect("text grows");
            for tier in Tier::ALL {
                write!(text, "{:>16}", tier.name()).expect("text grows");
            }
            text.push('\n');
            for quantity in Quantity::all() {
                write!(text, "{:30}", quantity.name()).expect("text grows");
                for tier in Tier::ALL {
                    let off = shown(ledger.of(tier, quantity).worst.off, tier.is_single());
                    write!(text, "{off:>16}").expect("text grows");
                }
                text.push('\n');
            }
        }
        self.tables.iter().for_each(|table| text.push_str(&table.summary()));
        for failure in self.failures() {
            writeln!(text, "\n{failure}").expect("text grows");
        }
        text
    }

    /// The record of a run, as Markdown.
    pub(crate) fn table(&self, threads: u64) -> String {
        let mut text = String::from(include_str!("../head.md"));
        if let Some((ledger, seconds)) = self.joints {
            text.push_str(&of_joints(ledger, seconds, threads));
        }
        self.tables.iter().for_each(|table| text.push_str(&table.markdown()));
        let Some((ledger, _)) = self.joints else { return text };
        for tier in [Tier::Default, Tier::Faithful] {
            for (by, what) in [
                (By::Kind, "kind of sample"),
                (By::Bend, "bend in rad"),
                (By::Angle, "drive angle in rad"),
            ] {
                write!(text, "\n## One joint, {}, by {what}\n\n", tier.name()).expect("text grows");
                text.push_str(&of_joints_by(ledger, by, tier));
            }
        }
        text
    }

    /// The worst samples with the digits that they have, and the worst places of the tables.
    pub(crate) fn worst(&self) -> String {
        let mut cases = vec![];
        let tiers = [Tier::Faithful, Tier::Default].into_iter();
        for (tier, quantity) in tiers.flat_map(|tier| Quantity::all().map(move |q| (tier, q))) {
            let Some((ledger, _)) = self.joints else { break };
            let Worst { off, sample, .. } = ledger.of(tier, quantity).again;
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
        let places = self.tables.iter().flat_map(|table| &table.worst);
        let places: Vec<String> = places.map(|place| format!("  {place:?}")).collect();
        let [cases, places] = [cases, places].map(|lines| lines.join(",\n"));
        format!("{{\"cases\": [\n{cases}\n], \"places\": [\n{places}\n]}}\n")
    }
}

/// The table of single joints, with its count.
fn of_joints(ledger: &Ledger, seconds: f64, threads: u64) -> String {
    let (judged, mut text) = (judged(ledger), String::new());
    let least = ledger.0.iter().flat_map(|tier| tier.iter().map(|e| e.judged)).min();
    write!(
        text,
        "\n{} results were judged, at least {} of each output in each tier, {:.1e} per second \
         on {threads} thread{}.\n\n",
        grouped(judged),
        grouped(least.unwrap_or(0)),
        judged as f64 / seconds,
        if threads == 1 { "" } else { "s" }
    )
    .expect("text grows");
    // The single tiers have one limit, behind the second of them.
    let names = Tier::ALL.iter().flat_map(|tier| match tier {
        Tier::Loose => vec![tier.name().into()],
        _ => vec![tier.name().to_string(), "limit".into()],
    });
    text.push_str(&head("one joint", names));
    for quantity in Quantity::all() {
        let cells = Tier::ALL.iter().flat_map(|&tier| {
            let off = shown(ledger.of(tier, quantity).worst.off, tier.is_single());
            match tier {
                Tier::Loose => vec![off],
                Tier::Float32 => vec![off, format!("{:e}", tier.limit(quantity))],
                _ => vec![off, tier.limit(quantity).to_string()],
            }
        });
        text.push_str(&table_row(quantity.name(), cells));
    }
    text
}

fn of_joints_by(ledger: &Ledger, by: By, tier: Tier) -> String {
    let short = |q: Quantity| q.name().replace("of the ", "").replace("of a ", "");
    let mut text = head("", Quantity::all().map(short));
    for (i, name) in by.rows().iter().enumerate() {
        let off = |q| shown(ledger.of(tier, q).by[by as usize][i], tier.is_single());
        text.push_str(&table_row(name, Quantity::all().map(off)));
    }
    text
}
