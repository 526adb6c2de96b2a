//! Numerical stress: the core's results against an independent oracle.
//!
//! `cardan-stress --help` says how to use it. The exit status is 1 if any error is beyond its limit.

mod angle;
mod as_built;
mod chains;
mod derivatives;
mod error_table;
mod exact;
mod forces;
mod joints;
mod judge;
mod leaning;
mod loading;
mod loads;
mod oracle;
mod points;
mod report;
mod samples;
mod shape_errors;
mod space;
mod taylor;
mod torsion;
mod turns;
mod vibration;
mod wide;

use std::fs;
use std::process::ExitCode;
use std::time::Instant;

use crate::error_table::ErrorTable;
use crate::joints::{BLOCK, Break};
use crate::judge::{Ledger, Quantity};

const HELP: &str = "\
Holds the results of the core against an independent oracle, in ulp of the exact result.

cardan-stress [OPTIONS]      samples of single joints, chains and points
cardan-stress oracle COUNT   what the oracle says, for tests/check_oracle.py to judge

--samples COUNT       samples of single joints, each for every output and tier [200000]
--threads COUNT       threads [1]
--seed NUMBER         another run [1]
--only SURFACE        one of joints, chains, points, loads, forces, derivatives, as-built, turns, torsion
--break OUTPUT=ULPS   make one result in a block wrong, to see that it is found
--table FILE          write the table of errors, as Markdown
--worst FILE          write the worst samples, as JSON
";

/// What `--only` calls the first table, which has threads and a search.
const JOINTS: &str = "joints";

/// Judges at least so many samples of each kind of a surface with a seed.
type Judge = fn(u64, u64) -> ErrorTable;

/// The other tables, by the names that `--only` takes.
const SURFACES: [(&str, Judge); 8] = [
    ("chains", chains::table),
    ("loads", loads::table),
    ("forces", forces::table),
    ("derivatives", derivatives::table),
    ("as-built", as_built::table),
    ("turns", turns::table),
    ("torsion", torsion::table),
    ("points", points::table),
];

struct Options {
    samples: u64,
    threads: u64,
    seed: u64,
    only: Option<String>,
    broken: Option<Break>,
    table: Option<String>,
    worst: Option<String>,
}

fn number(text: &str) -> Result<u64, String> {
    // Such as 1e8.
    let number: f64 = text.parse().map_err(|_| format!("{text:?} is not a number"))?;
    let whole = (1.0..1e15).contains(&number) && number.fract() == 0.0;
    if whole { Ok(number as u64) } else { Err(format!("{text:?} is not a count")) }
}

fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Options, String> {
    let mut options = Options {
        samples: 200_000,
        threads: 1,
        seed: 1,
        only: None,
        broken: None,
        table: None,
        worst: None,
    };
    while let Some(key) = arguments.next() {
        let value = arguments.next().ok_or(format!("{key} needs a value; see --help"))?;
        match &*key {
            "--samples" => options.samples = number(&value)?,
            "--threads" => options.threads = number(&value)?,
            "--seed" => options.seed = number(&value)?,
            "--only" => {
                if value != JOINTS && !SURFACES.iter().any(|(name, _)| *name == value) {
                    return Err(format!("there is no surface {value:?}; see --help"));
                }
                options.only = Some(value);
            }
            "--table" => options.table = Some(value),
            "--worst" => options.worst = Some(value),
            "--break" => {
                let (name, ulps) = value.split_once('=').ok_or("--break needs OUTPUT=ULPS")?;
                let named = Quantity::all().find(|q| q.name() == name);
                let quantity = named.ok_or(format!("there is no output {name:?}"))?;
                options.broken = Some(Break { quantity, ulps: number(ulps)? as i64 });
            }
            _ => return Err(format!("there is no option {key}; see --help")),
        }
    }
    Ok(options)
}

/// Single joints, in their many ways.
fn joints(options: &Options) -> (Ledger, f64) {
    let began = Instant::now();
    let blocks = options.samples.div_ceil(BLOCK as u64);
    let mut ledger = Ledger::new();
    std::thread::scope(|scope| {
        let share = |thread| (thread..blocks).step_by(options.threads as usize);
        let run =
            |thread| scope.spawn(move || joints::run(options.seed, share(thread), options.broken));
        let threads: Vec<_> = (0..options.threads).map(run).collect();
        for thread in threads {
            ledger.join(&thread.join().expect("a thread ends"));
        }
    });
    (ledger, began.elapsed().as_secs_f64())
}

fn stress(options: &Options) -> Result<bool, String> {
    let wanted = |name: &str| options.only.as_ref().is_none_or(|only| only == name);
    let joints = wanted(JOINTS).then(|| joints(options));
    let samples = (options.samples / 20).max(5000);
    let surfaces = SURFACES.iter().filter(|(name, _)| wanted(name));
    let tables: Vec<_> = surfaces.map(|(_, table)| table(options.seed, samples)).collect();
    let joints = joints.as_ref().map(|(ledger, seconds)| (ledger, *seconds));
    let report = report::Report { joints, tables: &tables };
    print!("{}", report.summary());
    let write = |file: &Option<String>, text: &dyn Fn() -> String| match file {
        Some(file) => fs::write(file, text()).map_err(|error| format!("{file}: {error}")),
        None => Ok(()),
    };
    write(&options.table, &|| report.table(options.threads))?;
    write(&options.worst, &|| report.worst())?;
    Ok(report.passes())
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words[..] {
        ["--help"] => {
            print!("{HELP}");
            Ok(true)
        }
        ["oracle", count] => number(count).map(|count| {
            oracle::print(count);
            true
        }),
        _ => parse(arguments.into_iter()).and_then(|options| stress(&options)),
    };
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}
