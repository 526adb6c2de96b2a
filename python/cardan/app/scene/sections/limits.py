"""Rules for the values of [limits]: a preset, and a limit with or without a maximum."""

from __future__ import annotations

from dataclasses import dataclass

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import ListOf, Number, Rule, Schema, Text, refused, shown
from cardan.design.limits import PRESETS, unknown_preset
from cardan.design.quantities import (
    FIRST_ORDERS,
    MOTION_QUANTITIES,
    ORDER_PATTERN,
    nearest_quantity,
    order_quantity,
    pattern,
    reduced_quantity,
)
from cardan.evaluation.outputs import OUTPUTS


@dataclass(frozen=True)
class Preset(Rule):
    """The name of a preset."""

    def read(self, where: Location, value: object) -> str:
        """Return the name."""
        name = Text().read(where, value)
        if name not in PRESETS:
            raise where.error(unknown_preset(name))
        return name

    @property
    def schema(self) -> Schema:
        """The names."""
        return {"enum": list(PRESETS)}


@dataclass(frozen=True)
class Source(Rule):
    """Where a limit comes from: text that a terminal prints as it stands."""

    def read(self, where: Location, value: object) -> str:
        """Return the text."""
        text = Text().read(where, value)
        if not text.isprintable():
            raise refused(where, text, "have printable characters only")
        return text

    @property
    def schema(self) -> Schema:
        """A string; only the reader knows which characters can be printed."""
        return Text().schema


@dataclass(frozen=True)
class LimitRule(Rule):
    """A positive number, or a list of a limit and a maximum that is not below it.

    A schema cannot compare the two; only the reader does.

    Attributes:
        number: what each of them must be.
    """

    number: Number

    @property
    def _pair(self) -> ListOf:
        return ListOf(self.number, "two numbers, limit and maximum", count=2)

    def read(self, where: Location, value: object) -> float | list[float]:
        """Return the number or both."""
        if not isinstance(value, list):
            return self.number.read(where, value)
        pair: list[float] = self._pair.read(where, value)
        if pair[0] > pair[1]:
            raise refused(where, value, "have a maximum that is not below the limit")
        return pair

    @property
    def schema(self) -> Schema:
        """A number or an array of two."""
        return {"oneOf": [self.number.schema, self._pair.schema]}


@dataclass(frozen=True)
class QuantityName(Rule):
    """The name of a quantity.

    Attributes:
        outputs: whether outputs are possible without item and reduction, and orders.
    """

    outputs: bool = False

    @property
    def _names(self) -> list[str]:
        return [*MOTION_QUANTITIES, *(OUTPUTS if self.outputs else ())]

    def read(self, where: Location, value: object) -> str:
        """Return the name."""
        name = Text().read(where, value)
        other = reduced_quantity(name) or (self.outputs and order_quantity(name))
        if name not in self._names and not other:
            known = [*self._names, *(FIRST_ORDERS if self.outputs and "order" in name else ())]
            raise where.error(f"is {shown(name)}; {nearest_quantity(name, known)}")
        return name

    @property
    def schema(self) -> Schema:
        """A name of a list or of a form."""
        # Python's end of a text may have a line end behind it; that of JSON Schema may not.
        forms = [*map(pattern, OUTPUTS.values()), *([ORDER_PATTERN] if self.outputs else [])]
        outputs = f"^({'|'.join(forms)})$(?!\\n)"
        return {"anyOf": [{"enum": self._names}, {"type": "string", "pattern": outputs}]}
