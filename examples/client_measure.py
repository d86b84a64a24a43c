"""Moves an axis at several velocities and measures its largest following error: python examples/client_measure.py"""

from cnc_ptp.client import Axis, Machine


def largest_following_error(axis: Axis, target: float, velocity: float) -> float:
    """mm, over the motion to a target at a velocity (mm/s)."""
    states = axis.states()
    job = axis.move_absolute(target, velocity=velocity)
    largest = 0.0
    for state in states:
        largest = max(largest, abs(state.following_error))
        if job.ended:
            return largest
    return largest


with Machine.offline("config/mill.yaml") as m:
    axis = m.axes["x"]
    for enabled in (False, True):
        axis.set_feedforward(enabled=enabled)
        print("with feedforward" if enabled else "without")
        for velocity in (10.0, 50.0, 200.0):
            target = 0.0 if axis.state.set_position else 150.0
            m.run_for(0.2)  # the drive comes to rest
            print(f"{velocity:8.0f} mm/s {largest_following_error(axis, target, velocity):8.4f} mm")
