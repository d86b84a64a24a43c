"""Files, classes and functions that the documents name are there: `axis/axis_unit.py AxisUnit.step`."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
FOLDERS = (ROOT, ROOT / "cnc_ptp", ROOT / "cnc_ptp" / "control")
"""What the paths of a document may be relative to."""
FILES = Counter(file.name for part in ("cnc_ptp", "test", "bench", "figures") for file in (ROOT / part).rglob("*.py"))
NAMED = re.compile(r"`((?:[\w.-]+/)+[\w-]+\.(?:py|yaml|xml|nc|csv))(?: ([\w.]+))?`")
BARE = re.compile(r"`(\w+\.py)\b")
MADE_BY_READER = "runs/"


def missing(text: str) -> list[str]:
    """What a text names and the project does not have."""
    wrong = []
    for path, names in NAMED.findall(text):
        if path.startswith(MADE_BY_READER):
            continue
        file = next((folder / path for folder in FOLDERS if (folder / path).is_file()), None)
        if file is None:
            wrong.append(path)
            continue
        source = file.read_text(encoding="utf-8")
        wrong += [f"{path} {name}" for name in names.split(".") if name and not defines(source, name)]
    return wrong


def ambiguous(text: str) -> list[str]:
    """File names without a folder that the project does not have exactly once."""
    return [name for name in BARE.findall(text) if FILES[name] != 1]


def defines(source: str, name: str) -> bool:
    """Whether a module has a class, function, method or constant of this name."""
    return bool(re.search(rf"^\s*(?:class|def|async def) {name}\b|^{name}\b *[:=]", source, re.MULTILINE))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_what_a_page_names_exists(page: Path) -> None:
    assert missing(page.read_text(encoding="utf-8")) == []


def test_a_wrong_name_is_found() -> None:
    text = "`axis/axis.py Axis`, `axis/none.py`, `axis/axis.py Axis.no_such_method`, `config/mill.yaml`, `runs/x.yaml`"
    assert missing(text) == ["axis/none.py", "axis/axis.py no_such_method"]


@pytest.mark.parametrize("room", ["axis", "channel", "control", "path", "spindle"])
def test_architecture_names_every_file_of_a_room(room: str) -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    files = [path.relative_to(ROOT / "cnc_ptp") for path in (ROOT / "cnc_ptp" / room).rglob("*.py")]
    assert [str(path) for path in files if path.name != "__init__.py" and str(path) not in text] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_file_name_without_folder_is_unique(page: Path) -> None:
    assert ambiguous(page.read_text(encoding="utf-8")) == []


def test_an_ambiguous_file_name_is_found() -> None:
    assert ambiguous("`wiring.py`, `axis.py Axis`, `none.py`, `axis/axis.py`") == ["axis.py", "none.py"]
