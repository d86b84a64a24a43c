"""The message on /diagnostics about a unit, without a graph: the worst finding first, numbers with their units."""

import re
from pathlib import Path

import pytest
from diagnostic_msgs.msg import DiagnosticStatus

from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes.unit.diagnostics import UnitDiagnostics
from cnc_ptp.nodes.unit.lateness import Lateness
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import Command, CycleTick, Event, PlcBlock, Severity

CONFIG = Path(__file__).parents[2] / "config"
PTP, MILL = CONFIG / "ptp.yaml", CONFIG / "mill.yaml"


class Watched:
    """A unit alone, with its health."""

    def __init__(self, machine, name, unit="mm"):
        self.runner = UnitRunner(build_unit(read_machine(machine), name), watchdog_cycles=10**9)
        self.health = UnitDiagnostics(self.runner.unit, block_ms=10.0, length_unit=unit)

    def run(self, blocks, **inputs):
        for _ in range(blocks):
            tick = CycleTick(self.runner.next_cycle, 10)
            self.runner.apply(tick, inputs)
            block = self.runner.compute(tick, inputs)
            for event in self.runner.unit.take_events():
                self.health.note(event)
            self.health.add_block(block)
            self.block = block

    def command(self, name, **arguments):
        record = self.runner.command(Command(self.runner.unit.name, name, arguments))
        assert record.accepted, record.message

    def status(self, came_twice=0):
        status = self.health.status(came_twice)
        return status.level, status.message, {value.key: float(value.value) for value in status.values}


def test_all_is_well():
    axis = Watched(PTP, "x")
    assert axis.status()[:2] == (DiagnosticStatus.OK, "no block yet")
    axis.run(3)
    assert axis.status() == (
        DiagnosticStatus.OK,
        "Standstill",
        {
            "blocks": 3.0,
            "lost blocks": 0.0,
            "blocks that came twice": 0.0,
            "following error, largest [mm]": 0.0,
            "following error of its limit [%]": 0.0,
        },
    )
    axis.command("move_absolute", target=100.0, velocity=100.0)
    axis.run(30)
    level, message, values = axis.status()
    assert (level, message) == (DiagnosticStatus.OK, "DiscreteMotion")
    assert values["following error, largest [mm]"] > 0.0


def test_an_error_is_told_with_its_text_until_it_is_reset():
    axis = Watched(PTP, "x")
    axis.command("upstream_lost", source="plc")
    axis.run(2)
    text = "axis x: no block of 'plc' came within the watchdog time; the axis stops on its own ramp (ErrorStop)"
    assert axis.status()[:2] == (DiagnosticStatus.ERROR, f"ErrorStop, P-ERR-26101 {text}")
    axis.command("reset")
    axis.run(2)
    assert axis.status()[:2] == (DiagnosticStatus.OK, "Standstill")


def test_the_worst_comes_first():
    axis = Watched(PTP, "x")
    axis.run(1)
    axis.health.lost_blocks = 2
    axis.health.add_lateness(12_340)
    level, message, values = axis.status(came_twice=5)
    assert level == DiagnosticStatus.ERROR
    assert message == "2 blocks lost; 5 blocks came twice; a block came 12.3 ms late, it takes 10 ms"
    assert (values["lost blocks"], values["blocks that came twice"]) == (2.0, 5.0)
    assert (values["lateness p50 [ms]"], values["lateness, largest [ms]"]) == (12.4, 12.34)


@pytest.mark.parametrize("late_us", [9_990, 10_000])
def test_lateness_is_a_warning_above_a_block_and_for_one_report(late_us):
    axis = Watched(PTP, "x")
    axis.run(1)
    axis.health.add_lateness(late_us)
    assert axis.status()[:2] == (DiagnosticStatus.OK, "Standstill")
    axis.health.add_lateness(25_000)
    warning = (DiagnosticStatus.WARN, "a block came 25.0 ms late, it takes 10 ms")
    assert [axis.status()[:2], axis.status()[:2]] == [warning, (DiagnosticStatus.OK, "Standstill")]


@pytest.mark.parametrize(("kind", "limit"), [(4, 10.0), (4, 2.5)])
@pytest.mark.parametrize("part", [0.5, 0.79, 0.82, 0.99])
def test_a_following_error_near_its_limit_is_a_warning(tmp_path, part, kind, limit):
    """At constant velocity the following error is v/Kv; the limit of type 4 is P-AXIS-00168."""
    monitoring = f"kv: 50000\n        slep_ueberw_typ: {kind}\n        slep_max: {limit * 1e4:.0f}"
    path = tmp_path / "monitored.yaml"
    path.write_text(PTP.read_text().replace("kv: 50000", monitoring, 1))
    kv = 500.0
    axis = Watched(path, "x")
    axis.command("move_absolute", target=90_000.0, velocity=part * limit * kv)
    axis.run(200)
    axis.status()
    axis.run(5)
    level, message, values = axis.status()
    share = values["following error of its limit [%]"]
    assert share == pytest.approx(100.0 * part, abs=0.1)
    if share >= 80.0:
        assert (level, message) == (DiagnosticStatus.WARN, f"following error at {share:.0f} % of its limit")
    else:
        assert (level, message) == (DiagnosticStatus.OK, "DiscreteMotion")


def test_a_spindle_and_a_channel_say_what_they_do():
    spindle = Watched(MILL, "s", "deg")
    spindle.command("start", direction="cw", speed_rpm=500.0)
    spindle.run(5)
    level, message, values = spindle.status()
    assert (level, message) == (DiagnosticStatus.OK, "ContinuousMotion")
    assert "following error, largest [deg]" in values
    channel = Watched(MILL, "channel")
    channel.run(1)
    assert channel.status()[:2] == (DiagnosticStatus.OK, "Idle")


def test_a_channel_shows_how_many_blocks_it_has_ahead(tmp_path):
    """100 blocks come in a block of 10 cycles; of a known program all are there."""
    path = tmp_path / "m.yaml"
    limits = "interpreter: {checked_text: 1000, blocks_per_cycle: 1}"
    path.write_text(MILL.read_text().replace("    spdl_anzahl: 1\n", f"    spdl_anzahl: 1\n    {limits}\n"))
    channel = Watched(path, "channel")
    lines = "\n".join(f"G01 X{0.02 * n:.2f}" for n in range(1, 2000))
    channel.command("load", program="a.nc", text=f"G359 F6000\n{lines}\nM30")
    channel.command("start")
    channel.run(30)
    level, message, values = channel.status()
    reason = "the path is slower because the interpreter does not keep up"
    assert (level, message) == (DiagnosticStatus.WARN, reason)
    assert values["buffer of interpreted blocks, least [%]"] == 0.0 and 0.0 < values["path that is known [mm]"] < 5.0
    channel.command("reset")
    channel.run(30)
    assert channel.status()[0] == DiagnosticStatus.OK
    channel.run(1)
    assert channel.status()[2]["path that is known [mm]"] == 0.0


@pytest.mark.parametrize(
    ("fields", "result"),
    [
        ({}, (DiagnosticStatus.OK, "running")),
        ({"run_done": True}, (DiagnosticStatus.OK, "the run has ended")),
        ({"run_failed": True}, (DiagnosticStatus.ERROR, "the run has failed")),
    ],
)
def test_the_plc_tells_how_the_run_goes(fields, result):
    plc = Watched(PTP, "plc")
    plc.health.add_block(PlcBlock(0, 10, **fields))
    assert plc.status()[:2] == result


def test_an_error_without_a_text_has_its_number():
    axis = Watched(PTP, "x")
    axis.command("group_error", source="y", error=26101)
    axis.run(1)
    assert re.fullmatch(r"ErrorStop, P-ERR-\d+ .+", axis.status()[1])
    axis.health = UnitDiagnostics(axis.runner.unit, block_ms=10.0, length_unit="mm")  # it has not heard the event
    axis.health.note(Event(0, "x", Severity.ERROR, 4711, "another one"))
    axis.health.add_block(axis.block)
    assert re.fullmatch(r"ErrorStop, P-ERR-\d+", axis.status()[1])


def test_histograms_of_nodes_add_up():
    total, first, second = Lateness(), Lateness(), Lateness()
    for late in (0, 99, 100, 950):
        first.add(late)
    second.add(120_050)
    message = first.message("x")
    assert (message.source, message.step_us, list(message.step), list(message.blocks)) == (
        "x",
        100,
        [0, 1, 9],
        [2, 1, 1],
    )
    total.merge(message)
    total.merge(second.message("y"))
    assert (total.counts.total(), total.largest_us, total.percentile_us(50.0)) == (5, 120_050, 200)
