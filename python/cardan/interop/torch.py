"""Outputs as differentiable functions of PyTorch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Unpack

import numpy as np

from cardan.arrays import import_optional
from cardan.interop.differentiable import Evaluation, Options

__all__ = ["evaluate"]


def evaluate(
    parameters: Mapping[str, Any],
    angle: Any,  # noqa: ANN401 - a tensor
    outputs: str | Sequence[str] = ("angle", "speed_ratio"),
    **options: Unpack[Options],
) -> dict[str, Any]:
    """Evaluate outputs as tensors of doubles that PyTorch can differentiate.

    The evaluation is a ``torch.autograd.Function`` that runs on the processor in double precision,
    differentiable once.

    Args:
        parameters: tensors by name, as of ``cardan.jax.evaluate``.
        angle: drive angles in rad.
        outputs: names from ``cardan.OUTPUTS``.
        options: ``shafts``, ``joints``, ``speed``, ``acceleration`` and ``bearings``, as of
            ``cardan.jax.evaluate``.

    Raises:
        ImportError: PyTorch is missing.
        ValueError: unknown parameters or outputs, shapes that do not fit.
    """
    torch: Any = import_optional("torch", "torch")
    evaluation = Evaluation(outputs, **options)
    tensors = {
        name: torch.as_tensor(value, dtype=torch.float64) for name, value in parameters.items()
    }
    angles = torch.as_tensor(angle, dtype=torch.float64)
    names = [*tensors]
    shapes = {name: tuple(tensor.shape) for name, tensor in tensors.items()}
    results = [*evaluation.result_shapes(shapes, tuple(angles.shape))]

    def arrays(tensors: Sequence[Any]) -> list[Any]:
        return [tensor.detach().cpu().numpy() for tensor in tensors]

    class Evaluate(torch.autograd.Function):  # type: ignore[misc, unused-ignore]
        @staticmethod
        def forward(ctx: Any, angle: Any, *tensors: Any) -> Any:  # noqa: ANN401 - tensors
            ctx.save_for_backward(angle, *tensors)
            at, *given = arrays([angle, *tensors])
            found = evaluation.values(dict(zip(names, given, strict=True)), at)
            return tuple(torch.from_numpy(np.array(found[name])) for name in results)

        @staticmethod
        @torch.autograd.function.once_differentiable  # type: ignore[untyped-decorator, unused-ignore]
        def backward(ctx: Any, *weights: Any) -> Any:  # noqa: ANN401 - tensors
            at, *given = arrays(ctx.saved_tensors)
            by_name, slopes = evaluation.pull_back(
                dict(zip(names, given, strict=True)),
                at,
                dict(zip(results, arrays(weights), strict=True)),
                by_angle=ctx.needs_input_grad[0],
            )
            return tuple(
                torch.from_numpy(np.array(array))
                for array in (slopes, *(by_name[name] for name in names))
            )

    found = Evaluate.apply(angles, *tensors.values())
    return dict(zip(results, found, strict=True))
