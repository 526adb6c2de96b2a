"""The driveline and the load that the keys of a scene describe, single or as a batch."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.app.scene.sections.driveline import FORMS, TEETH, Form
from cardan.app.scene.sections.table import FORMAT
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.geometry.constructors import sloping

_TORQUES = ("drive_torque_Nm", "output_torque_Nm")
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


def filled(values: Mapping[str, Any], bends: FloatArray | None) -> tuple[Form, dict[str, Any]]:
    """Return form and keys of the driveline, with twists and phases that are left out as zeros.

    Args:
        values: values by key.
        bends: the bends of its joints where they were recorded.

    Raises:
        ValueError: as for ``form_of``; keys that do not go with recorded bends.
    """
    made = dict(values)
    if bends is not None:
        for key in values:
            if key not in FORMS[0].optional:
                raise ArgumentValueError(key, "does not go with recorded bends")
        made[FORMS[0].keys[0]] = [0.0] * bends.shape[-1]
    for form in FORMS:
        given = [key for key in form.keys if key in made]
        if form.views and given:
            level = [0.0] * len(made[given[0]])
            made = {**dict.fromkeys(form.keys, level), **made}
    form = form_of(made)
    joints = len(made[form.keys[0]]) - form.ends
    for key in form.optional:
        made.setdefault(key, [0.0] * (joints - 1))
    if bends is not None:
        made[form.keys[0]] = bends
    return form, made


def make_driveline(form: Form, values: Mapping[str, Any]) -> Driveline:
    """Return the driveline of a form, or a batch if the values have leading dimensions.

    Raises:
        ValueError: values that make no driveline.
    """
    keys = FORMAT["driveline"].keys
    names: dict[str, tuple[str, ...]] = {keys[key].argument: (key,) for key in values}
    # Slopes become directions before their bends are known.
    names.setdefault("directions", form.keys)
    with _named(names, lambda: _vectors_along_shafts(values)):
        # Neither points nor directions are angles: what is in degrees is what can be.
        return form.make(**{keys[key].argument: values[key] for key in values}, degrees=True)


def teeth_of(values: Mapping[str, Any], joints: int) -> tuple[int, ...]:
    """Return the teeth of the spline of each shaft between two joints; empty if none are given.

    Raises:
        ValueError: not one number per shaft between two joints.
    """
    teeth = values.get(TEETH, [])
    if not isinstance(teeth, list):
        teeth = [teeth] * (joints - 1)
    elif TEETH in values:
        _check_count(TEETH, teeth, joints - 1, "one per shaft between two joints")
    return tuple(teeth)


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
            **{keys[key].argument: _in_si(value, keys[key].factor) for key, value in values.items()}
        )


def _in_si(value: ArrayLike, factor: float) -> ArrayLike:
    # Recorded values are long, and in SI units.
    return value if factor == 1.0 else np.multiply(value, factor)


def check_not_recorded(values: Mapping[str, Any], recorded: Container[str]) -> None:
    """Refuse keys of a load, or of a study, for what was recorded.

    Raises:
        ValueError: a motion or a torque of which the recording says another.
    """
    for keys, signal, said in (
        (_MOTION, "speed_rad_s", "times, from which speed and acceleration follow"),
        (_TORQUES, "drive_torque_Nm", "a torque"),
    ):
        if signal in recorded:
            for key in keys:
                if key in values:
                    raise ArgumentValueError(key, f"does not go with [angles], which gives {said}")


def at_samples(load: Load, which: NDArray[np.bool_]) -> Load:
    """Return the load at some of the samples of a recording."""
    values = {
        f"{load.end}_torque": load.torque,
        "speed": load.speed,
        "acceleration": load.acceleration,
    }
    return Load(
        inertias=load.inertias,
        **{name: value[which] if value.ndim else value for name, value in values.items()},
    )


def _check_count(key: str, values: Sequence[Any], wanted: int, why: str) -> None:
    if len(values) != wanted:
        raise ArgumentValueError(key, f"has length {len(values)}; it needs {wanted}, {why}")


@contextmanager
def _named(
    names: Mapping[str, tuple[str, ...]],
    vectors: Callable[[], FloatArray | None] | None = None,
) -> Iterator[None]:
    """Let errors name the keys of the file instead of a constructor's arguments.

    Args:
        names: keys by argument.
        vectors: finds the vectors along the shafts, if arguments give some.
    """
    try:
        yield
    except ArgumentValueError as error:
        key, *others = names.get(error.argument, (error.argument,))
        along = vectors and vectors()
        problem = error.problem
        # The place is that of a driveline in the batch and not of a vector in it.
        if along is not None and len(error.place) == along.ndim - 2:
            problem = _too_steep(key, along[tuple(map(int, error.place))]) or problem
        problem = " ".join((*(f"and {other}" for other in others), problem))
        raise ArgumentValueError(key, problem, error.place) from None


def _vectors_along_shafts(values: Mapping[str, Any]) -> FloatArray | None:
    """Vectors along the shafts that points, directions or slopes give; ``None`` for bends."""
    for key, value in values.items():
        if key.startswith("points"):
            return np.diff(np.asarray(value, float), axis=-2)
        if key == "directions":
            return np.asarray(value, float)
    if "slopes_vertical_deg" in values:
        return sloping(
            *(np.radians(values[f"slopes_{view}_deg"]) for view in ("vertical", "horizontal"))
        )
    return None


def _too_steep(key: str, vectors: FloatArray) -> str | None:
    """The first bend that is too large, in degrees and with the numbers of its points or shafts."""
    one, other = vectors[:-1], vectors[1:]
    sine = np.linalg.norm(np.cross(one, other), axis=-1)
    bends = np.degrees(np.arctan2(sine, np.sum(one * other, axis=-1)))
    if not np.any(bends >= 90.0):
        return None
    joint = int(np.argmax(bends >= 90.0))
    bend = bends[joint]
    if key.startswith("points"):
        place = f"at point {joint + 1}, between points {joint} and {joint + 2}"
    else:
        place = f"between shafts {joint} and {joint + 1}"
    return f"give joint {joint} a bend of {bend:.8g} deg {place}; a bend must lie in [0, 90) deg"


def largest_speed(load: Load | None) -> float:
    """Return the speed of the drive in rad/s, the largest of a recording; 0 if it is not given."""
    speeds = np.atleast_1d(0.0 if load is None else load.speed)
    known = speeds[~np.isnan(speeds)]
    return float(known[np.argmax(np.abs(known))]) if known.size else 0.0
