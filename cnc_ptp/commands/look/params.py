"""`cnc_ptp params`: the parameter reference on the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rich.console import Console

from cnc_ptp.commands.look.machine_params import changed_lines
from cnc_ptp.commands.look.table import table_lines
from cnc_ptp.errors import CncError
from cnc_ptp.parameters.declare.declarations import Declaration, catalogue
from cnc_ptp.parameters.declare.reference import HEADLINES, entry_text, find
from cnc_ptp.parameters.errors import UNKNOWN_PARAMETER

PLAIN_WIDTH = 120
"""Characters of a line that goes to a file or a pipe."""
HINT = "cnc_ptp params WORD: part of a name or id (frict, P-AXIS), number (99), word (following); --topic homing"


def params(wanted: str, list_name: str | None = None, topic: str | None = None, changed: str | None = None) -> int:
    """Prints the parameters found: one in full, several in one line each; without a word all groups.

    `list_name`, `topic`: only these; `changed`: only what this machine file sets, with its values. Raises CncError
    25018 when nothing is found, ParameterError for the machine file.
    """
    console = Console()
    width = console.width if console.is_terminal else PLAIN_WIDTH
    found = narrowed(find(wanted) if wanted else list(catalogue().by_id.values()), list_name, topic)
    if changed is not None:
        print(*changed_lines(changed, {entry.id for entry in found}, width), sep="\n")
    elif len(found) == 1:
        print(entry_text(found[0]))
    elif wanted or list_name or topic:
        print(*hit_lines(found, width), sep="\n")
    else:
        print(*group_lines(found, width), "", HINT, sep="\n")
    return 0


def narrowed(found: list[Declaration], list_name: str | None, topic: str | None) -> list[Declaration]:
    """Those of a list and topic. Raises CncError 25018 for words that name none, or that nothing is left of."""
    everything = catalogue().by_id.values()
    lists = {name: name for name in HEADLINES}
    lists |= {entry.id.rpartition("-")[0].lower(): entry.list_name for entry in everything}
    if list_name is not None:
        require_known("list", list_name, lists)
        found = [entry for entry in found if entry.list_name == lists[list_name.lower()]]
    if topic is not None:
        topics = dict.fromkeys(entry.topic for entry in everything)
        if not any(topic.lower() in known.lower() for known in topics):
            require_known("topic", topic, topics)
        found = [entry for entry in found if topic.lower() in entry.topic.lower()]
    if not found:
        raise CncError(UNKNOWN_PARAMETER, "no parameter matches all of this together")
    return found


def require_known(what: str, word: str, known: Iterable[str]) -> None:
    if word.lower() not in known:
        listed = ", ".join(known)
        raise CncError(UNKNOWN_PARAMETER, f"no {what} is called {word!r}, there are {listed}")


def hit_lines(found: Iterable[Declaration], width: int) -> Iterator[str]:
    """A line each: id, name, text."""
    rows = [(entry.id, entry.name, entry.text) for entry in found]
    return table_lines(("id", "name", "meaning"), rows, width)


def group_lines(declarations: Iterable[Declaration], width: int) -> Iterator[str]:
    """Lists and their topics, with the number of parameters and the first names of each."""
    groups: dict[tuple[str, str], list[Declaration]] = {}
    for entry in sorted(declarations, key=lambda entry: list(HEADLINES).index(entry.list_name)):
        groups.setdefault((entry.id.rpartition("-")[0], entry.topic), []).append(entry)
    rows = [
        (list_id, topic, f"{len(entries):2}", ", ".join(entry.name.rpartition(".")[2] for entry in entries))
        for (list_id, topic), entries in groups.items()
    ]
    return table_lines(("list", "topic", "", "parameters"), rows, width)
