"""A setpoint generator of the PLC's own: three phases with rectangular acceleration (TX1250 4.1).

A PLC in a file for config/ptp.yaml (docs/plc.md). It moves x forward and back, one setpoint for each cycle:

    cnc_ptp simulate config/ptp.yaml --plc examples/plc_setpoint_generator.py
"""

from math import copysign, sqrt

from cnc_ptp.plc.plcopen import MC_ExtSetPointGenDisable, MC_ExtSetPointGenEnable, MC_ExtSetPointGenFeed

VELOCITY = 1000.0
ACCELERATION = 4000.0
TARGETS = (600.0, 0.0)


class ThreePhases:
    """From one position to another: constant acceleration, constant velocity, constant deceleration."""

    def __init__(self, begin, end):
        self.end = end
        self.way = end - begin
        self.velocity = min(VELOCITY, sqrt(abs(self.way) * ACCELERATION))  # a short way has no second phase
        self.ramp = self.velocity / ACCELERATION
        self.duration = abs(self.way) / self.velocity + self.ramp

    def at(self, t):
        """Position, velocity and acceleration `t` seconds after the start."""
        sign, left = copysign(1.0, self.way), self.duration - t
        if left <= 0.0:
            return self.end, 0.0, 0.0
        if t < self.ramp:
            return self.end - self.way + sign * 0.5 * ACCELERATION * t * t, sign * ACCELERATION * t, sign * ACCELERATION
        if left > self.ramp:
            way = 0.5 * self.velocity * self.ramp + self.velocity * (t - self.ramp)
            return self.end - self.way + sign * way, sign * self.velocity, 0.0
        return self.end - sign * 0.5 * ACCELERATION * left * left, sign * ACCELERATION * left, -sign * ACCELERATION


class Plc:
    """Enables the external setpoints, gives those of one motion after the other, and disables them."""

    def __init__(self, io):
        self.x = io.axis("x")
        self.enable = MC_ExtSetPointGenEnable(self.x)
        self.feed = MC_ExtSetPointGenFeed(self.x)
        self.disable = MC_ExtSetPointGenDisable(self.x)
        self.targets = list(TARGETS)
        self.motion = None
        self.begun = 0

    def cycle(self, io):
        self.enable(True, mode="absolute")
        if self.enable.done and self.motion is None and self.targets:
            self.motion, self.begun = ThreePhases(self.x.set_position, self.targets.pop(0)), io.cycle
        if self.motion is not None:
            self.give_setpoints(io)
        self.disable(self.motion is None and not self.targets)
        if self.feed.error:
            raise RuntimeError(self.feed.error_text)
        io.done(self.disable.done)

    def give_setpoints(self, io):
        """One for each cycle of the block; the motion has ended when all of a block are at its end."""
        times = [(io.cycle - self.begun + n) * io.cycle_time for n in range(io.block_cycles)]
        direction = 1 if self.motion.way > 0.0 else -1
        self.feed(*((*self.motion.at(t), direction) for t in times))
        if times[0] > self.motion.duration:
            self.motion = None
