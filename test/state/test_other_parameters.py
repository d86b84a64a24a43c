"""Other parameters for units in the middle of a run."""

from __future__ import annotations

import pytest
from machine_support import MILL, PTP

from cnc_ptp.errors import CncError
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.state.other_parameters import ParameterChange, change_parameters


def test_other_units_are_refused() -> None:
    runners, _ = OfflineMachine(MILL, build_units(MILL)).parts
    with pytest.raises(CncError) as refused:
        change_parameters(runners, MILL, PTP)
    assert str(refused.value) == "P-ERR-26156 other parameters would give the machine other units; nothing was computed"


@pytest.mark.parametrize(
    ("here", "old", "new", "is_refused"),
    [({"a": []}, {"a": []}, {"a": {}}, True), ({"a": ([],)}, {"a": ([], 1)}, {"a": ({}, 1)}, False)],
)
def test_other_parts_are_refused(here: object, old: object, new: object, is_refused: bool) -> None:
    if not is_refused:  # the run has put something else there: it stays
        ParameterChange().change(here, old, new, "x")
        assert here == {"a": ([],)}
        return
    with pytest.raises(CncError) as refused:
        ParameterChange().change(here, old, new, "x")
    assert str(refused.value) == ("P-ERR-26156 other parameters would give x other parts; nothing was computed")


def test_what_the_run_has_changed_stays_and_the_rest_is_taken() -> None:
    here = {"kv": 5.0, "position": 3.0, "list": [1.0, 2.0]}
    old = {"kv": 5.0, "position": 0.0, "list": [1.0, 1.0]}
    new = {"kv": 8.0, "position": 1.0, "list": [4.0, 4.0]}
    ParameterChange().change(here, old, new, "x")
    assert here == {"kv": 8.0, "position": 3.0, "list": [4.0, 2.0]}
