"""A channel's view of its spindle when others command it in the same block."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

from machine_support import CYCLE_TIME, UnitBench
from spindle_support import two_gears

from cnc_ptp.channel.commanded_spindle import CommandedSpindle
from cnc_ptp.channel.spindle_reports import Condition, Expectation
from cnc_ptp.parameters import ChannelSpindle, Synchronisation
from cnc_ptp.spindle.spindle_unit import SpindleUnit

GEAR = "does not turn at {0} rpm as commanded, its gear is being changed"


class Watched:
    """A spindle with two gears that a channel watches."""

    def __init__(self) -> None:
        parameters = two_gears()
        self.bench = UnitBench(SpindleUnit(parameters, cycle_time=CYCLE_TIME))
        self.name = self.bench.unit.name
        words = ChannelSpindle("S", self.name, *[Synchronisation.MOS] * 5)
        self.spindle = CommandedSpindle(words, parameters, channel="channel", ranks=count())

    def speed(self, speed_rpm: float, command: str = "start") -> None:
        """The channel commands a speed, M3 or S."""
        words = {"direction": "cw"} if command == "start" else {}
        self.bench.accepted(command, source="channel", speed_rpm=speed_rpm, **words)
        self.expect(Condition.SPEED, speed_rpm)

    def expect(self, condition: Condition, value: float = 0.0) -> None:
        """The command goes out with the next block."""
        self.spindle.expect(Expectation(self.name, condition, value))
        self.spindle.send(self.bench.cycle)

    def notices(self, blocks: int, *, watched: bool = True) -> Iterator[str]:
        """Texts of the next blocks, without the name of the spindle."""
        for _ in range(blocks):
            self.bench.run(10)
            self.spindle.read(self.bench.cycle, self.bench.last)
            text = self.spindle.lost_speed(self.bench.cycle, watched=watched)
            if text:
                yield text.removeprefix(f"spindle {self.name} ")


def test_a_gear_change_in_the_block_of_m3() -> None:
    """M3 came first and does not wait in the spindle: it has had its turn."""
    watched = Watched()
    watched.speed(1000.0)
    watched.bench.accepted("select_gear", stage=2)
    assert list(watched.notices(1)) == [GEAR.format(1000)] and list(watched.notices(50)) == []


def test_m3_in_the_block_of_a_gear_change() -> None:
    """M3 came second and waits."""
    watched = Watched()
    watched.bench.accepted("select_gear", stage=2)
    watched.speed(1000.0)
    assert list(watched.notices(50)) == []
    watched.bench.accepted("gear_changed")
    assert list(watched.notices(50)) == [] and watched.bench.last.speed_reached[-1]
    watched.bench.accepted("select_gear", stage=1)
    assert list(watched.notices(1)) == [GEAR.format(1000)]


def test_commands_that_wait_from_the_block_of_m3_on() -> None:
    """M3 is active while they wait; the first of them begins when its speed is reached."""
    watched = Watched()
    watched.speed(1000.0)
    for position in (90.0, 180.0):
        watched.bench.accepted("orient", position_deg=position, source="plc")
    assert list(watched.notices(10)) == []
    assert list(watched.notices(20)) == ["does not turn at 1000 rpm as commanded, it is in DiscreteMotion"]


def test_a_new_speed_that_waits_for_a_gear() -> None:
    """The spindle has turned for the channel before: that its S waits does not make it turn."""
    watched = Watched()
    watched.speed(1000.0)
    assert list(watched.notices(30)) == []
    watched.bench.accepted("select_gear", stage=2)
    watched.speed(2000.0, "set_speed")
    assert list(watched.notices(1)) == [GEAR.format(2000)] and list(watched.notices(50)) == []


def test_m3_after_m5_has_its_turn_to_wait_for() -> None:
    watched = Watched()
    watched.speed(1000.0)
    assert list(watched.notices(30)) == []
    watched.bench.accepted("stop", source="channel")
    watched.expect(Condition.STANDSTILL)
    assert list(watched.notices(30)) == []
    watched.bench.accepted("select_gear", stage=2)
    watched.speed(1000.0)
    assert list(watched.notices(50)) == []


def test_a_path_that_waits_notices_nothing() -> None:
    watched = Watched()
    watched.speed(1000.0)
    assert list(watched.notices(5, watched=False)) == []
    watched.bench.accepted("select_gear", stage=2)
    assert list(watched.notices(5, watched=False)) == [] and list(watched.notices(1)) == [GEAR.format(1000)]


def test_a_program_notices_what_has_happened_before_it() -> None:
    """Between two manual blocks; only the second one is reported."""
    watched = Watched()
    watched.speed(1000.0)
    assert list(watched.notices(30, watched=False)) == []
    watched.bench.accepted("select_gear", stage=2)
    assert list(watched.notices(5, watched=False)) == [] and list(watched.notices(1)) == [GEAR.format(1000)]


def test_nothing_is_noticed_of_earlier_programs() -> None:
    watched = Watched()
    watched.speed(1000.0)
    assert list(watched.notices(30)) == []
    watched.spindle.expect_nothing()
    watched.bench.accepted("select_gear", stage=2)
    assert list(watched.notices(50)) == []
