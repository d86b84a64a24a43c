"""Which program each channel has, told to pages when it changes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from cnc_ptp.errors import CncError
from cnc_ptp.machine.program_files import read_file
from cnc_ptp.web.numbers import NO_PROGRAM
from cnc_ptp.web.programs.programs import ProgramFolder


class ProgramWatch:
    """The loaded programs of a machine, by channel: path as the machine names it, and text."""

    def __init__(self, folder: ProgramFolder) -> None:
        self._folder = folder
        self.loaded: dict[str, str] = {}
        """Channel -> path."""
        self.text_of: Callable[[str], str | None] = lambda path: None
        """Of a program that the machine has told of itself."""
        self._given: dict[str, str] = {}
        """Path -> text that a page has sent in place of a file."""

    def give_text(self, path: str, text: str) -> None:
        """A program is loaded from a text."""
        self._given = {path: text}

    def changes(self, state: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
        """The channels that have another program than before, as `program` tells them."""
        found = []
        for channel, fields in state.items():
            path = fields.get("program", "")
            if path and self.loaded.get(channel) != path:
                self.loaded[channel] = path
                found.append({"channel": channel, "name": Path(path).name})
        return found

    def all(self) -> list[dict[str, Any]]:
        return [{"channel": channel, "name": Path(path).name} for channel, path in self.loaded.items()]

    def forget(self) -> None:
        self.loaded.clear()

    def text(self, name: str) -> str:
        """Of a loaded program, wherever it is, or of one of the folder. Raises CncError 26240, 26242, 26110."""
        for path in self.loaded.values():
            if Path(path).name == name:
                return self._text(path)
        return self._folder.text(name)

    def loaded_text(self, channel: str) -> tuple[str, str]:
        """Path and text of the program of a channel. Raises CncError 26242, 26110."""
        path = self.loaded.get(channel)
        if path is None:
            raise CncError(NO_PROGRAM, f"channel {channel} has no program", "nothing was read")
        return path, self._text(path)

    def _text(self, path: str) -> str:
        told = self._given.get(path, self.text_of(path))
        return read_file("program", path) if told is None else told
