"""Commissioning that takes a while: a command of cnc_ptp in its own process, on the machine file alone."""

from __future__ import annotations

import asyncio
import contextlib
import os
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from cnc_ptp.client.faults import unknown_unit
from cnc_ptp.commissioning import progress_lines
from cnc_ptp.errors import CncError
from cnc_ptp.web.commissioning.changed_machine import write_changed
from cnc_ptp.web.numbers import BAD_MESSAGE, NOT_IDENTIFIED
from cnc_ptp.web.protocol import NOTHING, Message, error_fields, field

NICENESS = 10
MOST_TEXT = 1 << 20
KEPT = 10
"""Results that can still be accepted."""
IDENTIFIED = ("friction", "dynamics")
Tell = Callable[[Mapping[str, Any]], None]


class Tasks:
    """Tasks of all pages, one at a time: they need a processor."""

    def __init__(self, machine_file: str | None) -> None:
        """`machine_file` of the machine that runs; None: it is not known, and nothing can be identified."""
        self._file = machine_file
        self._last = 0
        self._running: dict[int, asyncio.subprocess.Process | None] = {}
        """None before its process is there."""
        self._cancelled: set[int] = set()
        self._results: dict[int, str] = {}

    @property
    def machine_file(self) -> str:
        """Raises CncError 26256."""
        if self._file is None:
            reason = "the server does not know the machine file"
            raise CncError(NOT_IDENTIFIED, reason, f"{NOTHING}; start it with --machine FILE")
        return self._file

    def identify(self, message: Message, axes: list[str]) -> list[str]:
        """The words of the command. Raises CncError 26111, 26233, 26256."""
        axis, what = field(message, "axis", "text"), field(message, "what", "text")
        if axis not in axes:
            raise unknown_unit(axis, axes, "axis")
        if what not in IDENTIFIED:
            raise CncError(BAD_MESSAGE, f"identify: what = '{what[:40]}' is not {' or '.join(IDENTIFIED)}", NOTHING)
        return ["identify", what, axis, "--machine", self.machine_file]

    def circle(self, message: Message) -> list[str]:
        """The words of the command. Raises CncError 26233, 26256."""
        radius, feed = field(message, "radius", "number"), field(message, "feed", "number")
        plane = field(message, "plane", "text", "XY")
        if plane not in ("XY", "ZX", "YZ"):
            raise CncError(BAD_MESSAGE, f"circle: plane = '{plane[:40]}' is not XY, ZX or YZ", NOTHING)
        words = ["circle", self.machine_file, "--radius", str(float(radius)), "--feed", str(float(feed))]
        words += ["--plane", plane]
        words += ["--feedforward"] if field(message, "feedforward", "switch", False) else []
        return words

    def begin(self, words: list[str], tell: Tell) -> tuple[int, asyncio.Task[None]]:
        """Its number, and what waits for its end. Raises CncError 26256 while another one runs."""
        if self._running:
            raise CncError(NOT_IDENTIFIED, "another task runs", f"{NOTHING}; wait for its end, or cancel it")
        self._last += 1
        self._running[self._last] = None
        return self._last, asyncio.create_task(self._run(self._last, words, tell))

    async def _run(self, number: int, words: list[str], tell: Tell) -> None:
        """Whatever happens, there is a result."""
        try:
            output, found, status = await self._output(number, words, tell)
        except Exception as error:  # no process, no space …
            output, found, status = repr(error), "", 1
        finally:
            del self._running[number]
        end = "was cancelled" if number in self._cancelled else f"has ended with status {status}"
        self._cancelled.discard(number)
        if status or not found:
            refused = error_fields(CncError(NOT_IDENTIFIED, f"task {number} {end}", "nothing was found"))
            tell({"type": "result", "task": number, "ok": False, "output": output, **refused})
            return
        kind = "picture" if words[0] == "circle" else "values"
        if kind == "values":
            self._results[number] = found
            while len(self._results) > KEPT:
                del self._results[next(iter(self._results))]
        tell({"type": "result", "task": number, "ok": True, "output": output, kind: found})

    async def _output(self, number: int, words: list[str], tell: Tell) -> tuple[str, str, int]:
        """Its report, what it has found, its status."""
        with tempfile.TemporaryDirectory() as folder:
            output = Path(folder) / ("circle.svg" if words[0] == "circle" else "values.yaml")
            command = [sys.executable, "-m", "cnc_ptp", *words, "-o", str(output)]
            process = await asyncio.create_subprocess_exec(
                *command,
                stdin=asyncio.subprocess.DEVNULL,
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.STDOUT,
                preexec_fn=be_nice,
                env=os.environ | {progress_lines.WANTED: "1"},
            )
            self._running[number] = process
            if number in self._cancelled:
                process.terminate()
            tell({"type": "progress", "task": number, "text": f"{words[0]} runs"})
            try:
                text = await self._read(number, process, tell)
                status = await process.wait()
            finally:
                with contextlib.suppress(ProcessLookupError):
                    process.kill()
            return text, output.read_text(encoding="utf-8") if output.exists() else "", status

    @staticmethod
    async def _read(number: int, process: asyncio.subprocess.Process, tell: Tell) -> str:
        """Its report; of a long one the end is kept. Each piece is sent as progress, with `percent` if it says so."""
        assert process.stdout is not None
        text = b""
        while piece := await process.stdout.read(1 << 16):
            text = (text + piece)[-MOST_TEXT:]
            lines = piece.decode(errors="replace").strip().splitlines()
            if lines:
                percent = progress_lines.percent_of(lines[-1])
                how_far = {} if percent is None else {"percent": percent}
                tell({"type": "progress", "task": number, "text": lines[-1], **how_far})
        lines = text.decode(errors="replace").splitlines(keepends=True)
        return "".join(line for line in lines if progress_lines.percent_of(line) is None)

    def cancel(self, number: int) -> None:
        """Raises CncError 26256 for a task that does not run."""
        if number not in self._running:
            raise CncError(NOT_IDENTIFIED, f"task {number} does not run", NOTHING)
        self._cancelled.add(number)
        process = self._running[number]
        if process is not None:
            process.terminate()

    def accept(self, number: int, name: str) -> str:
        """Writes a machine file with the result beside that of the machine; its path.

        Raises CncError 26254, 26256, ParameterError.
        """
        if number not in self._results:
            raise CncError(NOT_IDENTIFIED, f"task {number} has no result", NOTHING)
        return str(write_changed(Path(self.machine_file), self._results[number], name))

    def close(self) -> None:
        for process in self._running.values():
            if process is not None:
                with contextlib.suppress(ProcessLookupError):
                    process.terminate()


def be_nice() -> None:
    os.nice(NICENESS)
