"""Outputs as differentiable functions of JAX, for ``jax.grad``, ``jax.jit`` and ``jax.vmap``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Unpack

import numpy as np

from cardan.arrays import import_optional
from cardan.interop.differentiable import Evaluation, Options

__all__ = ["evaluate"]


def evaluate(
    parameters: Mapping[str, Any],
    angle: Any,  # noqa: ANN401 - an array of JAX
    outputs: str | Sequence[str] = ("angle", "speed_ratio"),
    **options: Unpack[Options],
) -> dict[str, Any]:
    """Evaluate outputs as a function that JAX can differentiate.

    JAX calls the evaluation on the host (``jax.pure_callback``) and takes its derivatives from
    ``Plan.gradient`` (``jax.custom_vjp``). The function runs under ``jit``, ``vmap`` and ``grad``.
    It does not run on a graphics processor or in forward mode (``jax.jvp``), and it has no second
    derivatives. Under ``vmap`` the calls follow one another; a batch of parameters in one call is
    faster. Results have JAX's default type, which is single precision unless ``jax_enable_x64`` is
    set.

    Args:
        parameters: arrays by name: ``"bends"`` with ``"twists"`` and ``"phases"`` (0 by default),
            or ``"points"`` with ``"phases"``, shaped as for ``Driveline.from_bends`` and
            ``from_points``; for loads ``"drive_torque"`` or ``"output_torque"``, one number, and
            ``"inertias"``, one per shaft; for forces the ``"positions"`` of the bearings and, with
            bends, the ``"lengths"`` of the shafts.
        angle: drive angles in rad.
        outputs: names from ``cardan.OUTPUTS``.
        options: ``shafts`` and ``joints`` of the outputs, as for ``Driveline.evaluate``; for loads
            the ``speed`` of the drive in rad/s and its ``acceleration`` in rad/s², 0 by default;
            ``bearings``, the shaft of each bearing.

    Returns:
        an array per output, shaped as by ``Driveline.evaluate``.

    Raises:
        ImportError: JAX is missing.
        ValueError: unknown parameters or outputs, shapes that do not fit.
    """
    jax: Any = import_optional("jax", "jax")
    evaluation = Evaluation(outputs, **options)
    number = jax.dtypes.canonicalize_dtype(np.float64)
    given = {name: jax.numpy.asarray(value, number) for name, value in dict(parameters).items()}
    angles = jax.numpy.asarray(angle, number)

    def like(shapes: Mapping[str, tuple[int, ...]]) -> dict[str, Any]:
        return {name: jax.ShapeDtypeStruct(shape, number) for name, shape in shapes.items()}

    def on_host(function: Any, shapes: Any, *arguments: Any) -> Any:  # noqa: ANN401 - trees of arrays
        return jax.pure_callback(function, shapes, *arguments, vmap_method="sequential")

    def values(parameters: Any, angle: Any) -> Any:  # noqa: ANN401 - trees of arrays
        def call(parameters: Any, angle: Any) -> Any:  # noqa: ANN401 - trees of arrays
            found = evaluation.values(parameters, angle)
            return {name: array.astype(number) for name, array in found.items()}

        shapes = {name: array.shape for name, array in parameters.items()}
        results = like(evaluation.result_shapes(shapes, angle.shape))
        return on_host(call, results, parameters, angle)

    def forward(parameters: Any, angle: Any) -> Any:  # noqa: ANN401 - trees of arrays
        return values(parameters, angle), (parameters, angle)

    def backward(kept: Any, weights: Any) -> Any:  # noqa: ANN401 - trees of arrays
        parameters, angle = kept

        def call(parameters: Any, angle: Any, weights: Any) -> Any:  # noqa: ANN401 - trees of arrays
            found, slopes = evaluation.pull_back(parameters, angle, weights)
            return {name: x.astype(number) for name, x in found.items()}, slopes.astype(number)

        shapes = {name: array.shape for name, array in parameters.items()}
        results = like(shapes), jax.ShapeDtypeStruct(angle.shape, number)
        return on_host(call, results, parameters, angle, weights)

    run = jax.custom_vjp(values)
    run.defvjp(forward, backward)
    results: dict[str, Any] = run(given, angles)
    return results
