"""requirements.lock: every requirement has an exact version that fits it, and hashes."""

import os
import re
import subprocess
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]
FILES = ("requirements-build.txt", "requirements.txt", "requirements-test.txt")
ENTRY = re.compile(r"^([A-Za-z0-9._-]+)(?:\[[^\]]*\])?==(\S+)(?: ; .*)? \\$", re.MULTILINE)


def locked():
    """Name -> version."""
    return {
        canonicalize_name(name): version for name, version in ENTRY.findall((ROOT / "requirements.lock").read_text())
    }


def required():
    for file in FILES:
        for line in (ROOT / file).read_text().splitlines():
            text = line.partition("#")[0].strip()
            if text:
                yield Requirement(text)


@pytest.mark.parametrize("requirement", [*required()], ids=lambda requirement: requirement.name)
def test_a_requirement_is_locked(requirement):
    """After a change of a requirement: make lock."""
    version = locked().get(canonicalize_name(requirement.name))
    assert version is not None, "make lock"
    assert requirement.specifier.contains(version, prereleases=True)


@pytest.mark.parametrize(
    ("stamps", "words", "is_locked"),
    [
        ((), ["LOCKED=1"], True),
        ((".requirements",), ["LOCKED=1"], True),  # set up before without it
        ((".requirements-locked",), [], None),  # stays locked: nothing to do
        ((), [], False),
    ],
)
def test_a_locked_setup_takes_nothing_else(tmp_path, stamps, words, is_locked):
    """What make would call in an environment; `is_locked` None: it installs no requirements."""
    for stamp in (".python", *stamps):
        (tmp_path / stamp).touch()
    environment = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MAKELEVEL")}
    call = ["make", "--dry-run", "setup", f"VENV={tmp_path}", *words]
    done = subprocess.run(call, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    calls = [call for call in done.stdout.replace("\\\n", " ").splitlines() if "pip install" in call]
    installs = [call for call in calls if "--no-deps" not in call]
    assert len(installs) == (is_locked is not None) and len(calls) == len(installs) + 1
    if installs:
        assert ("--require-hashes -r requirements.lock" in installs[0]) is is_locked
        assert ("requirements.txt" in installs[0]) is not is_locked


def test_every_entry_has_hashes():
    text = (ROOT / "requirements.lock").read_text()
    entries = [part for part in re.split(r"\n(?=[A-Za-z0-9])", text) if part]
    assert len(entries) == len(locked())
    assert all("--hash=sha256:" in entry for entry in entries)
