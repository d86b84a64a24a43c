"""NC programs and those that they call, read before they are loaded: the kernel itself opens no file.

A called program is looked for in the folder of its caller's main program, then in those of the machine file
(P-CHAN-90004), then among those that ship with cnc_ptp. Nothing outside these folders is read, whatever a link says.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

import cnc_ptp
from cnc_ptp.errors import CncError
from cnc_ptp.long_text import read_text
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.cycle_files import cycle_file
from cnc_ptp.nc.flow.flow_faults import CYCLE_FILE, FILE_UNKNOWN

UNREADABLE = 26110
TOO_MANY_FILES = 26122
MOST_FILES = 200
"""Programs that one program may call, directly or through others."""
UTF_16: Final = "it is UTF-16 text; save it as UTF-8"
UTF_32: Final = "it is UTF-32 text; save it as UTF-8"
NO_TEXT: Final = "it is no text, its first characters are NUL"
SHIPPED = Path(cnc_ptp.__path__[0]) / "nc" / "cycles"
"""Cycles that come with cnc_ptp; a program of the same name in the user's folder replaces one."""

LONGEST: Final = 4000
"""Characters of a block over several lines."""

_NAME = r'[^\s"\],#$\[();]+'
_CALLED = re.compile(rf'(?<![A-Z0-9_])L\s+(?:CYCLE\s*\[.*?NAME\s*=\s*"?({_NAME})|({_NAME}))', re.ASCII | re.IGNORECASE)
_CONTINUED = re.compile(r"\\\s*\n")
_CYCLE_CODE = re.compile(r"G\s*(8\d)(?![\d.])", re.ASCII | re.IGNORECASE)


def read_file(what: str, path: str) -> str:
    """Text of a file. Raises CncError 26110."""
    try:
        text = read_text(Path(path))
    except OSError as error:
        raise CncError(UNREADABLE, f"{what} {path} cannot be read: {error.strerror}", "nothing was started") from None
    except UnicodeDecodeError:
        reason = why_not_utf_8(Path(path).read_bytes())
        raise CncError(UNREADABLE, f"{what} {path} cannot be read: {reason}", "nothing was started") from None
    if text[:1] and "\0" in text[:2]:
        reason = of_other_width(text[:4].encode())
        raise CncError(UNREADABLE, f"{what} {path} cannot be read: {reason}", "nothing was started")
    return text


def of_other_width(begin: bytes) -> str:
    """What a file is that begins with a mark of UTF-16 or UTF-32, or has a NUL among its first two characters."""
    if begin in (b"\xff\xfe\0\0", b"\0\0\xfe\xff") or begin.count(0) == 3 != len(begin):
        return UTF_32
    return NO_TEXT if begin[:2] == b"\0\0" else UTF_16


def first_bad_byte(data: bytes) -> int:
    """Where it is no UTF-8."""
    try:
        data.decode("utf-8")
    except UnicodeDecodeError as error:
        return error.start
    return 0  # the file has changed meanwhile


def why_not_utf_8(data: bytes) -> str:
    """Where a text is none in UTF-8, and what it may be instead."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\0" in data[:2]:
        return of_other_width(data[:4])
    place = first_bad_byte(data)
    line = data.count(b"\n", 0, place) + 1
    column = len(data[data.rfind(b"\n", 0, place) + 1 : place].decode("utf-8")) + 1
    character = data[place : place + 1].decode("latin-1")
    meant = f" ('{character}' in Latin-1)" if character.isprintable() else ""
    return f"it is not UTF-8 text, byte 0x{data[place]:02X} in line {line} column {column}{meant}; save it as UTF-8"


class Search(NamedTuple):
    """What a machine file says of called programs.

    folders   searched besides that of the program (P-CHAN-90004)
    cycles    programs that G80 to G89 call, by code (P-CHAN-00160 …), where they are not g80.nc to g89.nc
    """

    folders: tuple[str, ...] = ()
    cycles: Mapping[str, str] = {}

    @property
    def missing(self) -> list[str]:
        """Folders that are not there."""
        return [folder for folder in self.folders if not Path(folder).is_dir()]

    def described(self, program: str) -> str:
        """The folders in which the programs that a program calls are looked for, in their order."""
        folders = [folder_of(program), *self.folders]
        shown = [folder if Path(folder).is_dir() else f"{folder} (does not exist)" for folder in folders]
        return ", ".join([*shown, f"{SHIPPED} (cycles that ship with cnc_ptp)"])

    def explain(self, error: ProgramError, program: str) -> None:
        """Adds the folders to an error about a called program that is in none of them."""
        if error.number in (CYCLE_FILE.number, FILE_UNKNOWN.number):
            error.note = f"searched: {self.described(program)}"

    def called(self, text: str, folder: str) -> dict[str, str]:
        """The programs that a text in this folder calls. Raises CncError 26110, 26122."""
        return called_programs(text, [folder, *self.folders], self.cycles)


NO_SEARCH: Final = Search()


def read_program(path: str, search: Search = NO_SEARCH) -> tuple[str, dict[str, str]]:
    """The text of a program, and by name the texts of those that it calls. Raises CncError 26110, 26122."""
    text = read_file("NC program", path)
    return text, search.called(text, folder_of(path))


def is_longer(path: str, characters: int) -> bool:
    """Whether a file may have more characters than that; False for one that is not there."""
    try:
        return Path(path).stat().st_size > characters
    except OSError:
        return False


def scan_program(path: str, search: Search) -> tuple[int, dict[str, str]]:
    """Number of lines of a program of any size, and by name the texts of the programs that it calls.

    Raises CncError 26110, 26122, as read_program.
    """
    count, before = 0, ""
    names: dict[str, str] = {}
    try:
        with Path(path).open(encoding="utf-8") as lines:
            for line in lines:
                count += 1
                if count == 1 and "\0" in line[:2]:
                    reason = of_other_width(line[:4].encode())
                    raise CncError(UNREADABLE, f"NC program {path} cannot be read: {reason}", "nothing was started")
                text, before = before + line, ""
                if line.endswith("\\\n") and len(text) < LONGEST:
                    before = text
                elif "L" in text or "l" in text or "8" in text:
                    names.update({name.upper(): name for name in called_names(text, search.cycles)})
    except OSError as error:
        text = f"NC program {path} cannot be read: {error.strerror}"
        raise CncError(UNREADABLE, text, "nothing was started") from None
    except UnicodeDecodeError:
        text = f"NC program {path} cannot be read: it is not UTF-8 text; save it as UTF-8"
        raise CncError(UNREADABLE, text, "nothing was started") from None
    calls = "\n".join(f'L CYCLE [NAME="{name}"]' for name in names.values())
    return count, search.called(calls, folder_of(path))


def called_programs(text: str, folders: Sequence[str], cycles: Mapping[str, str] = NO_SEARCH.cycles) -> dict[str, str]:
    """By name the texts of the programs that a text calls, directly or through others.

    A name that is in no folder is left out: the parser names its line.
    """
    found: dict[str, str] = {}
    names = called_names(text, cycles)
    while names:
        name = names.pop()
        if name.upper() in {known.upper() for known in found}:
            continue
        path = find(name, folders)
        if path is None:
            continue
        if len(found) == MOST_FILES:
            reason = f"the program calls more than {MOST_FILES} other programs"
            raise CncError(TOO_MANY_FILES, reason, "nothing was started")
        found[path.name] = read_file("NC program", str(path))
        names += called_names(found[path.name], cycles)
    return found


def folder_of(program: str) -> str:
    """Where programs are looked for: the folder of the loaded one, without one ("") the working directory."""
    return str(Path(program).parent)


def available_programs(folder: str) -> list[str]:
    """Names of the NC programs (.nc) in a folder, in their order; none if it cannot be read."""
    try:
        return sorted(entry.name for entry in Path(folder).iterdir() if entry.suffix.lower() == ".nc")
    except OSError:
        return []


def called_names(text: str, cycles: Mapping[str, str]) -> list[str]:
    """Names behind L and in L CYCLE, and those of G80 to G89, also in comments; without folders."""
    text = _CONTINUED.sub(" ", text)
    names = [match[1] or match[2] for match in _CALLED.finditer(text)]
    names += [cycle_file(f"G{match[1]}", cycles) for match in _CYCLE_CODE.finditer(text)]
    return [name for name in names if "/" not in name and "\\" not in name and not name.startswith(".")]


def find(name: str, folders: Sequence[str]) -> Path | None:
    """The file of this name in the first folder that has it; upper and lower case are not distinguished."""
    searched = (*map(Path, folders), SHIPPED)
    for folder in searched:
        exact = folder / name
        if is_within(exact, searched):
            return exact
        try:
            entries = sorted(folder.iterdir())
        except OSError:
            continue
        for entry in entries:
            if entry.name.upper() == name.upper() and is_within(entry, searched):
                return entry
    return None


def is_within(path: Path, folders: Sequence[Path]) -> bool:
    """Whether a path is a file that lies in one of the folders, also behind links."""
    if not path.is_file():
        return False
    target = path.resolve()
    return any(target.is_relative_to(folder.resolve()) for folder in folders)
