"""Mutants of changed Python lines: small changes of the package that no test notices.

    python tests/mutants.py --since HEAD~1 --seconds 60
    python tests/mutants.py --since HEAD~20 --only 'report/*' --jobs 2

Each mutant is the package with one small change in a line that differs from the commit: another
comparison, another sign, another constant, a call left out, two arguments swapped, a condition
turned round. Of the test files that ``tests/mutants.toml`` names for the module, the tests that
call the changed function run until one fails.

Mutants that survive are printed, except those that ``tests/data/equivalent_mutants.txt`` lists:
these were judged to change nothing that matters, for the reason in the line with ``#`` above them.
Add a test for a survivor, or its line to that file. With ``--strict`` the exit status is 1 if there
are new survivors; otherwise it is 1 only if the tests fail without a mutant. Needs ``fork``.
"""

from __future__ import annotations

import argparse
import fnmatch
import importlib
import importlib.util
import json
import os
import py_compile
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from queue import SimpleQueue
from types import FrameType
from typing import Any, NamedTuple

from mutations import Mutant, mutants_of

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "python" / "cardan"
KNOWN = ROOT / "tests" / "data" / "equivalent_mutants.txt"
# Loaded once before the forks; nothing of the package and nothing that starts threads.
LIBRARIES = (
    *("pytest", "hypothesis", "numpy", "mpmath", "scipy.optimize", "scipy.integrate"),
    *("click.testing", "matplotlib.figure", "matplotlib.backends.backend_svg", "jinja2"),
)


class Job(NamedTuple):
    """A mutant of a module, and the test files that judge it."""

    module: str
    mutant: Mutant
    tests: tuple[str, ...]

    @property
    def key(self) -> str:
        """What stays the same when lines move."""
        return f"{self.module}: {self.mutant.text}  [{self.mutant.change}]"


def changed_lines(since: str) -> dict[str, set[int]]:
    """Return the numbers of the lines of each module that differ from the commit."""
    command = ["git", "diff", "--unified=0", "--no-color", since, "--", "python/cardan/**.py"]
    diff = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    lines: dict[str, set[int]] = {}
    module = ""
    for line in diff.splitlines():
        if line.startswith("+++ "):
            module = line.removeprefix("+++ b/python/cardan/")
        elif found := re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@", line):
            first, count = int(found[1]), int(found[2] or 1)
            lines.setdefault(module, set()).update(range(first, first + count))
    return {module: found for module, found in lines.items() if (PACKAGE / module).exists()}


def jobs(since: str, only: str) -> list[Job]:
    """Return every mutant of the changed lines."""
    table: dict[str, list[str]] = tomllib.loads((ROOT / "tests/mutants.toml").read_text())["tests"]
    found = []
    for module, lines in changed_lines(since).items():
        if not fnmatch.fnmatch(module, only):
            continue
        tests = next(
            (tests for pattern, tests in table.items() if fnmatch.fnmatch(module, pattern)), []
        )
        source = (PACKAGE / module).read_text(encoding="utf-8")
        found += [Job(module, mutant, tuple(tests)) for mutant in mutants_of(source, lines)]
    return found


class Copy:
    """A copy of the package whose modules can be mutated one at a time."""

    def __init__(self, folder: Path) -> None:
        """Copy and compile the package of the tree and the native module that is installed."""
        self.folder, self.package = folder, folder / "cardan"
        shutil.copytree(PACKAGE, self.package, ignore=shutil.ignore_patterns("__pycache__"))
        if not list(self.package.glob("_core*.so")):
            installed = importlib.util.find_spec("cardan")
            assert installed is not None
            assert installed.origin is not None
            for native in Path(installed.origin).parent.glob("_core*"):
                shutil.copy(native, self.package)
        for path in self.package.rglob("*.py"):
            self._compile(path)

    def _compile(self, path: Path) -> None:
        # Unchecked: a mutant within the same second and of the same length would not be noticed.
        mode = py_compile.PycInvalidationMode.UNCHECKED_HASH
        py_compile.compile(str(path), invalidation_mode=mode)

    def baseline(self, tests: tuple[str, ...]) -> Baseline:
        """Run test files without a mutant, and see which test calls which function."""
        record = self.folder / "calls.json"
        if not self._passes(tests, 900.0, record):
            raise SystemExit(f"without a mutant these fail: {' '.join(tests)}")
        return Baseline(tests, **json.loads(record.read_text()))

    def run(self, job: Job, baseline: Baseline) -> bool:
        """Return whether the tests pass with a mutant."""
        path = self.package / job.module
        original = path.read_text(encoding="utf-8")
        tests, seconds = baseline.of(job)
        try:
            path.write_text(job.mutant.applied(original), encoding="utf-8")
            self._compile(path)
            return self._passes(tests, 10.0 + 4.0 * seconds)
        finally:
            path.write_text(original, encoding="utf-8")
            self._compile(path)

    def _passes(self, tests: Sequence[str], limit: float, record: Path | None = None) -> bool:
        child = os.fork()
        if child == 0:
            self._run_tests(tests, record)
        end = time.monotonic() + limit
        while time.monotonic() < end:
            done, status = os.waitpid(child, os.WNOHANG)
            if done:
                return os.waitstatus_to_exitcode(status) == 0
            time.sleep(0.02)
        os.killpg(child, signal.SIGKILL)
        os.waitpid(child, 0)
        return False

    def _run_tests(self, tests: Sequence[str], record: Path | None) -> None:
        """Run pytest in the forked process and end it."""
        status = 3
        try:
            os.setsid()
            null = os.open(os.devnull, os.O_RDWR)
            for descriptor in (0, 1, 2):
                os.dup2(null, descriptor)
            os.chdir(ROOT)
            sys.path.insert(0, str(self.folder))
            os.environ |= {"PYTHONPATH": str(self.folder), "PYTHONDONTWRITEBYTECODE": "1"}
            sys.dont_write_bytecode = True
            importlib.invalidate_caches()
            import pytest

            options = ["-x", "-q", "--assert=plain", "-p", "no:cacheprovider", "-W", "ignore"]
            calls = Calls(str(self.package) + os.sep)
            status = int(pytest.main([*options, *tests], plugins=[calls] if record else []))
            if record:
                record.write_text(json.dumps({"calls": calls.by_function, "times": calls.times}))
        finally:
            os._exit(status)


class Calls:
    """A plugin of pytest that sees which test calls which function of the package."""

    def __init__(self, package: str) -> None:
        """Take the folder of the package, with a separator at its end."""
        self.package = package
        self.by_function: dict[str, list[str]] = {}
        self.times: dict[str, float] = {}
        self.test = ""

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """Count what fixtures call for all tests of the file: they may share the fixture."""
        self.test = nodeid.split("::")[0]
        sys.settrace(self._called)

    def pytest_runtest_call(self, item: Any) -> None:  # noqa: ANN401 - of pytest
        """Count what a test calls for the test."""
        self.test = item.nodeid

    def pytest_runtest_logreport(self, report: Any) -> None:  # noqa: ANN401 - of pytest
        """Keep how long a test took."""
        if report.when == "call":
            self.times[report.nodeid] = report.duration

    def _called(self, frame: FrameType, event: str, _: object) -> None:
        path = frame.f_code.co_filename
        if event == "call" and path.startswith(self.package):
            key = f"{path.removeprefix(self.package)}:{frame.f_code.co_firstlineno}"
            tests = self.by_function.setdefault(key, [])
            if self.test not in tests:
                tests.append(self.test)


class Baseline(NamedTuple):
    """A run of test files without a mutant.

    Attributes:
        tests: the files.
        calls: the tests that call a function, or the file whose fixtures do, by module and line.
        times: how long each test took.
    """

    tests: tuple[str, ...]
    calls: dict[str, list[str]]
    times: dict[str, float]

    def of(self, job: Job) -> tuple[Sequence[str], float]:
        """Return what judges a mutant, shortest first, and how long that takes at most.

        What no test calls in its own process may be called in another one: all files judge it.
        """
        found = self.calls.get(f"{job.module}:{job.mutant.function}", list(self.tests))
        files = {test for test in found if "::" not in test}
        single = [test for test in found if test.split("::")[0] not in files]
        whole = sum(self.times.values())
        return [*sorted(single, key=lambda test: self.times.get(test, 0.0)), *sorted(files)], whole


def survivors(found: Sequence[Job], options: argparse.Namespace) -> Iterator[tuple[Job, bool]]:
    """Yield each mutant that ran, and whether it survived."""
    end = time.monotonic() + options.seconds
    with tempfile.TemporaryDirectory() as folder:
        copies: SimpleQueue[Copy] = SimpleQueue()
        for number in range(options.jobs):
            copies.put(Copy(Path(folder, str(number))))
        baselines: dict[tuple[str, ...], Baseline] = {}

        def judged(job: Job) -> tuple[Job, bool] | None:
            if time.monotonic() > end:
                return None
            copy = copies.get()
            try:
                if job.tests not in baselines:
                    baselines[job.tests] = copy.baseline(job.tests)
                return job, copy.run(job, baselines[job.tests])
            finally:
                copies.put(copy)

        with ThreadPoolExecutor(options.jobs) as pool:
            yield from filter(None, pool.map(judged, found))


def main() -> int:
    """Run; print the survivors; return the exit status."""
    parser = argparse.ArgumentParser(description="mutants of changed Python lines")
    parser.add_argument("--since", default="HEAD~1", help="the commit that lines are compared with")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="time to spend")
    parser.add_argument("--only", default="*", help="modules, as python/cardan/ has them")
    parser.add_argument("--seed", type=int, default=0, help="of the order of the mutants")
    parser.add_argument("--jobs", type=int, default=1, help="mutants at a time")
    parser.add_argument("--strict", action="store_true", help="fail if there are new survivors")
    options = parser.parse_args()
    # Mutants may be odd.
    warnings.simplefilter("ignore", SyntaxWarning)
    for name in LIBRARIES:
        with suppress(ImportError):
            importlib.import_module(name)
    found = jobs(options.since, options.only)
    random.Random(options.seed).shuffle(found)
    untested = sorted({job.module for job in found if not job.tests})
    found = [job for job in found if job.tests]
    known = set(KNOWN.read_text(encoding="utf-8").splitlines())
    counts: Counter[bool] = Counter()
    new = 0
    for job, survived in survivors(found, options):
        counts[survived] += 1
        if survived and job.key not in known:
            new += 1
            print(f"survives: line {job.mutant.line} of {job.key}", flush=True)
    print(f"{len(found)} mutants; {counts.total()} ran: {counts[False]} noticed, {new} new survive")
    if untested:
        print(f"no tests in tests/mutants.toml: {', '.join(untested)}")
    return 1 if new and options.strict else 0


if __name__ == "__main__":
    sys.exit(main())
