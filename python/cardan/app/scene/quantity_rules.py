"""The rule for names of quantities: those of the motion, its orders, and reduced outputs."""

from __future__ import annotations

from dataclasses import dataclass

from cardan.app.scene.errors import Location
from cardan.app.scene.rules import Rule, Schema, Text, shown
from cardan.design.order_quantities import FIRST, PATTERN, order_quantity
from cardan.design.quantities import MOTION_QUANTITIES, nearest_quantity
from cardan.design.reduced_quantities import pattern, reduced_quantity
from cardan.evaluation.outputs import OUTPUTS


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
            known = [*self._names, *(FIRST if self.outputs and "order" in name else ())]
            raise where.error(f"is {shown(name)}; {nearest_quantity(name, known)}")
        return name

    @property
    def schema(self) -> Schema:
        """A name of a list or of a form."""
        # Python's end of a text may have a line end behind it; that of JSON Schema may not.
        forms = [*map(pattern, OUTPUTS.values()), *([PATTERN] if self.outputs else [])]
        outputs = f"^({'|'.join(forms)})$(?!\\n)"
        return {"anyOf": [{"enum": self._names}, {"type": "string", "pattern": outputs}]}
