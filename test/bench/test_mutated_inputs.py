"""A few hundred mutated inputs of each kind, always the same ones; `python -m bench.fuzz` tries as many as wanted."""

import os
import subprocess
import sys
import time

import click
import pytest

from bench.fuzzing import engine
from bench.fuzzing.engine import Broken, Draw, Kind, Target, attempt, objection, run
from bench.fuzzing.guard import guarded
from bench.fuzzing.kinds import KINDS
from bench.fuzzing.recordings import both
from cnc_ptp.errors import CncError

SEED = 1


@pytest.mark.parametrize("kind", KINDS.values(), ids=[*KINDS])
def test_mutated_inputs_are_taken_as_documented(kind, tmp_path):
    verdict = run(kind, SEED, kind.daily, tmp_path)
    assert not verdict.findings, "\n".join(map(str, verdict.findings))
    assert verdict.count == kind.daily
    assert verdict.refused, "no input was refused: they are not mutated enough"


def test_every_byte_has_its_number(tmp_path):
    forms = both(tmp_path)
    make = KINDS["mcap-every"].prepare(tmp_path).make
    for number in (0, 1, 2, 3, 4, 5, 4 * len(forms[0]) - 4, 4 * len(forms[1]) - 1):
        form, place, given = forms[number % 2], number // 4 % len(forms[number % 2]), make(Draw("x", SEED, number))
        if number // 2 % 2:
            assert given == form[:place]
        else:
            assert [at for at in range(len(form)) if form[at] != given[at]] == [place]


# the engine finds what it is there for


def kind_of(call):
    return Kind("made up", lambda folder: Target(lambda draw: draw.random(), call), 1)


def finding_of(call, folder):
    _, finding = attempt(kind_of(call), kind_of(call).prepare(folder), SEED, 0, folder)
    return finding


def raise_(error):
    raise error


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (CncError(22001, "a reason"), ""),
        (click.UsageError("a text"), ""),
        (CncError(22001, " "), "error 22001 has no text"),
        (CncError(99999, "a reason"), "error 99999 is in no catalogue: P-ERR-99999 a reason"),
        (Broken("a state"), "Broken at no place of cnc_ptp: a state"),
        (KeyError("a key"), "KeyError at no place of cnc_ptp: 'a key'"),
    ],
)
def test_what_is_documented(error, reason):
    assert objection(error) == reason


def test_an_input_that_hangs(monkeypatch, tmp_path):
    monkeypatch.setattr(engine, "LONGEST", 0.05)
    finding = finding_of(lambda given: time.sleep(30.0), tmp_path)
    assert finding.reason == "no end within 0.05 s"
    assert str(finding).startswith("made up seed 1 number 0: no end within 0.05 s\n  input: 0.")


def test_an_input_that_writes_elsewhere(tmp_path):
    folder, outside = tmp_path / "folder", tmp_path / "outside.txt"
    folder.mkdir()
    (folder / "link").symlink_to(outside)
    finding = finding_of(lambda given: (folder / "a.txt").write_text("a"), folder)
    assert finding is None
    for path in (outside, folder / "link", folder / ".." / "outside.txt"):
        finding = finding_of(lambda given, path=path: path.write_text("a"), folder)
        assert finding.reason.startswith("PermissionError at ")
        assert not outside.exists()


def test_an_input_that_hides_that_it_writes_elsewhere(tmp_path):
    def call(_given):
        try:
            os.mkdir(tmp_path.parent / "elsewhere")
        except OSError:
            return

    finding = finding_of(call, tmp_path)
    assert finding.reason == f"outside of its folder: os.mkdir {tmp_path.parent / 'elsewhere'}"
    assert not (tmp_path.parent / "elsewhere").exists()


def test_an_input_that_starts_a_process(tmp_path):
    with guarded(tmp_path) as outside, pytest.raises(PermissionError):
        subprocess.run([sys.executable, "-c", "pass"], check=True)
    assert outside[0].startswith("subprocess.Popen ")


def test_findings_of_one_place_are_shown_once(tmp_path):
    verdict = run(kind_of(lambda given: raise_(KeyError(given))), SEED, 30, tmp_path)
    assert (verdict.undocumented, len(verdict.findings), verdict.count) == (30, 1, 30)
