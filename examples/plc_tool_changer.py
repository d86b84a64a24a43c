"""A tool changer and a door: a PLC in a file for config/mill.yaml (docs/plc.md).

T turns the magazine while the program continues. M6 waits until the magazine is there, the spindle stands at its change
position and the arm has changed the tools. While the door is open the path stands and the spindle does not turn: M3
waits until the door is closed.

    cnc_ptp simulate config/mill.yaml --plc examples/plc_tool_changer.py --program examples/plc_tool_changer.nc \
        --scenario examples/plc_tool_changer.yaml
"""

from cnc_ptp.plc.plcopen import MC_OrientSpindle, MC_SetOverride

POCKETS = 8
POCKET_TIME = 0.4
"""Seconds from one pocket of the magazine to the next."""
ARM_TIME = 0.6
"""Seconds in which the arm changes the tools."""
CHANGE_POSITION = 90.0
"""Of the spindle, °."""


class Door:
    """Feed hold, and override 0 of the spindle, while the input `door_closed` is not 1."""

    def __init__(self, io):
        self.channel = io.channel("channel")
        self.override = MC_SetOverride(io.spindle("s"))
        self.closed = None

    def cycle(self, io):
        closed = io.inputs.get("door_closed") == 1
        self.override(True, factor=1.0 if closed else 0.0)
        if closed != self.closed:
            self.channel.give("feed_hold", enabled=not closed)
            io.event("the door is closed" if closed else "the door is open")
        self.closed = closed


class Magazine:
    """Turns to the pocket of the tool that T has named, the shorter way round."""

    def __init__(self):
        self.pocket = 0
        self.wanted = 0
        self.next_step = 0.0

    @property
    def turns(self):
        return self.pocket != self.wanted

    def cycle(self, io):
        for function in io.functions:
            if function.kind == "T":
                self.wanted = function.number % POCKETS
                self.next_step = io.time + POCKET_TIME
        if self.turns and io.time >= self.next_step:
            forward = (self.wanted - self.pocket) % POCKETS <= POCKETS // 2
            self.pocket = (self.pocket + (1 if forward else -1)) % POCKETS
            self.next_step += POCKET_TIME


class Plc:
    """Acknowledges M6 when the tool is changed, all other functions at once."""

    def __init__(self, io):
        io.auto_acknowledge(False)
        self.door = Door(io)
        self.magazine = Magazine()
        self.orient = MC_OrientSpindle(io.spindle("s"))
        self.arm_moves = False
        self.arm_ready = 0.0

    def cycle(self, io):
        self.door.cycle(io)
        self.magazine.cycle(io)
        change = next((request for request in io.requests if (request.kind, request.number) == ("M", 6)), None)
        for request in io.requests:
            if request is not change:
                io.acknowledge(request.id)
        self.orient(change is not None, position=CHANGE_POSITION)
        if self.orient.error:
            raise RuntimeError(self.orient.error_text)
        self.move_arm(io, change)

    def move_arm(self, io, change):
        """Starts when spindle and magazine are there; the change is acknowledged when the arm is back."""
        if not self.arm_moves and change is not None and self.orient.done and not self.magazine.turns:
            self.arm_moves, self.arm_ready = True, io.time + ARM_TIME
        if self.arm_moves and io.time >= self.arm_ready:
            self.arm_moves = False
            io.acknowledge(change.id)
            io.event(f"tool of pocket {self.magazine.pocket} is in the spindle")
