"""A recording in several files: a folder as rosbag2 has it, `run/run_0.mcap`, `run/run_1.mcap`, …, `run/metadata.yaml`.

While a recording is being written the folder lists the parts that are closed; readers find the one that follows by its
number, also after the recorder was killed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import yaml
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.writer import MCAP0_MAGIC

from cnc_ptp import yaml_text
from cnc_ptp.errors import CncError
from cnc_ptp.recording.bag import FILE, INFORMATION, bag_information, metadata_text, write_beside
from cnc_ptp.recording.mcap_chunks import UNREADABLE
from cnc_ptp.recording.overwriting import replacing, why_not_made

NO_BAG = 26014
NO_FOLDER = 26020
NUMBERED = re.compile(r"(?P<stem>.+)_(?P<number>\d+)\.mcap")


class PartsFolder:
    """The folder of a recording that is being written."""

    def __init__(self, folder: Path) -> None:
        """Makes the folder, or empties one of its parts. Raises CncError 26020; nothing else in it is touched."""
        self._folder = folder
        self._parts: list[dict[str, Any]] = []
        try:
            folder.mkdir(exist_ok=True)
            for old in files_in(folder):
                old.unlink(missing_ok=True)
        except OSError as error:
            raise CncError(
                NO_FOLDER,
                f"recording {folder}: no folder for its parts: {why_not_made(error, folder)}",
                "nothing is recorded",
            ) from error

    @property
    def count(self) -> int:
        """Parts that are closed."""
        return len(self._parts)

    def next_part(self) -> Path:
        return self._folder / f"{self._folder.stem}_{self.count}.mcap"

    def add(self, part: Path, information: dict[str, Any]) -> None:
        """A part was closed; `information` as bag_information has it."""
        self._parts.append({**information, "relative_file_paths": [part.name]})
        write_folder(self._folder, self._parts)


def files_in(folder: Path) -> list[Path]:
    """The parts of a folder, also one that is missing, and its `metadata.yaml`."""
    return [*numbered_parts(folder, folder.stem), folder / FILE]


def replace_parts(new: Path, folder: Path) -> None:
    """Moves a folder of parts to the name `folder`: there its files take the place of parts that are there already.

    The former ones are put beside the new ones first. After an error or Ctrl-C they are where they were;
    of a process that is killed meanwhile they lie in a folder `.part.*` beside it.
    """
    if not folder.exists():
        new.rename(folder)
        return
    former = new.with_name(f"former.{new.name}")
    former.mkdir()
    moved: list[tuple[Path, Path]] = []
    try:
        for old in [file for file in files_in(folder) if file.exists()]:
            _move(old, former / old.name, moved)
        for part in sorted(new.iterdir()):
            _move(part, folder / part.name, moved)
    except BaseException:
        for was, now in reversed(moved):
            if now.exists():
                now.rename(was)
        raise


def _move(file: Path, target: Path, moved: list[tuple[Path, Path]]) -> None:
    """Noted before it is done, so that nothing is forgotten when it is interrupted."""
    moved.append((file, target))
    file.rename(target)


def numbered_parts(folder: Path, stem: str, first: int = 0) -> Iterator[Path]:
    """The files of a folder that are numbered from `first` on; of a gap the first that is not there."""
    expected = first
    numbers = [
        int(found["number"])
        for file in folder.iterdir()
        if (found := NUMBERED.fullmatch(file.name))
        and found["stem"] == stem
        and file.name == f"{stem}_{int(found['number'])}.mcap"
    ]
    for number in sorted(number for number in numbers if number >= first):
        if number > expected:
            yield folder / f"{stem}_{expected}.mcap"
        yield folder / f"{stem}_{number}.mcap"
        expected = number + 1


def begun_parts(folder: Path, stem: str, first: int = 0) -> list[Path]:
    """The same without a last one that has no begin: the recorder was killed before its first byte."""
    parts = [*numbered_parts(folder, stem, first)]
    if first + len(parts) > 1 and parts and parts[-1].stat().st_size < len(MCAP0_MAGIC):
        parts.pop()
    return parts


def write_folder(folder: Path, parts: Iterable[dict[str, Any]]) -> None:
    """Writes `metadata.yaml`; without room for it the parts themselves hold the same."""
    text = metadata_text({INFORMATION: joined_information([*parts])})
    with suppress(OSError), replacing(folder / FILE) as file:
        file.write_text(text, encoding="utf-8")


def joined_information(parts: list[dict[str, Any]]) -> dict[str, Any]:
    """The metadata of a bag from those of its files."""
    files = [entry for part in parts for entry in part["files"]]
    filled = [entry for entry in files if entry["message_count"]] or files
    begin = min(_begin(entry) for entry in filled)
    end = max(_begin(entry) + entry["duration"]["nanoseconds"] for entry in filled)
    topics: dict[str, dict[str, Any]] = {}
    for part in parts:
        for topic in part["topics_with_message_count"]:
            known = topics.setdefault(topic["topic_metadata"]["name"], {**topic, "message_count": 0})
            known["message_count"] += topic["message_count"]
    return {
        **parts[0],
        "starting_time": {"nanoseconds_since_epoch": begin},
        "duration": {"nanoseconds": end - begin},
        "message_count": sum(entry["message_count"] for entry in files),
        "topics_with_message_count": [*topics.values()],
        "relative_file_paths": [entry["path"] for entry in files],
        "files": files,
    }


def _begin(entry: Mapping[str, Any]) -> int:
    return int(entry["starting_time"]["nanoseconds_since_epoch"])


def describe_folder(folder: Path) -> None:
    """Writes the `metadata.yaml` of parts that are all closed: after a recorder was killed."""
    write_folder(folder, [information_of(part) for part in begun_parts(folder, folder.stem)])


def describe_file(recording: Path) -> None:
    """Writes the `metadata.yaml` beside a file that was moved there; a device has none."""
    if recording.is_file():
        write_beside(recording, information_of(recording))


def information_of(part: Path) -> dict[str, Any]:
    """From the summary of a file."""
    with part.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    if summary is None or summary.statistics is None:
        raise McapError(f"{part} has no summary")
    channels, schemas = [*summary.channels.values()], [*summary.schemas.values()]
    return bag_information(part.name, summary.statistics, channels, schemas)


def files_of(path: Path) -> list[Path]:
    """The file, or those of a folder or of its `metadata.yaml`.

    Raises CncError 26001 for a part that is not there, 26014 for other folders.
    """
    files = named_files_of(path)
    missing = [file for file in files if file != path and not file.exists()]
    if missing:
        raise CncError(
            UNREADABLE,
            f"recording {missing[0].parent}: its part {missing[0].name} is not there",
            "nothing was read, put it back, or 'cnc_ptp recover' makes a recording of the others",
        )
    return files


def named_files_of(path: Path) -> list[Path]:
    """As files_of, with parts that are not there. Raises CncError 26014 for other folders."""
    folder = path.parent if path.name == FILE else path
    if not folder.is_dir():
        return [path]
    listed = listed_files(folder)
    last = NUMBERED.fullmatch(listed[-1].name) if listed else None
    if last is not None:
        return [*listed, *begun_parts(folder, last["stem"], int(last["number"]) + 1)]
    found = listed or begun_parts(folder, folder.stem)
    if not found:
        raise CncError(
            NO_BAG,
            f"recording {folder}: a folder without a {FILE} of rosbag2",
            "nothing was read, give a file of the folder",
        )
    return found


def listed_files(folder: Path) -> list[Path]:
    """The files that the `metadata.yaml` of a folder lists; none if it is not one of rosbag2."""
    try:
        text = (folder / FILE).read_text(encoding="utf-8")
        return [folder / name for name in yaml_text.load(text)[INFORMATION]["relative_file_paths"]]
    except (OSError, UnicodeDecodeError, yaml.YAMLError, TypeError, KeyError):
        return []
