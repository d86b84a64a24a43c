"""State changes are reported as events, with the cycle and the program line."""

from machine_support import MILL

from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import Command, Severity


def test_state_changes_are_events() -> None:
    program = "%P\nN10 G01 X1 F6000\nN20 M00\nM30"
    job = [
        Entry(0.0, Command("channel", "load", {"program": "p", "text": program})),
        Entry(0.0, Command("channel", "start", {})),
        Entry(1.0, Command("channel", "start", {})),
    ]
    events = [
        event
        for outputs in OfflineMachine(MILL, build_units(MILL, scenario=job)).run()
        for output in outputs.values()
        for event in output.events
    ]
    assert {event.severity for event in events} == {Severity.INFO}
    texts = [(event.text, event.line) for event in events]
    assert texts[0] == ("channel: Running -> Stopped", 3)
    assert texts[-1] == ("z: SynchronizedMotion -> Standstill", 0)
