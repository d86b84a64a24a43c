"""`cnc_ptp jog` when its process is suspended."""

import time
from types import SimpleNamespace

from cnc_ptp.commands.client.jog import JOGS, SILENCE, Jogger


class SuspendedClient:
    """Its process is suspended during the second wait; the machine ends the jog meanwhile."""

    def __init__(self):
        self.sent, self.waits = [], 0
        self.axis = SimpleNamespace(state=JOGS, position=1.0, speed=5.0, cycle=0, busy=True, error_id=0, unit="mm")
        self.gone = False

    def look_at(self, _units):
        return self

    def view(self, _unit):
        return self.axis

    def get_name(self):
        return "jog"

    def create_subscription(self, *_):
        pass

    def create_publisher(self, *_):
        return SimpleNamespace(publish=lambda message: self.sent.append(message.velocity))

    def spin_until(self, _condition, _seconds):
        self.waits += 1
        self.axis.cycle += 200
        if self.waits == 2:
            time.sleep(SILENCE + 0.05)
            self.axis.state, self.axis.speed, self.axis.busy = "Standstill", 0.0, False


def test_a_jog_that_was_ended_meanwhile_is_no_success(capsys):
    """What it sees first when it continues is an axis that stands."""
    client = SuspendedClient()
    jogger = Jogger(client, "x", 5.0)
    jogger.run(lambda: False, None, None)
    assert jogger.end() == 1
    assert client.sent == [5.0, 5.0, 0.0]
    said = capsys.readouterr()
    assert said.err == f"x: this command was suspended for more than {SILENCE:g} s; the jog has ended\n"
    assert said.out == "x: Standstill at 1.000 mm\n"
