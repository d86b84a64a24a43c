"""The recorder of a machine: recordings that begin and end while it runs, and snapshots of its last seconds."""

from __future__ import annotations

import os
from os import PathLike, fspath
from typing import Any

from cnc_ptp.client.job import Answer
from cnc_ptp.client.session import Session

Path = str | PathLike[str]


class Recorder:
    """`m.recorder`; one recording is written at a time, besides snapshots, and nothing that exists is overwritten.

    Files are relative to the working directory of this program; with `split` in the options they are folders.
    Each call raises the refusals of docs/recordings.md, CncError 26221 where the machine has no recorder, and 26136
    without an answer.
    """

    def __init__(self, session: Session) -> None:
        self._session = session

    def start(self, file: Path) -> Answer:
        """Begins a recording with the next block, at `cycle`. Raises CncError 26113, 26190, 26192, 26196."""
        return self._ask("start", file=os.path.abspath(fspath(file)))

    def stop(self) -> Answer:
        """Ends the recording, also that of the run, and closes it; it ends before `cycle`. Raises CncError 26191."""
        return self._ask("stop")

    def snapshot(self, file: Path, seconds: float | None = None, until: float | None = None) -> Answer:
        """Writes the `seconds` up to the time `until` of the machine, None: all that `keep` has kept, up to now.

        `cycle`: the first one; `warning`: it is less.

        Raises CncError 26113, 26192, 26193, 26197.
        """
        times = {"seconds": seconds, "until": until}
        given = {name: float(value) for name, value in times.items() if value is not None}
        return self._ask("snapshot", file=os.path.abspath(fspath(file)), **given)

    def _ask(self, command: str, **arguments: Any) -> Answer:
        reply = self._session.ask_recorder(command, arguments)
        return Answer(reply.cycle, reply.message)
