"""What `check` finds: errors of the language and of the machine, all of them."""

from __future__ import annotations

from dataclasses import replace

import pytest
from machine_support import ROOT

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.nc.contour import Smoothing
from cnc_ptp.parameters import read_machine


def errors(machine: str, text: str) -> list[tuple[int, int]]:
    """Line and number of each error."""
    check = ProgramCheck.of_first_channel(read_machine(ROOT / machine), "test.nc")
    return [(error.line, error.number) for error in check.errors(text, "test.nc")]


def test_errors_of_the_machine_are_found_behind_those_of_the_language():
    assert errors("config/mill.yaml", "M77\nX=P9\nM78\nX5\nM78\nM30\n") == [
        *((1, 22011), (2, 20925), (3, 22011), (5, 22011)),
    ]


def test_the_callers_of_a_line_that_the_machine_cannot_carry_out():
    check = ProgramCheck.of_first_channel(read_machine(ROOT / "config/mill.yaml"), "test.nc")
    (error,) = check.errors("%L A\nM77\nM29\n%MAIN\nLL A\nM30\n", "test.nc")
    assert error.full_message.endswith(", called in test.nc line 5")


@pytest.mark.parametrize("between", ["", "X=P9\n"])
def test_threads_are_checked_from_where_they_begin(between):
    found = errors("config/lathe.yaml", f"M03 S3000\nG33 Z270 K30\n{between}G33 Z240 K30\nM30\n")
    assert [pair for pair in found if pair[1] == 22082] == [(2, 22082), (4 if between else 3, 22082)]


def test_a_check_starts_with_the_transition_of_the_machine():
    """Measuring runs are refused while corners are rounded."""
    machine = read_machine(ROOT / "config/mill.yaml")
    channels = {name: replace(channel, transition=261) for name, channel in machine.channels.items()}
    check = ProgramCheck.of_first_channel(replace(machine, channels=channels), "test.nc")
    assert [error.number for error in check.errors("G100 X1 F100\nM30\n", "test.nc")] == [120652]


def test_hsc_takes_the_tolerance_of_the_machine():
    machine = read_machine(ROOT / "config/mill.yaml")
    channels = {name: replace(channel, hsc_path_dev=0.02) for name, channel in machine.channels.items()}
    check = ProgramCheck.of_first_channel(replace(machine, channels=channels), "test.nc")
    first, *_ = check.blocks(check.parse("#HSC ON\nG01 X1 F100\nM30\n", "test.nc"), (0.0,) * 3)
    assert first.motion.transition.smoothing == Smoothing(0.02)
