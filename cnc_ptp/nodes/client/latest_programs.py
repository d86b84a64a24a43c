"""The newest program states of channels, for people."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rclpy.node import Node

from cnc_ptp import msg
from cnc_ptp.nc.block_search import base_name
from cnc_ptp.nodes.topics import LATEST, program_topic


class LatestPrograms:
    """Keeps the newest ProgramState of channels."""

    def __init__(self, node: Node, channels: Iterable[str]) -> None:
        self._newest: dict[str, Any] = {}
        self._channels = list(channels)
        for channel in self._channels:
            node.create_subscription(msg.ProgramState, program_topic(channel), self._keep, LATEST)

    def _keep(self, message: Any) -> None:
        self._newest[message.channel] = message

    @property
    def complete(self) -> bool:
        """Every channel has published."""
        return len(self._newest) == len(self._channels)

    def lines(self) -> list[str]:
        """One for each channel with a program or manual blocks."""
        states = (self._newest[channel] for channel in self._channels if channel in self._newest)
        return [program_text(state) for state in states if state.program or state.manual]


def program_text(state: Any) -> str:
    """`state`: ProgramState. Its program, and while one runs line, callers, percent and time left."""
    name = "manual blocks" if state.manual else base_name(state.program)
    if not state.active:
        return f"{state.channel}: {name}"
    where = f" of {base_name(state.file)}" if not state.manual and base_name(state.file) != name else ""
    called = "".join(f", called in {base_name(call)}" for call in state.calls)
    left = f", {state.time_left:.0f} s left" if state.time_left >= 0.0 else ""
    return f"{state.channel}: {name}, line {state.line}{where} '{state.text}'{called}, {state.percent:.0f} %{left}"
