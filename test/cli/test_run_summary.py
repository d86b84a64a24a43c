"""The closing lines of a run of the graph, from what its nodes have reported."""

import sys
from io import StringIO
from pathlib import Path
from types import SimpleNamespace

import pytest

from cnc_ptp import KERNEL
from cnc_ptp.channel.program_report import ProgramReport
from cnc_ptp.commands.run import run as command
from cnc_ptp.commands.run.progress import RunProgress
from cnc_ptp.commands.run.run import print_summary
from cnc_ptp.commands.run.simulate import ratio_text
from cnc_ptp.nodes.unit.lateness import Lateness
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.channel_states import ChannelStateCode as C
from cnc_ptp.protocol.notes import Note, Notes

ONE_CHANNEL = {"channel": ProgramReport(40)}
PTP = Path(__file__).parents[2] / "config" / "ptp.yaml"


def reported(more=()):
    return {"blocks": 7.0, "lost blocks": 0.0, "blocks that came twice": 1.0, **dict(more)}


def monitor(diagnostics, *, notes=(), run_failed=False, programs=ONE_CHANNEL):
    return SimpleNamespace(
        diagnostics=diagnostics,
        cycle=70,
        programs=programs,
        ending="",
        lateness=Lateness,
        errors=[],
        notes=list(notes),
        refused=sum(note.refused for note in notes),
        run_failed=run_failed,
    )


@pytest.mark.parametrize(
    ("ratio", "text"), [(0.573, "0.57"), (0.0412, "0.041"), (3.44, "3.4"), (9.96, "10"), (57.4, "57"), (123.4, "123")]
)
def test_a_ratio_to_real_time_has_two_digits(ratio, text):
    assert ratio_text(ratio) == text


def test_axes_come_in_the_order_of_the_machine_file(capsys):
    """The nodes report in any order; z has not reported at all."""
    heard = {"c": (0.5, "deg"), "y": (0.25, "mm"), "x": (0.125, "mm")}
    diagnostics = {"plc": reported()}
    for name, (error, unit) in heard.items():
        diagnostics[name] = reported({f"following error, largest [{unit}]": error})
    print_summary(read_machine(PTP), monitor(diagnostics), [])
    assert capsys.readouterr().out.splitlines() == [
        f"machine time 0.070 s (70 cycles), {KERNEL.kind}",
        "program time 0.040 s",
        "blocks 28 in 4 nodes, lost 0, computed twice 4",
        "largest following error x: 0.1250 mm",
        "largest following error y: 0.2500 mm",
        "largest following error c: 0.5000 deg",
    ]


def test_each_channel_has_its_program_time_and_is_told_when_it_was_cut_off(capsys):
    programs = {"one": ProgramReport(40, done=True, line=3), "two": ProgramReport(70, False, 2, C.RUNNING)}
    print_summary(read_machine(PTP), monitor({}, programs=programs), [], 0.07)
    told = capsys.readouterr().out.splitlines()
    assert told[1:3] == ["program time one: 0.040 s", "program time two: 0.070 s"]
    assert told[4:] == [
        "warning: P-WARN-26121 channel two: --duration 0.07 s has cut off the program in line 2, state RUNNING"
    ]
    print_summary(read_machine(PTP), monitor({}, programs=programs), ["P-ERR-26106 interrupted"], 0.07)
    assert "P-WARN-26121" not in capsys.readouterr().out


@pytest.mark.parametrize(("failures", "run_failed"), [([], False), (["P-ERR-26106 interrupted"], False), ([], True)])
def test_axes_that_stood_when_everything_was_stopped_are_no_news(failures, run_failed, capsys):
    stood, news = "axis x: stop without effect in Standstill", "axis x: target is its position"
    notes = [Note(0, stood, idle_stop=True), Note(0, news)]
    print_summary(read_machine(PTP), monitor({}, notes=notes, run_failed=run_failed), failures)
    told = capsys.readouterr().out.splitlines()[3:]
    warnings = [f"warning: {text}" for text in (stood, news)]
    assert told == [*(f"failed: {text}" for text in failures), *warnings[bool(failures or run_failed) :]]


@pytest.mark.parametrize(("duration", "told"), [(None, True), (0.0, False)])
def test_a_graph_without_anything_to_do_says_so(duration, told, capsys, monkeypatch):
    supervisor = SimpleNamespace(run=lambda: monitor({}), failures=[])
    monkeypatch.setattr(command, "Supervisor", lambda *_, **__: supervisor)
    assert command.run(str(PTP), None, None, duration, None, free_run=True, composed=False) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert (last == "note: there was nothing to do, give --program, --scenario, --plc, --duration or --stay") is told


def test_a_terminal_sees_notes_as_they_come(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    with RunProgress() as progress:
        for notes in ([Note(0, "one")], [Note(1, "[two] :x:", refused=True), Note(0, "three", idle_stop=True)], []):
            progress.tell(notes)
    shown = capsys.readouterr().err
    assert (shown.count("warning: one"), shown.count("refused: P-ERR-1 [two] :x:"), "three" in shown) == (1, 1, False)
    monkeypatch.delenv("FORCE_COLOR")
    with RunProgress() as progress:
        progress.tell([Note(0, "one")])
    assert capsys.readouterr() == ("", "")


def test_a_run_that_stays_tells_notes_and_faults_without_a_terminal(capsys):
    with RunProgress(always_tells=True) as progress:
        progress.tell([Note(23073, "axis x: stop without effect: the axis does not move")])
        progress.tell([], ["error: P-ERR-26101 axis x: no block"])
    told = "warning: P-WARN-23073 axis x: stop without effect: the axis does not move\nerror: P-ERR-26101 axis x: no block\n"
    assert capsys.readouterr() == ("", told)


@pytest.mark.parametrize("error", [BrokenPipeError(), OSError(28, "No space left on device")])
def test_a_reader_that_has_gone_or_a_full_disk_ends_no_run(error, monkeypatch):
    """As with `2>&1 | tee`, which a Ctrl-C ends too."""
    tries = []

    class Gone(StringIO):
        def write(self, text):
            tries.append(text)
            raise error

    monkeypatch.setattr(sys, "stderr", Gone())
    with RunProgress(always_tells=True) as progress:
        for _ in range(2):
            progress.tell([Note(0, "one")], ["error: two"])
    assert len(tries) == 1


def test_a_note_is_new_once_also_when_its_refusal_comes_later():
    notes = Notes()
    for note in (Note(1, "one"), Note(1, "one"), Note(2, "two", refused=True)):
        notes.add(note)
    assert [str(note) for note in notes.take_new()] == ["warning: P-WARN-1 one", "refused: P-ERR-2 two"]
    notes.add(Note(1, "one", refused=True))
    assert notes.take_new() == [] and [note.refused for note in notes] == [True, True]
