"""What a recording says of itself in its metadata: its origin, its format, whether it can be computed again."""

from __future__ import annotations

import platform
import subprocess
from collections.abc import Collection, Iterable, Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path

import cnc_ptp
from cnc_ptp import KERNEL
from cnc_ptp.errors import CncError
from cnc_ptp.recording.mcap_chunks import CORRUPT
from cnc_ptp.recording.mcap_file import MISSING

FROM_THE_FUTURE = 26016
FOREIGN = 26017
NOT_COMPUTABLE = 26018
FORMAT = "format"
"""Key of the metadata: version of what a recording holds."""
FORMAT_VERSION = 1
"""Counts up when an older reader would take something for what it is not; new topics and fields alone do not."""
RECORD_WHEN = "record_when"
"""Key: the condition of a recording that does not begin with the run, or who has begun it."""
WITHOUT = "not_computable"
"""Key: what is missing for the run to be computed again from 0, if anything."""
COMPUTABLE_FROM = "computable_from"
"""Key: from which cycle on nothing is missing; a checkpoint at or behind it is a beginning."""
WHAT_IF_OF = "what_if_of"
"""Key: the recording whose run was changed."""
PART = "part"
"""Key: the number of a file of several, from 0 on."""
TIMES = {"start_ns": 0, "cycle_time_ns": 1}
"""Times in ns among the metadata of a recording, and the least that they may be."""
MOST_DIGITS = 19
PATIENCE = 5.0
"""Seconds for git."""


def origin() -> dict[str, str]:
    """What a run was computed by: version and revision of the sources, kind of the kernel, Python, computer."""
    return {
        "version": version("cnc_ptp"),
        "revision": revision(),
        "kernel": KERNEL.kind,
        "python": platform.python_version(),
        "host": platform.node(),
        "system": platform.platform(),
    }


@cache
def revision(folder: Path = Path(cnc_ptp.__file__).parents[1]) -> str:
    """Of the git checkout that `folder` is, with `-dirty` where files were changed; empty for an installed package."""
    if not (folder / ".git").exists():
        return ""
    command = ["git", "-C", str(folder), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
    try:
        told = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
    except (OSError, subprocess.SubprocessError):
        return ""
    return told.stdout.strip()


def require_known_format(path: Path, metadata: Mapping[str, str]) -> None:
    """Raises CncError 26016 for a recording of a newer version; those without a format are the oldest."""
    found = metadata.get(FORMAT, "0")
    if not found.isdecimal() or int(found) > FORMAT_VERSION:
        by = metadata.get("version", "")
        raise CncError(
            FROM_THE_FUTURE,
            f"recording {path}: has format {found}{f' of cnc_ptp {by}' if by else ''}, this version reads up to "
            f"format {FORMAT_VERSION}",
            "nothing was read, use a newer version of cnc_ptp",
        )


def require_times(path: Path, notes: Mapping[str, str]) -> None:
    """Raises CncError 26003 for a start or a cycle time that is no number of ns."""
    for name, least in TIMES.items():
        given = notes.get(name, "1")
        if len(given) > MOST_DIGITS or not given.isdecimal() or not least <= int(given) < 2**63:
            reason = f"recording {path}: corrupt: its metadata have {name} = {given[:MOST_DIGITS]!r}"
            raise CncError(CORRUPT, reason, f"nothing was read, a whole number from {least} to 2**63 - 1 is needed")


def notes_of(path: Path, records: Iterable[Mapping[str, str]]) -> dict[str, str]:
    """What the files of a recording say of it, one after another; the first that says something counts.

    Without all of its parts it is not computable. Raises CncError 26003, 26016.
    """
    notes: dict[str, str] = {}
    parts: list[str] = []
    missing: dict[str, None] = {}
    for record in records:
        require_known_format(path, record)
        parts += [record[PART]] if PART in record else []
        missing |= dict.fromkeys([record[MISSING]] if MISSING in record else [])
        notes = {**record, **notes}
    require_times(path, notes)
    if missing:
        notes[MISSING] = "; ".join(missing)
    lacking = next((number for number, part in enumerate(parts) if part != str(number)), None)
    if lacking is not None:
        notes.setdefault(WITHOUT, f"part {lacking} of the run is not there")
        notes.pop(COMPUTABLE_FROM, None)
    return notes


def require_own(path: Path, metadata: Mapping[str, str], states: Collection[str]) -> None:
    """Raises CncError 26017 for an MCAP file of another program: neither our metadata nor `states` of ours."""
    if not metadata and not states:
        raise foreign(path, "nothing was drawn")


def foreign(path: Path, effect: str) -> CncError:
    return CncError(FOREIGN, f"recording {path}: is not of cnc_ptp", f"{effect}; `cnc_ptp export` reads its topics")


def require_computable(path: Path, metadata: Mapping[str, str]) -> None:
    """Raises CncError 26018 for a recording that says that something is missing for it."""
    if WITHOUT in metadata:
        raise not_computable(path, metadata[WITHOUT], metadata.get(WHAT_IF_OF, ""))


def computable_from(path: Path, metadata: Mapping[str, str]) -> int:
    """The first cycle at which a checkpoint is a beginning, 0: all can be computed. Raises CncError 26018 for none."""
    cycle = metadata.get(COMPUTABLE_FROM, "")
    if cycle.isdecimal() and len(cycle) <= MOST_DIGITS:
        return int(cycle)
    require_computable(path, metadata)
    return 0


def not_computable(path: Path, why: str, what_if_of: str = "") -> CncError:
    remedy = f"replay {what_if_of} with all changes" if what_if_of else "its states can be read and drawn"
    return CncError(NOT_COMPUTABLE, f"recording {path}: {why}", f"the run cannot be computed again, {remedy}")
