"""Pictures, drawn with matplotlib: of scenes, drivelines and what the sources show.

Most ``plot_`` functions draw on the axes that they are given as ``ax`` and return them. Without
``ax`` they make a figure of pyplot, 80 mm wide, in the settings of ``STYLE``. ``plot_scene``,
``plot_part``, ``plot_forces``, ``plot_ball_joint``, ``plot_optimise`` and ``plot_torsion`` return
a whole figure: a page, A4 across, and pictures up to 170 mm wide. Curves differ in dashes as well
as colour, so that they can be told apart in grey. All need matplotlib and raise an ``ImportError``
without it.

>>> import cardan.app.plots
>>> line = cardan.Driveline.from_bends([[10], [20], [30]], degrees=True)
>>> axes = cardan.plots.plot_curves(line, "speed_ratio")  # doctest: +SKIP
>>> cardan.plots.save(axes.figure, "ratio.svg")  # doctest: +SKIP
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from cardan.app.answers.answer import Answer
from cardan.app.answers.axial_travel import plot_slide_orders, plot_slides
from cardan.app.answers.backlash import plot_backlash, plot_lash
from cardan.app.answers.ball_joint import plot_ball_joint, plot_seat_pressure, plot_seat_section
from cardan.app.answers.drive_speed import plot_drive_speed
from cardan.app.answers.forces.picture import plot_force_hodograph, plot_forces
from cardan.app.answers.life.picture import plot_heat, plot_pin_load, plot_sizes
from cardan.app.answers.optimise.picture import (
    plot_optimise,
    plot_optimised_states,
    plot_over_variable,
)
from cardan.app.answers.table import PARTS, pictures
from cardan.app.answers.tolerances.picture import plot_tolerance_shares, plot_tolerances
from cardan.app.answers.torsion.picture import (
    plot_campbell,
    plot_stability,
    plot_torsion,
    plot_torsion_response,
)
from cardan.app.answers.turn.picture import plot_scene, write_picture
from cardan.app.files.columns import PICTURES as SUFFIXES
from cardan.app.pictures.curves import plot_curves, plot_double_joint, plot_harmonics, plot_result
from cardan.app.pictures.driveline import plot_driveline, yoke_pins
from cardan.app.pictures.sources import (
    plot_angle_error,
    plot_bend_vectors,
    plot_bending_moments,
    plot_driven_angle,
    plot_hodograph,
    plot_largest_angle_error,
    plot_non_uniformity,
    plot_small_angle,
    plot_torque_ratio,
)
from cardan.app.pictures.study import plot_states, plot_study
from cardan.app.pictures.style import STYLE, check_kind, save
from cardan.app.scene.language.units import shown_in
from cardan.app.scene.scene import BallJointScene, Scene
from cardan.arrays.errors import ArgumentValueError, nearest

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "STYLE",
    "SUFFIXES",
    "plot_angle_error",
    "plot_backlash",
    "plot_ball_joint",
    "plot_bend_vectors",
    "plot_bending_moments",
    "plot_campbell",
    "plot_curves",
    "plot_double_joint",
    "plot_drive_speed",
    "plot_driveline",
    "plot_driven_angle",
    "plot_force_hodograph",
    "plot_forces",
    "plot_harmonics",
    "plot_heat",
    "plot_hodograph",
    "plot_largest_angle_error",
    "plot_lash",
    "plot_non_uniformity",
    "plot_optimise",
    "plot_optimised_states",
    "plot_over_variable",
    "plot_part",
    "plot_pin_load",
    "plot_result",
    "plot_scene",
    "plot_seat_pressure",
    "plot_seat_section",
    "plot_sizes",
    "plot_slide_orders",
    "plot_slides",
    "plot_small_angle",
    "plot_stability",
    "plot_states",
    "plot_study",
    "plot_tolerance_shares",
    "plot_tolerances",
    "plot_torque_ratio",
    "plot_torsion",
    "plot_torsion_response",
    "save",
    "write_picture",
    "yoke_pins",
]


def plot_part(scene: Scene | BallJointScene, name: str) -> Figure:
    """Return a picture of a part of the answer to a scene, as ``cardan plot --what`` draws it.

    Args:
        scene: the scene.
        name: the picture, such as ``"forces"``; ``cardan plot --help`` lists them.

    Raises:
        ValueError: an unknown name, a scene that lacks what the picture shows.
    """
    check_kind("scene", scene, Scene, BallJointScene)
    known = pictures()
    if name not in known:
        raise ArgumentValueError("name", f"is {name!r}; {nearest(name, known)}")
    if isinstance(scene, BallJointScene) and name not in PARTS["ball_joint"].pictures():
        raise ValueError(f"{scene.name}: a ball joint alone has no picture {name!r}")
    with shown_in(scene.units):
        return known[name](Answer(scene))
