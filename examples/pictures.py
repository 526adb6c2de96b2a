"""Draw every kind of picture that ``cardan.plots`` knows as SVG, most of them 80 mm wide.

Give it a folder to write to, by default ``pictures``. The documentation shows them.
"""

import sys
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.style
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import cardan
from cardan.app import plots
from cardan.app.answers.optimise.figures import optimised
from cardan.app.answers.torsion.figures import torsion_figures
from cardan.app.scene.starters import STARTERS

matplotlib.use("agg")
matplotlib.style.use(dict(plots.STYLE))

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "pictures")
folder.mkdir(parents=True, exist_ok=True)


def save(name: str, drawn: Axes | Figure) -> None:
    """Write a figure, or the one of these axes, and forget it."""
    figure = drawn.get_figure(root=True) if isinstance(drawn, Axes) else drawn
    assert figure is not None
    plots.save(figure, folder / f"{name}.svg")
    pyplot.close(figure)
    print(f"wrote {name}.svg")


def panels(count: int) -> tuple[Any, Any]:
    """Return a figure of 80 mm with axes for curves over the same angles."""
    size = (80 / 25.4, (14 + 28 * count) / 25.4)
    return pyplot.subplots(count, sharex=True, figsize=size, layout="constrained")


# The catalogues' figures of a single joint (Bilder 10 to 13).
save("driven_angle", plots.plot_driven_angle())
save("angle_error", plots.plot_angle_error([10, 20, 30]))
save("largest_angle_error", plots.plot_largest_angle_error())
save("non_uniformity", plots.plot_non_uniformity())

# Their worked example of a shaft bent in space (Bild 18), and the same shaft drawn.
shaft = cardan.Driveline.from_projected_bends([15, -11.5], [7, 12], degrees=True)
save("bend_vectors", plots.plot_bend_vectors(shaft))
shaft = shaft.with_phases(shaft.optimal_phases())
save("spatial_shaft", plots.plot_driveline(shaft))

# Grossmann's Abb. 3 and 4, and the path of the moment vector.
save("torque_ratio", plots.plot_torque_ratio(50))
save("bending_moments", plots.plot_bending_moments(50))
joint = cardan.Driveline.from_bends([50], degrees=True)
save("hodograph", plots.plot_hodograph(joint))

# The paths of the forces in a truck's driveline over the turn.
scene = cardan.Scene.load(Path(__file__).with_name("bearings.toml"))
save("forces", plots.plot_part(scene, "forces"))

# The axial travel of a shaft whose axes miss each other.
scene = cardan.Scene.load(Path(__file__).with_name("axial_travel.toml"))
save("axial_travel", plots.plot_part(scene, "axial_travel"))

# The backlash loop of worn joints.
scene = cardan.Scene.load(Path(__file__).with_name("worn_joints.toml"))
save("backlash", plots.plot_part(scene, "backlash"))

# Thoma's moments of a flywheel, exact and for small bends.
figure, axes = panels(3)
plots.plot_small_angle("torque", 30, ax=axes[0])
plots.plot_small_angle("moment_x", 30, ax=axes[1])
plots.plot_small_angle("moment_z", 30, ax=axes[2])
for ax in axes:
    ax.label_outer()
save("small_angle", figure)

# The speed of his drive, with a pulley of 1, 3 and 10 times the flywheel's inertia.
rig = cardan.Driveline.from_bends([8.5], degrees=True)
save("drive_speed", plots.plot_drive_speed(rig, [[0.02, 0.02], [0.06, 0.02], [0.2, 0.02]]))

# Motion of single joints to compare, and their harmonics.
joints = cardan.Driveline.from_bends([[10], [20], [30]], degrees=True)
figure, axes = panels(3)
for ax, output in zip(axes, ("angle_error", "speed_ratio", "acceleration_ratio"), strict=True):
    plots.plot_curves(joints, output, ax=ax)
    ax.label_outer()
save("motion", figure)
save("harmonics", plots.plot_harmonics(joints))

# The shaft of the five-minute start.
page = Path(__file__).parents[1] / "docs" / "start.md"
text = page.read_text("utf-8").partition('```toml title="shaft.toml"\n')[2].partition("```")[0]
save("start", plots.plot_scene(cardan.Scene.parse(text).run()))

# A driveline of three joints in space, and the loads of a W arrangement.
points = [[0, 0, 0], [600, 0, 0], [1900, -140, 60], [3100, -180, 0], [3500, -180, -40]]
save("driveline", plots.plot_driveline(cardan.Driveline.from_points(points), points=points))
w_shaft = cardan.Driveline.from_bends([15, 15], degrees=True)
load = cardan.Load(drive_torque=200.0)
figure, axes = panels(3)
plots.plot_curves(w_shaft, "torque", load=load, shaft=1, ax=axes[0])
plots.plot_curves(w_shaft, "bending_driven", load=load, joint=0, ax=axes[1])
plots.plot_curves(w_shaft, "support_moment", load=load, shaft=1, ax=axes[2])
for ax in axes:
    ax.label_outer()
save("loads", figure)

# How well a second joint compensates the first, by its bend and the phase of its yokes.
scene = cardan.Scene.parse("""
    [driveline]
    bends_deg = [10, 10]
    [study]
    bends_deg.1 = {from = 7, to = 13, steps = 121}
    phases_deg.0 = {from = -10, to = 10, steps = 81}
""")
study = scene.run().study
assert study is not None
save("equivalent_bend", plots.plot_study(study))

# The length of a shaft over the travel of its axle.
scene = cardan.Scene.load(Path(__file__).with_name("slip.toml"))
study = scene.run().study
assert study is not None
save("length", plots.plot_study(study, "length_1"))

# The equivalent bend of a truck over its ride heights, with the limit of the catalogues.
scene = cardan.Scene.load(Path(__file__).with_name("ride_heights.toml"))
heights = scene.run().study
assert isinstance(heights, cardan.scene.StatesResult)
save("states", plots.plot_states(heights))

# The best layout of a truck's driveline over nine ride heights.
scene = cardan.Scene.parse("""
    [driveline]
    points_mm = [[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45], [3450, -196, 45]]
    teeth = 24
    [states]
    names = ["-80", "-60", "-40", "-20", "rest", "+20", "+40", "+60", "+80"]
    points_mm.3.y = [-260, -240, -220, -200, -180, -160, -140, -120, -100]
    points_mm.4.y = [-276, -256, -236, -216, -196, -176, -156, -136, -116]
    [optimise]
    vary = {"points_mm.2.y" = [-40, 40], "phases_deg.0" = "free", "phases_deg.1" = "free"}
""")
best = optimised(scene)
assert best is not None
save("optimise", plots.plot_optimise(best))

# How the equivalent bend of a shaft scatters, and which tolerance makes it scatter.
scene = cardan.Scene.load(Path(__file__).with_name("workshop.toml"))
save("tolerances", plots.plot_part(scene, "tolerances"))

# Torques of a truck's shafts over the speed, and the natural frequencies with the orders.
scene = cardan.Scene.load(Path(__file__).with_name("truck_torsion.toml"))
vibration = torsion_figures(scene)
assert vibration is not None
save("torsion_response", plots.plot_torsion(vibration))
save("campbell", plots.plot_campbell(vibration))

# A boat with an engine of three cylinders.
scene = cardan.Scene.load(Path(__file__).with_name("boat.toml"))
vibration = torsion_figures(scene)
assert vibration is not None
save("boat_response", plots.plot_torsion(vibration))

# A light truck that shudders: force over the speed, shapes, and force over the stiffness.
scene = cardan.Scene.parse(STARTERS["shudder"].text)
save("lateral", plots.plot_part(scene, "lateral"))
save("lateral_shapes", plots.plot_part(scene, "shapes"))
save("lateral_stiffness", plots.plot_part(scene, "stiffness"))

# Where a test rig with a torsion bar is unstable.
scene = cardan.Scene.load(Path(__file__).with_name("rig_torsion.toml"))
vibration = torsion_figures(scene)
assert vibration is not None
save("stability", plots.plot_stability(vibration))

# Life with each size of joint, load of the pins and heat of a conveyor.
scene = cardan.Scene.load(Path(__file__).with_name("conveyor.toml"))
save("life", plots.plot_part(scene, "life"))

# The machines of the how-to pages: layouts, forces, torques and scatter.
for name, kind in (("machine_truck", "truck-shaft"), ("machine_pto", "pto-shaft")):
    best = optimised(cardan.Scene.parse(STARTERS[kind].text))
    assert best is not None
    save(name, plots.plot_optimise(best))

scene = cardan.Scene.parse(STARTERS["mill-spindle"].text)
save("machine_mill", plots.plot_part(scene, "forces"))

vibration = torsion_figures(cardan.Scene.parse(STARTERS["test-rig"].text))
assert vibration is not None
save("machine_rig", plots.plot_torsion(vibration))

scene = cardan.Scene.parse(STARTERS["steering-column"].text)
assert scene.states is not None
columns = scene.drivelines()
save("machine_steering", plots.plot_curves(columns, "speed_ratio", labels=scene.states.names))

# The boat of the drawing after its engine was lowered.
boat = STARTERS["ship-shaft"].text
lowered = boat.replace("-220, 0]", "-127.715, 0]").replace("-262, 0]", "-169.715, 0]")
scene = cardan.Scene.parse(lowered)
save("machine_ship", plots.plot_part(scene, "tolerances"))

# A double joint that is synchronous at 35 deg, and one whose pivot is worn by 0.2 mm.
save("double_joint", plots.plot_double_joint(60.0, 35.0, wear=0.2))

# The pressure on the seat of a ball joint with clearance.
ball = cardan.scene.BallJointScene.parse("""
    title = "Ball joint under 20 kN"
    [ball_joint]
    load_N = 20000
    radius_mm = 16
    half_angle_deg = 60
    clearance_mm = 0.01
    seat = {allowable_pressure_MPa = 60, layer_mm = 1, modulus_MPa = 2500, poisson = 0.4}
""")
save("ball_joint", plots.plot_ball_joint(ball.ball_joint, ball.title))
