"""The structures of a program's lines: which $ENDIF belongs to which $IF, where labels are, where a jump leads to."""

from collections.abc import Sequence
from typing import Final, NamedTuple

from cnc_ptp.errors import nearest_name
from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.expressions.nodes import Node
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow import flow_faults as faults

DEEPEST: Final = 40
"""Structures within each other."""
CLOSING: Final = {
    "$IF": "$ENDIF",
    "$SWITCH": "$ENDSWITCH",
    "$FOR": "$ENDFOR",
    "$WHILE": "$ENDWHILE",
    "$DO": "$ENDDO",
    "$REPEAT": "$UNTIL",
}
OPENED: Final = {closing: opening for opening, closing in CLOSING.items()}
DIVIDES: Final = {"$ELSEIF": "$IF", "$ELSE": "$IF", "$CASE": "$SWITCH", "$DEFAULT": "$SWITCH"}
LOOPS: Final = ("$FOR", "$WHILE", "$DO", "$REPEAT")


class Place(NamedTuple):
    """Where a line begins: its number from 1, its offset in the text (END behind the last line)."""

    line: int
    offset: int


NOWHERE: Final = Place(0, -1)


class Branch(NamedTuple):
    """$IF, $ELSEIF, $CASE with their condition or value, $ELSE and $DEFAULT without; `place`: the line behind it."""

    keyword: str
    condition: Node | None
    place: Place
    line: int


class Control:
    """The keyword of a control statement ($IF), its column and the condition or value of a branch."""

    def __init__(self, keyword: str, column: int) -> None:
        self.keyword, self.column = keyword, column
        self.condition: Node | None = None
        self.synchronises = False
        """What its structure evaluates in another line reads what only the run knows."""


class Structure:
    """A condition or loop: `begin` is its first line, `body` the one behind it, `end` its last one, `after` follows."""

    def __init__(self, keyword: str, begin: Place, body: Place, parent: "Structure | None", source: Source) -> None:
        self.keyword, self.begin, self.body, self.parent, self.source = keyword, begin, body, parent, source
        self.end = NOWHERE
        self.after = NOWHERE
        self.branches: list[Branch] = []
        self.synchronises = False
        """One of its conditions or its end value reads what only the run knows."""
        self.statement: object = None
        """The $FOR that counts the turns."""

    @property
    def depth(self) -> int:
        return 1 if self.parent is None else 1 + self.parent.depth

    def innermost(self, keywords: Sequence[str]) -> "Structure | None":
        """This one or the nearest around it that is one of `keywords`."""
        structure: Structure | None = self
        while structure is not None and structure.keyword not in keywords:
            structure = structure.parent
        return structure

    @property
    def outermost(self) -> "Structure":
        """The one around it that is within no other; itself if there is none."""
        structure = self
        while structure.parent is not None:
            structure = structure.parent
        return structure

    def surrounds(self, other: "Structure | None") -> bool:
        """Whether `other` is this one or stands within it."""
        while other is not None and other is not self:
            other = other.parent
        return other is self


class Label(NamedTuple):
    """A place to jump to, and the structure around it."""

    place: Place
    structure: Structure | None


class Jump(NamedTuple):
    """A $GOTO while its label is not known yet."""

    label: str
    line: int
    column: int
    structure: Structure | None
    source: Source


class StructureReader:
    """Collects the structures of one main program or subroutine, line by line."""

    def __init__(self, program: str) -> None:
        self.program = program
        """Its title, for errors."""
        self.open: Structure | None = None
        self.labels: dict[str, Label] = {}
        self.jumps: list[Jump] = []

    @property
    def awaits_case(self) -> bool:
        """A $SWITCH has begun, and no $CASE of it."""
        return self.open is not None and self.open.keyword == "$SWITCH" and not self.open.branches

    def opens(self, control: Control, begin: Place, behind: Place, source: Source) -> Structure:
        """$IF, $FOR ... in line `begin`; `behind` is the next one."""
        keyword = control.keyword
        structure = Structure(keyword, begin, behind, self.open, source)
        if structure.depth > DEEPEST:
            raise faults.TOO_DEEP.at(source, control.column, keyword=keyword, depth=structure.depth, limit=DEEPEST)
        if keyword == "$IF":
            structure.branches.append(Branch(keyword, control.condition, behind, begin.line))
        self.open = structure
        return structure

    def divides(self, control: Control, begin: Place, behind: Place, source: Source) -> Structure:
        """$ELSE, $CASE ..."""
        keyword, column = control.keyword, control.column
        structure = self._current(keyword, DIVIDES[keyword], source, column)
        for branch in structure.branches:
            if branch.keyword == "$ELSE":
                raise faults.AFTER_ELSE.at(source, column, keyword=keyword, line=branch.line)
            if branch.keyword == keyword == "$DEFAULT":
                raise faults.SECOND_DEFAULT.at(source, column, line=branch.line)
        structure.branches.append(Branch(keyword, control.condition, behind, begin.line))
        return structure

    def closes(self, keyword: str, begin: Place, behind: Place, source: Source, column: int) -> Structure:
        structure = self._current(keyword, OPENED[keyword], source, column)
        structure.end, structure.after = begin, behind
        self.open = structure.parent
        return structure

    def _current(self, keyword: str, opening: str, source: Source, column: int) -> Structure:
        """The open structure, which must be of this kind."""
        current = self.open
        if current is None or current.innermost((opening,)) is None:
            raise faults.STRAY[keyword].at(source, column)
        if current.keyword != opening:
            values = {"opened": current.keyword, "closing": CLOSING[current.keyword]}
            outer = current.innermost((opening,))
            assert outer is not None
            self.open = outer.parent if keyword in OPENED else outer
            raise faults.CROSSED.at(source, column, keyword=keyword, line=current.begin.line, **values)
        return current

    def leaves(self, keyword: str, source: Source, column: int) -> Structure:
        """$BREAK and $CONTINUE: what they leave or continue."""
        kinds = LOOPS if keyword == "$CONTINUE" else (*LOOPS, "$SWITCH")
        found = self.open.innermost(kinds) if self.open is not None else None
        if found is None:
            raise faults.STRAY[keyword].at(source, column)
        return found

    def label(self, name: str, place: Place, source: Source, column: int) -> None:
        known = self.labels.get(name)
        if known is not None:
            line = known.place.line
            raise faults.LABEL_TWICE.at(source, column, label=name, program=self.program, line=line)
        self.labels[name] = Label(place, self.open)

    def jump(self, label: str, line: int, source: Source, column: int) -> None:
        self.jumps.append(Jump(label, line, column, self.open, source))

    def finish(self, errors: list[ProgramError]) -> dict[int, Place | ProgramError]:
        """Targets of all jumps by line, or why there is none; what is not closed becomes an error."""
        left = self.open
        while left is not None:
            values = {"keyword": left.keyword, "closing": CLOSING[left.keyword], "program": self.program}
            errors.append(
                faults.NOT_CLOSED.at(left.source, left.source.column(left.keyword), line=left.begin.line, **values)
            )
            left = left.parent
        targets: dict[int, Place | ProgramError] = {}
        for jump in self.jumps:
            try:
                targets[jump.line] = self._target(jump)
            except ProgramError as error:
                targets[jump.line] = error
                errors.append(error)
        return targets

    def _target(self, jump: Jump) -> Place:
        label = self.labels.get(jump.label)
        if label is None:
            nearest = nearest_name(jump.label, list(self.labels))
            values = {"program": self.program, "label": jump.label, "nearest": nearest}
            raise faults.LABEL_UNKNOWN.at(jump.source, jump.column, **values)
        loop = label.structure.innermost(LOOPS) if label.structure is not None else None
        if loop is not None and not loop.surrounds(jump.structure):
            values = {"label": jump.label, "keyword": loop.keyword, "line": str(loop.begin.line)}
            raise faults.JUMP_INTO_LOOP.at(jump.source, jump.column, **values)
        return label.place
