"""An axis is enabled and moved forward and backward (TX1250 4.3).

A PLC in a file for config/ptp.yaml (docs/plc.md). The recording begins when the axis does:

    cnc_ptp simulate config/ptp.yaml --plc examples/plc_move_axis.py --record runs/move.mcap \
        --record-when 'x.set_velocity != 0'
"""

from cnc_ptp.plc.plcopen import MC_MoveAbsolute, MC_Power

POSITIONS = (2000.0, 0.0)
ROUNDS = 2


class Plc:
    """The states of the motion: init, start, move."""

    def __init__(self, io):
        x = io.axis("x")
        self.power = MC_Power(x)
        self.move = MC_MoveAbsolute(x)
        self.state = "init"
        self.moves = 0

    def cycle(self, io):
        self.power(True)
        start = self.state in ("start", "move")
        self.move(start, position=POSITIONS[self.moves % 2], velocity=2000.0, acceleration=5000.0, jerk=50000.0)
        if self.move.error:
            raise RuntimeError(self.move.error_text)
        if self.state == "init":  # the next edge of execute comes with the next cycle
            self.state = "start" if self.power.status and io.time >= 0.2 else "init"
        elif self.state == "start":
            self.state = "move"
        elif self.move.done:
            self.moves += 1
            self.state = "init" if self.moves < 2 * ROUNDS else "end"
        io.done(self.state == "end")
