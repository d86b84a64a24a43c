"""Where a parameter acts: sections of the documents that name it, modules that read it. For docs/parameters.md."""

import re
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import Declaration

PACKAGE = Path(__file__).parents[2]
DOCUMENTS = PACKAGE.parent / "docs"
GENERATED = ("parameters", "commands", "hli_objects", "nc_language", "iso_language", "gallery", "index")
"""Pages that are lists themselves."""
LISTS = ("Parameters of chapter 3", "Errors, warnings, faults", "Errors")
"""Sections that name many parameters; they are shown only where no other does."""
MOST = 2
"""Sections that are named for a parameter."""
_ID = re.compile(r"P-[A-Z]+-[0-9]{5}")
_SHORT = re.compile(r"(?<![0-9-])[0-9]{5}(?![0-9])")
"""A number without its list: 00129/00128."""
_CONSTANT = re.compile(r"\bids\.([A-Z0-9_]+)")


class Section(NamedTuple):
    """A headline of a page and its anchor."""

    page: str
    title: str
    anchor: str

    @property
    def link(self) -> str:
        """In Markdown, from a page beside it."""
        return f"[{self.page}: {self.title}]({self.page}.md#{self.anchor})"


def sections_of(declaration: Declaration) -> list[Section]:
    """The sections that name a parameter most often, those that come first before others."""
    found = mentions().get(declaration.id, Counter())
    own = Counter({section: count for section, count in found.items() if section.title not in LISTS})
    return [section for section, _ in (own or found).most_common(MOST)]


def modules_of(declaration: Declaration) -> list[str]:
    """The modules of the package that read a parameter: parameters/view/axis_view.py."""
    return readers().get(declaration.id, [])


@cache
def mentions() -> dict[str, Counter[Section]]:
    """Id -> how often each section names it, in the order of the pages."""
    found: dict[str, Counter[Section]] = {}
    for page in sorted(DOCUMENTS.glob("*.md")):
        if page.stem in GENERATED:
            continue
        for section, line in lines_of(page):
            for number in ids_in(line):
                found.setdefault(number, Counter())[section] += 1
    return found


def lines_of(page: Path) -> Iterator[tuple[Section, str]]:
    """The lines of a page with their sections, anchors as GitHub and the site make them."""
    used: Counter[str] = Counter()
    section, code = None, False
    for line in page.read_text(encoding="utf-8").splitlines():
        code ^= line.startswith("```")
        if not code and (head := re.match(r"#+ (.+)", line)):
            title = re.sub(r"`|\[([^]]*)\]\([^)]*\)", lambda link: link[1] or "", head[1]).strip()
            slug = re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")
            section = Section(page.stem, title, f"{slug}-{used[slug]}" if used[slug] else slug)
            used[slug] += 1
        elif section is not None:
            yield section, line


def ids_in(line: str) -> Iterator[str]:
    """Full ids, and short numbers of the list that the line has named before: P-AXIS-00129/00128."""
    prefix = ""
    for found in re.finditer(rf"{_ID.pattern}|{_SHORT.pattern}", line):
        if found[0].startswith("P-"):
            prefix = found[0].rpartition("-")[0]
            yield found[0]
        elif prefix:
            yield f"{prefix}-{found[0]}"


@cache
def readers() -> dict[str, list[str]]:
    """Id -> modules that use its constant, the views first: they make of it what the kernel takes."""
    found: dict[str, list[str]] = {}
    modules = (path.relative_to(PACKAGE) for path in PACKAGE.rglob("*.py"))
    for module in sorted(modules, key=lambda module: ("view" not in module.parts, module)):
        if "declare" in module.parts or "check" in module.parts:
            continue
        for name in dict.fromkeys(_CONSTANT.findall((PACKAGE / module).read_text(encoding="utf-8"))):
            if number := getattr(ids, name, ""):
                found.setdefault(number, []).append(module.as_posix())
    return found
