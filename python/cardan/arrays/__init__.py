"""Arrays as arguments: their coercion, and the libraries beside NumPy that make them."""

from cardan.arrays.coercion import FloatArray, as_float64, common_shape, scalar_or_array
from cardan.arrays.libraries import adapter, array_namespace_of, deferring, import_optional
from cardan.arrays.ranges import not_negative, per_joint, positive

__all__ = [
    "FloatArray",
    "adapter",
    "array_namespace_of",
    "as_float64",
    "common_shape",
    "deferring",
    "import_optional",
    "not_negative",
    "per_joint",
    "positive",
    "scalar_or_array",
]
