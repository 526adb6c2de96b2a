//! The command: its short form passes, and one result that is a few ulp off makes it fail.

use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cardan-stress")).args(arguments).output().unwrap()
}

#[test]
fn the_short_form_passes() {
    let output = run(&[]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(text.contains("results of single joints judged"), "{text}");
    for surface in ["Chains", "Joints as built", "Torsional vibration", "Points"] {
        assert!(text.contains(&format!("\n{surface}: ")), "{surface}: {text}");
    }
}

#[test]
fn a_few_wrong_ulps_of_every_output_are_found() {
    let limits = include_str!("../../../tests/data/limits.toml");
    let rows = limits.lines().filter_map(|line| line.strip_prefix("[output.")?.strip_suffix(']'));
    for output in rows.map(|row| row.trim_matches('"')) {
        // Vectors are judged in ulp of their largest component.
        let is_vector = output.starts_with("support")
            || cardan::Output::named(output).is_ok_and(|output| output.components() > 1);
        broken_by(output, if is_vector { 6 } else { 3 });
    }
}

fn broken_by(output: &str, ulps: u32) {
    let broken = format!("{output}={ulps}");
    let broken = run(&["--only", "joints", "--samples", "20000", "--break", &broken]);
    let text = String::from_utf8(broken.stdout).unwrap();
    assert_eq!(broken.status.code(), Some(1), "{output}: {text}");
    assert!(text.contains(&format!("tolerance=0 {output}: ")), "{output}: {text}");
}

#[test]
fn what_is_wrong_is_said_in_a_line() {
    for (arguments, message) in [
        (&["--samples", "many"][..], "\"many\" is not a number\n"),
        (&["--break", "speed=1"], "there is no output \"speed\"\n"),
        (&["--samples"], "--samples needs a value; see --help\n"),
        (&["--only", "gears"], "there is no surface \"gears\"; see --help\n"),
        (&["--loud", "1"], "there is no option --loud; see --help\n"),
    ] {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(2));
        assert_eq!(String::from_utf8(output.stderr).unwrap(), message);
    }
}
