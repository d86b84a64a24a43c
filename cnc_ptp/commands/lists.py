"""`cnc_ptp lists`: the vendor's lists as a machine file, and a machine file as lists."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.console import Console

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import errors, machine_text
from cnc_ptp.parameters.errors import Place
from cnc_ptp.parameters.lists.exporting import export_lists
from cnc_ptp.parameters.lists.folder import SUFFIX
from cnc_ptp.parameters.lists.importing import import_lists
from cnc_ptp.parameters.lists.kinds import WORDS, Kind
from cnc_ptp.parameters.lists.problems import NOTHING_WRITTEN, ListError, ListProblem
from cnc_ptp.parameters.lists.report import Report
from cnc_ptp.parameters.lists.text import FOREIGN
from cnc_ptp.recording.overwriting import no_folder

LARGEST_FILE = 16_000_000
"""Bytes of a file that may be a list."""


def import_folder(
    folder: str,
    output: str,
    *,
    report: str | None = None,
    kinds: Sequence[tuple[str, str]] = (),
    force: bool = False,
    strict: bool = False,
    incomplete: bool = False,
) -> int:
    """Writes the machine file of a folder of lists, and prints what became of their lines; `report` has every line.

    Raises ListError when something is wrong with them, 25045 when an output exists and `force` is not given.
    """
    for file in (output, report):
        require_output(file, Path(folder), force)
    if report is not None and Path(report).resolve() == Path(output).resolve():
        raise CncError(errors.LIST_OUTPUT, f"{output} is both machine file and report; name two", NOTHING_WRITTEN)
    files = read_folder(Path(folder))
    chosen: dict[str, Kind] = {file: WORDS[word] for file, word in kinds}
    imported = import_lists(str(Path(folder)), files, chosen=chosen, strict=strict, incomplete=incomplete)
    write_files({output: imported.text, **({report: full_report(imported.report)} if report else {})})
    console = Console(highlight=False, soft_wrap=True, emoji=False)
    for line in imported.report.lines():
        console.print(line, markup=False)
    console.print(f"{output} is written", markup=False)
    return 0


def full_report(report: Report) -> str:
    return "".join(f"{line}\n" for line in report.lines(full=True))


def read_folder(folder: Path) -> dict[str, bytes]:
    """The files of a folder by name. Raises ListError 25040 for what is no folder and for names, 25017 for a file."""
    problems: list[ListProblem] = []
    files: dict[str, bytes] = {}
    try:
        found = sorted(path for path in folder.iterdir() if path.is_file() and not path.name.startswith("."))
    except OSError as error:
        text = f"the folder of lists cannot be read, {error.strerror}; name a folder with files *.lis"
        raise ListError([ListProblem(errors.LIST_FOLDER, Place(str(folder), 1, 1), text)]) from None
    for path in found:
        if FOREIGN.search(path.name):
            if path.suffix.lower() == SUFFIX:
                text = f"{path.name!a} has characters that no list can hold in its name; rename it"
                problems.append(ListProblem(errors.LIST_FOLDER, Place(str(folder), 1, 1), text))
            continue
        try:
            if path.stat().st_size > LARGEST_FILE:
                raise OSError(0, f"it is larger than {LARGEST_FILE // 1_000_000} MB")
            files[path.name] = path.read_bytes()
        except OSError as error:
            text = f"the file cannot be read, {error.strerror}"
            problems.append(ListProblem(errors.UNREADABLE, Place(str(path), 1, 1), text))
    if problems:
        raise ListError(problems)
    return files


def require_output(output: str | None, folder: Path, force: bool) -> None:
    """Raises CncError 25045 for a file that is there already or is one of the lists, or one in no folder."""
    if output is None:
        return
    if not Path(output).absolute().parent.is_dir():
        raise CncError(errors.LIST_OUTPUT, f"{output} cannot be written: {no_folder(output)}", NOTHING_WRITTEN)
    if Path(output).is_dir():
        raise CncError(errors.LIST_OUTPUT, f"{output} is a folder; name a file", NOTHING_WRITTEN)
    if Path(output).suffix.lower() == SUFFIX and Path(output).resolve().parent == folder.resolve():
        text = f"{output} would stand among the lists; name a file of another folder, or *.yaml"
        raise CncError(errors.LIST_OUTPUT, text, NOTHING_WRITTEN)
    if Path(output).exists() and not force:
        raise CncError(errors.LIST_OUTPUT, f"{output} exists; name another file, or add --force", NOTHING_WRITTEN)


def write_files(files: Mapping[str, str]) -> None:
    """Writes all of them beside their places first, so that none is half written. Raises CncError 25045."""
    written: dict[str, str] = {}
    try:
        for output, text in files.items():
            handle, name = tempfile.mkstemp(prefix=f".{Path(output).name}.", dir=Path(output).absolute().parent)
            written[output] = name
            with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as stream:
                stream.write(text)
            os.chmod(name, 0o666 & ~umask())
        for output, name in written.items():
            Path(name).replace(output)
    except OSError as error:
        raise CncError(errors.LIST_OUTPUT, f"{output} cannot be written: {error.strerror}", NOTHING_WRITTEN) from None
    finally:
        for name in written.values():
            Path(name).unlink(missing_ok=True)


def umask() -> int:
    """The permissions that new files do not have; asking for them sets them, so they are set again."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask


def export_folder(machine: str, output: str, *, force: bool = False) -> int:
    """Writes the lists of a machine file into a new folder; with `force` into one that has lists of these names.

    Raises ParameterError for a machine that no node accepts, ListError for what no list can hold, 25045 for a folder.
    """
    folder = Path(output)
    require_folder(folder, force)
    lists = export_lists(machine_text(machine), machine)
    require_no_others(folder, lists)
    write_folder(folder, lists)
    for name in lists:
        print(folder / name)
    print(f"{len(lists)} lists are written")
    return 0


def require_folder(folder: Path, force: bool) -> None:
    """Raises CncError 25045 for a folder with something in it, or one in no folder."""
    if not folder.absolute().parent.is_dir():
        raise CncError(errors.LIST_OUTPUT, f"{folder} cannot be written: {no_folder(folder)}", NOTHING_WRITTEN)
    if folder.exists() and not folder.is_dir():
        raise CncError(errors.LIST_OUTPUT, f"{folder} is a file; name a folder", NOTHING_WRITTEN)
    if not force and folder.is_dir() and any(folder.iterdir()):
        text = f"{folder} is not empty; name another folder, or add --force, which overwrites lists"
        raise CncError(errors.LIST_OUTPUT, text, NOTHING_WRITTEN)


def require_no_others(folder: Path, lists: Mapping[str, str]) -> None:
    """Raises CncError 25045 for lists that would be read together with those that are written."""
    found = sorted(path.name for path in folder.glob("*") if path.suffix.lower() == SUFFIX and path.name not in lists)
    if found:
        text = f"{folder} has other lists: {', '.join(found[:5])}; delete them, or name another folder"
        raise CncError(errors.LIST_OUTPUT, text, NOTHING_WRITTEN)


def write_folder(folder: Path, lists: Mapping[str, str]) -> None:
    """Writes all lists beside the folder first; a new one appears with all of them. Raises CncError 25045."""
    temporary, effect = "", NOTHING_WRITTEN
    try:
        temporary = tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.absolute().parent)
        for name, text in lists.items():
            (Path(temporary) / name).write_text(text, encoding="utf-8", newline="\n")
        if not folder.exists() or not any(folder.iterdir()):
            os.chmod(temporary, 0o777 & ~umask())
            Path(temporary).replace(folder)
            return
        effect = "the folder may hold a part of the lists"
        for name in lists:
            (Path(temporary) / name).replace(folder / name)
    except OSError as error:
        raise CncError(errors.LIST_OUTPUT, f"{folder} cannot be written: {error.strerror}", effect) from None
    finally:
        if temporary:
            shutil.rmtree(temporary, ignore_errors=True)
