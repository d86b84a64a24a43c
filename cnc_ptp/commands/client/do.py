"""`cnc_ptp do`: one command to a unit of a running machine."""

from __future__ import annotations

import signal
from collections.abc import Sequence

from rich.console import Console

from cnc_ptp.commands.client.command_words import read_arguments
from cnc_ptp.commands.client.unit_table import line
from cnc_ptp.commands.console import RUN_FAILED, print_error
from cnc_ptp.errors import CncError
from cnc_ptp.interrupt import EndRequest
from cnc_ptp.nodes.client.latest_blocks import GONE_TEXT
from cnc_ptp.nodes.client.machine_client import NO_ANSWER, MachineClient, arguments_of, connected
from cnc_ptp.nodes.topics import RECORDER
from cnc_ptp.protocol.commands import READING

BEGINNINGS = (
    "move_absolute",
    "move_relative",
    "move_modulo",
    "move_additive",
    "new_target",
    "new_velocity_and_target",
    "start",
    "mdi",
)
"""Commands for which a stop before the end is a failure."""


def do(unit: str, command: str, words: Sequence[str], wait: bool) -> int:
    """Gives the command and prints the answer. Status 1 when it is refused, or fails while it is waited for."""
    with connected() as client:
        if unit == RECORDER:
            return tell_recorder(client, command, words)
        kind = client.require_unit(unit)
        arguments = read_arguments(kind, unit, command, words, arguments_of(kind, unit, command))
        waiting = Waiting(client, unit, whole=command in BEGINNINGS) if wait and kind != "plc" else None
        try:
            answer = client.ask(unit, command, arguments)
        except CncError as error:
            if error.number != NO_ANSWER:
                raise
            print_error(error)
            return RUN_FAILED
        if not answer.accepted:
            print_error(CncError(answer.error_id, answer.message))
            return RUN_FAILED
        console = Console(highlight=False, soft_wrap=True)
        console.print(f"{unit}: {command} accepted, acts at cycle {answer.cycle}", markup=False)
        if command in READING:
            console.print(answer.message, markup=False)
        elif answer.message:
            console.print(f"warning: {answer.message}", style="yellow", markup=False)
        return 0 if waiting is None else waiting.until_settled(answer.cycle)


def tell_recorder(client: MachineClient, command: str, words: Sequence[str]) -> int:
    """It is no unit: what it does has no effect on the machine. Status 1 when it refuses."""
    arguments = read_arguments(RECORDER, "", command, words, arguments_of(RECORDER, "", command))
    try:
        answer = client.ask_recorder(command, arguments)
    except CncError as error:
        print_error(error)
        return RUN_FAILED
    if not answer.accepted:
        print_error(CncError(answer.error_id, answer.message))
        return RUN_FAILED
    console = Console(highlight=False, soft_wrap=True)
    text = "ends before cycle" if command == "stop" else "begins with cycle"
    console.print(f"recorder: {command}: {arguments.get('file', 'the recording')} {text} {answer.cycle}", markup=False)
    if answer.message:
        console.print(f"warning: {answer.message}", style="yellow", markup=False)
    return 0


class Waiting:
    """Waits until a unit has carried out a command."""

    def __init__(self, client: MachineClient, unit: str, *, whole: bool) -> None:
        """`whole`: the motion or program must be finished; a stop before its end is a failure."""
        self._whole = whole
        self._client = client
        self._unit = unit
        self._blocks = client.look_at([unit])

    def until_settled(self, cycle: int) -> int:
        """Returns the exit status; Ctrl-C ends the waiting, not the motion."""
        with EndRequest() as end:
            while not end.given and not self._settled_after(cycle) and not self._blocks.gone:
                self._client.spin_for(0.02)
            if end.given:
                name = signal.Signals(end.number).name
                print(f"{self._unit}: no longer waited for ({name}); it continues")
                return 128 + end.number
        if not self._settled_after(cycle):
            Console(stderr=True, highlight=False).print(f"{self._unit}: {GONE_TEXT}", style="red")
            return RUN_FAILED
        view = self._blocks.view(self._unit)
        assert view is not None
        print(line(view))
        stopped = self._whole and view.stopped
        if stopped:
            Console(stderr=True, highlight=False).print(f"{self._unit}: stopped before its end", style="red")
        return RUN_FAILED if view.error_id or stopped else 0

    def _settled_after(self, cycle: int) -> bool:
        view = self._blocks.view(self._unit)
        return view is not None and view.cycle > cycle and (view.settled or view.error_id != 0)
