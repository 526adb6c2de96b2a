//! Machines, their figures and what would bring these within their limits.

use std::cell::RefCell;

use cardan::design::tube::Round;
use cardan::judge::{
    CaseLoads, Cases, Change, Figure, Kind, LimitOf, Machine, Parts, Search, Searching,
    SlidingShaft, Variable,
};
use cardan::{Error, Execution, Result, check_length};

use crate::arguments::{Arguments, Lines, LoadOf};

/// The states, or the steps of the duty cycle.
fn cases(lines: &Lines<'_>, speed: &[f64], load: Option<LoadOf<'_>>) -> Result<Cases> {
    let load = load.map(|load| CaseLoads {
        end: load.end,
        torque: load.torque.to_vec(),
        acceleration: load.acceleration.to_vec(),
        inertias: load.inertias.iter().map(|&(shaft, each)| (shaft, each.to_vec())).collect(),
    });
    let unknown = vec![0.0; lines.count()];
    Cases::new(&lines.batch, &lines.arrays, if speed.is_empty() { &unknown } else { speed }, load)
}

/// The number of a column for each joint or tube, which is empty or has as many as the others.
fn column(arguments: &Arguments<'_>, name: &'static str, count: usize) -> Result<Vec<f64>> {
    let values = arguments.of(name);
    check_length(name, values.len(), count, 1)?;
    Ok(values.to_vec())
}

fn parts(arguments: &Arguments<'_>) -> Result<Parts> {
    let worn = arguments.of("friction").len();
    let mut friction = vec![[0.0; 4]; worn];
    for (i, name) in ["friction", "pin_radius", "arm", "seal_torque"].into_iter().enumerate() {
        for (own, value) in friction.iter_mut().zip(column(arguments, name, worn)?) {
            own[i] = value;
        }
    }
    let shafts = arguments.counts("tubes")?;
    let of = |name| column(arguments, name, shafts.len());
    let (diameters, walls, lengths) = (of("outer_diameter")?, of("wall")?, of("tube_length")?);
    let (moduli, densities) = (of("elastic_modulus")?, of("density")?);
    let tube = |(i, &shaft): (usize, &usize)| {
        let round = Round {
            diameter: diameters[i],
            wall: walls[i],
            length: lengths[i],
            shear_modulus: f64::NAN, // stiffness is not judged
            elastic_modulus: moduli[i],
            density: densities[i],
        };
        (shaft, round)
    };
    let unknown = |name| Ok(arguments.maybe(name)?.unwrap_or(f64::NAN));
    let spline = if arguments.of("spline").is_empty() {
        None
    } else {
        Some(SlidingShaft {
            shaft: arguments.count("spline")?,
            engaged: unknown("engaged")?,
            push_in: unknown("push_in")?,
            friction: unknown("spline_friction")?,
            radius: unknown("spline_radius")?,
        })
    };
    Ok(Parts {
        shares: arguments.finite("shares")?.to_vec(),
        ratings: arguments.of("ratings").to_vec(),
        friction,
        tubes: shafts.iter().enumerate().map(tube).collect(),
        spline,
        centres: arguments.finite("centres")?.to_vec(),
        drawn: drawn(arguments)?,
        play: arguments.of("play").to_vec(),
    })
}

/// The driveline of the drawing, if it is known.
fn drawn(arguments: &Arguments<'_>) -> Result<Option<Cases>> {
    if arguments.of("drawn_bends").is_empty() {
        return Ok(None);
    }
    let line = arguments.drivelines([
        "drawn_bends",
        "drawn_twists",
        "drawn_phases",
        "drawn_directions",
        "drawn_normals",
        "drawn_lengths",
        "drawn_positions",
    ])?;
    check_length("drawn_bends", line.count(), 1, 1)?;
    cases(&line, &[], None).map(Some)
}

fn limits(arguments: &Arguments<'_>) -> Result<Vec<LimitOf>> {
    let kinds = arguments.members("limit_kinds", &Kind::ALL)?;
    let of = |name| column(arguments, name, kinds.len());
    let (items, limits, maxima) = (of("limit_items")?, of("limits")?, of("maxima")?);
    let limit = |(i, &kind): (usize, &Kind)| LimitOf {
        kind,
        item: (items[i] >= 0.0).then_some(items[i] as usize),
        limit: limits[i],
        maximum: maxima[i],
    };
    Ok(kinds.iter().enumerate().map(limit).collect())
}

fn machine(arguments: &Arguments<'_>) -> Result<Machine> {
    let lines = arguments.lines()?;
    let load = arguments.usual_load(lines.count())?;
    let states = cases(&lines, arguments.finite("speed")?, load)?;
    let steps = if arguments.of("step_bends").is_empty() {
        None
    } else {
        let steps = arguments.drivelines([
            "step_bends",
            "step_twists",
            "step_phases",
            "step_directions",
            "step_normals",
            "step_lengths",
            "step_positions",
        ])?;
        let names = ["step_torque", "step_speed", "step_acceleration", "step_inertias"];
        let load = arguments.load(steps.count(), names)?;
        Some(cases(&steps, arguments.finite("step_speed")?, load)?)
    };
    let bearings = lines.batch.bearings.clone().unwrap_or_default();
    let parts = parts(arguments)?;
    Machine::new(lines.joints, &bearings, states, steps, parts, &limits(arguments)?)
}

/// An item as a number, −1 for none.
fn item(item: Option<usize>) -> f64 {
    item.map_or(-1.0, |item| item as f64)
}

pub(crate) fn figures(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let machine = machine(arguments)?;
    let machine = if arguments.flag("limited")? { machine.limited() } else { machine };
    let found = machine.figures(Execution::default())?;
    let column = |of: &dyn Fn(&Figure) -> f64| found.iter().map(of).collect::<Vec<f64>>();
    Ok(vec![
        column(&|one| one.kind as usize as f64),
        column(&|one| item(one.item)),
        column(&|one| one.limit.limit),
        column(&|one| one.limit.maximum),
        column(&|one| item(one.worst)),
        column(&|one| one.values.len() as f64),
        found.iter().flat_map(|one| one.values.iter().copied()).collect(),
        found.iter().flat_map(|one| one.ranks.iter().map(|&rank| rank as usize as f64)).collect(),
    ])
}

/// A machine and what is tried of it.
fn searched(arguments: &Arguments<'_>) -> Result<(Machine, Search)> {
    let search = Search {
        reach: arguments.maybe("reach")?.unwrap_or(0.0),
        teeth: arguments.counts("teeth")?,
        ratings: arguments.of("known_ratings").to_vec(),
    };
    if !(search.reach >= 0.0 && search.reach.is_finite()) {
        return Err(Error::new(
            "reach",
            &[],
            format!("is {} m; it must be finite and not negative", search.reach),
        ));
    }
    Ok((machine(arguments)?, search))
}

pub(crate) fn suggest(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (machine, search) = searched(arguments)?;
    Ok(columns(machine.suggest(&search, Execution::default())?))
}

thread_local! {
    /// The search that was begun last, and its number.
    static SEARCHING: RefCell<(usize, Option<Searching>)> = const { RefCell::new((0, None)) };
}

/// Begins a search that is advanced round by round, in place of the one before.
pub(crate) fn search(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (machine, search) = searched(arguments)?;
    let begun = machine.searching(&search, Execution::default())?;
    let number = SEARCHING.with_borrow_mut(|(number, searching)| {
        *searching = Some(begun);
        *number += 1;
        *number
    });
    Ok(vec![vec![number as f64]])
}

/// Result of a function of the search with the given number.
fn going<T>(arguments: &Arguments<'_>, of: impl FnOnce(&mut Searching) -> Result<T>) -> Result<T> {
    let wanted = arguments.count("search")?;
    SEARCHING.with_borrow_mut(|(number, searching)| match searching {
        Some(searching) if *number == wanted => of(searching),
        _ => Err(Error::new("search", &[], format!("{wanted} is not the one begun last"))),
    })
}

pub(crate) fn advance(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let goes_on = going(arguments, |searching| searching.advance(Execution::default()))?;
    Ok(vec![vec![f64::from(goes_on)]])
}

pub(crate) fn found(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    going(arguments, |searching| searching.changes(Execution::default())).map(columns)
}

/// Changes as columns.
fn columns(found: Vec<Change>) -> Vec<Vec<f64>> {
    let mut columns = vec![vec![]; 10];
    for change in found {
        let (variable, number, axis) = match change.variable {
            Variable::Point { point, axis } => (0, point, Some(axis)),
            Variable::Phase(shaft) => (1, shaft, None),
            Variable::Bearing(bearing) => (2, bearing, None),
            Variable::Engaged(shaft) => (3, shaft, None),
            Variable::Rating(joint) => (4, joint, None),
        };
        let worst = change.worst.as_ref();
        let value = worst.and_then(|one| one.worst.map(|place| one.values[place]));
        let row = [
            f64::from(variable),
            number as f64,
            item(axis),
            change.from,
            change.to,
            change.share,
            change.verdict as usize as f64,
            item(worst.map(|one| one.kind as usize)),
            item(worst.and_then(|one| one.item)),
            value.unwrap_or(f64::NAN),
        ];
        for (column, value) in columns.iter_mut().zip(row) {
            column.push(value);
        }
    }
    columns
}
