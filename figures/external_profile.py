"""`python -m figures.external_profile`: writes the setpoints of the external setpoint example.

A generator like one in a PLC program: 600 mm at 1000 mm/s in three phases (constant acceleration, velocity,
deceleration), one packet per cycle of 1 ms. As TX1250 2.6 asks, the direction is +1 one cycle before the motion and one
cycle after it, and 0 at the end.
"""

from __future__ import annotations

from collections.abc import Iterator

from figures.scenario_head import ROOT

FILE = ROOT / "examples" / "figures" / "ptp_external_setpoints.csv"
HEADER = "cycle,position,velocity,acceleration,direction"
CYCLE_TIME, DISTANCE, VELOCITY, ACCELERATION = 0.001, 600.0, 1000.0, 4000.0
"""s, mm, mm/s, mm/s²."""


def setpoints() -> Iterator[tuple[float, float, float]]:
    """Position, velocity and acceleration of each cycle of the motion, its end included."""
    ramp = VELOCITY / ACCELERATION
    end = DISTANCE / VELOCITY + ramp
    for cycle in range(round(end / CYCLE_TIME)):
        t = cycle * CYCLE_TIME
        if t < ramp:
            yield 0.5 * ACCELERATION * t * t, ACCELERATION * t, ACCELERATION
        elif t < end - ramp:
            yield VELOCITY * (t - 0.5 * ramp), VELOCITY, 0.0
        else:
            left = end - t
            yield DISTANCE - 0.5 * ACCELERATION * left * left, ACCELERATION * left, -ACCELERATION
    yield DISTANCE, 0.0, 0.0


def csv_text() -> str:
    """All packets as the scenario command `external_setpoints` reads them."""
    moving = [(*setpoint, 1) for setpoint in setpoints()]
    packets = [(0.0, 0.0, 0.0, 1), *moving, (DISTANCE, 0.0, 0.0, 1), (DISTANCE, 0.0, 0.0, 0)]
    lines = [f"{cycle},{p:.9g},{v:.9g},{a:.9g},{direction}" for cycle, (p, v, a, direction) in enumerate(packets)]
    return "\n".join([HEADER, *lines, ""])


if __name__ == "__main__":
    FILE.write_text(csv_text(), encoding="utf-8")
