"""Every topic runs in its shortest form; what it measures is not judged."""

import math
import re
from pathlib import Path

import pytest

from bench import (
    client,
    control,
    graph,
    interpreter,
    lists,
    lookahead,
    motion,
    offline,
    plc,
    recording,
    smoothing,
    spindles,
    streaming,
    sweep,
    what_if,
)
from bench.figures import Effort
from bench.graph_run import SUPERVISOR, GraphRun, Watch, node_name, run_graph
from bench.jobs import MACHINE, long_program
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.run_entries import check_program
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import read_machine

SMALLEST = Effort(runs=1, size=0.002, graph_seconds=1.0)


@pytest.mark.long
@pytest.mark.parametrize(
    "topic", [interpreter, motion, control, smoothing, lookahead, streaming, recording, offline, spindles, lists, sweep]
)
def test_topic_yields_figures(topic) -> None:
    said: list[str] = []
    figures = list(topic.figures(SMALLEST, said.append))
    assert said
    assert len({figure.name for figure in figures}) == len(figures) >= 2
    assert all(math.isfinite(figure.value) and figure.unit for figure in figures)


def test_a_what_if_begins_in_the_middle_of_commands() -> None:
    said: list[str] = []
    figures = [*what_if.figures(Effort(runs=1, size=0.01, graph_seconds=1.0), said.append)]
    assert said and all(math.isfinite(figure.value) and figure.value > 0.0 for figure in figures)
    [started] = [figure for figure in figures if figure.goal is not None]
    assert re.search(r"of 8 axes with \d\d commands", started.name)


def test_the_session_of_a_client_is_carried_out() -> None:
    assert client.offline_seconds() > 0.0


def test_long_program_suits_the_machine() -> None:
    check_program(read_machine(MACHINE), long_program(600.0), "long.nc")


def test_long_program_is_long_enough(tmp_path: Path) -> None:
    program = tmp_path / "long.nc"
    program.write_text(long_program(10.0))
    assert offline.run_offline(MACHINE, program=str(program)).machine_seconds > 10.0


def test_graph_composed_in_one_process(tmp_path: Path) -> None:
    program, record = tmp_path / "long.nc", str(tmp_path / "run.mcap")
    program.write_text(long_program(10.0))
    run = run_graph(MACHINE, str(program), seconds=1.0, record=record, free_run=True, composed=True)
    assert run.failures == []
    assert run.startup > 0.0
    assert graph.missing_samples(record) == 0


@pytest.mark.long
def test_a_plc_beside_the_graph(monkeypatch: pytest.MonkeyPatch) -> None:
    """Four topics at once; how fast, is not judged."""
    monkeypatch.setenv("ROS_DOMAIN_ID", "0")  # it takes a domain of its own, which ends with the test
    figures = {figure.name: figure for figure in plc.figures(SMALLEST, print)}
    assert 0.0 < figures["override messages per second and topic"].value <= 1000.0
    assert figures["blocks lost"].value == figures["samples missing in the recording"].value == 0.0
    assert figures["topics whose newest value has won"].value == 4


def test_figures_of_a_watched_run() -> None:
    run = GraphRun(
        startup=2.0,
        wall=10.0,
        cycles=10_000,
        cpu={"axis x": 1.0, "axis y": 2.0, "spindle s": 1.2, "clock": 0.5, SUPERVISOR: 4.0},
        pss_mb={"axis x": 50.0, "axis y": 50.0, "spindle s": 50.0, "clock": 40.0, SUPERVISOR: 60.0},
        blocks=3000,
        lateness_p99_ms=12.0,
    )
    figures = {(figure.name, figure.unit): figure for figure in [*graph.real_time(run), *graph.resources(run)]}
    assert figures["4 nodes together", "cores"].value == pytest.approx(0.47)
    assert figures["memory of 4 nodes (PSS)", "MB"].value == 190.0
    assert figures["a spindle node, in axis nodes", ""].value == pytest.approx(0.8)
    assert figures["block lateness p99", "ms"].met is False
    assert [figure.value for figure in graph.rate("free run", run)] == [1000.0, pytest.approx(0.87)]


def test_without_spindles_nothing_is_set_beside_an_axis() -> None:
    assert list(graph.spindle_beside_axis({"axis x": 1.0, "clock": 0.5})) == []


def test_sixteen_spindles_turn_as_the_job_says(tmp_path: Path) -> None:
    machine = read_machine(spindles.machine_file(tmp_path / "spindles.yaml"))
    for speeds, hold in ((spindles.STEADY, 5.0), (spindles.RAMPS, 0.8)):
        offline_machine = OfflineMachine(machine, build_units(machine, scenario=spindles.entries(speeds, hold, 1.0)))
        for _ in range(50):
            outputs = offline_machine.tick()
        turning = [outputs[f"s{n}"].block.set_speed_rpm[-1] for n in range(1, spindles.SPINDLES + 1)]
        assert min(map(abs, turning)) >= 500.0 and min(turning) < 0.0 < max(turning)
        assert not any(event.severity for output in outputs.values() for event in output.events)


def test_failures_are_told() -> None:
    run = GraphRun(failures=["P-ERR-26104 node 'x' ended", "P-ERR-26104 node 'x' ended"])
    told = [(figure.name, figure.value, figure.met) for figure in graph.rate("free run", run)]
    assert told == [("P-ERR-26104 node 'x' ended", 2, False)]


def test_a_run_too_short_to_be_watched_has_no_cores() -> None:
    run = Watch(memory_at=1e9, own=SUPERVISOR).finish()
    assert [figure.name for figure in graph.resources(run)] == ["start-up, from the call to the first cycle"]
    assert list(graph.rate("free run", run)) == []


def test_watch_takes_samples_when_the_run_has_settled(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter(range(100))
    monkeypatch.setattr("bench.graph_run.time.monotonic", lambda: float(next(clock)))
    watch = Watch(memory_at=3000, own=SUPERVISOR)
    for cycle in (0, 10, 2000, 3000, 4000):
        watch.look(cycle)
    run = watch.finish()
    assert (run.startup, run.wall, run.cycles) == (2.0, 2.0, 2000)
    assert run.pss_mb[SUPERVISOR] > 1.0


def test_names_of_node_processes() -> None:
    assert node_name(["python", "-m", "cnc_ptp.nodes.axis", "mill.yaml", "x"]) == "axis x"
    assert node_name(["python", "-m", "cnc_ptp.nodes.clock", "mill.yaml"]) == "clock"
