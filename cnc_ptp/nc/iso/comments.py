"""Comments of the vocabulary iso."""

from cnc_ptp.nc import faults
from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.iso import iso_faults


def without_comments(source: Source) -> str:
    """The line in capitals with blanks in place of comments, which do not nest; raises ProgramError."""
    kept: list[str] = []
    opened = 0
    for column, character in enumerate(source.text, start=1):
        if opened:
            opened = 0 if character == ")" else opened
            kept.append(" ")
        elif character == ";":
            break
        elif character == "(":
            opened = column
            kept.append(" ")
        elif character == ")":
            raise faults.COMMENT_NOT_OPEN.at(source, column)
        elif not character.isascii():
            raise faults.UNEXPECTED_CHARACTER.at(source, column, character=character)
        else:
            kept.append(character.upper())
    if opened:
        raise iso_faults.COMMENT_OPEN.at(source, opened)
    return "".join(kept).rstrip()
