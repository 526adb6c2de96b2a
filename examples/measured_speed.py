"""Take the joint's own unevenness out of a measured speed, so that the engine's remains.

The sensor sits behind a joint of 12 deg; its order 2 hides the engine's order 1.5.
"""

import numpy as np

import cardan

line = cardan.Driveline.from_bends([12], degrees=True)

# A made-up measurement: 30 turns, speed of the drive with 0.3 % of order 1.5.
angle = np.linspace(0.0, 60.0 * np.pi, 6000, endpoint=False)
drive = 100.0 * (1.0 + 0.003 * np.sin(1.5 * angle))
measured = drive * line.evaluate(angle, "speed_ratio").speed_ratio

cleaned = measured / line.evaluate(angle, "speed_ratio").speed_ratio


def amplitude(speed: np.ndarray, order: float) -> float:
    """Amplitude of an order, relative to the mean."""
    spin = np.exp(-1j * order * angle)
    return float(2.0 * abs(np.mean(speed * spin)) / np.mean(speed))


for name, speed in (("measured", measured), ("cleaned", cleaned)):
    orders = {order: amplitude(speed, order) for order in (1.5, 2.0, 4.0)}
    print(f"{name:9}", *(f"order {order:g}: {100 * a:.3f} %" for order, a in orders.items()))
print(f"the joint alone has {100 * line.harmonics(2).speed_ratio[0]:.3f} % of order 2")
