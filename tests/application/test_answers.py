"""The JSON answers of the command: their schema, their keys."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from click.testing import CliRunner

from cardan.app.answers.schema import answers_schema
from cardan.app.command import commands
from cardan.app.scene import Scene, starters
from example_scenes import ANSWERS, DRIVELINES, EXAMPLES, Answers

ROOT = Path(__file__).parents[2]
SCHEMA = answers_schema()


def answer(command: str, *arguments: str | Path) -> Any:  # noqa: ANN401 - JSON
    result = CliRunner().invoke(commands(), [command, *map(str, arguments), "--json"])
    assert result.exit_code in (0, 1), result.output
    return json.loads(result.stdout)


def test_schema_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_the_command_prints_it() -> None:
    assert json.loads(CliRunner().invoke(commands(), ["schema", "--answers"]).output) == SCHEMA


def keys(schema: Any) -> Iterator[str]:  # noqa: ANN401 - JSON
    if isinstance(schema, dict):
        yield from schema.get("properties", {})
        for value in schema.values():
            yield from keys(value)
    elif isinstance(schema, list):
        for value in schema:
            yield from keys(value)


def objects(schema: Any) -> Iterator[dict[str, Any]]:  # noqa: ANN401 - JSON
    if isinstance(schema, dict):
        if schema.get("type") == "object":
            yield schema
        for value in schema.values():
            yield from objects(value)
    elif isinstance(schema, list):
        for value in schema:
            yield from objects(value)


def test_no_object_has_other_keys() -> None:
    assert all(found["additionalProperties"] is False for found in objects(SCHEMA["$defs"]))


# A key that changes its name or goes away breaks programs: then VERSION grows.
BALL_JOINT = {
    *("ball_joint", "verdict", "load_N", "radius_mm", "radius", "clearance_mm"),
    *("half_angle_deg", "half_angle_rad", "contact_angle_deg", "contact_angle_rad"),
    *("peak_pressure_MPa", "edge_pressure_MPa", "projected_pressure_MPa"),
    *("parts", "part", "name", "allowable_pressure_MPa", "margin_MPa", "approach_um"),
    *("smallest_radius_mm", "allowable_load_N", "turning_friction_Nm", "swivelling_friction_Nm"),
}
SLIP = {
    *("slip", "shaft", "verdict", "drivelines", "length_mm", "shortest", "longest", "at"),
    *("travel", "engaged", "push_in", "value_mm", "limit_mm", "torque", "value_Nm"),
    *("axial_force_N", "supports", "side", "axial_N", "transverse_N"),
    *("other_shafts", "travel_mm", "key", "value", "bearings", "bearing", "force_N"),
}
SLIDES = {"slides", "joint", "slide", "travel_mm", "orders", "order", "amplitude_mm", "state"}
STEERING = {
    *("steering", "verdict", "on_centre", "state", "ratio", "slope", "nearest"),
    *("centre_deg", "limit_deg", "offset_deg", "turn_to_quick_deg", "turn_to_slow_deg"),
    *("centre_rad", "limit_rad", "offset_rad", "turn_to_quick_rad", "turn_to_slow_rad"),
}
STATES = {
    *("states", "state", "names", "weights", "keys", "key", "values", "figures", "column"),
    *("quantity", "statistic", "shaft", "joint", "bearing", "least", "largest", "value"),
}
FORCES = {
    "state",
    *("forces", "figures", "not_determinate", "quantity", "reason", "joint", "bearing", "shaft"),
    *("largest_N", "mean_N", "order_1_N", "order_2_N", "order_4_N"),
    *("at_drive_angle_deg", "at_drive_angle_rad"),
}
TOLERANCES = {
    *("distribution", "samples", "seed", "figures", "figure", "unit", "nominal", "quantiles"),
    *("share", "value", "worst", "worst_kind", "guaranteed", "limit", "passing"),
    *("shares", "group", "of", "number", "worst_in", "states", "state"),
}
JUDGED = {"verdict", "value", "source", "state", "states", "at", "key", "why"}
TUBES = {
    *JUDGED,
    *("tubes", "shaft", "stiffness_Nm_per_rad", "inertia_kgm2", "mass_kg", "torque", "value_Nm"),
    *("stress", "value_MPa", "limit_MPa", "maximum_MPa", "critical", "speed", "value_rpm"),
    *("margin", "limit", "maximum"),
}
LIFE = {
    *JUDGED,
    *("life", "hours_h", "decisive", "target_h", "of_sizes", "chosen", "efficiency", "heat"),
    *("steps", "step", "share_percent", "speed_rpm", "torque_Nm", "end", "bends"),
    *("joints", "joint", "size", "bearing", "rating_Nm", "hours", "catalogue_h", "damage"),
    *("small_swing", "bend", "bend_deg", "bend_rad", "speed_bend", "largest_heat"),
    *("sizes", "fits", "heat_W"),
    *("value_h", "limit_h", "maximum_h", "value_percent", "value_W", "limit_W", "maximum_W"),
    *("value_deg", "limit_deg", "maximum_deg", "value_rad", "limit_rad", "maximum_rad"),
    *("value_rpm_deg", "limit_rpm_deg", "maximum_rpm_deg"),
}
BEND_RULES = {
    *("bend_rules", "shaft", "equivalent_bend_deg", "factor", "damping_ratio", "exceeded"),
    *("speed_rpm", "inside", "critical_speeds", "order"),
}
AS_BUILT = (
    *("as_built", "drawing", "worst", "angle_error_deg", "angle_error_rad", "acceleration_rad_s2"),
    *("backlash", "torque_Nm", "end", "lash_deg", "lash_rad", "wind_up_deg", "wind_up_rad"),
    *("min", "max"),
)
KEYS = {
    "run": {
        *AS_BUILT,
        "order",
        "period_deg",
        "period_rad",
        *BALL_JOINT,
        *FORCES,
        *SLIP,
        *SLIDES,
        *STATES,
        *STEERING,
        *("answer", "version", "title", "drive_angles", "rows", "study", "files"),
        *("source", "samples", "missing_samples", "turns", "samples_per_turn"),
        *("first_deg", "first_rad", "last_deg", "last_rad"),
        *("quantity", "shaft", "joint", "bearing", "component", "statistic", "of"),
        *("value", "value_deg", "value_rad", "value_rpm", "value_rad_s2", "value_Nm", "value_N"),
        *("value_m", "value_mm"),
        *("at_drive_angle_deg", "at_drive_angle_rad"),
        *("drivelines", "axes", "figures", "column", "least", "largest", "at"),
        *("key", "values", "min", "max"),
        *("signals", "signal", "unit", "first", "last", "filter_samples"),
        *("samples_per_second", "gaps", "longest_gap_s", "longest_gap_after_s"),
        *("angle_of", "min_deg", "min_rad", "max_deg", "max_rad"),
        *("file", "rows", "parts", "found"),
    },
    "check": {
        *AS_BUILT,
        *BALL_JOINT,
        *FORCES,
        *SLIP,
        *SLIDES,
        *STEERING,
        *("states", "state", "verdicts", "equivalent_bend_deg", "verdict", "worst_in"),
        *TOLERANCES,
        *LIFE,
        *TUBES,
        *("tolerances", "life"),
        "tolerances",
        *BEND_RULES,
        "torsion",
        *("answer", "version", "title", "verdict", "drivelines", "passes", "preset", "advice"),
        *("not_judged", "within", "tolerable", "beyond", "unknown"),
        *("catalogue", "equivalent_bend", "non_uniformity", "non_uniformity_limit"),
        *("practice", "bend_difference", "torsional_excitation"),
        *("inertia_excitation_driving", "inertia_excitation_coasting"),
        *("value_deg", "limit_deg", "maximum_deg", "margin_deg"),
        *("value_rad_s2", "limit_rad_s2", "maximum_rad_s2", "margin_rad_s2"),
        *("drive_speed", "variation", "shaft", "shaft_variation", "share", "share_limit"),
        *("inertia_kgm2", "needed_inertia_kgm2"),
        *("source", "worst_at", "key", "value", "within_up_to_rpm", "tolerable_up_to_rpm"),
    },
    "identify": {
        *("answer", "version", "title", "samples", "missing_samples", "turns"),
        *("equivalent_joint", "equivalent_bend_deg", "equivalent_bend_rad"),
        *("standard_deviation_deg", "standard_deviation_rad", "detected"),
        *("detection_limit_deg", "detection_limit_rad", "angle_offset_deg", "angle_offset_rad"),
        *("purity", "purity_standard_deviation", "residual", "residual_deg", "residual_rad"),
        *("orders", "order", "amplitude", "amplitude_deg", "amplitude_rad"),
        *("two_joints", "joints", "joint", "bend_deg", "bend_rad"),
        *("phase_less_twist_deg", "phase_less_twist_rad"),
    },
    "optimise": {
        *("answer", "version", "title", "variables", "minimised", "kept", "files"),
        *("key", "unit", "before", "after", "change", "range", "teeth", "at_end"),
        *("quantity", "over", "states", "state", "limit", "at_limit"),
    },
    "tolerances": {
        *TOLERANCES,
        *("answer", "version", "title", "permitted", "given", "factor", "needless"),
    },
    "life": {*LIFE, *TUBES, *("answer", "version", "title")},
    "torsion": {
        *BEND_RULES,
        *("answer", "version", "title", "verdict", "files", "speed_range", "from_rpm", "to_rpm"),
        *("natural_frequencies", "natural_frequency", "frequency_Hz", "shares", "share"),
        *("amplitude_Nm", "torques", "least_Nm", "largest_Nm", "mean_Nm", "reversals"),
        *("unstable", "multiplier", "missing", "reason", "response", "shafts", "orders"),
        *("periodic_motions", "count", "stable", "smallest_Nm"),
    },
    "phase": {
        *("answer", "version", "title", "view", "arrangement", "cause", "catalogue", "fork_signs"),
        *("equivalent_bend_deg", "present", "best", "on_teeth", "limit_deg", "above_limits"),
        *("shafts", "shaft", "phase_deg", "sense", "setting_deg", "setting_other_sense_deg"),
        *("turn_deg", "turn_sense", "turn_other_sense_deg", "teeth", "turn_teeth"),
        *("states", "names", "weights", "worst"),
        *("bend_ranges", "joint", "bend_deg", "from_deg", "to_deg", "off_deg"),
    },
}


def test_keys_stay() -> None:
    assert SCHEMA["$defs"].keys() == KEYS.keys()
    for kind, names in KEYS.items():
        assert set(keys(SCHEMA["$defs"][kind])) == names


@pytest.mark.parametrize("options", [[], ["--radians"]], ids=["deg", "rad"])
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_answer_by_the_schema(path: Path, options: list[str], answered: Answers) -> None:
    data = answered(path).data("run", *options)
    ANSWERS.validate(data)
    assert (data["answer"], data["version"]) == ("run", 1)
    unit = "rad" if options else "deg"
    assert not {key for key in _keys_of(data) if key.endswith({"rad": "_deg", "deg": "_rad"}[unit])}


@pytest.mark.parametrize("path", DRIVELINES, ids=lambda path: path.stem)
def test_settings_of_the_examples_answer_by_the_schema(path: Path, answered: Answers) -> None:
    line = Scene.load(path).line
    if line.n_joints > 1 and not line.shape:
        ANSWERS.validate(answered(path).data("phase"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_verdicts_on_the_examples_answer_by_the_schema(path: Path, answered: Answers) -> None:
    ANSWERS.validate(answered(path).data("check"))


def _keys_of(data: Any) -> Iterator[str]:  # noqa: ANN401 - JSON
    for value in data.values() if isinstance(data, dict) else data:
        if isinstance(value, dict | list):
            yield from _keys_of(value)
    if isinstance(data, dict):
        yield from data


# The machines' scenes are examples.
@pytest.mark.parametrize(
    "kind", [kind for kind, starter in starters.STARTERS.items() if not starter.machine]
)
def test_starters_answer_by_the_schema(kind: str, tmp_path: Path) -> None:
    starters.write_starter(kind, tmp_path / "scene.toml")
    ANSWERS.validate(answer("run", tmp_path / "scene.toml", "--into", tmp_path))


def test_the_schema_refuses_other_answers(tmp_path: Path) -> None:
    data = answer("run", ROOT / "examples" / "foeppl.toml", "--into", tmp_path)
    for change in (
        {"answer": "walk"},
        {"version": 2},
        {"more": 1},
        {"rows": [{**data["rows"][0], "value": 1.0}]},
        {"rows": [{key: v for key, v in data["rows"][0].items() if key != "joint"}]},
        {"rows": [{**data["rows"][0], "statistic": "worst"}]},
    ):
        assert not ANSWERS.is_valid({**data, **change})


def test_quantities_are_one_row_each_however_many_shafts(tmp_path: Path) -> None:
    """The keys of a row do not depend on how many shafts there are."""
    text = (
        "[driveline]\nbends_deg = [10, 20]\n[load]\nspeed_rpm = 60\ndrive_torque_Nm = 5\n[output]\n"
    )
    shapes = []
    for shafts in ("", "shafts = [2]", "shafts = [0, 1, 2]"):
        (tmp_path / "scene.toml").write_text(f"{text}{shafts}")
        rows = answer("run", tmp_path / "scene.toml")["rows"]
        last = [row for row in rows if row.get("shaft") == 2]
        shapes.append([(row["quantity"], row["statistic"], row["of"], {*row}) for row in last])
    assert shapes[0] == shapes[1] == shapes[2]
    assert len(shapes[0]) == 10
