"""Random programs that are disturbed at random moments: override, feed hold, reset, single block."""

from __future__ import annotations

import random

from machine_support import MachineBench
from path_checker import Findings
from random_paths import RandomProgram, run_of

from cnc_ptp.protocol.channel_states import ChannelStateCode

BLOCK = 0.01
"""s between commands."""
LARGEST = 1.2
"""Largest override."""
MOMENTS = 10
"""Disturbances of a run."""
LONGEST = 200.0
"""s of a run with all its standstills."""


def disturbed(seed: int, kind: str, moments: int = MOMENTS) -> Findings:
    """A run with that many disturbances of a kind; checked whole, `reset` up to where it stops."""
    draw = random.Random(seed)
    program = RandomProgram(seed)
    seconds = len(program.bench().run().column("x", "set_position")) * 0.001
    bench = program.bench(end_when_idle=False)
    found = Findings()
    if kind == "reset":
        bench.run(draw.uniform(0.0, 1.0) * seconds)
        bench.give("channel", "reset")
        settle(bench, found)
    elif kind == "single block":
        single_blocks(bench, draw, seconds, moments, found)
    else:
        disturb = {"override": to_zero, "hold": hold, "ramp": ramp}[kind]
        for _ in range(moments):
            bench.run(draw.uniform(0.0, 2.0) * seconds / moments)
            disturb(bench, draw)
        settle(bench, found)
    found.texts += program.checker().check(run_of(bench, LARGEST), complete=kind != "reset").texts
    found.texts += bench.errors()
    return found


def settle(bench: MachineBench, found: Findings) -> None:
    """To the end of the program."""
    for _ in range(int(LONGEST)):
        bench.run(1.0)
        if bench.last("channel").done:
            return
    found.texts.append("the run does not end")


def to_zero(bench: MachineBench, draw: random.Random) -> None:
    """Override 0, and back before or behind the standstill."""
    bench.give("channel", "set_override", percent=0.0)
    bench.run(draw.choice((BLOCK, 0.05, 0.2, 1.0)))
    bench.give("channel", "set_override", percent=draw.choice((100.0, 100.0, 30.0, 120.0)))


def hold(bench: MachineBench, draw: random.Random) -> None:
    bench.give("channel", "feed_hold", enabled=True)
    bench.run(draw.choice((BLOCK, 0.05, 0.2, 1.0)))
    bench.give("channel", "feed_hold", enabled=False)


def ramp(bench: MachineBench, draw: random.Random) -> None:
    """The override goes in steps from one value to another, one in each block."""
    begin, end, steps = draw.uniform(0.0, 120.0), draw.uniform(20.0, 120.0), draw.randint(2, 30)
    for step in range(1, steps + 1):
        bench.give("channel", "set_override", percent=begin + (end - begin) * step / steps)
        bench.run(BLOCK)


def single_blocks(bench: MachineBench, draw: random.Random, seconds: float, moments: int, found: Findings) -> None:
    """On at a random moment, a few blocks one by one, off again."""
    bench.run(draw.uniform(0.0, 1.0) * seconds)
    bench.give("channel", "single_block", enabled=True)
    for _ in range(moments):
        bench.run(draw.choice((0.05, 0.5, 2.0)))
        resume(bench)
    bench.give("channel", "single_block", enabled=False)
    for _ in range(int(LONGEST)):
        resume(bench)
        bench.run(1.0)
        if bench.last("channel").done:
            return
    found.texts.append("the run does not end")


def resume(bench: MachineBench) -> None:
    """Where the program has stopped; one that is finished would begin again."""
    if bench.last("channel").state[-1] == ChannelStateCode.STOPPED:
        bench.give("channel", "start")
