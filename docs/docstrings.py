"""Docstrings as Markdown: examples, tables, literal blocks and roles of plain text."""

from __future__ import annotations

import re
from typing import Any

import griffe

_PAGE = re.compile(r"the documentation's page (\w+)")
# An example up to the next empty line, a table from its first rule to its last.
_VERBATIM = re.compile(r"^>>> .*?(?=\n\n|\Z)|^=+  =.*^=+  =[= ]*$", re.DOTALL | re.MULTILINE)


class Docstrings(griffe.Extension):
    """Mends what Markdown would take for quotations and paragraphs, and links to pages."""

    def on_function(self, *, func: griffe.Function, **_: Any) -> None:  # noqa: ANN401
        """Drop what a constructor does where its class says what it takes."""
        told = func.parent and func.parent.docstring
        if func.name == "__init__" and told and "Args:" in told.value:
            func.docstring = None

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:  # noqa: ANN401
        """Show what a class binds of functions of other modules as its methods."""
        line = pkg["driveline.Driveline"]
        for member in [*line.members.values()]:
            bound = re.fullmatch(r"(classmethod\()?(\w+)\)?", str(getattr(member, "value", "")))
            found = bound and line.module.members.get(bound[2])
            if bound and found and found.is_function:
                line.set_member(member.name, _as_method(found, member, of_class=bool(bound[1])))

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:  # noqa: ANN401
        """Fence examples and tables, let literal blocks begin with one colon, drop roles."""
        if obj.docstring:
            text = _VERBATIM.sub(r"```text\n\g<0>\n```", obj.docstring.value)
            text = re.sub(r"::$", ":", text, flags=re.MULTILINE)
            text = _PAGE.sub(lambda page: f"[{page[1]}](../{page[1].lower()}.md)", text)
            obj.docstring.value = text.replace(":func:`", "`")


def _as_method(
    function: griffe.Function, attribute: griffe.Attribute, *, of_class: bool
) -> griffe.Function:
    """The function with the name and the place of the attribute, without its first parameter."""
    method = griffe.Function(
        attribute.name,
        parameters=griffe.Parameters(*[*function.parameters][1:]),
        returns=function.returns,
        docstring=function.docstring,
        lineno=attribute.lineno,
        parent=attribute.parent,
    )
    method.labels |= {"classmethod"} if of_class else set()
    return method
