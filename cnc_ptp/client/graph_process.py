"""`python -m cnc_ptp.client.graph_process PIPE OPTIONS`: the process of a graph that a client has started.

It writes JSON lines to the pipe: that the clock ticks, why it did not start, what went wrong until its end.
"""

from __future__ import annotations

import json
import os
import select
import sys
from typing import Any

import click

from cnc_ptp.errors import WRONG_INPUT, CncError
from cnc_ptp.nodes.forked import end_with, start_server
from cnc_ptp.ros_arguments import namespace_option


@click.command()
@click.argument("pipe", type=int)
@click.argument("options")
@namespace_option
def command(pipe: int, options: str) -> None:
    """Runs the graph; OPTIONS are those of RunOptions, and whether it is `composed`, as JSON."""
    end_with(sys.stdin.fileno())
    if select.select([sys.stdin], [], [], 0.0)[0]:
        return  # the client has ended before the signal was ordered
    given = json.loads(options)
    composed = given.pop("composed")
    if not composed:
        start_server()  # first: it imports for all nodes, which takes as long as what comes now
    try:
        failures = run(pipe, given, composed=composed)
    except CncError as error:
        tell(pipe, refused=[error.number, error.reason, error.effect, error.where, dict(error.values)])
        sys.exit(WRONG_INPUT)
    tell(pipe, failures=failures)


def run(pipe: int, options: dict[str, Any], *, composed: bool) -> list[str]:
    """Runs the graph to its end; what went wrong with it."""
    from cnc_ptp.nodes.composed import run_composed
    from cnc_ptp.nodes.monitor import RunMonitor
    from cnc_ptp.nodes.supervisor import RunOptions, Supervisor
    from cnc_ptp.parameters import read_machine
    from cnc_ptp.recording.recorder_options import RecorderOptions

    told = False

    def show(monitor: RunMonitor) -> None:
        nonlocal told
        if monitor.cycle and not told:
            told = True
            tell(pipe, running=True)

    machine = read_machine(options["machine"])
    given = options.pop("recorder", None)
    recorder = None if given is None else RecorderOptions(**given)
    run_options = RunOptions(**options, recorder=recorder, stay=True)
    if composed:
        return run_composed(machine, run_options, show=show)[1]
    supervisor = Supervisor(machine, run_options, show=show)
    supervisor.run()
    return supervisor.failures


def tell(pipe: int, **report: Any) -> None:
    os.write(pipe, json.dumps(report, default=str).encode() + b"\n")


if __name__ == "__main__":
    command()
