//! The table of functions: what each takes and returns. The page's side is written from it.

use cardan::judge::{Kind, Scope, Side};
use cardan::{Output, Result};

use crate::arguments::Arguments;
use crate::{design, geometry, judge, lateral, motion, torsion};

/// Meaning of the numbers of an argument or a result.
#[derive(Clone, Copy)]
pub(crate) enum Meaning {
    /// A quantity in this unit, `"1"` for a ratio or a number.
    In(&'static str),
    /// Places in a list of names.
    Of(&'static Names),
}

/// A list of names that numbers stand for.
pub(crate) struct Names {
    pub(crate) name: &'static str,
    names: fn() -> Vec<&'static str>,
}

/// An argument or a result.
#[derive(Clone, Copy)]
pub(crate) struct Field {
    pub(crate) name: &'static str,
    meaning: Meaning,
    /// Its axes, the last one changing fastest.
    shape: &'static str,
}

/// A function.
pub(crate) struct Function {
    pub(crate) name: &'static str,
    /// In groups that functions have in common.
    pub(crate) arguments: &'static [&'static [Field]],
    pub(crate) results: &'static [Field],
    pub(crate) call: fn(&Arguments<'_>) -> Result<Vec<Vec<f64>>>,
}

static OUTPUTS: Names =
    Names { name: "outputs", names: || Output::ALL.map(|output| output.row().name).to_vec() };
static KINDS: Names =
    Names { name: "kinds", names: || Kind::ALL.map(|kind| kind.row().name).to_vec() };
static ENDS: Names = Names { name: "ends", names: || vec!["drive", "output"] };
static AXES: Names = Names { name: "axes", names: || vec!["space", "shaft"] };
static WEARS: Names = Names { name: "wears", names: || vec!["friction", "fatigue"] };
static RANKS: Names =
    Names { name: "ranks", names: || vec!["not judged", "within", "tolerable", "beyond"] };
static VARIABLES: Names =
    Names { name: "variables", names: || vec!["point", "phase", "bearing", "engaged", "rating"] };
static NAMES: [&Names; 7] = [&OUTPUTS, &KINDS, &ENDS, &AXES, &WEARS, &RANKS, &VARIABLES];

const fn field(name: &'static str, unit: &'static str, shape: &'static str) -> Field {
    Field { name, meaning: Meaning::In(unit), shape }
}

const fn named(name: &'static str, names: &'static Names, shape: &'static str) -> Field {
    Field { name, meaning: Meaning::Of(names), shape }
}

/// The same fields with a prefix.
macro_rules! fields {
    ($prefix:literal, $($name:literal $unit:literal $shape:literal),* $(,)?) => {
        [$(field(concat!($prefix, $name), $unit, $shape)),*]
    };
}

const JOINTS: &[Field] = &[field("joints", "1", "")];
const CHAINS: &[Field] = &[
    field("bends", "rad", "lines, joints"),
    field("twists", "rad", "lines, joints - 1"),
    field("phases", "rad", "lines, joints - 1"),
];
const FRAMES: &[Field] =
    &[field("directions", "1", "lines, joints + 1, 3"), field("normals", "1", "lines, joints, 3")];
/// Empty where shafts have no lengths.
const MOUNTED: &[Field] = &[
    field("lengths", "m", "lines, joints + 1"),
    field("positions", "m", "lines, bearings"),
    field("bearings", "1", "bearings"),
];
/// Empty without a load.
const LOAD: &[Field] = &[
    named("end", &ENDS, ""),
    field("torque", "N m", "lines"),
    field("speed", "rad/s", "lines"),
    field("acceleration", "rad/s²", "lines"),
    field("inertia_shafts", "1", "inertias"),
    field("inertias", "kg m²", "inertias, lines"),
];
const LINES: [&[Field]; 4] = [JOINTS, CHAINS, FRAMES, MOUNTED];
const REQUEST: &[Field] = &[
    named("outputs", &OUTPUTS, "outputs"),
    field("of_shafts", "1", "of_shafts"),
    field("of_joints", "1", "of_joints"),
    named("axes", &AXES, ""),
];
const STEPS: &[Field] = &fields!["step_",
    "bends" "rad" "steps, joints",
    "twists" "rad" "steps, joints - 1",
    "phases" "rad" "steps, joints - 1",
    "directions" "1" "steps, joints + 1, 3",
    "normals" "1" "steps, joints, 3",
    "lengths" "m" "steps, joints + 1",
    "positions" "m" "steps, bearings",
    "torque" "N m" "steps",
    "speed" "rad/s" "steps",
    "acceleration" "rad/s²" "steps",
    "inertias" "kg m²" "inertias, steps",
];
/// Likewise, of the one driveline of the drawing.
const DRAWN: &[Field] = &fields!["drawn_",
    "bends" "rad" "1, joints",
    "twists" "rad" "1, joints - 1",
    "phases" "rad" "1, joints - 1",
    "directions" "1" "1, joints + 1, 3",
    "normals" "1" "1, joints, 3",
    "lengths" "m" "1, joints + 1",
    "positions" "m" "1, bearings",
];
/// Empty where the machine does not have them.
const PARTS: &[Field] = &[
    field("shares", "1", "steps"),
    field("ratings", "N m", "joints"),
    field("friction", "1", "joints"),
    field("pin_radius", "m", "joints"),
    field("arm", "m", "joints"),
    field("seal_torque", "N m", "joints"),
    field("tubes", "1", "tubes"),
    field("outer_diameter", "m", "tubes"),
    field("wall", "m", "tubes"),
    field("tube_length", "m", "tubes"),
    field("elastic_modulus", "Pa", "tubes"),
    field("density", "kg/m³", "tubes"),
    field("spline", "1", ""),
    field("engaged", "m", ""),
    field("push_in", "m", ""),
    field("spline_friction", "1", ""),
    field("spline_radius", "m", ""),
    field("centres", "rad", "lines or 1"),
    field("play", "rad", "joints"),
];
/// The item of a limit is −1 if it is of all.
const LIMITS: &[Field] = &[
    named("limit_kinds", &KINDS, "limits"),
    field("limit_items", "1", "limits"),
    field("limits", "of its kind", "limits"),
    field("maxima", "of its kind", "limits"),
];
const MACHINE: [&[Field]; 9] = [JOINTS, CHAINS, FRAMES, MOUNTED, LOAD, STEPS, DRAWN, PARTS, LIMITS];

const SEARCH: &[Field] = &[
    field("reach", "m", ""),
    field("teeth", "1", "joints - 1"),
    field("known_ratings", "N m", "known_ratings"),
];
const CHANGES: &[Field] = &[
    named("variables", &VARIABLES, "changes"),
    field("items", "1", "changes"),
    field("axes", "1", "changes"),
    field("from", "of its variable", "changes"),
    field("to", "of its variable", "changes"),
    field("shares", "1", "changes"),
    named("verdicts", &RANKS, "changes"),
    named("worst_kinds", &KINDS, "changes"),
    field("worst_items", "1", "changes"),
    field("worst_values", "of its kind", "changes"),
];

/// All functions. The number of one is its place.
pub(crate) static FUNCTIONS: &[Function] = &[
    Function {
        name: "from_points",
        arguments: &[
            JOINTS,
            &[
                field("points", "unit", "lines, joints + 2, 3"),
                field("unit", "m", ""),
                field("phases", "rad", "lines, joints - 1"),
            ],
        ],
        results: &[
            field("bends", "rad", "lines, joints"),
            field("twists", "rad", "lines, joints - 1"),
            field("directions", "1", "lines, joints + 1, 3"),
            field("normals", "1", "lines, joints, 3"),
            field("lengths", "m", "lines, joints + 1"),
        ],
        call: geometry::from_points,
    },
    Function {
        name: "from_bends",
        arguments: &[JOINTS, CHAINS],
        results: FRAMES,
        call: geometry::from_bends,
    },
    Function {
        name: "equivalent",
        arguments: &[JOINTS, CHAINS, &[field("shaft", "1", "")]],
        results: &[
            field("bend", "rad", "lines"),
            field("angle_offset", "rad", "lines"),
            field("k", "1", "lines"),
            field("non_uniformity", "1", "lines"),
            field("max_angle_error", "rad", "lines"),
            field("min_speed_ratio", "1", "lines"),
            field("max_speed_ratio", "1", "lines"),
            field("max_acceleration_ratio", "1", "lines"),
        ],
        call: geometry::equivalent,
    },
    Function {
        name: "optimal_phases",
        arguments: &[JOINTS, CHAINS],
        results: &[field("phases", "rad", "lines, joints - 1")],
        call: geometry::optimal_phases,
    },
    Function {
        name: "common_phases",
        arguments: &[
            JOINTS,
            CHAINS,
            &[
                field("weights", "1", "states"),
                field("held", "1", "joints - 1"),
                field("teeth", "1", "joints - 1"),
            ],
        ],
        results: &[field("phases", "rad", "lines / states, joints - 1")],
        call: geometry::common_phases,
    },
    Function {
        name: "evaluate",
        arguments: &[
            LINES[0],
            LINES[1],
            LINES[2],
            LINES[3],
            LOAD,
            REQUEST,
            &[
                field("tolerance", "1", ""),
                field("angles", "rad", "samples"),
                field("start", "rad", ""),
                field("stop", "rad", ""),
                field("samples", "1", ""),
                field("per_turn", "1", ""),
            ],
        ],
        results: &[field("values", "of its output", "planes, lines, samples")],
        call: motion::evaluate,
    },
    Function {
        name: "drive_angles",
        arguments: &[JOINTS, CHAINS, FRAMES, &[field("angles", "rad", "samples")]],
        results: &[
            field("angles", "rad", "lines, samples"),
            field("error_terms", "rad", "lines, samples"),
        ],
        call: motion::drive_angles,
    },
    Function {
        name: "peaks",
        arguments: &[
            LINES[0],
            LINES[1],
            LINES[2],
            LINES[3],
            LOAD,
            REQUEST,
            &[field("least", "1", "")],
        ],
        results: &[
            field("values", "of its output", "lines, items"),
            field("counts", "1", "lines, items"),
            field("places", "rad", "counts"),
        ],
        call: motion::peaks,
    },
    Function {
        name: "orders",
        arguments: &[
            LINES[0],
            LINES[1],
            LINES[2],
            LINES[3],
            LOAD,
            REQUEST,
            &[
                field("orders", "1", "orders"),
                field("driven", "1", ""),
                field("tolerance", "1", ""),
            ],
        ],
        results: &[
            field("mean", "of its output", "lines, planes"),
            field("error", "of its output", "lines, planes"),
            field("amplitudes", "of its output", "lines, planes, orders, 2"),
        ],
        call: motion::orders,
    },
    Function {
        name: "excitations",
        arguments: &[JOINTS, CHAINS, FRAMES],
        results: &[
            field("bend", "rad", "lines"),
            field("torsional", "1", "lines"),
            field("inertia_driving", "1", "lines"),
            field("inertia_coasting", "1", "lines"),
        ],
        call: design::excitations,
    },
    Function {
        name: "steering",
        arguments: &[JOINTS, CHAINS, FRAMES, &[field("centres", "rad", "lines")]],
        results: &[
            field("ratio", "1", "lines"),
            field("slope", "1/rad", "lines"),
            field("offset", "rad", "lines"),
            field("quick", "1", "lines"),
            field("turn_to_quick", "rad", "lines"),
            field("turn_to_slow", "rad", "lines"),
            field("difference", "1", "lines"),
            field("noticed", "rad", "lines"),
        ],
        call: design::steering,
    },
    Function {
        name: "spline_forces",
        arguments: &[
            LINES[0],
            LINES[1],
            LINES[2],
            LINES[3],
            &[
                field("spline", "1", ""),
                field("torque", "N m", "lines"),
                field("friction", "1", "lines"),
                field("radius", "m", "lines"),
            ],
        ],
        results: &[
            field("axial", "N", "lines"),
            field("upstream", "N", "lines, 3"),
            field("upstream_axial", "N", "lines"),
            field("upstream_transverse", "N", "lines"),
            field("downstream_axial", "N", "lines"),
            field("downstream_transverse", "N", "lines"),
            field("bearing_forces", "N", "lines, bearings, 3"),
        ],
        call: design::spline_forces,
    },
    Function {
        name: "tubes",
        arguments: &[&[
            field("outer_diameter", "m", "tubes"),
            field("wall", "m", "tubes"),
            field("length", "m", "tubes"),
            field("shear_modulus", "Pa", "tubes"),
            field("elastic_modulus", "Pa", "tubes"),
            field("density", "kg/m³", "tubes"),
        ]],
        results: &[
            field("stiffness", "N m/rad", "tubes"),
            field("inertia", "kg m²", "tubes"),
            field("mass", "kg", "tubes"),
            field("critical_speed", "rad/s", "tubes"),
            field("shear_per_torque", "Pa/(N m)", "tubes"),
        ],
        call: design::tubes,
    },
    Function {
        name: "pin_means",
        arguments: &[JOINTS, CHAINS, FRAMES, LOAD, &[named("wear", &WEARS, "")]],
        results: &[field("means", "of its wear", "lines, means")],
        call: design::pin_means,
    },
    Function {
        name: "hours",
        arguments: &[&[
            field("means", "of fatigue", "joints, 5"),
            field("bends", "rad", "joints"),
            field("rpm", "1/min", "joints"),
            field("ratings", "N m", "joints"),
        ]],
        results: &[field("hours", "h", "joints"), field("by_law", "h", "joints")],
        call: design::hours,
    },
    Function {
        name: "free_drives",
        arguments: &[JOINTS, CHAINS, FRAMES, &[field("inertias", "kg m²", "lines, joints + 1")]],
        results: &[
            field("least", "1", "lines"),
            field("largest", "1", "lines"),
            field("variation", "1", "lines"),
        ],
        call: design::free_drives,
    },
    Function {
        name: "least_drive_inertias",
        arguments: &[
            JOINTS,
            CHAINS,
            FRAMES,
            &[field("inertias", "kg m²", "lines, joints + 1"), field("variations", "1", "lines")],
        ],
        results: &[field("inertia", "kg m²", "lines")],
        call: design::least_drive_inertias,
    },
    Function {
        name: "torsion",
        arguments: &[
            JOINTS,
            CHAINS,
            &[
                field("inertias", "kg m²", "joints + 1, 2"),
                field("stiffnesses", "N m/rad", "joints + 1"),
                field("load_torque", "N m", ""),
                field("free", "1", ""),
                field("couplings", "1", "couplings"),
                field("coupling_stiffnesses", "N m/rad", "couplings"),
                field("plays", "rad", "couplings"),
                field("twist_counts", "1", "couplings"),
                field("twist_torques", "rad and N m", "twist_counts, 2"),
                field("mean_counts", "1", "couplings"),
                field("stiffnesses_by_mean", "N m and N m/rad", "mean_counts, 2"),
                field("orders", "1", "orders"),
                field("excited", "1", "orders"),
                field("range", "rad/s", "2"),
                field("margin", "1", ""),
                field("speed", "rad/s", ""),
            ],
        ],
        results: &[
            field("shafts", "1", "modes"),
            field("nearest", "1", ""),
            named("rank", &RANKS, ""),
            field("nearest_now", "1", ""),
            field("away_now", "1", "orders, modes"),
            field("frequencies", "rad/s", "modes"),
            field("speeds", "rad/s", "orders, modes"),
            field("away", "1", "orders, modes"),
        ],
        call: torsion::torsion,
    },
    Function {
        name: "lateral",
        arguments: &[
            JOINTS,
            &[
                field("directions", "1", "joints + 1, 3"),
                field("lengths", "m", "joints + 1"),
                field("kinds", "1", "joints + 1"),
                field("of_shafts", "SI", "joints + 1, 5"),
                field("elastic_shafts", "1", "elastic"),
                field("of_elastic", "SI", "elastic, 10"),
                field("mass_shafts", "1", "masses"),
                field("of_masses", "SI", "masses, 4"),
                field("unbalance_shafts", "1", "unbalances"),
                field("of_unbalances", "SI", "unbalances, 5"),
                field("sliding", "1", "joints"),
                field("count", "1", ""),
                field("speeds", "rad/s", "speeds"),
                field("orders", "1", "orders"),
                field("moments_re", "N m", "speeds, orders, joints, 3"),
                field("moments_im", "N m", "speeds, orders, joints, 3"),
                field("probe_shafts", "1", "probes"),
                field("probe_positions", "m", "probes"),
            ],
        ],
        results: &[
            field("probes_re", "m", "speeds, orders, probes, 3"),
            field("probes_im", "m", "speeds, orders, probes, 3"),
            field("frequencies", "rad/s", "count"),
            field("forces", "N", "speeds, orders, elastic"),
            field("displacements", "m", "speeds, orders, elastic"),
        ],
        call: lateral::lateral,
    },
    Function {
        name: "figures",
        arguments: &[
            MACHINE[0],
            MACHINE[1],
            MACHINE[2],
            MACHINE[3],
            MACHINE[4],
            MACHINE[5],
            MACHINE[6],
            MACHINE[7],
            MACHINE[8],
            &[field("limited", "1", "")],
        ],
        results: &[
            named("kinds", &KINDS, "figures"),
            field("items", "1", "figures"),
            field("limits", "of its kind", "figures"),
            field("maxima", "of its kind", "figures"),
            field("worst", "1", "figures"),
            field("counts", "1", "figures"),
            field("values", "of its kind", "counts"),
            named("ranks", &RANKS, "counts"),
        ],
        call: judge::figures,
    },
    Function {
        name: "suggest",
        arguments: &[
            MACHINE[0], MACHINE[1], MACHINE[2], MACHINE[3], MACHINE[4], MACHINE[5], MACHINE[6],
            MACHINE[7], MACHINE[8], SEARCH,
        ],
        results: CHANGES,
        call: judge::suggest,
    },
    Function {
        name: "search",
        arguments: &[
            MACHINE[0], MACHINE[1], MACHINE[2], MACHINE[3], MACHINE[4], MACHINE[5], MACHINE[6],
            MACHINE[7], MACHINE[8], SEARCH,
        ],
        results: &[field("search", "1", "")],
        call: judge::search,
    },
    Function {
        name: "advance",
        arguments: &[&[field("search", "1", "")]],
        results: &[field("goes_on", "1", "")],
        call: judge::advance,
    },
    Function {
        name: "found",
        arguments: &[&[field("search", "1", "")]],
        results: CHANGES,
        call: judge::found,
    },
];

/// The table as JSON, with the tables of outputs and of kinds.
pub(crate) fn described() -> String {
    let list = |parts: Vec<String>| format!("[{}]", parts.join(","));
    let quoted = |names: &[&str]| list(names.iter().map(|name| format!("{name:?}")).collect());
    let of_field = |field: &Field| {
        let (key, meaning) = match field.meaning {
            Meaning::In(unit) => ("unit", unit),
            Meaning::Of(names) => ("of", names.name),
        };
        let Field { name, shape, .. } = field;
        format!("{{\"name\":{name:?},{key:?}:{meaning:?},\"shape\":{shape:?}}}")
    };
    let of_function = |function: &Function| {
        let arguments = function.arguments.concat().iter().map(of_field).collect();
        let results = function.results.iter().map(of_field).collect();
        let (arguments, results) = (list(arguments), list(results));
        let name = function.name;
        format!("{{\"name\":{name:?},\"arguments\":{arguments},\"results\":{results}}}")
    };
    let of_output = |output: Output| {
        let row = output.row();
        let (name, per, unit) = (row.name, row.per.name(), row.unit);
        let (components, load) = (quoted(row.components), output.needs_load());
        format!(
            "{{\"name\":{name:?},\"per\":{per:?},\"unit\":{unit:?},\"components\":{components},\
             \"needs_load\":{load}}}"
        )
    };
    let of_kind = |kind: Kind| {
        let row = kind.row();
        let (name, unit, most) = (row.name, row.unit, row.side == Side::Most);
        let per = row.per.map_or("null".to_owned(), |per| format!("{:?}", per.name()));
        let scope = match row.scope {
            Scope::States => "states",
            Scope::Cases => "cases",
            Scope::Once => "once",
        };
        format!(
            "{{\"name\":{name:?},\"unit\":{unit:?},\"per\":{per},\"most\":{most},\
             \"scope\":{scope:?}}}"
        )
    };
    let names = NAMES.map(|names| format!("{:?}:{}", names.name, quoted(&(names.names)())));
    format!(
        "{{\"version\":{:?},\"names\":{{{}}},\"outputs\":{},\"kinds\":{},\"functions\":{}}}",
        env!("CARGO_PKG_VERSION"),
        names.join(","),
        list(Output::ALL.map(of_output).to_vec()),
        list(Kind::ALL.map(of_kind).to_vec()),
        list(FUNCTIONS.iter().map(of_function).collect()),
    )
}
