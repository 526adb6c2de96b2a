"""Build hooks of the documentation: formulas, what other parts of the project write, scene keys."""

from __future__ import annotations

import html
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cases
from latex2mathml.converter import convert

import cardan

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.pages import Page

ROOT = Path(__file__).parent.parent

_FORMULA = re.compile(r'<(span|div) class="arithmatex">(.*?)</\1>', re.DOTALL)
# A function, with its power: between it and what is no bracket a thin space belongs.
_NAME = "<mi>(?:arcsin|arctan|arg|cosh|cos|ln|sec|sinh|sin|tan)</mi>"
_FUNCTION = rf"(?:(?<!<msup>){_NAME}|<msup>{_NAME}.*?</msup>)"
_BEFORE = re.compile(rf"(?:(?<=</m[in]>)|(?<=</mfrac>))(?={_FUNCTION})")
_AFTER = re.compile(rf"({_FUNCTION})(?!(?:<mrow>)?<mo[^>]*>&#x00028;|</mrow>)")
_SPACE = '<mspace width="0.17em"/>'
_BAR = re.compile(r'<mo(?: stretchy="false")?>&#x0007C;</mo>')
# Within a row a browser takes every minus for one between two terms.
_BEFORE_SIGN = "|".join([r"\[", *(f"&#x{ord(sign):05X};" for sign in "({,;=<>≤≥≈←→·×")])
_SIGN = re.compile(rf"(<mo[^>]*>(?:{_BEFORE_SIGN})</mo>(?:<mspace[^>]*>)?)<mo>(?=&#x02212;)")
_INCLUDE = re.compile(r"\{\{ (.+?) \}\}")
_LINK = re.compile(r"(!?)\[(.*?)\]\((?!https?:|#)(.*?)\)")
_DECISION = re.compile(r"\]\(((?:[\w./]*/)?)(\d{4})-[\w-]+\.md\)")
_DOCSTRING = re.compile(
    r'(<div class="doc-signature highlight">(?:(?!<div).)*</div>)?'
    r'(\s*<div class="doc doc-contents[^>]*>\s*)?'
    r"<!--docstring-->\s*(<p>.*?</p>)?(.*?)<!--/docstring-->",
    re.DOTALL,
)
_CODE = re.compile(r'<div class="language-\w+ highlight">.*?</div>', re.DOTALL)
_FEW = 4
"""Lines of a signature above which it is folded with what it takes."""
_TABLE = re.compile(r"<table>.*?</table>", re.DOTALL)
_VERBATIM = re.compile(r"(<(?:pre|script)\b.*?</(?:pre|script)>)", re.DOTALL)
_LONG = 40
"""Lines of code above which a block is folded."""
_SHOWN = 8
"""Lines of a long output that are shown at least."""


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Show the version at the head of every page."""
    config.site_name = f"cardan {cardan.__version__}"
    return config


def on_page_content(content: str, *, page: Page, **_: Any) -> str:  # noqa: ANN401
    """Turn formulas into MathML, which browsers show without a script; fold what is long.

    A page whose head has ``fold: tables`` folds all of them.
    """
    folded = _CODE.sub(_code, _DOCSTRING.sub(_docstring, content))
    if page.meta.get("fold") == "tables":
        folded = _TABLE.sub(_table, folded)
    return _FORMULA.sub(_formula, folded)


def on_post_page(output: str, **_: Any) -> str:  # noqa: ANN401
    """Drop indentation and empty lines, except in code."""
    parts = _VERBATIM.split(output)
    parts[::2] = [re.sub(r"\s*\n\s*", "\n", part) for part in parts[::2]]
    # Pages in HTML need neither marks of spaces in code nor the name space of formulas.
    whole = "".join(parts).replace('<span class="w"> </span>', " ")
    return whole.replace(' xmlns="http://www.w3.org/1998/Math/MathML"', "")


def _table(match: re.Match[str]) -> str:
    rows = match[0].count("<tr>") - 1
    summary = f"{rows} row{'s' if rows > 1 else ''}"
    return f"<details><summary>{summary}</summary>{match[0]}</details>"


def _docstring(match: re.Match[str]) -> str:
    """Show the first sentence, and a signature of few lines; fold the rest."""
    signature, opening, first, rest = (group or "" for group in match.groups())
    shown, folded = (signature, "") if signature.count("\n") <= _FEW else ("", signature)
    more = f"{folded}{rest}".strip()
    summary = "<summary>Details</summary>"
    details = f"<details data-search-exclude>{summary}{more}</details>" if more else ""
    return f"{shown}{opening}{first}{details}"


def _code(match: re.Match[str]) -> str:
    """Fold long code, and what a long output says after its first paragraphs."""
    lines = match[0].split("\n")
    block = match[0].replace("<div ", "<div data-search-exclude ", 1)
    if len(lines) <= _LONG:
        return block
    if match[0].startswith('<div class="language-text '):
        first = next((i for i, line in enumerate(lines) if i > _SHOWN and not line), _SHOWN)
        head, tail = "\n".join(lines[:first]), "\n".join(lines[first + 1 :])
        opening = re.match(r".*?<code>", block, re.DOTALL)
        closing = "</code></pre></div>"
        assert opening is not None
        shown = head.replace("<div ", "<div data-search-exclude ", 1) + closing
        summary = f"{len(lines) - first} more lines"
        return f"{shown}<details><summary>{summary}</summary>{opening[0]}{tail}</details>"
    name = re.search(r'<span class="filename">(.*?)</span>', match[0])
    title = f"<code>{name[1]}</code>" if name else "All of it"
    return f"<details><summary>{title}, {len(lines)} lines</summary>{block}</details>"


def _formula(match: re.Match[str]) -> str:
    display = "block" if match[1] == "div" else "inline"
    latex = html.unescape(match[2]).strip().removeprefix("\\(").removeprefix("\\[")
    latex = latex.removesuffix("\\)").removesuffix("\\]").strip()
    mathml = convert(latex, display=display).replace("<mi>\\arg<", "<mi>arg<")
    if "\\" in mathml:
        raise ValueError(f"{latex} has a command that the site cannot show")
    # Before powers a browser takes the bars of a magnitude for signs between two terms.
    mathml = _BAR.sub('<mo stretchy="false" lspace="0" rspace="0">&#x0007C;</mo>', mathml)
    mathml = _SIGN.sub(r'\1<mo form="prefix">', mathml)
    return _AFTER.sub(rf"\1{_SPACE}", _BEFORE.sub(_SPACE, mathml))


def on_page_markdown(markdown: str, *, page: Page, **_: Any) -> str:  # noqa: ANN401
    """Put in what ``{{ … }}`` names: a text of the project or a section of it, outputs, commands.

    What the benches have not written yet is left out. All decisions are on one page.
    """
    own = page.file.src_uri == "decisions/index.md"

    def decision(match: re.Match[str]) -> str:
        return f"](#decision-{match[2]})" if own else f"]({match[1]}index.md#decision-{match[2]})"

    text = _INCLUDE.sub(lambda match: included(match[1]), markdown)
    return _DECISION.sub(decision, text)


def decisions() -> str:
    """Return the decisions that have a file of their own, folded."""
    parts = []
    for path in sorted((ROOT / "docs" / "decisions").glob("0*.md")):
        title, text = path.read_text("utf-8").removeprefix("# ").split("\n", 1)
        anchor = f'<a id="decision-{path.name[:4]}"></a>'
        text = re.sub("^## (.*)$", r"**\1**", text, flags=re.MULTILINE)
        summary = f"<summary>{html.escape(title)}</summary>"
        parts.append(f'<details markdown="1">{summary}\n\n{anchor}\n{text}\n</details>')
    return "\n\n".join(parts)


def included(name: str) -> str:
    """Return the text to put in for a name."""
    own: dict[str, Callable[[], str]] = {
        "scene-keys": scene_keys,
        "outputs": outputs,
        "limits": limits,
        "limits-as-built": limits_as_built,
        "presets": presets,
        "commands": command_help,
        "cases-answer": cases.answer,
        "cases": cases.book,
        "decisions": decisions,
        "version": lambda: cardan.__version__,
    }
    if name in own:
        return own[name]()
    file, _, heading = name.partition("#")
    path = ROOT / file
    if file.startswith("benches/") and not path.exists():
        return ""
    text = path.read_text(encoding="utf-8")
    if heading:
        text = text.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    # Its title goes, its sections become sections of the page; pictures lie beside it, and what
    # is no page of the documentation is not part of the site.
    text = re.sub(r"\A# .*\n", "", text)
    folder = path.parent.relative_to(ROOT).as_posix()

    def link(match: re.Match[str]) -> str:
        if match[1]:
            return f"![{match[2]}]({folder}/{match[3]})"
        page = re.match(r"docs/(?=.*\.md)", match[3])
        return f"[{match[2]}]({match[3][page.end() :]})" if page else match[2]

    return _LINK.sub(link, text)


def outputs() -> str:
    """Return a table of what can be evaluated."""
    from cardan import OUTPUTS

    rows = [
        f"| `{name}` | {output.per} | {output.unit} | {output.meaning} "
        f"| {output.source.replace('|', '&#124;')} |"
        for name, output in OUTPUTS.items()
    ]
    head = "| output | per | unit | meaning | equation and source |"
    return "\n".join([head, "|---|---|---|---|---|", *rows])


def limits() -> str:
    """Return the table of accuracy limits of one joint that tests and stress read."""
    return limits_of(
        "output",
        {
            "tolerance_0": "`tolerance=0`",
            "samples": "default, regular tests",
            "worst": "default, long searches",
            "single": "single precision, relative to the largest value",
        },
    )


def presets() -> str:
    """Return a table of the presets: every rule with its source and what is exact."""
    from cardan.design.limits import PRESETS

    head = "preset | rule of the source | source | page | year | edition | beside what is exact"
    rows = [head, "|".join(["---"] * len(head.split("|")))]
    for name, preset in PRESETS.items():
        for rule in preset.rules:
            source = rule.source
            published = (f"{source.title}{rule.more}", source.pages, source.year, source.edition)
            own = rule.own
            if limit := preset.figures.get(rule.figure):
                own = f"`{rule.figure}` {limit.limit:g}, at most {limit.maximum:g}: {own}"
            cells = (f"`{name}`", own, *published, rule.exact)
            rows.append(" | ".join(cell.replace("|", "&#124;") for cell in cells))
    return "\n".join(f"| {row} |" for row in rows)


def limits_as_built() -> str:
    """Return the table of those of joints as built."""
    columns = {
        "tolerance_0": "`tolerance=0`",
        "worst": "default",
        "single": "single precision, relative to the largest value",
    }
    return limits_of("as_built", columns)


def limits_of(table: str, columns: dict[str, str]) -> str:
    """Return some columns, with their titles, of a table of the limits."""
    text = (ROOT / "tests" / "data" / "limits.toml").read_text(encoding="utf-8")
    rows = [
        [name, *(str(row.get(column, "–")).replace("e-0", "e-") for column in columns)]
        for name, row in tomllib.loads(text)[table].items()
    ]
    lines = [["output", *columns.values()], ["---"] * (len(columns) + 1), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def command_help() -> str:
    """Return what every command says with ``--help``."""
    import click

    from cardan.app.command import commands

    group = commands()
    parts = []
    with click.Context(group, info_name="cardan") as parent:
        parts.append(f"```text\n{group.get_help(parent)}\n```")
        for name in group.list_commands(parent):
            _, command, _ = group.resolve_command(parent, [name])
            assert command is not None
            with click.Context(command, info_name=name, parent=parent) as context:
                shown = command.get_help(context)
            parts.append(
                f"## `cardan {name}`\n\n{command.get_short_help_str(80)}\n\n"
                f'<details markdown="1"><summary>Options</summary>\n\n```text\n{shown}\n```\n\n'
                "</details>"
            )
    return "\n\n".join(parts)


def scene_keys() -> str:
    """Return a table of keys per section of a scene, from the JSON Schema."""
    from cardan import Scene

    schema = Scene.schema()
    lines = ["| key | holds |", "|---|---|"]
    sections = []
    for name, value in schema["properties"].items():
        if not (section := _section(value)):
            lines.append(_row(name, value))
            continue
        inner = {key: own for key, own in section.items() if _section(own)}
        for path, own in {name: value, **{f"{name}.{key}": inner[key] for key in inner}}.items():
            heading = f"[{path}]" if "properties" in own else f"[[{path}]]"
            sections += [f"\n## `{heading}`\n", f"{own['description'].capitalize()}.\n"]
            sections += ["| key | holds |", "|---|---|"]
            keys = {key: entry for key, entry in _section(own).items() if key not in inner}
            sections += [_row(key, entry) for key, entry in keys.items()]
    return "\n".join(lines + sections)


def _section(value: dict[str, Any]) -> dict[str, Any]:
    """Return the keys of a section, or of each of several; nothing of a key that is none."""
    one = value.get("oneOf", [value])[0]
    found: dict[str, Any] = one.get("items", one).get("properties", {})
    # Keys of a value that is a table have no descriptions of their own.
    return found if all("description" in entry for entry in found.values()) else {}


def _row(key: str, value: dict[str, Any]) -> str:
    return f"| `{key}` | {value.get('description', '').replace('|', '/')} |"
