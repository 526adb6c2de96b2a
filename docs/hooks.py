"""Build hooks of the documentation: formulas, what other parts of the project write, scene keys."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from latex2mathml.converter import convert

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files

ROOT = Path(__file__).parent.parent

_FORMULA = re.compile(r'<(span|div) class="arithmatex">(.*?)</\1>', re.DOTALL)
_INCLUDE = re.compile(r"^\{\{ (\S+) \}\}$", re.MULTILINE)
_HEADING = re.compile(r"^(?=#+ )", re.MULTILINE)


def on_page_content(html: str, **_: Any) -> str:  # noqa: ANN401
    """Turn formulas into MathML, which browsers show without a script."""
    return _FORMULA.sub(_formula, html)


def _formula(match: re.Match[str]) -> str:
    display = "block" if match[1] == "div" else "inline"
    latex = html.unescape(match[2]).strip().removeprefix("\\(").removeprefix("\\[")
    return str(convert(latex.removesuffix("\\)").removesuffix("\\]").strip(), display=display))


def on_page_markdown(markdown: str, **_: Any) -> str:  # noqa: ANN401
    """Put in what ``{{ file }}`` names: a text of the project, or the keys of scene files.

    What the benches have not written yet is left out.
    """
    return _INCLUDE.sub(lambda match: included(match[1]), markdown)


def included(name: str) -> str:
    """Return the text to put in for a name."""
    path = ROOT / name
    if name.startswith("benches/") and not path.exists():
        return ""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".json":
        return scene_keys(json.loads(text))
    # Its title goes, its sections become sections of the page.
    text = re.sub(r"\A# .*\n", "", text)
    return text if "\n## " in text else _HEADING.sub("#", text)


def scene_keys(schema: dict[str, Any]) -> str:
    """Return a table of keys per section of the schema of scenes."""
    lines = ["| key | holds |", "|---|---|"]
    sections = []
    for name, value in schema["properties"].items():
        if "properties" not in value:
            lines.append(_row(name, value))
            continue
        sections += [f"\n## `[{name}]`\n", f"{value['description'].capitalize()}.\n"]
        sections += ["| key | holds |", "|---|---|"]
        sections += [_row(key, entry) for key, entry in value["properties"].items()]
    return "\n".join(lines + sections)


def _row(key: str, value: dict[str, Any]) -> str:
    return f"| `{key}` | {value.get('description', '').replace('|', '/')} |"


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the pictures of the benches to the site."""
    from mkdocs.structure.files import File

    for picture in sorted((ROOT / "benches").glob("*.svg")):
        uri = f"benches/{picture.name}"
        files.append(File.generated(config, uri, abs_src_path=str(picture)))
    return files
