"""What would fix a driveline, in words."""

from __future__ import annotations

import math
from typing import Any

from cardan.app.answers.printed import listed
from cardan.motion.workshop import VIEW, both_senses

_NAMES = {
    "straight": "All joints are straight.",
    "single bend": "Only one joint is bent.",
    "W": "W arrangement: the bends lie in one plane, in the same direction.",
    "Z": "Z arrangement: the bends lie in one plane, in opposite directions.",
    "planar": "Planar arrangement: all bends lie in one plane.",
    "spatial": "Spatial arrangement: the bends lie in different planes.",
}

BEST_OF_STATES = (
    "The best setting has the least weighted mean over the states; single states may be worse than "
    "now."
)
"""What the best of several states is."""

# Less than this, in degrees, would read 0.00.
SHOWN = 0.005


def arrangement_text(data: dict[str, Any]) -> str:
    """Name the arrangement, of states that of the worst at present."""
    words = _NAMES[data["arrangement"]]
    if "states" not in data:
        return words
    name, colon, bends = words.rstrip(".").partition(":")
    return f"{name} (in {data['states']['worst']['present']}){colon}{bends}."


def advice_text(data: dict[str, Any]) -> str:
    """Say what is left at best, on the teeth where these are known, and what would fix it."""
    limit = f"the limit of {data['limit_deg']:.4g}°"
    if "states" in data:
        return _states_advice_text(data, limit)
    bends = data["equivalent_bend_deg"]
    present, best = (f"{bends[key]:.3f}°" for key in ("present", "best"))
    settable = bends.get("on_teeth", bends["best"])
    turned = [
        f"shaft {shaft['shaft']}"
        for shaft in data.get("teeth") or data["shafts"]
        if shaft["turn_deg"] >= SHOWN
    ]
    if data["cause"] == "bends":
        return " ".join(remedies(data))
    if data["cause"] == "none" and not turned:
        return f"The yokes have their best setting; nothing to turn. {present} is within {limit}."
    if data["cause"] == "none":
        return (
            f"Nothing has to be turned: {present} is within {limit}. The best "
            f"{'teeth leave' if 'on_teeth' in bends else 'setting leaves'} {settable:.3f}°."
        )
    cause = f"The phases are the cause: {present} is beyond {limit}."
    if "on_teeth" in bends and settable > data["limit_deg"]:
        return f"{cause} The exact setting leaves {best}, but no teeth bring it within the limit."
    which = listed(turned)
    return (
        f"{cause} Turn the output-side yoke of {which} as said above: {settable:.3f}° is within "
        "the limit."
    )


def remedies(data: dict[str, Any]) -> list[str]:
    """Say what would bring a driveline within its limit, a sentence each; nothing if it is."""
    if data["cause"] == "none":
        return []
    bends = data["equivalent_bend_deg"]
    if "states" in data:
        return _states_remedies(data)
    best = f"{bends['best']:.3f}°"
    settable = bends.get("on_teeth", bends["best"])
    if data["cause"] == "phases" and settable > data["limit_deg"]:
        return [
            f"No teeth of the splines bring it within the limit of {data['limit_deg']:.4g}°: the "
            f"best teeth leave {settable:.3f}°. The exact setting would leave {best}."
        ]
    if data["cause"] == "phases":
        return [f"{_turns(data)}; that leaves {settable:.3f}°."]
    left = f": the best setting leaves {best}" if data["shafts"] else ""
    return [f"{_too_different(data)}{left}.", _changes(data)]


def _turns(data: dict[str, Any]) -> str:
    turns = ", of ".join(
        f"shaft {shaft['shaft']} by "
        + (teeth_text(shaft) if shaft.get("turn_teeth") else turn_text(shaft))
        for shaft in data.get("teeth") or data["shafts"]
        if shaft["turn_deg"] >= SHOWN
    )
    return f"Turn the output-side yoke of {turns}, {VIEW}"


def _settable(data: dict[str, Any]) -> str:
    """The setting that can be made: on the teeth where these are known."""
    return "on_teeth" if "on_teeth" in data["equivalent_bend_deg"] else "best"


def _most(data: dict[str, Any], setting: str) -> str:
    """The largest equivalent bend over the states, and in which of them it is."""
    return f"{data['equivalent_bend_deg'][setting]:.3f}° in {data['states']['worst'][setting]}"


def _states_advice_text(data: dict[str, Any], limit: str) -> str:
    settable = _settable(data)
    within = data["equivalent_bend_deg"][settable] <= data["limit_deg"]
    verdict = "within" if data["cause"] == "none" else "beyond"
    now = (
        f"The largest equivalent bend of all states is {_most(data, 'present')}, {verdict} {limit}."
    )
    turned = any(shaft["turn_deg"] >= SHOWN for shaft in data.get("teeth") or data["shafts"])
    if not turned:
        return f"{now} The yokes have the best common setting."
    left = f"The best common setting leaves at most {_most(data, settable)}"
    if verdict == "within":
        return f"{now} Nothing has to be turned. {left}."
    return f"{now} {left}, {'within' if within else 'beyond'} the limit."


def _states_remedies(data: dict[str, Any]) -> list[str]:
    settable = _settable(data)
    if data["equivalent_bend_deg"][settable] <= data["limit_deg"]:
        return [f"{_turns(data)}; that leaves at most {_most(data, settable)}."]
    if not data["shafts"]:
        return ["A single joint cannot cancel its own unevenness; add a second joint."]
    return [
        f"Even the best common setting of the yokes leaves {_most(data, settable)}, beyond the "
        f"limit of {data['limit_deg']:.4g}°. Bring the bends of the joints nearer to each other "
        "in that state. More weight of that state favours it at the cost of the others."
    ]


def teeth_text(shaft: dict[str, Any]) -> str:
    """Say by how many teeth to turn a yoke on its spline."""
    count = shaft["turn_teeth"]
    teeth = "tooth" if count == 1 else "teeth"
    return f"{count} {teeth} {shaft['turn_sense']} ({shaft['turn_deg']:.2f}°)"


def turn_text(shaft: dict[str, Any]) -> str:
    """Say how to turn a yoke; the other way round too where that is not much longer."""
    degrees, sense = shaft["turn_deg"], shaft["turn_sense"]
    if degrees <= 45.0:
        return f"{degrees:.2f}° {sense}"
    return both_senses(degrees, sense).replace(" = ", " or ")


def _too_different(data: dict[str, Any]) -> str:
    bent = _bent(data)
    if not data["shafts"]:
        return "A single joint cannot cancel its own unevenness"
    if len(bent) == 1:
        return "One bend alone cannot cancel; no phase can fix that"
    if len(bent) == 2:
        bends = " and ".join(f"{found['bend_deg']:.4g}°" for found in bent)
        return f"The bends differ ({bends}); no phase can fix that"
    largest = _largest(data)
    return (
        f"Joint {largest['joint']} is bent by {largest['bend_deg']:.4g}°, more than the other "
        "joints can cancel; no phase can fix that"
    )


def _changes(data: dict[str, Any]) -> str:
    """Say which bends would do: either of two, of more the largest; for one alone a second one.

    Figures are rounded into the range, so that they do what they promise.
    """
    bent, largest = _bent(data), _largest(data)
    straight = [found for found in data["bend_ranges"] if found not in bent]
    changed = {1: [*bent, *straight[:1]], 2: bent}.get(len(bent), [largest])
    changes = ", or ".join(
        f"joint {found['joint']} a bend of {_range(found['from_deg'], found['to_deg'])}"
        for found in changed
    )
    then = "; then set the yokes anew"
    if not data["shafts"]:
        then = ", or add a second joint with the same bend"
    return f"To come within the limit of {data['limit_deg']:.4g}°, give {changes}{then}."


def _bent(data: dict[str, Any]) -> list[dict[str, Any]]:
    return [found for found in data["bend_ranges"] if found["bend_deg"] >= SHOWN]


def _largest(data: dict[str, Any]) -> dict[str, Any]:
    largest: dict[str, Any] = max(data["bend_ranges"], key=lambda found: float(found["bend_deg"]))
    return largest


def _range(low: float, high: float) -> str:
    most = f"{math.floor(high * 100.0 + 1e-6) / 100.0:.2f}°"
    if low < SHOWN:
        return f"at most {most}"
    return f"{math.ceil(low * 100.0 - 1e-6) / 100.0:.2f}° to {most}"
