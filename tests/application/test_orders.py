"""Orders of a recording and its picture, and pictures over time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.patches import StepPatch

from cardan import Driveline
from cardan.app.answers.turn.orders import Bands, orders
from cardan.app.command import commands
from cardan.app.plots import plot_scene
from cardan.app.scene import Scene

RANDOM = np.random.default_rng(7)
JOINT = "[driveline]\nbends_deg = [20]\n"
ANGLES = "[angles]\nfile = 'run.csv'\ntime_column_s = 't'\nspeed_column_rpm = 'n'\n"


def irregular(turns: float, per_turn: float) -> np.ndarray:
    """Angles at unequal steps, that grow over the run as those of a run-up do."""
    count = int(turns * per_turn)
    steps = RANDOM.uniform(0.5, 1.5, count) * np.linspace(0.7, 1.3, count)
    angle = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(3.0 + 2.0 * np.pi * turns * angle / angle[-1])


@pytest.mark.parametrize("turns", [1.0, 2.5, 7.0, 37.3, 100.0])
def test_orders_of_known_waves(turns: float) -> None:
    """Amplitudes of whole orders, above a mean and a trend; the drive may turn backwards."""
    angle = irregular(turns, 200)
    signal = 5.0 + 0.3 * angle + 2.0 * np.cos(2.0 * angle + 1.0) + 0.5 * np.sin(5.0 * angle)
    if turns < 2.0:
        signal -= 0.3 * angle
    for sign in (1.0, -1.0):
        found = orders(sign * angle, np.stack([signal, 0.0 * signal]))
        assert found.orders[-1] == pytest.approx(12.0, abs=1e-9)
        sizes = dict(zip(found.orders.round(9), found.amplitudes[0], strict=True))
        assert sizes.pop(2.0) == pytest.approx(2.0, rel=2e-5)
        assert sizes.pop(5.0) == pytest.approx(0.5, rel=1e-4)
        sizes.pop(0.0)
        assert max(sizes.values()) < 1e-3
        assert np.all(found.amplitudes[1] == 0.0)


def test_half_orders() -> None:
    """Of a four-stroke engine; a segment has an even number of turns."""
    angle = irregular(39.0, 100)
    found = orders(angle, np.sin(0.5 * angle)[np.newaxis])
    assert found.turns % 2 == 0
    assert (found.turns, found.segments) == (18, 2)
    sizes = dict(zip(found.orders.round(9), found.amplitudes[0], strict=True))
    assert sizes.pop(0.5) == pytest.approx(1.0, rel=1e-4)
    assert max(sizes.values()) < 1e-3


def test_orders_of_a_joint() -> None:
    """The closed form of the harmonics, from irregular samples with gaps and turns of a counter."""
    line = Driveline.from_bends([20], degrees=True)
    angle = irregular(10.0, 150)
    ratio = line.evaluate(angle, "speed_ratio").speed_ratio
    counted = angle % (2.0 * np.pi)
    counted[RANDOM.integers(0, counted.size, 20)] = np.nan
    found = orders(counted, ratio[np.newaxis])
    for order, exact in zip((2, 4, 6), line.harmonics((2, 4, 6)).speed_ratio, strict=True):
        assert found.amplitudes[0][order * found.turns] == pytest.approx(float(exact), abs=2e-6)


def test_a_run_up_from_rest() -> None:
    """Samples at rest, before and within the run, change nothing."""
    angle = irregular(10.0, 100)
    wave = np.sin(2.0 * angle)
    rest = np.repeat(np.arange(angle.size), np.where(np.arange(angle.size) % 400 == 0, 30, 1))
    moving, resting = (orders(angle[i], wave[i][np.newaxis]) for i in (slice(None), rest))
    np.testing.assert_array_equal(moving.amplitudes, resting.amplitudes)


def test_few_samples_have_few_orders() -> None:
    found = orders(irregular(10.0, 10), np.zeros((1, 101)))
    assert found.orders[-1] == pytest.approx(5.0, abs=0.1)


@pytest.mark.parametrize(
    ("angle", "message"),
    [
        (np.linspace(0.0, 6.0, 100), "at least one turn and 8 samples; there are 0.955 turns"),
        (np.linspace(0.0, 7.0, 5), "at least one turn and 8 samples; there are 1.11 turns"),
        (np.sin(np.linspace(0.0, 6.0, 100)), "a drive that turns one way; its angle goes back"),
        (np.zeros(20), "there are 0 turns"),
        (np.arange(40) * 4.0, "two samples per turn; there are 1.61 over 24.83 turns"),
        (np.arange(40) * 1e3, "two samples per turn; there are 0.00644 over 6207 turns"),
        (np.full(9, np.nan), "there are 0 turns"),
    ],
)
def test_what_has_no_orders(angle: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match="orders need") as caught:
        orders(angle, angle[np.newaxis])
    assert message in str(caught.value)


# Pictures


@pytest.fixture
def run_up(tmp_path: Path) -> Path:
    """A drive that runs up from 600 to 900 rpm in 3 s."""
    time = 0.001 * np.arange(3001)
    rows = zip(time.tolist(), (600.0 + 100.0 * time).tolist(), strict=True)
    (tmp_path / "run.csv").write_text("t,n\n" + "".join(f"{t},{n}\n" for t, n in rows))
    path = tmp_path / "run.toml"
    path.write_text(JOINT + ANGLES)
    return path


def test_the_page_over_time(run_up: Path) -> None:
    """Bands of the turns, at the times at which they begin; the speed of the drive is shown."""
    result = Scene.load(run_up).run()
    pages = {over: plot_scene(result, over=over) for over in (None, "time", "turns")}
    labels = {over: page.axes[-1].get_xlabel() for over, page in pages.items()}
    assert labels == {None: "time [s]", "time": "time [s]", "turns": "turns of the drive"}
    speed = next(axes for axes in pages["time"].axes if axes.get_label() == "drive speed [rpm]")
    assert speed.get_xlim() == pytest.approx((0.0, 3.0))
    (band,) = (artist for artist in speed.get_children() if isinstance(artist, StepPatch))
    values, edges, _ = band.get_data()
    # Turn 15 begins at 300 rpm/s t**2 / 2 + 600 rpm t = 15 turns.
    begin = (-600.0 + np.sqrt(600.0**2 + 200.0 * 15.0 * 60.0)) / 100.0
    assert edges[15] == pytest.approx(begin, abs=1e-3)
    assert values[14] == pytest.approx(600.0 + 100.0 * begin, abs=0.2)
    bands = Bands.of_time(np.arange(0.0, 500.0), 3600.0 * np.sin(np.arange(0.0, 500.0) / 50.0))
    assert bands is not None
    assert bands.each.startswith("span of ")
    assert np.ptp(np.diff(bands.edges)) < 1e-9


def test_few_turns_over_time(run_up: Path) -> None:
    """Curves, and no bands; over the time where it is asked for."""
    lines = (run_up.parent / "run.csv").read_text().splitlines(keepends=True)
    (run_up.parent / "run.csv").write_text("".join(lines[:102]))
    result = Scene.load(run_up).run()
    axes = plot_scene(result, over="time").axes[-1]
    assert axes.get_xlabel() == "time [s]"
    assert axes.get_lines()[0].get_xdata() == pytest.approx(0.001 * np.arange(101))
    assert axes.get_xlim() == pytest.approx((0.0, 0.1))
    for over in (None, "turns"):
        assert plot_scene(result, over=over).axes[-1].get_xlabel() == "drive angle [deg]"


def test_the_page_of_orders(run_up: Path) -> None:
    """The peak of the speed ratio is that of the closed form, at order 2."""
    figure = plot_scene(Scene.load(run_up).run(), over="orders")
    axes = next(axes for axes in figure.axes if str(axes.get_label()).startswith("speed ratio"))
    (line,) = axes.get_lines()
    places, sizes = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    assert places[np.argmax(sizes)] == 2.0
    exact = float(Driveline.from_bends([20], degrees=True).harmonics(2).speed_ratio[0])
    assert np.max(sizes) == pytest.approx(exact, rel=1e-3)
    notes = " ".join(text.get_text() for text in figure.texts)
    assert "over 18 turns, less their linear trend; root mean squares of 2 such segments" in notes


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        (JOINT, ["--over", "time"], "--over is 'time'; the scene has no time_column_s"),
        (
            f"{JOINT}[sweep]\nturns = 0.5\n",
            ["--over", "orders"],
            "--over is 'orders'; orders need at least one turn and 8 samples; there are 0.5 turns",
        ),
        (JOINT, ["--over", "orders", "--study", "k"], "--over does not go with --study"),
    ],
)
def test_what_cannot_be_drawn(
    tmp_path: Path, text: str, options: list[str], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(text)
    done = CliRunner().invoke(commands(), ["plot", "a.toml", *options])
    assert done.exit_code == 2
    assert message in done.stderr
    assert not Path("a.svg").exists()


def test_the_command_draws_orders_of_a_sweep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(JOINT)
    done = CliRunner().invoke(commands(), ["plot", "a.toml", "--over", "orders"])
    assert done.exit_code == 0, done.output
    assert Path("a.svg").read_text().count("<path") > 100


def test_whole_orders_are_stems(tmp_path: Path) -> None:
    """Of one turn nothing is known between them, and what is constant has none."""
    path = tmp_path / "a.toml"
    path.write_text(
        "[driveline]\nbends_deg = [0, 20]\n[load]\noutput_torque_Nm = 7\n"
        '[output]\nquantities = ["speed_ratio", "torque"]\nshafts = [1, 2]\n'
    )
    figure = plot_scene(Scene.load(path).run(), over="orders")
    ratio, torque = (
        next(axes for axes in figure.axes if str(axes.get_label()).startswith(name))
        for name in ("speed ratio", "torque")
    )
    still, turning = (np.asarray(line.get_xydata()) for line in ratio.get_lines())
    assert len(still) == 0
    orders = np.arange(2, 13, 2)
    exact = Driveline.from_bends([20], degrees=True).harmonics(orders).speed_ratio
    assert ratio.get_lines()[1].get_linestyle() == "None"
    assert turning[:, 0] == pytest.approx(orders + 0.125)
    assert turning[:, 1] == pytest.approx(exact, rel=1e-6, abs=1e-10)
    stems = [np.asarray(path.vertices).tolist() for path in ratio.collections[1].get_paths()]
    assert stems == [[[x, 0.0], [x, y]] for x, y in turning.tolist()]
    assert ratio.get_ylim()[1] > exact[0]
    assert [text.get_text() for text in ratio.texts] == []
    assert [len(np.asarray(line.get_xdata())) > 0 for line in torque.get_lines()] == [True, False]


def test_a_constant_quantity_says_so(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text('[driveline]\nbends_deg = [0]\n[output]\nquantities = ["speed_ratio"]\n')
    figure = plot_scene(Scene.load(path).run(), over="orders")
    (ratio,) = (axes for axes in figure.axes if str(axes.get_label()).startswith("speed ratio"))
    assert [text.get_text() for text in ratio.texts] == ["constant"]
    assert all(len(np.asarray(line.get_xdata())) == 0 for line in ratio.get_lines())
