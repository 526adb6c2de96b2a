"""What a recording shows of the joints of a driveline, in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cardan.app.answers.printed import aligned, figure_text
from cardan.design.wrapping import fill

# A recording whose purity is farther from 1, and by more than the noise can do, shows something
# besides the joints.
_PURE = 0.2
_SIGMAS = 3.0


def identification_text(data: Mapping[str, Any], *, radians: bool = False) -> str:
    """Return an identification as printed text, at most 79 characters wide.

    Args:
        data: what ``figures.identification.identification_data`` returned.
        radians: whether its angles are in radians.
    """
    unit, sign = ("rad", " rad") if radians else ("deg", "°")
    joint, two = data["equivalent_joint"], data["two_joints"]

    def angle(value: float | None) -> str:
        return "unknown" if value is None else f"{figure_text(value)}{sign}"

    def bend(entry: Mapping[str, Any], name: str) -> str:
        spread = angle(entry[f"standard_deviation_{unit}"])
        return f"{angle(entry[f'{name}_{unit}'])}, standard deviation {spread}"

    of_ratio = "residual" in joint
    ending, size = ("", figure_text) if of_ratio else (f"_{unit}", angle)
    missing = f", {data['missing_samples']} missing" if data["missing_samples"] else ""
    lines = [
        ("samples", f"{data['samples']}{missing}"),
        ("turns of the drive", figure_text(data["turns"])),
        ("equivalent bend", bend(joint, "equivalent_bend")),
        ("smallest bend detected", angle(joint[f"detection_limit_{unit}"])),
        ("offset of the drive angle", angle(joint[f"angle_offset_{unit}"])),
    ]
    if two:
        for entry in two["joints"]:
            lines.append((f"bend of joint {entry['joint']}", bend(entry, "bend")))
        lines.append(("phase less twist", angle(two[f"phase_less_twist_{unit}"])))
    of_what = "speed ratio" if of_ratio else "angle error"
    for entry in joint["orders"]:
        lines.append((f"{of_what}, order {entry['order']}", size(entry[f"amplitude{ending}"])))
    lines += [
        ("purity", _purity(joint)),
        ("not explained, rms", size(joint[f"residual{ending}"])),
    ]
    notes = "\n\n".join(fill(note, 79) for note in _notes(joint, sign, bool(two)))
    return f"{data['title']}\n\n{aligned(lines)}\n\n{notes}"


def _purity(joint: Mapping[str, Any]) -> str:
    purity, spread = joint["purity"], joint["purity_standard_deviation"]
    if purity is None or spread is None:
        return "unknown"
    return f"{figure_text(purity)}, standard deviation {figure_text(spread)}"


def _notes(joint: Mapping[str, Any], sign: str, two: bool) -> list[str]:
    notes = [
        "The offset is what to add to the recorded drive angle so that the driving pin lies in the "
        f"bend plane of the equivalent joint at 0{sign}."
    ]
    if not joint["detected"]:
        notes = ["The bend is not larger than the noise permits to detect."]
    elif joint["purity"] is not None:
        noise = _SIGMAS * (joint["purity_standard_deviation"] or 0.0)
        if abs(joint["purity"] - 1.0) > max(_PURE, noise):
            notes.append(
                "The purity is not 1: order 4 does not fit order 2, so the recording shows "
                "something besides universal joints."
            )
        elif noise > 1.0:
            notes.append(
                "The noise hides order 4, so the purity does not tell whether order 2 comes from "
                "joints. A longer recording, with more samples, does."
            )
    notes.append(
        "An ovality of an encoder has order 2 as well. A recording with straight joints tells it "
        "from a bend."
    )
    notes.append(
        "Phase and twist cannot be told apart: only their difference shows."
        if two
        else "Bends and phases of several joints cannot be told apart by two encoders: only the "
        "equivalent bend shows."
    )
    return notes
