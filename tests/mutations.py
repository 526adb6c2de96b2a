"""Small changes of Python source: what ``mutants.py`` tries on lines that changed."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Set
from typing import NamedTuple

_COMPARISONS: dict[type[ast.cmpop], tuple[str, ...]] = {
    ast.Lt: ("<=", ">="),
    ast.LtE: ("<", ">"),
    ast.Gt: (">=", "<="),
    ast.GtE: (">", "<"),
    ast.Eq: ("!=",),
    ast.NotEq: ("==",),
    ast.In: ("not in",),
    ast.NotIn: ("in",),
    ast.Is: ("is not",),
    ast.IsNot: ("is",),
}
_OPERATORS: dict[type[ast.operator], str] = {
    ast.Add: "-",
    ast.Sub: "+",
    ast.Mult: "/",
    ast.Div: "*",
    ast.FloorDiv: "*",
    ast.Pow: "*",
    ast.BitAnd: "|",
    ast.BitOr: "&",
}


class Mutant(NamedTuple):
    """One change of a source.

    Attributes:
        line: number of the line, from 1.
        function: first line of the function around it, decorators included; 0 if there is none.
        text: the line without its indentation.
        change: what becomes of what.
        start: first byte that is replaced, in UTF-8.
        stop: where the bytes after it begin.
        new: what replaces them.
    """

    line: int
    function: int
    text: str
    change: str
    start: int
    stop: int
    new: str

    def applied(self, source: str) -> str:
        """Return the source with the change."""
        content = source.encode()
        return (content[: self.start] + self.new.encode() + content[self.stop :]).decode()


def mutants_of(source: str, lines: Set[int]) -> Iterator[Mutant]:
    """Yield the mutants of some lines of a module, each of which is Python."""
    content = source.encode()
    starts = [0]
    for line in content.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    texts = source.splitlines()
    tree = ast.parse(source)
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    for node in _judged(tree):
        for part, new in _changes(node):
            if part.lineno not in lines:
                continue
            start = starts[part.lineno - 1] + part.col_offset
            stop = starts[(part.end_lineno or part.lineno) - 1] + (part.end_col_offset or 0)
            old = content[start:stop].decode()
            # In brackets it stays one expression wherever it stands.
            put = new if isinstance(part, ast.Constant | ast.stmt) else f"({new})"
            change = f"{' '.join(old.split())} -> {' '.join(new.split())}"
            function = max((_first(f) for f in functions if _within(part, f)), default=0)
            text = texts[part.lineno - 1].strip()
            mutant = Mutant(part.lineno, function, text, change, start, stop, put)
            try:
                ast.parse(mutant.applied(source))
            except (SyntaxError, ValueError):
                continue
            yield mutant


def _first(function: ast.FunctionDef) -> int:
    return min([function.lineno, *(decorator.lineno for decorator in function.decorator_list)])


def _within(part: ast.expr | ast.stmt, function: ast.FunctionDef) -> bool:
    """Whether a part is executed when the function is called."""
    return function.body[0].lineno <= part.lineno <= (function.end_lineno or 0)


def _judged(tree: ast.AST) -> Iterator[ast.expr | ast.stmt]:
    """Walk what is executed: no annotations, docstrings, parts of f-strings, imports for types."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list", "type_params"):
            continue
        for node in value if isinstance(value, list) else [value]:
            if not isinstance(node, ast.AST) or isinstance(node, ast.JoinedStr):
                # Python 3.11 does not know the places of values in an f-string.
                continue
            if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
                continue
            if isinstance(node, ast.expr | ast.stmt):
                yield node
            yield from _judged(node)


def _changes(node: ast.expr | ast.stmt) -> Iterator[tuple[ast.expr | ast.stmt, str]]:
    """Yield the part of a node that is replaced, and what takes its place."""
    text = ast.unparse
    match node:
        case ast.Compare(left=left, ops=[operator], comparators=[right]):
            for new in _COMPARISONS[type(operator)]:
                yield node, f"{text(left)} {new} {text(right)}"
        case ast.BinOp(left=left, op=operator, right=right) if type(operator) in _OPERATORS:
            yield node, f"({text(left)}) {_OPERATORS[type(operator)]} ({text(right)})"
        case ast.UnaryOp(op=ast.USub() | ast.Not(), operand=operand):
            yield node, text(operand)
        case ast.BoolOp(op=operator, values=values):
            word = " or " if isinstance(operator, ast.And) else " and "
            yield node, word.join(f"({text(value)})" for value in values)
        case ast.Constant(value=bool(value)):
            yield node, repr(not value)
        case ast.Constant(value=int(value)):
            yield node, repr(value + 1)
        case ast.Constant(value=float(value)):
            yield node, repr(value * 2.0 if value else 1.0)
        case ast.IfExp(test=test, body=body, orelse=other):
            yield node, f"{text(other)} if {text(test)} else {text(body)}"
        case ast.Call(func=function, args=[first, *others], keywords=keywords):
            if not isinstance(first, ast.Starred | ast.GeneratorExp):
                yield node, text(first)
            if others and not isinstance(first, ast.Starred) and text(first) != text(others[0]):
                swapped = [others[0], first, *others[1:]]
                yield node, text(ast.Call(func=function, args=swapped, keywords=keywords))
        case ast.Expr(value=ast.Call()):
            yield node, "pass"
        case ast.If(test=ast.Name() | ast.Attribute() | ast.Call() as test):
            yield test, f"not {text(test)}"
        case _:
            pass
