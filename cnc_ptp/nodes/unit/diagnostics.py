"""Diagnostics of a unit: its faults, or its state, and figures."""

from __future__ import annotations

from collections.abc import Iterator

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

from cnc_ptp.channel.channel_unit import ChannelUnit
from cnc_ptp.nodes.unit.lateness import Lateness
from cnc_ptp.protocol.axis_states import AxisStateCode, state_name
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, CycleBlock, Event, PlcBlock, Severity, SpindleBlock
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.protocol.unit import Unit
from cnc_ptp.recording import node_figures as figures

NEAR_LIMIT = 0.8
"""Part of its limit from which a following error is a warning."""
Finding = tuple[bytes, str]
"""A level of DiagnosticStatus and what is wrong."""


class UnitDiagnostics:
    """Gathers the diagnostics of a unit's node; a report covers the time since the previous one."""

    def __init__(self, unit: Unit, *, block_ms: float, length_unit: str) -> None:
        """`block_ms`: time of a block; `length_unit` of following errors: mm or deg."""
        self._unit = unit
        self._block_ms = block_ms
        self._length_unit = length_unit
        self._block: CycleBlock | None = None
        self._blocks = 0
        self._error_texts: dict[int, str] = {}
        self._following_error = 0.0
        self._lag_share = 0.0
        self._latest_ms = 0.0
        self._least_fill = 1.0
        self.lateness = Lateness()
        self.lost_blocks = 0

    def add_block(self, block: CycleBlock) -> None:
        """The block that was computed last."""
        self._block = block
        self._blocks += 1
        if isinstance(self._unit, ChannelUnit):
            self._least_fill = min(self._least_fill, self._unit.blocks_ahead[0])
        errors: list[float] = []
        if isinstance(block, AxisBlock):
            errors = block.following_error
        elif isinstance(block, SpindleBlock):
            errors = block.following_error_deg
        if errors:
            self._following_error = max(self._following_error, max(errors), -min(errors))
            self._lag_share = max(self._lag_share, self._unit.lag_share(block))

    def add_lateness(self, lateness_us: int) -> None:
        """How late the block was ready."""
        self.lateness.add(lateness_us)
        self._latest_ms = max(self._latest_ms, lateness_us / 1000.0)

    def note(self, event: Event) -> None:
        """Keeps the text of errors: blocks hold their number only."""
        if event.severity == Severity.ERROR:
            self._error_texts[event.error_id] = event.text

    def status(self, came_twice: int) -> DiagnosticStatus:
        """The report; `came_twice`: ticks and blocks that did so."""
        findings = sorted(self._findings(came_twice), reverse=True, key=lambda finding: finding[0])
        level = findings[0][0] if findings else DiagnosticStatus.OK
        message = "; ".join(text for _, text in findings) or self._state()
        values = [KeyValue(key=key, value=value) for key, value in self._values(came_twice).items()]
        self._latest_ms = self._lag_share = 0.0
        self._least_fill = 1.0
        return DiagnosticStatus(
            name=self._unit.name, level=level, hardware_id="cnc_ptp", message=message, values=values
        )

    def _findings(self, came_twice: int) -> Iterator[Finding]:
        block = self._block
        if isinstance(block, PlcBlock):
            if block.run_failed:
                yield DiagnosticStatus.ERROR, "the run has failed"
        elif block is not None and block.error_id[-1]:
            error_id = block.error_id[-1]
            text = self._error_texts.get(error_id, "")
            yield DiagnosticStatus.ERROR, f"{self._state()}, P-ERR-{error_id} {text}".rstrip()
        if self.lost_blocks:
            yield DiagnosticStatus.ERROR, f"{self.lost_blocks} blocks lost"
        if came_twice:
            yield DiagnosticStatus.ERROR, f"{came_twice} blocks came twice"
        if self._lag_share >= NEAR_LIMIT:
            yield DiagnosticStatus.WARN, f"following error at {self._lag_share * 100.0:.0f} % of its limit"
        if isinstance(self._unit, ChannelUnit) and self._unit.runs_out:
            yield DiagnosticStatus.WARN, "the path is slower because the interpreter does not keep up"
        if self._latest_ms > self._block_ms:
            yield DiagnosticStatus.WARN, f"a block came {self._latest_ms:.1f} ms late, it takes {self._block_ms:g} ms"

    def _state(self) -> str:
        block = self._block
        if block is None:
            return "no block yet"
        if isinstance(block, PlcBlock):
            return "the run has ended" if block.run_done else "running"
        if isinstance(block, ChannelBlock):
            name = state_name(ChannelStateCode(block.state[-1]))
            return f"{name}, line {block.line[-1]}" if block.line[-1] else name
        return state_name(AxisStateCode(block.state[-1]))

    def _values(self, came_twice: int) -> dict[str, str]:
        values = {
            figures.BLOCKS: str(self._blocks),
            figures.LOST_BLOCKS: str(self.lost_blocks),
            figures.CAME_TWICE: str(came_twice),
        }
        if self.lateness.counts:
            values |= {
                figures.LATENESS_P50: f"{self.lateness.percentile_us(50.0) / 1000.0:.1f}",
                figures.LATENESS_P99: f"{self.lateness.percentile_us(99.0) / 1000.0:.1f}",
                figures.LATENESS_MAX: f"{self.lateness.largest_us / 1000.0:.3f}",
            }
        if isinstance(self._block, (AxisBlock, SpindleBlock)):
            values[figures.following_error(self._length_unit)] = str(self._following_error)
            values[figures.LAG_OF_LIMIT] = f"{self._lag_share * 100.0:.1f}"
        if isinstance(self._unit, ChannelUnit):
            values[figures.BUFFER_FILL] = f"{self._least_fill * 100.0:.0f}"
            values[figures.PATH_AHEAD] = f"{self._unit.blocks_ahead[1]:.3f}"
        return values
