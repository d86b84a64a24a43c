"""`cnc_ptp jog`: moves an axis of a running machine for as long as the command runs."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from rich.console import Console

from cnc_ptp import msg
from cnc_ptp.axis.jog_commands import JOG
from cnc_ptp.commands.console import RUN_FAILED
from cnc_ptp.interrupt import EndRequest
from cnc_ptp.nodes.bridge.jog_topics import PATIENCE as SILENCE
from cnc_ptp.nodes.bridge.jog_topics import free_run_text, second_client_text
from cnc_ptp.nodes.client.jog_sender import PERIOD, JogSender
from cnc_ptp.nodes.client.latest_blocks import GONE_TEXT
from cnc_ptp.nodes.client.machine_client import PATIENCE, MachineClient, connected
from cnc_ptp.nodes.process import take_priority
from cnc_ptp.nodes.topics import COMMAND, EVENT, PLC_INPUT
from cnc_ptp.protocol.axis_states import AxisStateCode, state_name
from cnc_ptp.protocol.blocks import Severity
from cnc_ptp.protocol.unit_view import UnitView

JOGS = state_name(AxisStateCode.CONTINUOUS_MOTION)
DELAY = 0.03
"""Seconds from a block of the axis to the effect of a message."""
STEADY = 1.001
"""A speed that grows by less from block to block has reached its final value."""
START = 1.0
"""Seconds after which the jog of an axis that does not move ends."""
STOP = 30.0
"""Seconds for the ramp at the end."""


def jog(axis: str, direction: str, speed: float, distance: float | None, seconds: float | None) -> int:
    """Jogs until Ctrl-C, a distance (mm, deg) or a time (s), and waits until the axis is at a standstill.

    Status 1 when the axis refuses, is in error, or is not at a standstill in the end, and after a suspension.
    """
    with connected() as client, EndRequest() as end:
        client.require_unit(axis, ("axis",))
        jogger = Jogger(client, axis, speed if direction == "+" else -speed)
        if not jogger.ready():
            return jogger.report("the machine does not listen, or shows nothing of the axis; nothing has moved")
        take_priority()  # a jog ends after 0.2 s of silence: other busy programs must not cause that
        jogger.run(lambda: end.given, distance, seconds)
        return jogger.end()


class Jogger:
    """Sends jog messages and follows the axis."""

    def __init__(self, client: MachineClient, axis: str, velocity: float) -> None:
        self._client = client
        self._axis = axis
        self._velocity = velocity
        self._blocks = client.look_at([axis])
        self._sender = JogSender(client, axis)
        self._refused = self._stalled = self._ignored = False
        self._errors = Console(stderr=True, highlight=False, soft_wrap=True)
        client.create_subscription(msg.CommandRecord, COMMAND, self._on_command, PLC_INPUT)
        client.create_subscription(msg.Event, EVENT, self._on_event, PLC_INPUT)

    def ready(self) -> bool:
        """The PLC is subscribed, and the axis publishes its position."""

        def is_ready() -> bool:
            return self._sender.is_heard and self._blocks.view(self._axis) is not None

        return bool(self._client.spin_until(is_ready, PATIENCE))

    def run(self, ended: Callable[[], bool], distance: float | None, seconds: float | None) -> None:
        """Sends the velocity until it is enough, the axis has stopped, or it refuses."""
        started_at, start = time.monotonic(), self._place().position or 0.0
        end = JogEnd(distance)
        moved, sent = False, started_at
        deadline = math.inf if seconds is None else started_at + seconds
        while not ended() and not self._refused and not self._blocks.gone and time.monotonic() < deadline:
            if self._note_stall(sent):
                return
            sent = time.monotonic()
            self._sender.send(self._velocity)
            self._client.spin_until(ended, PERIOD if distance is None else PERIOD / 5.0)
            view = self._place()
            moved = moved or view.state == JOGS
            stopped = view.state != JOGS and (moved or time.monotonic() - started_at > START)
            gone = abs((view.position or 0.0) - start)
            due = end.is_due(gone, abs(view.speed or 0.0), view.cycle)
            if self._note_stall(sent) or stopped or due:
                return

    def _note_stall(self, sent: float) -> bool:
        """The machine has ended the jog since then; that this process continues is no reason to move again."""
        self._stalled = time.monotonic() - sent > SILENCE
        if self._stalled:
            self.report(f"this command was suspended for more than {SILENCE:g} s; the jog has ended")
        return self._stalled

    def end(self) -> int:
        """Ends the jog, waits for standstill, prints the position; returns the exit status."""
        if self._ignored:
            return self.report("the jog is ignored: another client jogs the axis, or the machine is in free run")
        cycle = self._place().cycle
        self._sender.send(0.0)

        def stands() -> bool:
            return self._place().cycle > cycle + 100 and not self._place().busy

        self._client.spin_until(lambda: stands() or self._blocks.gone, STOP)
        if self._blocks.gone:
            return self.report(GONE_TEXT)
        view = self._place()
        where = f"{view.position:.3f} {view.unit}" if view.position is not None else ""
        print(f"{self._axis}: {view.state} at {where}")
        return RUN_FAILED if self._refused or self._stalled or view.error_id or not stands() else 0

    def report(self, text: str) -> int:
        self._errors.print(f"{self._axis}: {text}", style="red", markup=False)
        return RUN_FAILED

    def _place(self) -> UnitView:
        view: UnitView | None = self._blocks.view(self._axis)
        assert view is not None
        return view

    def _on_command(self, message: msg.CommandRecord) -> None:
        if message.target == self._axis and message.command == JOG and self._sender.has_begun:
            self._refused = self._refused or not message.accepted
            if message.message and message.accepted:
                self._errors.print(f"warning: {message.message}", style="yellow", markup=False)

    def _on_event(self, message: msg.Event) -> None:
        axis, client = self._axis, self._client.get_name()
        if message.text in (free_run_text(axis), second_client_text(axis, client)):
            self._ignored = self._refused = True
        if message.source == self._axis and message.severity > Severity.INFO and self._sender.has_begun:
            self._errors.print(f"P-ERR-{message.error_id} {message.text}", style="yellow", markup=False)


class JogEnd:
    """When a jog over a distance must end: its last ramp is as long as the one at the start was."""

    def __init__(self, distance: float | None) -> None:
        """`distance` in mm (deg), None = any."""
        self._distance = distance
        self._ramp: float | None = None
        self._seen = (0, 0.0, 0.0)

    def is_due(self, gone: float, speed: float, cycle: int) -> bool:
        """`gone` mm (deg) from the start, at `speed` in `cycle`: an end now leads to the distance, roughly."""
        if self._distance is None:
            return False
        last_cycle, last_gone, last_speed = self._seen
        if cycle > last_cycle:
            self._seen = cycle, gone, speed
            if self._ramp is None and 0.0 < speed <= last_speed * STEADY:
                self._ramp = last_gone
        ramp = gone if self._ramp is None else self._ramp
        return gone + ramp + speed * DELAY >= self._distance
