"""Pictures, drawn with matplotlib: of scenes, drivelines and what the sources show.

Every ``plot_`` function but ``plot_scene``, ``plot_forces``, ``plot_ball_joint``,
``plot_optimise`` and ``plot_torsion`` draws on the axes that it is given as ``ax`` and returns
them. Without ``ax`` it makes a figure of pyplot, 80 mm wide, in the settings of ``STYLE``. These
five return a whole figure: a page, A4 across, and pictures up to 170 mm wide. Curves differ in
dashes as well as colour, so that they can be told apart in grey.

>>> import cardan.app.plots
>>> line = cardan.Driveline.from_bends([[10], [20], [30]], degrees=True)
>>> axes = cardan.plots.plot_curves(line, "speed_ratio")  # doctest: +SKIP
>>> cardan.plots.save(axes.figure, "ratio.svg")  # doctest: +SKIP
"""

from cardan.app.files.pictures import SUFFIXES
from cardan.app.plots.backlash import plot_backlash, plot_lash, write_backlash
from cardan.app.plots.ball_joint import plot_ball_joint, plot_seat_pressure, plot_seat_section
from cardan.app.plots.bend_vectors import plot_bend_vectors
from cardan.app.plots.catalogue import (
    plot_angle_error,
    plot_driven_angle,
    plot_largest_angle_error,
    plot_non_uniformity,
)
from cardan.app.plots.curves import plot_curves
from cardan.app.plots.double_joint import plot_double_joint
from cardan.app.plots.drive_speed import plot_drive_speed
from cardan.app.plots.driveline import plot_driveline, yoke_pins
from cardan.app.plots.force_hodograph import plot_force_hodograph, plot_forces
from cardan.app.plots.grossmann import plot_bending_moments, plot_torque_ratio
from cardan.app.plots.harmonics import plot_harmonics
from cardan.app.plots.hodograph import plot_hodograph
from cardan.app.plots.life import plot_heat, plot_pin_load, plot_sizes, write_life
from cardan.app.plots.optimise import plot_optimise, plot_optimised_states, plot_over_variable
from cardan.app.plots.result import plot_result
from cardan.app.plots.scene import plot_scene, write_picture
from cardan.app.plots.slides import plot_slide_orders, plot_slides, write_slides
from cardan.app.plots.states import plot_states
from cardan.app.plots.study import plot_study
from cardan.app.plots.style import STYLE, save
from cardan.app.plots.thoma import plot_small_angle
from cardan.app.plots.tolerances import plot_tolerance_shares, plot_tolerances, write_tolerances
from cardan.app.plots.torsion import (
    plot_campbell,
    plot_stability,
    plot_torsion,
    plot_torsion_response,
)

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
    "write_backlash",
    "write_life",
    "write_picture",
    "write_slides",
    "write_tolerances",
    "yoke_pins",
]
