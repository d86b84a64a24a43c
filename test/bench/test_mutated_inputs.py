"""A few hundred mutated inputs of each kind, always the same ones; `python -m bench.fuzz` tries as many as wanted."""

import asyncio
import itertools
import mmap
import os
import subprocess
import sys
import time
from types import SimpleNamespace

import click
import pytest
from click.testing import CliRunner

from bench import fuzz
from bench.fuzzing import doors, engine, messages, web_messages
from bench.fuzzing.engine import Broken, Draw, Kind, Target, Verdict, attempt, objection, run
from bench.fuzzing.graph import ACTION, SERVICE, TOPIC, Goal, Graph
from bench.fuzzing.guard import guarded
from bench.fuzzing.kinds import KINDS
from bench.fuzzing.recordings import both
from cnc_ptp import srv
from cnc_ptp.errors import CncError
from cnc_ptp.nodes.access_policy import PARAMETER_EVENTS, ROSOUT, external_plc_access, machine_access
from cnc_ptp.nodes.topics import DRIVE_STOPS, TICK, block_topic
from cnc_ptp.parameters import read_machine

SEED = 1


THROUGH_NODES = pytest.mark.motion_unchecked("what the recorder does not get: commands that explain a jump")


@pytest.mark.parametrize(
    "kind",
    [
        pytest.param(kind, marks=[THROUGH_NODES] if name in ("topic", "service", "goal") else [])
        for name, kind in KINDS.items()
    ],
    ids=[*KINDS],
)
def test_mutated_inputs_are_taken_as_documented(kind, tmp_path):
    verdict = run(kind, SEED, kind.daily, tmp_path)
    assert not verdict.findings, "\n".join(map(str, verdict.findings))
    assert verdict.count == kind.daily
    assert 0 < verdict.refused < verdict.count, "inputs are mutated not enough, or too much"


def test_every_byte_has_its_number(tmp_path):
    forms = both(tmp_path)
    make = KINDS["mcap-every"].prepare(tmp_path).make
    for number in (0, 1, 2, 3, 4, 5, 4 * len(forms[0]) - 4, 4 * len(forms[1]) - 1):
        form, place, given = forms[number % 2], number // 4 % len(forms[number % 2]), make(Draw("x", SEED, number))
        if number // 2 % 2:
            assert given == form[:place]
        else:
            assert [at for at in range(len(form)) if form[at] != given[at]] == [place]


# nodes


def test_no_door_of_a_node_is_left_out(tmp_path):
    """By the access policy. Ticks and blocks are handed over in one process: the kind `block` has them."""
    machine = read_machine(str(doors.MACHINE))
    graph = Graph(doors.MACHINE, tmp_path)
    nodes = {node.get_name() for node in graph.nodes}
    graph.close()
    names = {}
    for kind, node, name in graph.inputs:
        names.setdefault((kind, node), set()).add(name)
    handed_over = {TICK, DRIVE_STOPS, *map(block_topic, graph.units)}
    for access in machine_access(machine):
        if access.name in nodes:
            read = {name.removeprefix("/") for name in access.subscribe}
            found = names.get((TOPIC, access.name), set())
            assert found <= read and read - found <= handed_over, access.name
            assert names.get((SERVICE, access.name), set()) == access.reply
            assert names.get((ACTION, access.name), set()) == access.execute
    written = external_plc_access(machine).publish - {ROSOUT, PARAMETER_EVENTS}
    assert written <= names[TOPIC, "plc"]
    assert {DRIVE_STOPS, "checkpoints"} <= names[TOPIC, "recorder"]


@pytest.fixture
def graph(tmp_path):
    graph = Graph(doors.MACHINE, tmp_path)
    yield graph
    graph.close()


def test_what_ends_a_node_or_changes_a_unit_is_found(graph, monkeypatch):
    stop = graph.inputs[SERVICE, "x", "x/stop"]
    refused = graph.call(graph.inputs[SERVICE, "x", "x/move_absolute"], srv.MoveAbsolute.Request())
    assert (refused.accepted, refused.error_id) == (False, 22001)
    with pytest.raises(CncError):
        graph.check()
    graph.check()

    def ends(*_):
        raise CncError(26267, "its drive has stopped")

    monkeypatch.setattr(stop.receive, "callback", ends)
    with pytest.raises(Broken, match="the node would end: P-ERR-26267"):
        graph.call(stop, stop.type.Request())
    graph.units["x"].failure = CncError(26267, "its drive has stopped")
    with pytest.raises(Broken, match="node x would end: P-ERR-26267"):
        graph.check()


def test_a_refusal_that_changes_a_unit_is_found(graph, monkeypatch):
    move = graph.inputs[SERVICE, "x", "x/power"]
    carried_out = move.receive.callback

    def says_no(request, response):
        carried_out(request, response)
        response.accepted, response.error_id, response.message = False, 22001, "refused; nothing was changed"
        return response

    monkeypatch.setattr(move.receive, "callback", says_no)
    graph.call(move, move.type.Request(enabled=False))
    with pytest.raises(Broken, match="a refusal has changed something: refused; nothing was changed"):
        graph.check()


def test_a_goal_that_ends_twice_is_found():
    goal = Goal(None)
    with pytest.raises(Broken, match="nobody has canceled"):
        goal.canceled()
    goal.succeed()
    with pytest.raises(Broken, match="a goal ends twice"):
        goal.abort()


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
    assert str(finding).startswith("made up number 0: no end within 0.05 s\n  input: 0.")
    assert str(finding).endswith("\n  again: made up --seed 1 --first 0 --count 1")


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


def test_a_target_is_closed_whatever_happens(tmp_path):
    closed = []

    def call(_given):
        raise KeyboardInterrupt

    kind = Kind("made up", lambda folder: Target(lambda draw: 0, call, lambda: closed.append(True)), 1)
    with pytest.raises(KeyboardInterrupt):
        run(kind, SEED, 1, tmp_path)
    assert closed == [True]


# memory


def memory_at(monkeypatch, *held):
    """Stands for what the process holds at half, three quarters and the end, in KiB."""
    numbers = iter(held)

    class Process:
        def memory_info(self):
            return SimpleNamespace(rss=next(numbers) * 1024)

    monkeypatch.setattr(engine.psutil, "Process", Process)


def test_a_kind_that_leaks_is_found(monkeypatch, tmp_path):
    monkeypatch.setattr(engine, "LEAST_JUDGED", 100)
    kept = []

    def leak(_given):
        kept.append(mmap.mmap(-1, 1 << 19))  # memory that was not in use before, whatever this process has freed
        kept[-1].write(b"x" * (1 << 19))

    verdict = run(kind_of(leak), SEED, 100, tmp_path)
    (finding,) = verdict.findings
    assert (verdict.undocumented, finding.first, finding.number, finding.input) == (1, 0, 99, "all of these")
    assert finding.reason.startswith("memory grows: ")
    assert 2 * engine.LARGEST_GROWTH < verdict.growth < 64 << 10


def test_growth_is_judged_by_both_quarters(monkeypatch, tmp_path):
    count = engine.LEAST_JUDGED
    memory_at(monkeypatch, 1000, 1000 + 4097, 1000 + 9000)
    verdict = run(kind_of(lambda given: None), SEED, count, tmp_path, first=7)
    assert [str(finding) for finding in verdict.findings] == [
        f"made up number {count + 6}: memory grows: 4,097 KiB in the third quarter of the inputs and 4,903 KiB in the "
        "fourth, more than 4,096 KiB each\n  input: all of these\n"
        f"  again: made up --seed 1 --first 7 --count {count}"
    ]
    assert verdict.growth == 9000


@pytest.mark.long
@pytest.mark.parametrize(
    ("count", "held"),
    [
        (engine.LEAST_JUDGED, (1000, 1000 + 4096, 90_000)),  # at the limit in one quarter
        (engine.LEAST_JUDGED, (1000, 90_000, 90_000)),  # something that is kept once
        (engine.LEAST_JUDGED - 1, (1000, 50_000, 90_000)),  # too few inputs
    ],
)
def test_growth_that_is_no_finding(count, held, monkeypatch, tmp_path):
    memory_at(monkeypatch, *held)
    verdict = run(kind_of(lambda given: None), SEED, count, tmp_path)
    assert (verdict.findings, verdict.count) == ([], count)
    assert verdict.growth == held[-1] - held[0]


# inputs that share a state


@pytest.mark.long
def test_a_finding_names_the_first_input_of_its_state(tmp_path):
    state = []

    def call(given):
        state.append(given)
        if len(state) > 3:
            raise Broken(f"inputs {state}")

    kind = Kind("made up", lambda folder: Target(lambda draw: draw.number, call, renew=state.clear, lasts=5), 1)
    finding = run(kind, SEED, 20, tmp_path, first=6).findings[0]
    assert (finding.first, finding.number, finding.reason) == (
        6,
        9,
        "Broken at no place of cnc_ptp: inputs [6, 7, 8, 9]",
    )
    state.clear()
    finding = run(kind, SEED, 10, tmp_path, first=7).findings[0]
    assert (finding.first, finding.number) == (10, 13)
    state.clear()
    again = run(kind, SEED, finding.number - finding.first + 1, tmp_path, first=finding.first).findings[0]
    assert again == finding


@THROUGH_NODES
@pytest.mark.parametrize("name", ["command", "function-block", "service", "web"])
def test_a_state_is_as_new_at_its_first_input(name, monkeypatch, tmp_path):
    for module in (doors, messages, web_messages):
        monkeypatch.setattr(module, "LASTS", 4)
    told = [outcomes(KINDS[name].prepare(tmp_path), range(first, 8)) for first in (0, 4)]
    assert told[0][4:] == told[1]


def outcomes(target, numbers):
    """What is said about each input."""
    said = []
    try:
        for number in numbers:
            if number % target.lasts == 0:
                target.renew()
            try:
                said.append(target.call(target.make(Draw("made up", SEED, number))))
            except CncError as error:
                said.append(str(error))
    finally:
        target.close()
    return said


# HTTP

REQUEST = b"GET / HTTP/1.1\r\nContent-Length: 2\r\n\r\nab"


@pytest.mark.parametrize(
    ("data", "whole"),
    [
        (REQUEST, True),
        (REQUEST + b"c", True),
        (REQUEST[:-1], False),
        (REQUEST[:-3], False),
        (REQUEST[:-4], False),
        (b"", False),
        (b"GET / HTTP/1.1\r\n\r\n", True),
        (b"GET / HTTP/1.1\r\nContent-Length: x\r\n\r\n", True),
        (b"POST / HTTP/1.1\r\ntransfer-encoding: Chunked\r\n\r\n5\r\n", False),
    ],
)
def test_what_is_a_whole_request(data, whole):
    assert web_messages.is_whole(data) == whole


class Answering:
    """The site of the kind `http`, with a server that gives one answer to everything."""

    def __init__(self, answer):
        self.loop, self.cookie, self.login = asyncio.new_event_loop(), "", SimpleNamespace(token="")
        self.answer = answer
        self.server = self.loop.run_until_complete(asyncio.start_server(self.take, "127.0.0.1", 0))
        self.http = SimpleNamespace(port=self.server.sockets[0].getsockname()[1])

    async def take(self, reader, writer):
        await reader.read(1)
        if self.answer is None:
            await reader.read()  # until the other side gives up
        else:
            writer.write(self.answer)
        writer.close()

    def next_one(self):
        return self

    def renew(self):
        """It is as it was."""

    def close(self):
        self.server.close()
        self.loop.run_until_complete(self.server.wait_closed())
        self.loop.close()


NO_ANSWER = "no answer to a whole request within 0.2 s, or a connection closed without one"


@pytest.mark.parametrize(
    ("answer", "request_", "reason"),
    [
        (None, REQUEST, NO_ANSWER),
        (b"", REQUEST, NO_ANSWER),
        (b"HTTP/1.1 200 OK\r\n", REQUEST, NO_ANSWER),
        (None, REQUEST[:-1], ""),
        (b"HTTP/1.1 200 OK\r\n\r\n", REQUEST, ""),
        (b"HTTP/1.1 404 Not Found\r\nConnection: close\r\n\r\n", REQUEST, ""),
        *((f"HTTP/1.1 {status} x\r\n\r\n".encode(), REQUEST, f"status {status}") for status in (500, 501, 503, 505)),
    ],
)
def test_which_answers_are_documented(answer, request_, reason, monkeypatch, tmp_path):
    monkeypatch.setattr(web_messages, "PATIENCE", 0.2)
    monkeypatch.setattr(web_messages, "Sites", lambda folder: Answering(answer))
    target = web_messages.http_requests(tmp_path)._replace(make=lambda draw: request_)
    kind = Kind("http", lambda folder: target, 1)
    try:
        _, finding = attempt(kind, target, SEED, 0, tmp_path)
    finally:
        target.close()
    assert (finding.reason if finding else "") == (f"Broken at no place of cnc_ptp: {reason}" if reason else "")


# the command line


def test_a_row_of_the_table():
    verdict = Verdict("users", 3, 1200, 1100, 2, [], 0.5, 17, -2048, 9.6)
    assert fuzz.HEAD.split() == [
        *("kind", "seed", "count", "refused", "undocumented", "slowest,", "s", "number", "growth,", "KiB", "s")
    ]
    assert fuzz.row(verdict).split() == ["users", "3", "1,200", "1,100", "2", "0.50", "17", "-2,048", "10"]
    assert len(fuzz.row(verdict)) == len(fuzz.HEAD)


def test_the_command_tries_the_kinds_that_are_named():
    result = CliRunner().invoke(fuzz.main, ["users", "csv", "--count", "5", "--seed", "2"])
    head, *rows = result.stdout.splitlines()
    assert (result.exit_code, head, result.stderr) == (0, fuzz.HEAD, "")
    assert [row.split()[:3] for row in rows] == [["users", "2", "5"], ["csv", "2", "5"]]


def made_up(monkeypatch):
    """The numbers that a kind of its own gets; number 3 is a finding."""
    numbers = []

    def call(number):
        numbers.append(number)
        if number == 3:
            raise Broken("three")

    kind = Kind("made up", lambda folder: Target(lambda draw: draw.number, call), 1)
    monkeypatch.setitem(KINDS, "users", kind)
    return numbers


def test_the_command_begins_at_the_first_number(monkeypatch):
    numbers = made_up(monkeypatch)
    result = CliRunner().invoke(fuzz.main, ["users", "--first", "2", "--count", "3"])
    assert numbers == [2, 3, 4]
    assert result.exit_code == 1
    assert result.stderr == (
        "made up number 3: Broken at no place of cnc_ptp: three\n  input: 3\n"
        "  again: made up --seed 1 --first 3 --count 1\n"
    )


def test_the_command_ends_after_some_minutes(monkeypatch):
    numbers = made_up(monkeypatch)
    clock = itertools.count()
    monkeypatch.setattr(engine, "time", SimpleNamespace(monotonic=lambda: float(next(clock))))
    result = CliRunner().invoke(fuzz.main, ["users", "--first", "4", "--count", "1000", "--minutes", "0.5"])
    assert result.exit_code == 0
    assert numbers == [*range(4, 14)], "three looks at the clock an input, 30 s"
