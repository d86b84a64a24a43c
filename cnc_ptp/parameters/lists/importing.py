"""A folder of lists -> the text of a machine file, and a report of what became of each line."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import AXIS_LETTERS
from cnc_ptp.parameters.declare.ranges import default_text
from cnc_ptp.parameters.errors import ParameterError, Place, Problem
from cnc_ptp.parameters.lists.folder import Folder, ListFile, entry_of, is_count
from cnc_ptp.parameters.lists.kinds import COMPENSATION, STARTUP, Kind, kind_of
from cnc_ptp.parameters.lists.lines import Line
from cnc_ptp.parameters.lists.machine_text import HEAD, MachineText, Origin
from cnc_ptp.parameters.lists.marks import list_mark
from cnc_ptp.parameters.lists.names import BadIndex, Found, UnknownName, resolve
from cnc_ptp.parameters.lists.problems import ListError, ListProblem
from cnc_ptp.parameters.lists.report import CORRECTED, DEFAULTED, NOTICE, READ, UNKNOWN, ListCount, Report
from cnc_ptp.parameters.lists.units import UNIT_LISTS, Unit, Units, find_units, number_in, place_of
from cnc_ptp.parameters.lists.values import NO_VALUE, BadLine, said_otherwise, split_value, to_yaml
from cnc_ptp.parameters.loader import load_machine
from cnc_ptp.parameters.read.machine_sections import read_parameters
from cnc_ptp.parameters.read.parameter_set import ParameterSet

MACHINE_FILE = "machine.yaml"
"""As the text of the machine is called while it is checked."""


class Imported(NamedTuple):
    """A machine file, the parameters of its nodes by name, and the report."""

    text: str
    sets: Mapping[str, ParameterSet]
    report: Report


def import_lists(
    folder: str,
    files: Mapping[str, bytes],
    *,
    chosen: Mapping[str, Kind] | None = None,
    strict: bool = False,
    incomplete: bool = False,
) -> Imported:
    """The machine of the files of a folder, by name; `chosen`: kinds of lists that their names do not say.

    Raises ListError with all problems; if `strict`, an unknown line is one. If `incomplete`, what values say against
    each other is only reported: no node accepts such a machine yet.
    """
    report = Report()
    reader = Folder(folder, files, chosen or {}, report)
    lists = reader.read()
    problems = reader.problems
    units = find_units(lists, reader.startup, problems)
    alone = bool(problems)
    writer = Writer(report, problems, strict)
    writer.machine(reader.startup, folder, units)
    for unit in units:
        writer.unit(unit)
    checker = Checker(writer.text, Origin(place_of(reader.startup, folder)), report, problems)
    sets = checker.sets(alone=alone, incomplete=incomplete)
    if problems:
        raise ListError(problems)
    add_defaults(sets, units, report)
    return Imported(writer.text.text, sets, report)


class Writer:
    """Writes the sections of the machine file."""

    def __init__(self, report: Report, problems: list[ListProblem], strict: bool) -> None:
        self.report, self.problems, self.strict = report, problems, strict
        self.text = MachineText()
        self.text.add(HEAD)
        self.first: dict[str, Line] = {}
        self.letter = ""
        """Axis type of the unit whose lists are written."""
        self.number: int | None = None
        """Its logical axis number, if its own list has one."""
        self.named: Counter[str] = Counter()
        """How many files of each kind the start-up list names, by the parameter that counts them."""

    def machine(self, startup: ListFile | None, folder: str, units: Units) -> None:
        """The section /machine: its units, and what else the start-up list has."""
        origin = Origin(place_of(startup, folder))
        self.text.section("machine", origin)
        for name, kind in UNIT_LISTS.items():
            self.text.names(name, [unit.name for unit in units.of(kind)], origin)
        self.first = {}
        if startup:
            entries = [entry for line in startup.lines if (entry := entry_of(line))]
            self.named = Counter(kind.counted_by for kind, _ in entries)
            self.add_list("machine", startup)

    def unit(self, unit: Unit) -> None:
        self.text.section(unit.name, Origin(unit.own.place))
        self.first, self.letter, self.number = {}, unit.letter, unit.number
        for entry in unit.lists:
            self.add_list(unit.name, entry)

    def add_list(self, node: str, entry: ListFile) -> None:
        """The lines of one list."""
        self.report.lists.append(ListCount(entry.path, entry.kind.title, node, entry.encoding))
        self.text.mark(list_mark(entry.kind, entry.name))
        lines = list(entry.lines)
        while lines and lines[-1].is_blank:
            lines.pop()
        for line in lines:
            if line.is_blank:
                self.text.add("")
            elif line.comment is not None:
                self.text.comment(line.comment)
            elif not self.is_frame(line, entry.kind):
                self.line(line, entry.kind)

    def is_frame(self, line: Line, kind: Kind) -> bool:
        """Whether a line only says what the machine file has in another form: files of lists, their numbers, units.

        Its remark becomes a comment.
        """
        if kind is not STARTUP or not (entry_of(line) or is_count(line) or line.name in UNIT_LISTS):
            return False
        self.frame(line)
        if is_count(line) and (count := self.named[line.name]):
            self.compare(line, count, f"the start-up list names {count}; all that it names are read")
        return True

    def compare(self, line: Line, number: int, text: str) -> None:
        """A notice about a number that the machine file has from elsewhere, if the list gives another one."""
        written, _, _ = line.rest.partition("#")[0].strip().partition(" ")
        if not written:
            self.problem(errors.LIST_LINE, line, f"{line.name}: {NO_VALUE}")
        elif number_in({line.name: written}, line.name) != number:
            self.report.add(NOTICE, line.value_place, f"{line.name} is {written}, but {text}")

    def frame(self, line: Line) -> None:
        self.report.add(READ, line.place, " ".join(line.text.split()))
        if remark := line.rest.partition("#")[2].strip():
            self.text.comment(f"{line.name}: {remark}")

    def line(self, line: Line, kind: Kind) -> None:
        """A line with a value, or one that is kept as it is."""
        if not line.name:
            self.keep(line, "no name of a parameter begins it")
            return
        try:
            found = self.found(kind, line)
            written = split_value(found.declaration, line.rest)
        except UnknownName as reason:
            self.keep(line, f"{line.name}: {reason}")
        except BadIndex as reason:
            self.problems.append(ListProblem(errors.INDEX, line.place, f"{line.name}: {reason}", line.text))
        except BadLine as reason:
            self.problem(errors.LIST_LINE, line, f"{line.name}: {reason}")
        else:
            if kind is COMPENSATION and found.declaration.id == ids.KOPF_ACHS_NR:
                self.frame(line)
                if self.number is not None:
                    text = f"no axis has this number; this is taken as the list of number {self.number}"
                    self.compare(line, self.number, text)
            else:
                if said := said_otherwise(found.declaration, written):
                    text = f"the remark says {said}, the value is {written.value}; the value counts"
                    self.report.add(NOTICE, line.value_place, f"{line.name}: {text}")
                self.value(line, kind, found, to_yaml(found.declaration, written.value), written.remark)

    def found(self, kind: Kind, line: Line) -> Found:
        """The parameter of a line. Raises UnknownName, also for one that axes of another type have, and BadIndex."""
        found = resolve(kind.node, line.name)
        axes = found.declaration.axes
        if axes and self.letter and self.letter not in axes:
            fitting = " and ".join(AXIS_LETTERS[letter] for letter in axes)
            reason = f"only {fitting} have {found.declaration.id}, this is one of the {AXIS_LETTERS[self.letter]}"
            raise UnknownName(reason)
        return found

    def value(self, line: Line, kind: Kind, found: Found, value: str, remark: str) -> None:
        name = found.declaration.ros_name(found.indexes)
        if (first := self.first.setdefault(name, line)) is not line:
            text = f"{found.declaration.id} {found.declaration.list_style_name(found.indexes)} is given twice"
            where = f"line {first.place.line}" if first.place.file == line.place.file else f"{first.place}"
            self.problem(errors.DUPLICATE_KEY, line, f"{text}, first in {where}; delete one of the lines")
            return
        other = kind_of(found.declaration)
        moved = f"it belongs into the {other.title}, where an export puts it" if other is not kind else ""
        corrections = [correction for correction in (found.correction, moved) if correction]
        for correction in corrections:
            self.report.add(CORRECTED, line.place, correction)
        if not corrections:
            self.report.add(READ, line.place, " ".join(line.text.split()))
        self.text.value(name, value, remark, Origin(line.value_place, line.text))

    def keep(self, line: Line, reason: str) -> None:
        """A line that nothing reads; an export writes it again."""
        if self.strict:
            self.problems.append(ListProblem(errors.UNKNOWN_NAME, line.place, reason, line.text))
        self.report.add(UNKNOWN, line.place, f"{reason}; kept")
        self.text.unknown(line.kept)

    def problem(self, error_id: int, line: Line, text: str) -> None:
        self.problems.append(ListProblem(error_id, line.value_place, text, line.text))


class Checker:
    """Reads the machine file that was made; what its reader says gets the places in the lists."""

    def __init__(self, text: MachineText, nowhere: Origin, report: Report, problems: list[ListProblem]) -> None:
        self.text, self.nowhere, self.report, self.problems = text, nowhere, report, problems

    def sets(self, *, alone: bool, incomplete: bool) -> Mapping[str, ParameterSet]:
        """The parameters by node; none, with problems, if it is refused.

        If a list is missing already (`alone`), only single values are checked; the other checks would say so again.
        """
        text, file = self.text.text, MACHINE_FILE
        try:
            machine = load_machine(text, file, lambda place: self.origin(place).place)
        except ParameterError as error:
            if not (incomplete or alone):
                self.refused(error.problems)
                return {}
            return self.incomplete_sets(text, file, error.problems)
        for notice in machine.warnings:
            self.report.add(NOTICE, self.origin(notice.place).place, f"{notice.parameter}: {notice.text}")
        return machine.sets

    def incomplete_sets(self, text: str, file: str, found: Sequence[Problem]) -> Mapping[str, ParameterSet]:
        """As `sets`; problems of single values stay such, the others become notices."""
        try:
            machine, sets, of_values = read_parameters(text, file)
        except ParameterError as error:
            self.refused(error.problems)
            return {}
        self.refused(of_values)
        for problem in found:
            if problem not in of_values:
                self.report.add(NOTICE, self.origin(problem.place).place, f"P-ERR-{problem.error_id} {problem.text}")
        return {"machine": machine, **sets}

    def refused(self, found: Iterable[Problem]) -> None:
        for problem in found:
            place, line = self.origin(problem.place)
            self.problems.append(ListProblem(problem.error_id, place, problem.text, line))

    def origin(self, place: Place) -> Origin:
        """Of a place in the machine file, or of one in a list."""
        if place.file == MACHINE_FILE:
            return self.text.origin(place.line, self.nowhere)
        return next((known for known in self.text.origins if known and known.place == place), Origin(place))


def add_defaults(sets: Mapping[str, ParameterSet], units: Units, report: Report) -> None:
    """Reports what no list gives."""
    for unit in units:
        parameters = sets[unit.name]
        for declaration, indexes, value in parameters.parameters():
            if not parameters.is_given(declaration.id, *indexes):
                name = declaration.list_style_name(indexes)
                report.add(DEFAULTED, unit.own.place, f"{declaration.id} {name} {default_text(value)}")
