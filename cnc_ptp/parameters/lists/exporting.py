"""A machine file -> a folder of lists: the start-up list, and one for each axis, channel, tool table and so on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.errors import Place
from cnc_ptp.parameters.lists.commented import CommentedSection, Item, read_commented
from cnc_ptp.parameters.lists.folder import SUFFIX
from cnc_ptp.parameters.lists.kinds import AXIS, CHANNEL, CLAMP, COMPENSATION, STARTUP, TOOL, ZERO, Kind, kind_of
from cnc_ptp.parameters.lists.lines import comment_text
from cnc_ptp.parameters.lists.marks import LIST, UNKNOWN, comment_line, read_mark
from cnc_ptp.parameters.lists.problems import ListError, ListProblem
from cnc_ptp.parameters.lists.text import FOREIGN
from cnc_ptp.parameters.lists.units import UNIT_LISTS
from cnc_ptp.parameters.lists.values import NO_ITEMS, list_text, to_list
from cnc_ptp.parameters.loader import load_machine
from cnc_ptp.parameters.read.named_files import split_files
from cnc_ptp.parameters.read.parameter_set import Parameter, ParameterSet

STARTUP_FILE: Final = "hochlauf.lis"
NAME_WIDTH: Final = 44
VALUE_WIDTH: Final = 12
SAID_BY_FILES: Final = (ids.CHANNELS, ids.AXES, ids.SPINDLES, ids.WERKZ_DATA, ids.NULLP_DATA, ids.PZV_DATA)
"""What the start-up list says by naming units and files."""
MAIN: Final = {"machine": STARTUP, "channel": CHANNEL, "axis": AXIS, "spindle": AXIS}
"""The list that every node of a kind has."""
ORDER: Final = (AXIS, COMPENSATION, CHANNEL, TOOL, ZERO, CLAMP)


@dataclass
class List:
    """A list that is written."""

    kind: Kind
    file: str = ""
    lines: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        return "\n".join([*self.lines, ""])

    def strip(self) -> None:
        """Without blank lines at its ends."""
        while self.lines and not self.lines[-1]:
            self.lines.pop()
        while self.lines and not self.lines[0]:
            self.lines.pop(0)


def export_lists(text: str, file: str) -> dict[str, str]:
    """The lists of a machine file by name; `text` as `machine_text` gives it, with the files that it names.

    Raises ParameterError for a machine that no node accepts, ListError for what no list can hold.
    """
    machine = load_machine(text, file)
    sections = {section.node: section for section in read_commented(split_files(text)[0], file)}
    problems: list[ListProblem] = []
    nodes = {
        node: NodeExport(machine.raw(node), file, problems).lists(sections.get(node, CommentedSection(node, 1)))
        for node in machine.sets
    }
    if problems:
        raise ListError(problems)
    name_files(nodes)
    startup = nodes["machine"][STARTUP.name]
    startup.lines += [*([""] if startup.lines else []), *start_lines(machine.sets, nodes)]
    return {entry.file: entry.text for lists in nodes.values() for entry in lists.values()}


class NodeExport:
    """The lists of one node; what cannot be written goes to `problems`."""

    def __init__(self, parameters: ParameterSet, file: str, problems: list[ListProblem]) -> None:
        self.parameters, self.file, self.problems = parameters, file, problems
        self.written: dict[str, List] = {}
        self.current: List | None = None
        """The list of the last mark."""
        self.waiting: list[str] = []
        """Comments without a mark before them: they go with the next value."""

    def lists(self, section: CommentedSection) -> dict[str, List]:
        """By kind; the values of the files that a machine file names behind its own."""
        last = main = self.list_of(MAIN[self.parameters.kind])
        self.implied(main)
        for item in section.items:
            if item.name:
                last = self.value(item) or last
            else:
                self.comment(item)
        last.lines += self.waiting
        self.values_of_files({item.name for item in section.items})
        for entry in self.written.values():
            entry.strip()
        return {kind.name: self.written[kind.name] for kind in (STARTUP, *ORDER) if kind.name in self.written}

    def list_of(self, kind: Kind) -> List:
        if kind.name not in self.written:
            self.written[kind.name] = List(kind)
            if kind is COMPENSATION:
                number = self.parameters.value(ids.KOPF_ACHS_NR)
                self.written[kind.name].lines.append(line_text("kopf.achs_nr", str(number)))
        return self.written[kind.name]

    def implied(self, main: List) -> None:
        """What follows from the place in a machine file and must be said in a list: axis number, type of a spindle."""
        for name, value in self.parameters.implied.items():
            if name not in self.parameters.given:
                main.lines.append(line_text(name, str(value)))

    def comment(self, item: Item) -> None:
        """A whole line: mark, kept line, comment, blank."""
        if mark := read_mark(item.comment):
            kind, file = mark
            if self.waiting:
                (self.current or self.list_of(MAIN[self.parameters.kind])).lines += self.waiting
                self.waiting = []
            if kind.node == MAIN[self.parameters.kind].node:
                self.current = self.list_of(kind)
                self.current.file = self.current.file or file
            return
        if item.comment.startswith(LIST):
            return
        line = item.comment.removeprefix(UNKNOWN).strip() if item.comment.startswith(UNKNOWN) else ""
        if not line and item.comment:
            line = comment_line(comment_text(item.comment))
        self.require_readable(line, item)
        (self.current.lines if self.current else self.waiting).append(line)

    def value(self, item: Item) -> List | None:
        """Writes a value and returns its list; None where the start-up list says it in another way."""
        given = self.parameters.find(item.name)
        if given.declaration.id in SAID_BY_FILES:
            if item.comment:
                self.comment(Item(item.line, comment=comment_line(item.comment)))
            return None
        target = self.list_of(kind_of(given.declaration))
        target.lines += self.waiting
        self.waiting = []
        self.require_readable(item.comment, item)
        self.add(target, given, item.raw, item.comment, item.line)
        return target

    def values_of_files(self, own: set[str]) -> None:
        """What the files that the machine file names give; in the order of their indexes."""
        others = [self.parameters.find(name) for name in self.parameters.given if name not in own]
        for given in sorted(others, key=lambda given: given.indexes[:1]):
            self.add(self.list_of(kind_of(given.declaration)), given, "", "", 1)

    def add(self, target: List, given: Parameter, raw: str, comment: str, line: int) -> None:
        name = given.declaration.list_style_name(given.indexes)
        try:
            target.lines.append(line_text(name, to_list(given.declaration, given.value, raw), comment))
        except ValueError:
            text = f"the text of {name} has control characters or ends of lines, which no list can hold; change it"
            self.problems.append(ListProblem(errors.LIST_VALUE, Place(self.file, line, 1), text))

    def require_readable(self, comment: str, item: Item) -> None:
        if FOREIGN.search(comment):
            text = "a comment has control characters, which no list can hold; change it"
            self.problems.append(ListProblem(errors.LIST_VALUE, Place(self.file, item.line, 1), text))


def line_text(name: str, value: str, comment: str = "") -> str:
    """A line in columns."""
    line = f"{name:{NAME_WIDTH}} {value:{VALUE_WIDTH}} {comment_line(comment)}" if comment else ""
    return line or f"{name:{NAME_WIDTH}} {value}"


def name_files(nodes: Mapping[str, Mapping[str, List]]) -> None:
    """Gives each list the file that its mark says; another one if that is taken, or without a mark."""
    taken: set[str] = set()
    for node, lists in nodes.items():
        for entry in lists.values():
            own = STARTUP_FILE if entry.kind is STARTUP else f"{entry.kind.entry}_{node}{SUFFIX}"
            wanted = entry.file if entry.file.lower().endswith(SUFFIX) else own
            entry.file = wanted if wanted.lower() not in taken else own
            number = 1
            while entry.file.lower() in taken:
                number += 1
                entry.file = f"{own.removesuffix(SUFFIX)}_{number}{SUFFIX}"
            taken.add(entry.file.lower())


def start_lines(sets: Mapping[str, ParameterSet], nodes: Mapping[str, Mapping[str, List]]) -> Iterator[str]:
    """The end of the start-up list: the nodes by their names, how many lists there are, and their files."""
    of_kind = {kind: [node for node in nodes if sets[node].kind == kind] for kind in UNIT_LISTS.values()}
    for name, unit in UNIT_LISTS.items():
        yield line_text(name, ", ".join(of_kind[unit]) or NO_ITEMS)
    axes = [*of_kind["axis"], *of_kind["spindle"]]
    for kind in (CHANNEL, TOOL, ZERO, CLAMP, AXIS, COMPENSATION):
        owners = axes if kind.node == "axis" else of_kind["channel"]
        files = {index: nodes[node][kind.name].file for index, node in enumerate(owners) if kind.name in nodes[node]}
        if kind.counted_by:
            yield line_text(kind.counted_by, str(len(files)))
        for index, file in files.items():
            yield line_text(f"{kind.entry}[{index}]", list_text(file))
