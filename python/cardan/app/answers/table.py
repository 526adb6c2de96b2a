"""The table of parts: everything that an answer about a scene can have.

A part has a module, or a room of modules. Its ``find`` finds its figures, whose fields are rows;
``sentences`` says what follows from them; ``drawn`` draws them on the page. What a row says is
printed, listed, judged and described by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module, resources
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, get_args, get_origin, get_type_hints

from cardan.app.answers.data import data_of, schema_of
from cardan.app.answers.printed import filled, part_text
from cardan.app.answers.rows import Entry, element_of, entries, item_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from cardan.app.answers.answer import Answer


@dataclass(frozen=True)
class Part:
    """A part of an answer."""

    name: str  # its module or room, and its key in the JSON
    title: str  # its heading
    noun: str  # what its figures are those of, in a sentence: "the spline"; "" of the driveline
    sections: tuple[str, ...]  # the sections of a scene without which there is no such part
    shown: tuple[str, ...]  # the commands whose answers have it
    given: str = ""  # what its own section gives, for a scene that lacks it
    said: bool = False  # whether an answer about more than it only has its sentences
    alone: bool = False  # whether a ball joint alone has it

    def _own(self, function: str) -> Any:  # noqa: ANN401 - of any signature
        """The part's own function of a name, from its module or one of those of its room."""
        path = f"cardan.app.answers.{self.name}"
        modules = [path]
        if hasattr(import_module(path), "__path__"):
            modules = [f"{path}.{each}" for each in ("figures", "text", "picture")]
        for module in filter(find_spec, modules):
            if own := getattr(import_module(module), function, None):
                return own
        return None

    def find(self, answer: Answer) -> Any:  # noqa: ANN401 - any part
        """Return the figures of a scene, ``None`` or nothing without them."""
        return self._own("find")(answer)

    def whole(self, answer: Answer, found: Any) -> Any:  # noqa: ANN401 - any part
        """Return the figures with those that only the page and the part's own command show."""
        own = self._own("whole")
        return own(answer, found) if own else found

    def entries(self, found: Any) -> Iterator[Entry]:  # noqa: ANN401 - any part
        """Yield the figures as rows with values."""
        yield from entries(found, self.name)

    def data(self, found: Any, *, radians: bool = False) -> Any:  # noqa: ANN401 - any part
        """Return the figures as plain data for JSON."""
        return data_of(found, radians=radians)

    def schema(self) -> dict[str, Any]:
        """Return the JSON Schema of the figures."""
        hint = self._hint()
        schema = schema_of(element_of(hint))
        several = tuple in (get_origin(each) for each in (hint, *get_args(hint)))
        return {"type": "array", "items": schema} if several else schema

    def figures(self) -> type:
        """Return the dataclass of all figures, or of those of each item."""
        found: type = element_of(self._hint("whole" if self._own("whole") else "find"))
        return found

    def _hint(self, function: str = "find") -> Any:  # noqa: ANN401 - any annotation
        return get_type_hints(self._own(function))["return"]

    def text(self, found: Any, *, radians: bool = False, brief: bool = False) -> str:  # noqa: ANN401
        """Return the figures and what follows from them as plain text, 79 wide.

        Args:
            found: the figures.
            radians: whether angles are in radians.
            brief: whether the answer is about more than this part.
        """
        if brief and (own := self._own("brief")):
            return str(own(found))
        if brief and self.said:
            return "\n".join([self.heading(found), *filled(self.sentences(found))])
        if own := self._own("words"):
            return str(own(found, radians=radians))
        return part_text(self.heading(found), found, self.sentences(found), radians=radians)

    def section(self, answer: Answer, found: Any) -> dict[str, Any]:  # noqa: ANN401 - any part
        """Return the figures as data for the page: what the macro ``answered`` takes, and own data.

        ``template`` is the part's own template, if it has one.
        """
        # The page alone needs it.
        from cardan.app.answers.page import section_of

        found = answer.needed(self.name)
        data = section_of(self, found)
        if drawn := self._own("drawn"):
            data |= drawn(answer, found)
        template = resources.files("cardan.app").joinpath("report/templates", f"{self.name}.html")
        own = template.name if template.is_file() else ""
        return {"key": self.name, "heading": self.title, "template": own, **data}

    def pictures(self) -> dict[str, Callable[[Answer], Figure]]:
        """Return what draws the pictures of the part, by their names."""
        return self._own("PICTURES") or {}

    def heading(self, found: Any) -> str:  # noqa: ANN401 - any part
        """Return what stands above the figures: ``"Spline of shaft 1"``."""
        if own := self._own("heading"):
            return str(own(found))
        about = "" if isinstance(found, tuple) else item_of(found)
        return f"{self.title} of {about}" if about else self.title

    def sentences(self, found: Any) -> list[str]:  # noqa: ANN401 - any part
        """Return what follows from the figures, in words."""
        own = self._own("sentences")
        return list(own(found)) if own else []


_ALL = ("run", "check", "report")
_LIFE = ("check", "life", "report")

_PARTS = (
    Part("moves", "What would help", "", (), ()),
    Part("remarks", "Worth a look", "", (), _ALL),
    Part("limits", "Motion", "", ("load", "limits"), ("check",)),
    Part("presets", "Published limits", "", ("limits",), ("check", "report")),
    Part("readings", "As read", "", ("driveline",), ("check", "report")),
    Part("states", "Motion in each state", "the state", ("states",), ("check",)),
    Part("drive_speed", "Speed of the drive", "the drive", ("load",), ("check",)),
    Part("as_built", "Joints as built", "the joints", ("joints", "tolerances"), _ALL),
    Part("backlash", "Backlash", "the driveline", ("joints",), _ALL),
    Part("forces", "Forces", "", ("load",), _ALL),
    Part("spline", "Spline", "the spline", ("slip",), _ALL),
    Part("axial_travel", "Axial travel of offset axes", "the shafts", ("offsets",), _ALL),
    Part("steering", "Steering", "the steering", ("steering",), _ALL),
    Part(
        *("tolerances", "Tolerances", "", ("tolerances",), ("check", "tolerances", "report")),
        given="the tolerances",
        said=True,
    ),
    Part("life", "Life of the joints", "", ("joints", "life"), _LIFE, said=True),
    Part("tubes", "Tubes", "the tube", ("tubes",), _LIFE),
    Part(
        *("torsion", "Torsional vibration", "the shafts", ("torsion",)),
        ("check", "torsion", "report"),
        given="stiffnesses and inertias",
    ),
    Part(
        *("lateral", "Lateral vibration", "", ("lateral",)),
        ("check", "lateral", "report"),
        given="the speeds, and makes bearings elastic",
    ),
    Part(
        *("optimise", "Best values", "", ("optimise",), ("optimise", "report")),
        given="what may change",
    ),
    Part("ball_joint", "Ball joint", "the ball joint", ("ball_joint",), _ALL, alone=True),
)

PARTS = {part.name: part for part in _PARTS}
"""The parts by name, in the order in which answers have them."""


def pictures() -> dict[str, Callable[[Answer], Figure]]:
    """Return what draws the pictures of all parts, by their names."""
    return {name: draw for part in _PARTS for name, draw in part.pictures().items()}
