"""An axis is homed by reference cam and zero pulse, and moved to a position (TX1250 4.2, with MC_Home).

A PLC in a file for config/ptp.yaml (docs/plc.md):

    cnc_ptp simulate config/ptp.yaml --plc examples/plc_homing.py
"""

from cnc_ptp.plc.plcopen import MC_Home, MC_MoveAbsolute, MC_Power

AWAY = 30.0  # mm from the cam, so that the homing has to look for it
REFERENCE_POSITION = 100.0  # mm: what the place of the zero pulse is called
POSITION = 150.0  # mm


class Plc:
    """Power, away from the cam, homing, positioning: each block starts when the one before it is done."""

    def __init__(self, io):
        x = io.axis("x")
        self.power, self.home = MC_Power(x), MC_Home(x)
        self.away, self.move = MC_MoveAbsolute(x), MC_MoveAbsolute(x)

    def cycle(self, io):
        self.power(True)
        self.away(self.power.status, position=AWAY, velocity=200.0)
        self.home(self.away.done, position=REFERENCE_POSITION)
        if self.home.done and not self.move.execute:
            io.event(f"x is homed, its zero pulse is at {REFERENCE_POSITION:g} mm")
        self.move(self.home.done, position=POSITION, velocity=100.0)
        for block in (self.power, self.away, self.home, self.move):
            if block.error:
                raise RuntimeError(block.error_text)
        io.done(self.move.done)
