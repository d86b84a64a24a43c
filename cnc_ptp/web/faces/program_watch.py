"""Which program each channel has, told to pages whenever one is loaded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cnc_ptp.client.record_arguments import record_arguments
from cnc_ptp.errors import CncError
from cnc_ptp.machine.program_files import read_file
from cnc_ptp.protocol.blocks import CommandRecord
from cnc_ptp.recording.command_words import is_load
from cnc_ptp.web.numbers import NO_PROGRAM
from cnc_ptp.web.programs.programs import ProgramFolder

REMEMBERED = 4
"""Loads of a channel: its state may be behind its records."""


@dataclass(frozen=True, slots=True, eq=False)
class Load:
    """A program that was loaded: path as the machine names it, its text, and those of the programs that it calls."""

    path: str
    text: str | None
    """None: not known."""
    files: Mapping[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return Path(self.path).name


def load_of(arguments: Mapping[str, Any]) -> Load:
    """Of the arguments of `load`, as a record has them."""
    return Load(arguments["program"], arguments.get("text"), arguments.get("files") or {})


class ProgramWatch:
    """The loaded programs of a machine, by channel."""

    def __init__(self, folder: ProgramFolder, *, is_recording: bool = False) -> None:
        """Of a recording nothing is read but what it has."""
        self._folder = folder
        self.is_recording = is_recording
        self.loaded: dict[str, Load] = {}
        self._known: dict[str, list[Load]] = {}
        self._untold: list[str] = []

    def take_record(self, record: CommandRecord) -> None:
        """A command that was given, by whomever; a program that was refused is none."""
        if record.command != "load" or not record.accepted:
            return
        given = record_arguments(record)
        if is_load(given):
            load = load_of(given)
            self._known[record.target] = [load, *self._known.get(record.target, [])][:REMEMBERED]
            self.take(record.target, load)

    def take(self, channel: str, load: Load) -> None:
        """A channel has another program, or the same one again."""
        self.loaded[channel] = load
        self._untold.append(channel)

    def take_state(self, state: Mapping[str, Mapping[str, Any]], loads: Mapping[str, Load]) -> None:
        """Fields that have changed, and what a recording has loaded by now: programs without a record."""
        for channel, load in loads.items():
            if self.loaded.get(channel) is not load:
                self.take(channel, load)
        for channel, fields in state.items():
            path = fields.get("program", "")
            if path and (channel not in self.loaded or self.loaded[channel].path != path):
                known = [load for load in self._known.get(channel, []) if load.path == path]
                self.take(channel, known[0] if known else Load(path, None))

    def news(self) -> list[dict[str, Any]]:
        """As `program` tells them: the channels that have loaded something since the last call."""
        told = [self._told(channel) for channel in dict.fromkeys(self._untold)]
        self._untold.clear()
        return told

    def all(self) -> list[dict[str, Any]]:
        return [self._told(channel) for channel in self.loaded]

    def _told(self, channel: str) -> dict[str, Any]:
        return {"channel": channel, "name": self.loaded[channel].name}

    def text(self, name: str, channel: str = "") -> str:
        """Of a loaded program, wherever it is, or of one of the folder; `channel`: the one that has loaded it.

        Raises CncError 26240, 26242, 26110.
        """
        for each, load in self.loaded.items():
            if load.name == name and channel in ("", each):
                return self._text(each)
        if self.is_recording:
            raise no_text(f"program '{name[:80]}'")
        return self._folder.text(name)

    def loaded_text(self, channel: str) -> Load:
        """The program of a channel, with its text. Raises CncError 26242, 26110."""
        if channel not in self.loaded:
            raise CncError(NO_PROGRAM, f"channel {channel} has no program", "nothing was read")
        text = self._text(channel)
        return Load(self.loaded[channel].path, text, self.loaded[channel].files)

    def _text(self, channel: str) -> str:
        load = self.loaded[channel]
        if load.text is None and self.is_recording:
            raise no_text(f"program '{load.name}'")
        return read_file("program", load.path) if load.text is None else load.text


def no_text(what: str) -> CncError:
    """Files of this computer are not those of a recording."""
    return CncError(NO_PROGRAM, f"{what}: the recording does not have its text", "nothing was read")
