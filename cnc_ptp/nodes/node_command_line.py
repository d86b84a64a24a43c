"""Command line of the unit nodes: `axis MACHINE.yaml x --ros-args …`."""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection
from multiprocessing import parent_process
from typing import Any

import click

from cnc_ptp import KERNEL
from cnc_ptp.errors import WRONG_INPUT, CncError
from cnc_ptp.machine.wiring import UNKNOWN_UNIT, unit_kinds
from cnc_ptp.nodes import process
from cnc_ptp.number_range import STATES_PER_SECOND
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.ros_arguments import split
from cnc_ptp.state.machine_state import CHECKPOINT_SECONDS

MACHINE = click.argument("machine", type=click.Path(dir_okay=False))
NAME = click.argument("name")
RECORDERS = click.option(
    "--recorders", default=0, show_default=True, help="1: a recorder must have found the blocks first."
)
DIALECT = click.option("--dialect", type=click.Choice(("twincat", "iso")), help="Vocabulary of --program.")
STATE_RATE = click.option(
    "--state-rate", type=STATES_PER_SECOND, help="Live states per second, instead of P-MACH-00070."
)
CHECKPOINTS = click.option(
    "--checkpoints",
    type=click.FloatRange(min=0.0),
    default=CHECKPOINT_SECONDS,
    show_default=True,
    help="Machine time in s between two states for the recorder; 0: none.",
)
FREE_RUN = click.option("--free-run", is_flag=True, help="The clock runs free: the node waits for blocks, not ticks.")


def unit_main(node_class: Callable[..., Any], what: str, *more: click.Parameter) -> Callable[[], None]:
    """The `main` of the node of one unit: `<executable> MACHINE.yaml NAME`, with `more` options for its class."""

    @click.command(help=f"Runs the {what} NAME of MACHINE as a ROS node.")
    @MACHINE
    @NAME
    @RECORDERS
    @STATE_RATE
    @CHECKPOINTS
    def command(machine: str, name: str, **options: Any) -> None:
        def make() -> Any:
            node = node_class(read_machine(machine), name, **options)
            node.setup()
            return node

        sys.exit(process.run_unit(make, name=name))

    command.params.extend(more)
    return lambda: call(command)


def call(command: click.Command) -> None:
    """Runs a node's command with the process arguments; those for ROS are its context's object."""
    if KERNEL.remedy and parent_process() is None:  # not one of many nodes of a run
        print(f"{KERNEL}; {KERNEL.remedy}", file=sys.stderr)
    try:
        own, ros = split(sys.argv[1:])
    except CncError as error:
        print(error, file=sys.stderr)
        sys.exit(WRONG_INPUT)
    command.main(args=own, obj=ros)


def require_unit(machine: MachineParameters, name: str, kinds: Collection[str]) -> None:
    """Raises CncError 26111 when the machine has no unit `name` of these kinds."""
    units = unit_kinds(machine)
    if units.get(name) not in kinds:
        known = ", ".join(unit for unit, kind in units.items() if kind in kinds) or "none"
        raise CncError(
            UNKNOWN_UNIT,
            f"the machine has no {' or '.join(kinds)} '{name}'",
            f"the node does not start. Known: {known}",
        )
