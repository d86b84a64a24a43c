"""The server gives way to the nodes of a machine: nice 5, set once, whoever starts it."""

import os
import socket
from types import SimpleNamespace

import pytest

from cnc_ptp.commands.run.beside_run import WebBesideRun
from cnc_ptp.commands.run.web import web
from cnc_ptp.web.options import WebOptions


@pytest.fixture
def done(monkeypatch):
    """What a process does, in its order."""
    found = []

    async def serve(*arguments, **options):
        found.append("serves")

    monkeypatch.setattr("os.nice", found.append)
    monkeypatch.setattr("cnc_ptp.commands.run.web.serve", serve)
    return found


def begin(**options):
    assert web(0, "127.0.0.1", (), ".", None, None, None, **options) == 0


def test_on_its_own(done):
    begin()
    assert done == [5, "serves"]


def test_beside_a_run(done, monkeypatch):
    """Who starts it sets it, before it looks for all that it needs."""

    def start(words, *, pass_fds, preexec_fn, **options):
        preexec_fn()
        begin(listening=os.dup(pass_fds[0]))
        return SimpleNamespace(poll=lambda: 0)

    reading, writing = os.pipe()
    with os.fdopen(reading) as held, os.fdopen(writing, "w"):
        monkeypatch.setattr("sys.stdin", held)
        monkeypatch.setattr("cnc_ptp.commands.run.web.end_with", lambda number: None)
        monkeypatch.setattr("subprocess.Popen", start)
        with WebBesideRun(WebOptions(port=0), socket.create_server(("127.0.0.1", 0))) as beside:
            beside.begin()
    assert done == [5, "serves"]
