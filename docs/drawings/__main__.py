"""Draw conventions, mechanisms and machines: give ``python docs/drawings`` a folder to write to."""

import re
import sys
from pathlib import Path

import draw
import machines
import mechanisms

import cardan
from cardan.app.answers.readings import picture

folder = Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
for drawing in (*draw.DRAWINGS, *mechanisms.DRAWINGS, *machines.DRAWINGS):
    path = folder / f"{drawing.__name__.replace('_', '-')}.svg"
    path.write_text(drawing().svg(), encoding="utf-8")
    print(f"wrote {path.name}")


def outlined(text: re.Match[str]) -> str:
    """A text of a picture as outlines, as in the other drawings."""
    x, y, anchor, words = text.groups()
    made = draw.Drawing(0, 0, "")
    made.text((float(x), -float(y)), words, size=13, anchor=anchor)
    return made.parts[-1].replace("<path ", '<path stroke="none" ')


measured = picture(cardan.Scene.parse(cardan.scene.STARTERS["readings"].text))
# Outside a page its colours are not defined.
measured = measured.replace("var(--page, white)", "white").replace("currentColor", draw.INK)
texts = r'<text x="(.*?)" y="(.*?)" text-anchor="(.*?)".*?>(.*?)</text>'
measured = re.sub(texts, outlined, measured)
(folder / "measured.svg").write_text(measured, encoding="utf-8")
