"""Ctrl-C and other signals during long native work: it ends at once, and says nothing false.

Every evaluation here that is to be interrupted would go on for minutes or for ever. That it ends is
what is tested; docs/testing.md says how soon.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from cardan import Driveline, Sweep

pytestmark = [
    pytest.mark.skipif(os.name != "posix", reason="POSIX signals"),
    pytest.mark.xdist_group("signals"),
]

# The signal is sent by the process itself, some time after the call has begun.
PREAMBLE = """
import os, signal, threading, time
import numpy as np
from cardan import Driveline, Load, Sweep

signal.signal(signal.SIGINT, signal.default_int_handler)
line = Driveline.from_bends([0.5, 0.4])
endless = Sweep(0.0, 1e6, 1 << 36)

def interrupted(call, *arguments, **options):
    threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
    try:
        call(*arguments, **options)
    except KeyboardInterrupt:
        return
    raise SystemExit("it was not interrupted")
"""

CASES = {
    "all threads": "interrupted(line.evaluate, endless, 'angle', reduce='max')",
    "one thread": "interrupted(line.evaluate, endless, 'angle', reduce='max', workers=1)",
    "two threads": "interrupted(line.evaluate, endless, 'angle', reduce='max', workers=2)",
    "sweep that repeats": (
        "turns = Sweep.revolutions(1 << 28, 256)\n"
        "interrupted(line.evaluate, turns, 'angle', reduce='mean', workers=1)"
    ),
    "many drivelines": (
        "lines = Driveline.from_bends(np.full((20_000, 1, 64), 0.1))\n"
        "interrupted(lines.evaluate, Sweep(0.0, 1e3, 1 << 22), 'acceleration_ratio', reduce='max')"
    ),
    "twice": "interrupted(line.evaluate, endless, 'angle', reduce='max')\n" * 2,
    "handler of one's own": (
        "class Alarm(Exception): pass\n"
        "def rings(*_): raise Alarm\n"
        "signal.signal(signal.SIGALRM, rings)\n"
        "signal.setitimer(signal.ITIMER_REAL, 0.2)\n"
        "try:\n"
        "    line.evaluate(endless, 'angle', reduce='max')\n"
        "except Alarm:\n"
        "    pass"
    ),
    "in a forked process": (
        "line.evaluate(np.zeros(200_000))\n"
        "child = os.fork()\n"
        "if child == 0:\n"
        "    interrupted(line.evaluate, endless, 'angle', reduce='max')\n"
        "    os._exit(0)\n"
        "assert os.waitpid(child, 0)[1] == 0"
    ),
    "best phases": (
        "lines = Driveline.from_bends(np.random.default_rng(1).uniform(0.01, 0.3, (100_000, 32)))\n"
        "interrupted(lines.optimal_phases)"
    ),
    "one setting for states": (
        "bends = np.random.default_rng(1).uniform(0.01, 0.3, (10_000, 5, 6))\n"
        "lines = Driveline.from_bends(bends)\n"
        "interrupted(lambda: lines.optimal_phases(states=1))"
    ),
    "one setting of a long driveline": (
        "line = Driveline.from_bends(np.random.default_rng(1).uniform(0.01, 0.3, (3, 256)))\n"
        "interrupted(lambda: line.optimal_phases(states=0))"
    ),
    "best teeth": (
        "lines = Driveline.from_bends(np.random.default_rng(1).uniform(0.01, 0.3, (50_000, 6)))\n"
        "interrupted(lambda: lines.optimal_phases(teeth=18))"
    ),
}


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, marks=pytest.mark.long if case in ("twice", "two threads") else ())
        for case in CASES
    ],
)
def test_interrupted(case: str) -> None:
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", PREAMBLE + CASES[case]],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_what_is_filled_is_right_and_the_rest_untouched() -> None:
    """``out`` is partial after an interrupt: samples are results or as they were."""
    lines = Driveline.from_bends(np.linspace(0.01, 0.05, 64 * 3000).reshape(3000, 64))
    angle = np.linspace(0.0, 6.0, 2000)[:, np.newaxis]
    out = np.full((2000, 3000), np.nan)

    def rings(*_: object) -> None:
        raise TimeoutError("enough")

    before = signal.signal(signal.SIGALRM, rings)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.02)
        with pytest.raises(TimeoutError, match="enough"):
            lines.evaluate(angle, "speed_ratio", out={"speed_ratio": out})
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    done = ~np.isnan(out)
    assert done.any()
    assert not done.all()
    for row in (0, np.flatnonzero(done.any(axis=1))[-1]):
        want = lines.evaluate(angle[row], "speed_ratio").speed_ratio
        assert np.array_equal(out[row][done[row]], want[done[row]])


def test_signals_are_handled_meanwhile_and_change_nothing() -> None:
    line, sweep = Driveline.from_bends([0.5, 0.4]), Sweep(0.0, 1e4, 1 << 29)
    want = line.evaluate(sweep, "angle_error", reduce="rms").angle_error
    heard: list[int] = []
    before = signal.signal(signal.SIGALRM, lambda *_: heard.append(len(heard)))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.06, 0.06)
        got = line.evaluate(sweep, "angle_error", reduce="rms", workers=1).angle_error
        inside = len(heard)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert got == want
    assert inside
