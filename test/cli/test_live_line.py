"""The live line of a run: what it shows at each width, of machines with and without a channel."""

import io
from dataclasses import replace

import pytest
from rich.console import Console

from cnc_ptp.commands.run.live_line import LiveLine, clock_text, line_text
from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.blocks import ChannelBlock
from cnc_ptp.protocol.unit_view import UnitView, view_of


def axis(name, position=0.0, state="Standstill"):
    return UnitView(name, "axis", state, False, True, 100.0, 0, 10, 0.0, position=position, unit="mm", speed=0.0)


SPINDLE = UnitView("s", "spindle", "ContinuousMotion", True, True, 100.0, 0, 10, 0.0, speed=3000.0, speed_unit="rpm")
CHANNEL = UnitView(
    "channel",
    "channel",
    "Running",
    True,
    False,
    100.0,
    0,
    10,
    0.0,
    speed=1500.0,
    line=17,
    blocks_done=12,
    blocks_total=40,
    progress=0.4,
    time_left=83.2,
)
MILL = [CHANNEL, axis("x", 12.3456, "SynchronizedMotion"), axis("y", -3.0), axis("z"), SPINDLE]


@pytest.mark.parametrize("views", [MILL, [axis("x")], [SPINDLE], [axis(name, -99999.999) for name in "abcdefghijklmn"]])
@pytest.mark.parametrize("width", [1, 10, 20, 40, 60, 80, 100, 120, 200])
def test_it_never_is_longer_than_its_terminal(views, width):
    assert 0 < len(line_text(views, 3725.0, width)) <= width


def test_what_is_left_out_first():
    assert line_text(MILL, 3725.0, 200) == (
        "block 12/40 line 17 F1500  X   12.346 SynchronizedMotion  Y   -3.000 Standstill  Z    0.000 Standstill  "
        "S  3000.0 rpm ContinuousMotion  1:02:05  0:01:24 left"
    )
    assert line_text(MILL, 3725.0, 110) == (
        "block 12/40 line 17 F1500  X   12.346  Y   -3.000  Z    0.000  S  3000.0 rpm  1:02:05  0:01:24 left"
    )
    assert line_text(MILL, 3725.0, 80) == "block 12/40 line 17 F1500  X   12.346  Y   -3.000  Z    0.000  S  3000.0 rpm"
    assert line_text(MILL, 3725.0, 40) == "block 12/40  X   12.3  Y   -3.0  +2"


def test_a_time_left_that_is_not_known_is_not_shown():
    for left in (-1.0, 0.0):
        assert "left" not in line_text([replace(CHANNEL, time_left=left)], 3725.0, 200)
    two = [CHANNEL, replace(CHANNEL, name="second", time_left=100.0)]
    assert line_text(two, 3725.0, 200).endswith("1:02:05  0:01:40 left")
    assert "left" not in line_text([*two, replace(CHANNEL, time_left=-1.0)], 3725.0, 200)


def test_a_machine_without_a_channel_shows_its_axes():
    """It said that the nodes were starting, for ever."""
    shown = line_text([axis("x", 1.5), axis("c", 90.0, "ContinuousMotion")], 3.0, 80)
    assert shown == "X    1.500 Standstill  C   90.000 ContinuousMotion  0:00:03"
    assert line_text([], 3.0, 80) == "the nodes are starting  0:00:03"


@pytest.mark.parametrize(("width", "bar"), [(45, False), (80, False), (97, True), (160, True)])
def test_the_bar_takes_what_is_left(width, bar):
    line = LiveLine()
    line.views = MILL[:3]
    console = Console(file=io.StringIO(), width=width, force_terminal=True, color_system=None)
    console.print(line)
    (shown, *rest) = console.file.getvalue().splitlines()
    assert not rest and "block 12/40" in shown and len(shown.rstrip()) <= width
    assert ("━" in shown) is bar


def test_views_are_made_of_blocks_as_of_messages():
    block = ChannelBlock(90, 2, line=[1, 2], path_velocity=[0.0, 25.0], override_percent=[50.0, 60.0], state=[2, 2])
    block.error_id, block.done = [0, 0], False
    view = view_of("channel", "channel", block)
    assert (view.state, view.busy, view.settled, view.line, view.speed, view.override, view.cycle) == (
        "Running",
        True,
        False,
        2,
        1500.0,
        60.0,
        92,
    )
    assert AxisStateCode.STANDSTILL == 1


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.0, "0:00:00"), (59.9, "0:00:59"), (3600.0, "1:00:00"), (90061.0, "25:01:01")]
)
def test_clock(seconds, text):
    assert clock_text(seconds) == text
