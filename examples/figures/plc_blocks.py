"""Function blocks on one axis whose `execute` comes from the scenario (`set_input`), for timing diagrams."""

from cnc_ptp.plc.plcopen import MC_Halt, MC_MoveAbsolute, MC_MoveVelocity, MC_Stop

DYNAMICS = {"velocity": 1000.0, "acceleration": 5000.0, "deceleration": 5000.0, "jerk": 50000.0}
INPUTS = ("first", "second", "turn", "halt", "stop", "buffered", "blended")


class Plc:
    """`first` moves to `position` (500 mm), `second` to 800 mm, `turn` moves at 400 mm/s."""

    def __init__(self, io):
        x = io.axis("x")
        self.first = MC_MoveAbsolute(x)
        self.second = MC_MoveAbsolute(x)
        self.turn = MC_MoveVelocity(x)
        self.halt = MC_Halt(x)
        self.stop = MC_Stop(x)

    def cycle(self, io):
        given = {name: io.inputs.get(name, 0.0) for name in INPUTS}
        self.stop(given["stop"])
        self.halt(given["halt"])
        self.turn(given["turn"], velocity=400.0, acceleration=5000.0, deceleration=5000.0, jerk=50000.0)
        self.first(given["first"], position=io.inputs.get("position", 500.0), **DYNAMICS)
        mode = "buffered" if given["buffered"] else "blending_low" if given["blended"] else "aborting"
        self.second(given["second"], position=800.0, buffer_mode=mode, **(DYNAMICS | SLOWER[mode]))


SLOWER = {"aborting": {}, "buffered": {}, "blending_low": {"velocity": 400.0}}
"""With which a blending is seen in the velocity."""
