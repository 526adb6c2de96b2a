"""The driveline and the load that the keys of a scene describe, single or as a batch."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from cardan.driveline import Driveline
from cardan.errors import ArgumentValueError
from cardan.load import Load
from cardan.scene.format import FORMAT, FORMS, Form

_MOTION = ("speed_rpm", "speed_rad_s", "acceleration_rad_s2")


def form_of(values: Mapping[str, Any]) -> Form:
    """Return the form in which keys describe a driveline, their lengths checked.

    Raises:
        ValueError: no form, more than one, keys that do not go together, lengths that do not fit.
    """
    used = [form for form in FORMS if any(key in values for key in form.keys)]
    if not used:
        ways = "; ".join(" with ".join(form.keys) for form in FORMS)
        raise ValueError(f"no shafts or joints; give one of: {ways}")
    form = used[0]
    if len(used) > 1:
        one, other = (next(key for key in form.keys if key in values) for form in used[:2])
        raise ArgumentValueError(
            one, f"and {other} are both given; describe the driveline in one way"
        )
    for key in form.keys:
        if key not in values:
            raise ArgumentValueError(key, f"is missing; {' and '.join(form.keys)} go together")
    for key in values:
        if key not in form.keys + form.optional:
            raise ArgumentValueError(key, f"does not go with {form.keys[0]}, which says it already")

    first = form.keys[0]
    joints = len(values[first]) - form.ends
    if joints < 1:
        raise ArgumentValueError(
            first, f"has length {len(values[first])}; one joint needs {1 + form.ends}"
        )
    if form.joints is not None and joints != form.joints:
        raise ArgumentValueError(
            first, f"has length {joints}; it needs {form.joints}, one per joint"
        )
    for key in form.keys[1:]:
        _check_count(key, values[key], joints + form.ends, f"as many as {first}")
    for key in form.optional:
        if key in values:
            _check_count(key, values[key], joints - 1, "one per shaft between two joints")
    return form


def make_driveline(form: Form, values: Mapping[str, Any]) -> Driveline:
    """Return the driveline of a form, or a batch if the values have leading dimensions.

    Raises:
        ValueError: values that make no driveline.
    """
    keys = FORMAT["driveline"].keys
    names: dict[str, tuple[str, ...]] = {keys[key].argument: (key,) for key in values}
    # Slopes become directions before their bends are known.
    names.setdefault("directions", form.keys)
    with _named(names):
        # Neither points nor directions are angles: what is in degrees is what can be.
        return form.make(**{keys[key].argument: values[key] for key in values}, degrees=True)


def check_load(values: Mapping[str, Any], joints: int) -> None:
    """Refuse a load that does not fit the driveline.

    Raises:
        ValueError: not one inertia per shaft.
    """
    if "inertias_kgm2" in values:
        _check_count("inertias_kgm2", values["inertias_kgm2"], joints + 1, "one per shaft")


def make_load(values: Mapping[str, Any], varied: Container[str] = ()) -> Load:
    """Return the load that keys describe, of arrays if the values are.

    Args:
        values: values by key.
        varied: the keys of a study. The speed or acceleration that only the study gives is 0 here.

    Raises:
        ValueError: a negative inertia, inertias without a speed or an acceleration.
    """
    keys = FORMAT["load"].keys
    given = {keys[key].argument for key in values}
    still = {key: 0.0 for key in _MOTION if key in varied and keys[key].argument not in given}
    values = still | dict(values)
    with _named({keys[key].argument: (key,) for key in values}):
        return Load(
            **{
                keys[key].argument: np.multiply(value, keys[key].factor)
                for key, value in values.items()
            }
        )


def _check_count(key: str, values: Sequence[Any], wanted: int, why: str) -> None:
    if len(values) != wanted:
        raise ArgumentValueError(key, f"has length {len(values)}; it needs {wanted}, {why}")


@contextmanager
def _named(names: Mapping[str, tuple[str, ...]]) -> Iterator[None]:
    """Let errors name the keys of the file instead of a constructor's arguments."""
    try:
        yield
    except ArgumentValueError as error:
        key, *others = names.get(error.argument, (error.argument,))
        problem = " ".join((*(f"and {other}" for other in others), error.problem))
        raise ArgumentValueError(key, problem, error.place) from None
