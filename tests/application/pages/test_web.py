"""The module for browsers against the installed core: bit by bit, in Node and in Chromium."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
from collections.abc import Iterable, Iterator
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

import bits_cases
import cardan
import oracle
import tiers
from cardan import Driveline, Load
from cardan.app.scene import Scene
from cardan.app.scene.machine import machine_data, machine_of
from cardan.design.machine import RANKS, Machine

ROOT = Path(__file__).parents[3]
WEB = Path(str(resources.files("cardan"))) / "web"
NODE = shutil.which("node")
MACHINES = sorted((WEB.parent / "app" / "scene" / "machines").glob("*.toml"))
FACTORS = (0x01000193, 0x9E3779B1)

Call = tuple[str, dict[str, Any]] | tuple[str, dict[str, Any], tuple[int, int, int]]


REQUIRED = bool(os.environ.get("CARDAN_REQUIRE_BROWSER"))


def is_stale() -> bool:
    """Whether the module was built from other sources, which `.ci/run` does not allow."""
    return (
        subprocess.run([ROOT / ".ci/web", "--check"], capture_output=True, check=False).returncode
        != 0
    )


pytestmark = [
    pytest.mark.skipif(NODE is None and not REQUIRED, reason="needs Node"),
    pytest.mark.skipif(
        not REQUIRED and is_stale(), reason="the module is stale: .ci/web builds it"
    ),
]


def digest(values: Any) -> list[int]:  # noqa: ANN401
    """The number of values and two polynomials in their words, as ``calls.mjs`` has them."""
    own = np.ravel(np.asarray(values, dtype=np.float64))
    words = np.where(np.isnan(own), np.nan, own).view(np.uint32).astype(np.uint64)
    found = [own.size]
    for factor in FACTORS:
        powers = np.ones(max(1, words.size), dtype=np.uint32)
        with np.errstate(over="ignore"):
            powers[1:] = np.cumprod(
                np.full(powers.size - 1, factor, dtype=np.uint32), dtype=np.uint32
            )
            products = words.astype(np.uint32) * powers[: words.size][::-1]
        found.append(int(np.sum(products, dtype=np.uint64) % 2**32))
    return found


def packed(values: Any) -> Any:  # noqa: ANN401
    """Doubles as ``calls.mjs`` reads them; names as they are."""
    array = np.asarray(values)
    if array.dtype.kind in "US":
        return values
    data = np.ascontiguousarray(array, dtype=np.float64).tobytes()
    return {"f64": base64.b64encode(data).decode()}


def listed(calls: Iterable[Call]) -> list[Any]:
    """Calls as ``calls.mjs`` reads them."""
    return [
        (name, {key: packed(value) for key, value in own.items()}, *row)
        for name, own, *row in calls
    ]


def in_node(folder: Path, **asked: Any) -> dict[str, Any]:  # noqa: ANN401
    """What ``calls.mjs`` answers in Node."""
    (folder / "asked.json").write_text(json.dumps(asked))
    assert NODE, "needs Node"
    command = [NODE, str(ROOT / "tests/calls.mjs"), str(WEB), str(folder / "asked.json")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def lines_of(line: Driveline) -> dict[str, Any]:
    """The arrays of drivelines by the names of the module."""
    own = line._geometry
    names = ("bends", "twists", "phases", "directions", "normals", "lengths", "positions")
    return {
        "joints": line.n_joints,
        **dict(zip(names, own.arrays, strict=False)),
        "bearings": own.bearings,
    }


# --- recorded evaluations -------------------------------------------------------------------


def items(given: Any, count: int, default: list[int]) -> list[int] | None:  # noqa: ANN401
    if given is None:
        return default
    if isinstance(given, slice):
        return list(range(count)[given])
    return [item % count for item in given] if isinstance(given, list) else None


def evaluations(line: Driveline, names: Any, angle: Any, found: Any, options: Any) -> Iterator[Any]:  # noqa: ANN401
    """Calls that repeat an evaluation driveline by driveline, with the numbers expected."""
    names = [names] if isinstance(names, str) else list(names)
    n, load = line.n_joints, options.get("load")
    shafts = items(options.get("shafts"), n + 1, [n])
    joints = items(options.get("joints"), n, list(range(n)))
    if shafts is None or joints is None:
        return
    sweep = angle if isinstance(angle, cardan.Sweep) else None
    drive = np.asarray(angle, dtype=np.float64)
    loads: dict[str, NDArray[np.float64]] = {}
    if load is not None:
        loads = {"torque": load.torque, "speed": load.speed, "acceleration": load.acceleration}
        by_shaft = load.inertias_by_shaft(n)
        loads |= {f"inertia {shaft}": each for shaft, each in by_shaft.items()}
    own = line.reshape(-1)
    shape = np.broadcast_shapes(line.shape, drive.shape, *(each.shape for each in loads.values()))
    number = np.broadcast_to(np.arange(own.size).reshape(line.shape), shape).ravel()
    drive = np.broadcast_to(drive, shape).ravel()
    rows = np.column_stack([number, *(np.broadcast_to(x, shape).ravel() for x in loads.values())])
    groups, place = np.unique(rows, axis=0, return_inverse=True)
    for k in range(0, len(groups), max(1, len(groups) // 24)):
        # The module refuses angles that are not finite.
        mask = (np.ravel(place) == k) & np.isfinite(drive)
        if not mask.any():
            continue
        # All of a batch, because its largest bends decide on the formulas.
        call = lines_of(own)
        if load is not None:
            full = np.ones(own.size)
            of = {name: x * full for name, x in zip(loads, groups[k, 1:], strict=True)}
            call |= {name: of[name] for name in ("torque", "speed", "acceleration")}
            call |= {"end": load.end, "inertia_shafts": list(by_shaft)}
            call["inertias"] = [of[f"inertia {shaft}"] for shaft in by_shaft]
        call |= {"outputs": names, "of_shafts": shafts, "of_joints": joints}
        call["axes"] = options.get("axes", "space")
        if options.get("tolerance") is not None:
            call["tolerance"] = options["tolerance"]
        if sweep is None:
            call["angles"] = drive[mask]
        elif np.sum(mask) != len(sweep):
            continue
        else:
            call |= sweep_of(sweep)
        planes = []
        for name in names:
            array = np.asarray(found[name])
            components = array.shape[-1:] if cardan.OUTPUTS[name].axes else ()
            # The last shaft alone has no axis for shafts.
            array = array.reshape(-1, *shape, *components)
            array = array.reshape(len(array), -1, *components)[:, mask]
            planes.append(np.moveaxis(array, -1, 1) if components else array)
        row = (int(groups[k, 0]), own.size, int(mask.sum()))
        yield ("evaluate", call, row), np.concatenate([plane.ravel() for plane in planes])


def sweep_of(sweep: cardan.Sweep) -> dict[str, Any]:
    if sweep.unit == "turn":
        return {"samples": len(sweep), "per_turn": sweep._given[1]}
    start, stop, *_ = sweep._given
    return {"start": start, "stop": stop, "samples": len(sweep)}


def exported(line: Driveline, options: Any, result: Any) -> bool:  # noqa: ANN401
    """Whether the module has what an evaluation asks for."""
    single = any(np.asarray(result[name]).dtype == np.float32 for name in result)
    coarse = (options.get("tolerance") or 0.0) >= 1e-9
    return not (single or coarse or options.get("reduce") or line._geometry.is_as_built)


def test_recorded_evaluations_have_the_same_bits(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    groups = bits_cases.GROUPS if tiers.whole else (bits_cases.of_loads, bits_cases.of_forces)
    calls, wanted = [], []
    plan_at = oracle.plan_at

    def recording(line: Driveline, names: Any, **options: Any) -> Any:  # noqa: ANN401
        plan = plan_at(line, names, **options)

        def run(angle: Any, out: Any) -> Any:  # noqa: ANN401
            result = plan(angle, out)
            if exported(line, options, result):
                for call, numbers in evaluations(line, names, angle, result, options):
                    calls.append(call)
                    wanted.append(numbers)
            return result

        return run

    monkeypatch.setattr(bits_cases, "plan_at", recording)
    for group in groups:
        for _ in group():
            pass
    assert len(calls) > 100
    answers = in_node(tmp_path, calls=listed(calls))["answers"]
    wrong = [
        (call, answer)
        for call, numbers, answer in zip(calls, wanted, answers, strict=True)
        if answer.get("values") != digest(numbers)
    ]
    print(f"{len(calls)} calls, {sum(map(len, wanted))} results")
    assert not wrong, (len(wrong), wrong[0])
    assert sum(map(len, wanted)) > 1_000_000


# --- random machines ------------------------------------------------------------------------

OUTPUTS = tuple(cardan.OUTPUTS)


def random_machine(random: np.random.Generator) -> tuple[dict[str, Any], Driveline, Load]:
    """Points of several states with bearings and a load: the data, and what they make here."""
    joints, states = int(random.integers(1, 6)), int(random.integers(1, 6))
    steps = np.stack([np.ones(joints + 1), *(random.normal(0.0, 0.25, (2, joints + 1)))], axis=-1)
    points = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)]) * random.uniform(0.2, 2.0)
    points = points + random.normal(0.0, 0.02, (states, joints + 2, 3))
    phases = random.uniform(-2.0, 2.0, (states, joints - 1)) * (random.random() < 0.7)
    line = Driveline.from_points(points, phases)
    shortest = line.lengths().each.min(axis=0)
    bearings = [(0, 0.3 * shortest[0]), (0, 0.8 * shortest[0])]
    bearings += [(shaft, 0.5 * shortest[shaft]) for shaft in range(1, joints + 1)]
    line = line.with_bearings(bearings)
    end = "drive" if random.random() < 0.5 else "output"
    inertias = random.uniform(0.0, 0.3, joints + 1) * (random.random(joints + 1) < 0.6)
    inertias[0] = 0.0
    torque, speed, acceleration = random.uniform(-500.0, 500.0, (3, states))
    load = Load(
        speed=speed, acceleration=acceleration, inertias=inertias, **{f"{end}_torque": torque}
    )
    return {"joints": joints, "points": points, "phases": phases}, line, load


def loaded(line: Driveline, load: Load) -> dict[str, Any]:
    """Drivelines and their loads as arguments."""
    by_shaft = load.inertias_by_shaft(line.n_joints)
    return {
        **lines_of(line),
        "end": load.end,
        "torque": load.torque,
        "speed": load.speed,
        "acceleration": load.acceleration,
        "inertia_shafts": list(by_shaft),
        "inertias": [np.broadcast_to(each, line.shape) for each in by_shaft.values()],
    }


def planes(result: Any, names: Iterable[str]) -> NDArray[np.float64]:  # noqa: ANN401
    """The numbers of a result in the order of the module."""
    arrays = [np.asarray(result[name]) for name in names]
    scalar = result[OUTPUTS[0]].ndim
    return np.concatenate(
        [np.ravel(np.moveaxis(x, -1, 1) if x.ndim > scalar else x) for x in arrays]
    )


def test_random_machines_have_the_same_bits(tmp_path: Path) -> None:
    random = np.random.default_rng(38)
    calls: list[Call] = []
    wanted: list[dict[str, Any]] = []

    def add(name: str, arguments: dict[str, Any], **results: Any) -> None:  # noqa: ANN401
        calls.append((name, arguments))
        wanted.append({key: digest(value) for key, value in results.items()})
        total.append(sum(np.size(value) for value in results.values()))

    total: list[int] = []
    angles = np.concatenate([np.arange(32) * (np.pi / 32.0), [1e-12, -7.3, 1234.5]])
    for _ in range(160 if tiers.whole else 24):
        data, line, load = random_machine(random)
        own, count = line._geometry, line.n_joints
        chain = {name: getattr(own, name) for name in ("bends", "twists", "phases")}
        add(
            "from_points",
            data,
            **{name: getattr(own, name) for name in ("directions", "normals", "lengths")},
            bends=own.bends,
            twists=own.twists,
        )
        shown = line[:, np.newaxis].evaluate(
            angles, OUTPUTS, shafts=slice(None), load=by_state(load)
        )
        request = {"outputs": list(OUTPUTS), "of_shafts": range(count + 1)}
        arguments = {**loaded(line, load), **request, "of_joints": range(count)}
        add("evaluate", {**arguments, "angles": angles}, values=planes(shown, OUTPUTS))
        joint = line.equivalent()
        add("equivalent", {"joints": count, **chain, "shaft": count}, **vars(joint))
        best = line.optimal_phases()
        add("optimal_phases", {"joints": count, **chain}, phases=best)
    answers = in_node(tmp_path, calls=listed(calls))["answers"]
    for call, expected, answer in zip(calls, wanted, answers, strict=True):
        assert answer == expected, call
    print(f"{len(calls)} calls, {sum(total)} results")
    assert sum(total) > (1_000_000 if tiers.whole else 100_000)


def by_state(load: Load) -> Load:
    """The load of each state, for samples along an axis behind the states."""
    return load.changed(lambda values, own: values[:, np.newaxis] if values.ndim > own else values)


# --- the machines of the package ------------------------------------------------------------


@pytest.mark.parametrize("file", tiers.few(MACHINES, MACHINES[-3:]), ids=lambda file: file.stem)
def test_machines_are_judged_with_the_same_bits(file: Path, tmp_path: Path) -> None:
    scene = Scene.load(file)
    machine, data = machine_of(scene), machine_data(scene)
    assert machine is not None
    assert data is not None
    search = {"reach": 0.02, "teeth": list(scene.teeth)}
    answer = in_node(tmp_path, machines=[{"data": data, "search": search}])["judged"][0]
    figures = [
        [one.kind.name, one.item, digest(one.values), [RANKS[rank] for rank in one.ranks]]
        for one in machine.figures()
    ]
    assert answer["figures"] == figures
    limited = [not np.isnan(one.limit) for one in machine.figures()]
    assert answer["limited"] == [one for one, has in zip(figures, limited, strict=True) if has]
    assert answer["made"] == (figures if scene.points is not None else None)
    assert answer["verdict"] == machine.verdict()
    changes = [
        [one.variable, one.item, one.axis, digest([one.start, one.end])]
        for one in machine.suggest(0.02, teeth=scene.teeth)
    ]
    assert answer["suggested"] == changes
    if scene.points is not None:
        points = np.array(data["points"])
        points[:, 1, 2] += 0.004 / data["unit"]
        phases = np.array(data["phases"]).reshape(len(points), -1)
        raised = Machine(Driveline.from_points(points, phases)).figures()
        bends = {one.kind.name: digest(one.values) for one in raised if one.item is None}
        found = {name: values for name, item, values, _ in answer["raised"] if item is None}
        assert found["equivalent_bend"] == bends["equivalent_bend"]
        assert found["equivalent_bend"] != figures[0][2]
    for promised, then in answer["applied"]:
        assert then == promised


# --- what goes wrong ------------------------------------------------------------------------

STRAIGHT: dict[str, Any] = lines_of(Driveline.from_bends([0.0]))
BAD = (np.nan, np.inf, -1.0, 0.5, 1e9, 1e300, 0.0)


def test_malformed_calls_get_an_error(tmp_path: Path) -> None:
    """Every argument in turn is left out, cut, repeated and spoilt: no call stops the module."""
    random = np.random.default_rng(3)
    tables = {row["name"]: row for row in in_node(tmp_path)["table"]["functions"]}
    scenes = [machine_data(Scene.load(file)) for file in MACHINES]
    calls: list[Call] = []
    for _ in range(10_000 if tiers.whole else 300):
        data = scenes[random.integers(len(scenes))]
        assert data is not None
        row = tables[random.choice(list(tables))]
        names = [field["name"] for field in row["arguments"]]
        extra = {
            **{"outputs": ["angle_error", "moment"], "of_shafts": [0, 1], "of_joints": [0]},
            **{"angles": [0.1, 0.2], "shaft": 1, "weights": [1.0], "held": [0], "orders": [2]},
            **{"rpm": [100.0], "means": [1.0] * 5, "variations": [0.01]},
        }
        own = {name: data.get(name, extra.get(name, [])) for name in names}
        own = {
            name: [np.nan if x is None else x for x in np.ravel(np.array(value, dtype=object))]
            for name, value in own.items()
        }
        for name in random.choice(names, size=random.integers(1, 3)):
            value = own[name]
            how = random.integers(4)
            if how == 0 or not value:
                own[name] = [random.choice(BAD)] * int(random.integers(0, 3))
            elif how == 1:
                own[name] = value[: random.integers(len(value))]
            elif how == 2:
                own[name] = value * 2
            elif not isinstance(value[0], str):
                spoilt = list(value)
                spoilt[random.integers(len(value))] = random.choice(BAD)
                own[name] = spoilt
        calls.append((row["name"], own))
    answers = in_node(tmp_path, calls=listed(calls))["answers"]
    errors = [(call, one) for call, one in zip(calls, answers, strict=True) if "kind" in one]
    assert len(errors) > len(calls) // 4
    for call, one in errors:
        assert one["kind"] == "CardanError", (call, one)
        assert "stopped" not in one["error"], (call, one)


WRONG: list[tuple[str, dict[str, Any], str]] = [
    ("evaluate", {"joints": 0}, "a driveline has no joint"),
    ("evaluate", {"joints": [1, 2]}, "joints has 2 values; it has one"),
    (
        "optimal_phases",
        {"joints": 1, "bends": [1.6]},
        "bends[0, 0] is 1.6 rad; a bend must lie",
    ),
    ("from_points", {"joints": 1, "points": [0.0] * 9}, "points[0, 1] is (0, 0, 0) after"),
    ("from_points", {"joints": 1, "points": [np.nan] * 9}, "a point must be finite"),
    ("ranks", {}, "function ranks is unknown"),
    (
        "orders",
        {**STRAIGHT, "outputs": "angle", "of_shafts": 1, "orders": 2},
        'outputs holds "angle", which grows from turn to turn',
    ),
    (
        "suggest",
        {**STRAIGHT, "teeth": 1e9},
        "teeth[0] is 1000000000.0; it must be at most 1000",
    ),
    ("tubes", {"length": "long"}, 'length holds "long", which is unknown'),
    ("tubes", {"lengths": 1.0}, "lengths is no argument of tubes"),
    ("tubes", {"length": [1.0]}, "length has 1 values; 0 drivelines need 1 each"),
]


def test_errors_say_what_is_wrong(tmp_path: Path) -> None:
    calls = listed([(name, arguments) for name, arguments, _ in WRONG])
    for answer, (*_, message) in zip(in_node(tmp_path, calls=calls)["answers"], WRONG, strict=True):
        assert answer["kind"] == "CardanError"
        assert message in answer["error"], answer


def test_errors_have_parts(tmp_path: Path) -> None:
    calls: list[Call] = [
        ("optimal_phases", {"joints": 2, "bends": [0.1, 1.6], "twists": [0.0], "phases": [0.0]}),
        ("optimal_phases", {"joints": 2, "bends": [0.1, 0.2], "twists": [np.nan], "phases": [0.0]}),
        ("from_points", {"joints": 1, "points": [0.0] * 9}),
    ]
    bend, twist, points = in_node(tmp_path, calls=listed(calls))["answers"]
    rule = "a bend must lie in [0, pi/2), with pi/2 as a double"
    own = {"argument": "bends", "place": [0, 1], "value": "1.6", "unit": "rad", "rule": rule}
    assert bend["parts"] == own
    assert bend["error"] == f"bends[0, 1] is 1.6 rad; {rule}"
    assert (twist["parts"]["argument"], twist["parts"]["value"]) == ("twists", "NaN")
    assert points["parts"] == {"argument": "points", "place": [0, 1], "value": "undefined"}


def test_results_that_no_memory_holds_are_refused(tmp_path: Path) -> None:
    call = {**STRAIGHT, "outputs": ["angle"], "of_shafts": [1], "start": 0.0, "stop": 1.0}
    answer = in_node(tmp_path, calls=listed([("evaluate", {**call, "samples": 1e9})]))
    problem = "samples need 1 x 1 x 1000000000 results; at most 4194304 are possible"
    assert answer["answers"][0]["error"] == problem


def test_memory_does_not_grow(tmp_path: Path) -> None:
    data = machine_data(Scene.load(MACHINES[-1]))
    early, late = in_node(tmp_path, endure=[data, 6 if tiers.whole else 0])["memory"]
    assert early == late > 1_000_000


def test_the_readme_computes(tmp_path: Path) -> None:
    text = (WEB / "README.md").read_text(encoding="utf-8")
    code, shown = (
        text.split("```js\n")[1].split("```")[0],
        text.split("```text\n")[1].split("```")[0],
    )
    (tmp_path / "ten.mjs").write_text(code.replace('"./', f'"{WEB}/'))
    assert NODE, "needs Node"
    done = subprocess.run(
        [NODE, "ten.mjs"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == shown


def test_chromium_has_the_same_bits(tmp_path: Path) -> None:
    browser, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if browser is None or driver is None:
        assert not REQUIRED, "chromium or chromedriver is missing"
        pytest.skip("no chromium with chromedriver")
    random = np.random.default_rng(5)
    calls: list[Call] = []
    for _ in range(12):
        data, line, load = random_machine(random)
        calls.append(("from_points", data))
        request: dict[str, Any] = {"outputs": OUTPUTS, "of_shafts": range(line.n_joints + 1)}
        request |= {"of_joints": range(line.n_joints), "angles": np.linspace(0.0, 3.0, 40)}
        calls.append(("evaluate", {**loaded(line, load), **request}))
    asked = {"calls": listed(calls)}
    options = Options()
    options.binary_location = browser
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    with webdriver.Chrome(options, Service(driver)) as chrome:
        chrome.set_script_timeout(60)
        chrome.get("about:blank")
        script = """
            const [library, calls, module, asked, done] = arguments;
            const type = "text/javascript";
            const at = (text) => URL.createObjectURL(new Blob([text], { type }));
            const [first, second] = [at(library), at(calls)];
            const loaded = async (Cardan) => {
              return Cardan.load(Uint8Array.from(atob(module), (letter) => letter.charCodeAt(0)));
            };
            const here = async () => {
              const { Cardan } = await import(first), { answers } = await import(second);
              return answers(await loaded(Cardan), JSON.parse(asked).calls);
            };
            // A worker of a page without an address imports nothing.
            const whole = (text) => text.split("if (typeof process")[0].replace(/^export /gm, "");
            const code = `${whole(library)} ${whole(calls)} onmessage = async ({ data }) => {
              const [module, asked] = data, loaded = ${loaded};
              postMessage(answers(await loaded(Cardan), JSON.parse(asked).calls));
            };`;
            const worker = new Worker(at(code));
            const there = new Promise((resolve, reject) => {
              worker.onmessage = ({ data }) => resolve(data);
              worker.onerror = ({ message }) => reject(message);
            });
            worker.postMessage([module, asked]);
            Promise.all([here(), there]).then(done, (fault) => done(String(fault)));
        """
        found = chrome.execute_async_script(
            script,
            (WEB / "cardan.js").read_text(encoding="utf-8"),
            (ROOT / "tests/calls.mjs").read_text(encoding="utf-8"),
            base64.b64encode((WEB / "cardan.wasm.gz").read_bytes()).decode(),
            json.dumps(asked),
        )
    # In the page and in a worker.
    assert found == [in_node(tmp_path, **asked)["answers"]] * 2
