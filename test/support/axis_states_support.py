"""An axis in each of its situations, and all commands that it knows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from machine_support import CYCLE_TIME, UnitBench

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import ChannelBlock

V, A, J = 2000.0, 5000.0, 50_000.0
DYNAMICS = {"velocity": V, "acceleration": A, "deceleration": A, "jerk": J}


def path_block(first_cycle: int, positions: list[float], velocity: float = 0.0, *, axis: str = "x") -> ChannelBlock:
    """A channel block that moves `axis` (second of two) over `positions` at `velocity`."""
    count = len(positions)
    return ChannelBlock(
        first_cycle,
        count,
        path_active=True,
        axes=["other", axis],
        set_position=[0.0] * count + positions,
        set_velocity=[0.0] * count + [velocity] * count,
        set_acceleration=[0.0] * 2 * count,
        set_jerk=[0.0] * 2 * count,
    )


def follow_path(bench: UnitBench, blocks: int = 3, velocity: float = 100.0, begin: float = 0.0) -> None:
    """Lets the axis follow a path at constant velocity (which steps at its begin; the axis does not judge that)."""
    for _ in range(blocks):
        positions = [begin + velocity * CYCLE_TIME * n for n in range(bench.count)]
        bench.run(bench.count, {"channel": path_block(bench.cycle, positions, velocity)})
        begin = positions[-1] + velocity * CYCLE_TIME


def disabled(bench: UnitBench) -> None:
    bench.accepted("power", enabled=False)


def standing(bench: UnitBench) -> None:
    pass


def moving(bench: UnitBench) -> None:
    """Accelerates: 400 ms of the 500 ms up to 2000 mm/s."""
    bench.accepted("move_absolute", target=3000.0, **DYNAMICS)
    bench.run(400)


def braking(bench: UnitBench) -> None:
    """In the last ramp to 1000 mm, which begins after 500 ms."""
    bench.accepted("move_absolute", target=1000.0, **DYNAMICS)
    bench.run(700)


def held(bench: UnitBench) -> None:
    """Stands with a job that override 0 holds."""
    moving(bench)
    bench.accepted("set_override", percent=0.0)
    bench.run(1000)


def returning(bench: UnitBench) -> None:
    """Stops automatically to return to a new target that it has passed."""
    moving(bench)
    bench.accepted("new_target", target=100.0)
    bench.run(50)


def halting(bench: UnitBench) -> None:
    moving(bench)
    bench.accepted("halt")
    bench.run(50)


def stopping(bench: UnitBench) -> None:
    moving(bench)
    bench.accepted("stop")
    bench.run(50)


def waiting(bench: UnitBench) -> None:
    """Stops, and a new target waits for the end of the stop."""
    stopping(bench)
    bench.accepted("new_target", target=2000.0)
    bench.run(50)


def powered_off_in_motion(bench: UnitBench) -> None:
    moving(bench)
    bench.accepted("power", enabled=False)
    bench.run(50)


def compensating(bench: UnitBench) -> None:
    moving(bench)
    compensation = {"length": 300.0, "difference": 10.0, "process_velocity": 1000.0, "velocity_increase": 100.0}
    bench.accepted("compensation_start", **compensation)
    bench.run(50)


def external(bench: UnitBench) -> None:
    """External setpoints are enabled (absolute) and rest at 0."""
    bench.accepted("external_enable", mode="absolute")
    bench.run(50)


def external_beside(bench: UnitBench) -> None:
    """External setpoints are enabled (relative) on top of a PTP motion."""
    moving(bench)
    bench.accepted("external_enable", mode="relative")
    bench.run(50)


def velocity(bench: UnitBench) -> None:
    """Endlessly at 500 mm/s, by a job that is no jog."""
    bench.accepted("move_velocity", velocity=500.0)
    bench.run(300)


def adding(bench: UnitBench) -> None:
    """A superimposed motion on top of a PTP motion."""
    moving(bench)
    only_adding(bench)


def only_adding(bench: UnitBench) -> None:
    bench.accepted("move_superimposed", distance=400.0, velocity_difference=100.0)
    bench.run(50)


def jogging(bench: UnitBench) -> None:
    """Endlessly at 500 mm/s."""
    bench.accepted("jog", velocity=500.0)
    bench.run(400)


def jog_ended(bench: UnitBench) -> None:
    """On the ramp that ends a jog."""
    jogging(bench)
    bench.accepted("jog", velocity=0.0)
    bench.run(50)


def on_path(bench: UnitBench) -> None:
    follow_path(bench)


def error_ramp(bench: UnitBench) -> None:
    moving(bench)
    bench.accepted("upstream_lost", source="plc")
    bench.run(50)


def error_stop(bench: UnitBench) -> None:
    error_ramp(bench)
    bench.run(1000)


STATES: dict[str, tuple[Callable[[UnitBench], None], S]] = {
    "disabled": (disabled, S.DISABLED),
    "standing": (standing, S.STANDSTILL),
    "moving": (moving, S.DISCRETE_MOTION),
    "braking": (braking, S.DISCRETE_MOTION),
    "held": (held, S.DISCRETE_MOTION),
    "returning": (returning, S.DISCRETE_MOTION),
    "halting": (halting, S.DISCRETE_MOTION),
    "stopping": (stopping, S.STOPPING),
    "waiting": (waiting, S.STOPPING),
    "powered_off_in_motion": (powered_off_in_motion, S.STOPPING),
    "compensating": (compensating, S.DISCRETE_MOTION),
    "external": (external, S.CONTINUOUS_MOTION),
    "external_beside": (external_beside, S.DISCRETE_MOTION),
    "jogging": (jogging, S.CONTINUOUS_MOTION),
    "jog_ended": (jog_ended, S.DISCRETE_MOTION),
    "velocity": (velocity, S.CONTINUOUS_MOTION),
    "adding": (adding, S.DISCRETE_MOTION),
    "only_adding": (only_adding, S.DISCRETE_MOTION),
    "on_path": (on_path, S.SYNCHRONIZED_MOTION),
    "error_ramp": (error_ramp, S.ERROR_STOP),
    "error_stop": (error_stop, S.ERROR_STOP),
}

COMMANDS: dict[str, tuple[str, dict[str, Any]]] = {
    "power on": ("power", {"enabled": True}),
    "power off": ("power", {"enabled": False}),
    "reset": ("reset", {}),
    "move_absolute": ("move_absolute", {"target": 100.0, **DYNAMICS}),
    "move_relative": ("move_relative", {"distance": 100.0, **DYNAMICS}),
    "move_modulo": ("move_modulo", {"position": 90.0, **DYNAMICS}),
    "move_absolute aborting": ("move_absolute", {"target": 100.0, "buffer_mode": "aborting", **DYNAMICS}),
    "move_absolute buffered": ("move_absolute", {"target": 100.0, "buffer_mode": "buffered", **DYNAMICS}),
    "move_velocity": ("move_velocity", {"velocity": -300.0}),
    "move_velocity aborting": ("move_velocity", {"velocity": -300.0, "buffer_mode": "aborting"}),
    "move_superimposed": ("move_superimposed", {"distance": 5.0, "velocity_difference": 50.0}),
    "halt_superimposed": ("halt_superimposed", {}),
    "set_position": ("set_position", {"position": 1.0, "relative": True}),
    "set_override": ("set_override", {"percent": 60.0}),
    "set_override_type": ("set_override_type", {"type": 3}),
    "stop": ("stop", {}),
    "halt": ("halt", {}),
    "jog": ("jog", {"velocity": -300.0}),
    "jog 0": ("jog", {"velocity": 0.0}),
    "emergency_stop": ("emergency_stop", {"deceleration": 20_000.0, "jerk": 500_000.0}),
    "new_target": ("new_target", {"target": 2500.0}),
    "new_velocity_and_target": (
        "new_velocity_and_target",
        {"velocity": 1500.0, "target": 2500.0, "activation_position": 1200.0},
    ),
    "compensation_start": (
        "compensation_start",
        {"length": 200.0, "difference": 5.0, "process_velocity": 1000.0, "velocity_increase": 100.0},
    ),
    "compensation_stop": ("compensation_stop", {}),
    "external_enable absolute": ("external_enable", {"mode": "absolute"}),
    "external_enable relative": ("external_enable", {"mode": "relative"}),
    "external_disable": ("external_disable", {}),
    "external_setpoints": ("external_setpoints", {"setpoints": [[10**6, 0.0, 0.0, 0.0, 1]]}),
    "lost plc": ("upstream_lost", {"source": "plc"}),
    "lost clock": ("upstream_lost", {"source": "clock"}),
    "lost channel": ("upstream_lost", {"source": "channel"}),
}
