"""Arrays as arguments: their coercion, and the libraries beside NumPy that make them."""

from cardan.arrays.coercion import (
    ComplexArray,
    FloatArray,
    as_float64,
    common_shape,
    finite,
    not_negative,
    per_joint,
    per_shaft,
    positive,
    scalar_or_array,
    shares_of,
    together,
)
from cardan.arrays.libraries import adapter, array_namespace_of, deferring, import_optional

__all__ = [
    "ComplexArray",
    "FloatArray",
    "adapter",
    "array_namespace_of",
    "as_float64",
    "common_shape",
    "deferring",
    "finite",
    "import_optional",
    "not_negative",
    "per_joint",
    "per_shaft",
    "positive",
    "scalar_or_array",
    "shares_of",
    "together",
]
