"""#TIMER and V.G.TIMER: cycles of the run; values of M and H functions at the PLC."""

from __future__ import annotations

import pytest
from machine_support import MachineBench
from replay_support import bits

from cnc_ptp.protocol.notes import PROGRAM_MESSAGE


def messages(bench: MachineBench) -> list[str]:
    return [event.text for event in bench.all_events if event.error_id == PROGRAM_MESSAGE]


def run(program: str, scenario: str = "") -> MachineBench:
    return MachineBench(program, scenario).run()


def test_a_timer_counts_the_time_of_the_path() -> None:
    bench = run(
        "#TIMER START SYN [ID=1]\nG04 X0.5\n#TIMER STOP [ID=1]\nG04 X0.3\n#TIMER READ [ID=1]\nP1 = V.G.TIMER[1]\n"
        "#TIMER START [ID1]\nG04 X0.25\n#TIMER READ SYN [ID=1]\nX[P1 / 100] Y[V.G.TIMER[1] / 100]\nM30"
    )
    assert bench.errors() == bench.refusals() == []
    assert bench.position("x") == pytest.approx(5.0, abs=0.011)
    assert bench.position("y") == pytest.approx(7.5, abs=0.021)


def test_clear_keeps_what_was_read() -> None:
    bench = run(
        "#TIMER START [ID=127]\nG04 X0.2\n#TIMER READ [ID=127]\n#TIMER CLEAR [ID=127]\nX[V.G.TIMER[127] / 100]\n"
        "G04 X0.2\n#TIMER READ [ID=127]\nY[V.G.TIMER[127] + 1] Z[V.G.TIMER[3] - 2]\nM30"
    )
    assert bench.errors() == bench.refusals() == []
    assert bench.position("x") == pytest.approx(2.0, abs=0.011)
    assert (bench.position("y"), bench.position("z")) == (1.0, -2.0)


def test_a_second_start_changes_nothing_and_a_hold_counts() -> None:
    hold = "- {at: 0.1, to: channel, do: feed_hold, enabled: true}\n- {at: 1.1, to: channel, do: feed_hold, enabled: false}\n"
    program = (
        "#TIMER START [ID=1]\nG1 X2 F600\n#TIMER START [ID=1]\n#TIMER READ [ID=1]\nY[V.G.TIMER[1] / 100] F6000\nM30"
    )
    plain, held = run(program), run(program, hold)
    assert held.errors() == [] and held.position("y") - plain.position("y") == pytest.approx(10.0, abs=0.5)
    assert bits(held) == bits(run(program, hold))


def test_timers_stay_from_one_mdi_text_to_the_next() -> None:
    scenario = (
        '- {at: 0, to: channel, do: mdi, text: "#TIMER START [ID=1]"}\n'
        '- {at: 1, to: channel, do: mdi, text: "#TIMER READ [ID=1]\\nX[V.G.TIMER[1] / 1000]"}\n'
    )
    bench = MachineBench(None, scenario).run()
    assert bench.errors() == bench.refusals() == []
    assert bench.position("x") == pytest.approx(1.0, abs=0.02)


def test_values_of_functions_reach_the_plc() -> None:
    bench = run("M8=-345\nP1 = 3\nH5=P1\nM9\nM30")
    assert bench.errors() == bench.refusals() == []
    requests = [request for block in bench.blocks["channel"] for request in block.requests]
    sent = [(request.kind, request.number, request.value) for request in requests]
    assert sent == [("M", 8, -345.0), ("H", 5, 3.0), ("M", 9, 0.0)]
