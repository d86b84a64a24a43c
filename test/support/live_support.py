"""Commands beside a running machine, called in the process of the test."""

import time
from contextlib import redirect_stderr, redirect_stdout
from tempfile import TemporaryFile
from types import SimpleNamespace

import pytest

from cnc_ptp import cli


def call(*arguments):
    """A command in this process, which has loaded ROS already. (CliRunner's streams are too little for rclpy.)"""
    with TemporaryFile("w+") as out, TemporaryFile("w+") as errors:
        with redirect_stdout(out), redirect_stderr(errors), pytest.raises(SystemExit) as ended:
            cli.main.main([str(argument) for argument in arguments], prog_name="cnc_ptp")
        for file in (out, errors):
            file.seek(0)
        return SimpleNamespace(exit_code=ended.value.code, stdout=out.read(), stderr=errors.read())


def wait_for_machine():
    deadline = time.monotonic() + 60.0
    while call("status").exit_code:
        assert time.monotonic() < deadline, "the machine does not come"
