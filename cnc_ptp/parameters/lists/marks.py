"""How a machine file keeps what is no parameter of it: comments with a mark, which nothing but an export reads.

#: axis list achs_mds_x.lis     what follows is from this list
#? handbetrieb.hb.a_max 300     a line that no declaration has; an export writes it again
"""

from __future__ import annotations

import re
from typing import Final

from cnc_ptp.parameters.lists.kinds import KINDS, Kind
from cnc_ptp.parameters.lists.text import FOREIGN

LIST: Final = "#:"
UNKNOWN: Final = "#?"
_MARK: Final = re.compile(rf"#: ({'|'.join(KINDS)}) list (.+)")
_FILE: Final = re.compile(r"[^/\\\0]*[^/\\\0.\s][^/\\\0]*")


def list_mark(kind: Kind, file: str) -> str:
    return f"{LIST} {kind.title} {file}"


def read_mark(comment: str) -> tuple[Kind, str] | None:
    """Kind and file of a comment that begins a list; None if it is another one, or names no plain file."""
    found = _MARK.fullmatch(comment.strip())
    return (KINDS[found[1]], found[2]) if found and is_file_name(found[2]) else None


def is_file_name(name: str) -> bool:
    """Whether a name is that of a file in a folder, and of no other folder."""
    return _FILE.fullmatch(name) is not None and FOREIGN.search(name) is None


def comment_line(comment: str) -> str:
    """A comment of a list in YAML and in a list; never a mark, as a blank is behind its #."""
    return f"# {comment}" if comment else "#"
