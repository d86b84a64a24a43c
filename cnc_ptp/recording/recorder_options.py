"""What a recorder is to do, as its command line has it: `run --record …` passes it on to the node."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from math import inf
from pathlib import Path

from cnc_ptp.errors import CncError
from cnc_ptp.machine.program_files import read_file
from cnc_ptp.recording.on_demand import Snapshots
from cnc_ptp.recording.settings import COMPRESSIONS, Settings, read_split
from cnc_ptp.recording.trigger import Condition
from cnc_ptp.recording.writer import PLC_FILE
from cnc_ptp.recording.writing_place import require_folder, require_writable

BAD_OPTIONS = 26222
SCENARIO_FILE = "scenario.yaml"
"""Name in the recording."""


@dataclass(frozen=True, slots=True)
class RecorderOptions:
    """Options of the recorder; None or 0: not given.

    when           condition with which the recording of the run begins: 'x.set_velocity != 0'
    split          parts of a size or a time, '500MB' or '10min'; recordings are folders then
    compression    zstd, lz4 or none
    keep           seconds that are kept in memory for snapshots
    snapshots      folder for a snapshot at each error, which needs `keep`
    snapshot_when  condition with which a snapshot is taken too: 'x.following_error > 0.1'; needs `snapshots`
    scenario, plc  files that are kept in the recording
    """

    when: str | None = None
    split: str | None = None
    compression: str = "zstd"
    keep: float = 0.0
    snapshots: str | None = None
    snapshot_when: str | None = None
    scenario: str | None = None
    plc: str | None = None

    def words(self) -> Iterator[str]:
        """The same as a command line."""
        for each in fields(self):
            value = getattr(self, each.name)
            if value != each.default:
                yield from (f"--{each.name.replace('_', '-')}", str(value))

    def require_places(self, record: str | None) -> None:
        """Raises CncError 26113 when there is no place for the recording or for snapshots."""
        if record is not None:
            (require_folder if self.split else require_writable)(record)
        if self.snapshots is not None:
            require_folder(self.snapshots)

    def check(self, kinds: Mapping[str, str]) -> None:
        """`kinds` of units. Raises CncError 26012 for conditions and 26019 for a split."""
        for condition in (self.when, self.snapshot_when):
            if condition is not None:
                Condition(condition, kinds)
        if self.split is not None:
            read_split(self.split)

    def require_sense(self, record: str | None) -> None:
        """Raises CncError 26222 for values that are none, and for options that need another one."""
        wrong = (
            (self.compression not in COMPRESSIONS, f"compression = '{self.compression}' is none of zstd, lz4, none"),
            (not 0.0 <= self.keep < inf, f"keep = {self.keep:g} s is no time"),
            (self.when is not None and record is None, "when needs record: it is of the recording of the run"),
            (self.snapshots is not None and not self.keep, "snapshots needs keep: they are of what is kept in memory"),
            (self.snapshot_when is not None and self.snapshots is None, "snapshot_when needs snapshots"),
        )
        for is_wrong, reason in wrong:
            if is_wrong:
                raise CncError(BAD_OPTIONS, reason, "nothing was started", where="recorder options")

    def settings(self) -> Settings:
        """Raises CncError 26019 and 26110."""
        files = {}
        if self.scenario is not None:
            files[SCENARIO_FILE] = read_file("scenario", self.scenario)
        if self.plc is not None:
            files[f"{PLC_FILE}{Path(self.plc).name}"] = read_file("PLC file", self.plc)
        return Settings(self.compression, None if self.split is None else read_split(self.split), files)

    def snapshots_of(self, kinds: Mapping[str, str]) -> Snapshots:
        """Raises CncError 26012."""
        folder = None if self.snapshots is None else Path(self.snapshots)
        if folder is not None:
            folder.mkdir(exist_ok=True)
        return Snapshots(
            self.keep, folder, None if self.snapshot_when is None else Condition(self.snapshot_when, kinds)
        )


def check_recorder(options: RecorderOptions, record: str | None, kinds: Mapping[str, str]) -> None:
    """Before anything is started: raises CncError 26012, 26019 and 26222."""
    options.require_sense(record)
    options.check(kinds)


FROM_THE_START = RecorderOptions()
