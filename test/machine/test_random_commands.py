"""Random commands in random states: a state machine of Hypothesis, and the seeds that have found defects."""

from __future__ import annotations

import os

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, rule
from long_support import long

from bench import random_commands
from bench.random_commands import MACHINES, CommandedMachine, lives, main
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import AxisBlock

EXAMPLES = int(os.environ.get("RANDOM_COMMANDS", "6"))
STEPS = 40


class RandomCommands(RuleBasedStateMachine):
    """Commands by seed, so that Hypothesis can shorten their sequence."""

    machine: CommandedMachine

    @initialize(file=st.sampled_from(MACHINES), seed=st.integers(0, 2**32 - 1))
    def begin(self, file: str, seed: int) -> None:
        self.machine = CommandedMachine(seed, file)

    @rule(seed=st.integers(0, 2**32 - 1))
    def command(self, seed: int) -> None:
        self.machine.random.seed(seed)
        self.machine.random_command()
        assert self.machine.violations == []

    @rule(blocks=st.sampled_from((1, 2, 5, 20, 60)))
    def time(self, blocks: int) -> None:
        self.machine.run(blocks)
        assert self.machine.violations == []

    def teardown(self) -> None:
        if hasattr(self, "machine"):
            assert self.machine.finish() == []


TestRandomCommands = RandomCommands.TestCase
TestRandomCommands.settings = settings(
    max_examples=EXAMPLES,
    stateful_step_count=STEPS,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


@pytest.mark.parametrize("seed", [1, *long([2])])
def test_a_life_has_no_violation(seed: int) -> None:
    (machine,) = lives(120, seed)
    assert machine.violations == []
    assert machine.counts["commands"] > 50
    assert machine.counts["refused"] > 10


@pytest.mark.long
@pytest.mark.parametrize("seed", [200254, 200383, 200525, 200569, 200604, 200775, 200865, 200989, 400221, 401235])
def test_seeds_that_have_found_something(seed: int) -> None:
    (machine,) = lives(300, seed)
    assert machine.violations == []


def test_the_same_seed_makes_the_same_machine() -> None:
    first, second = (next(lives(30, 3)) for _ in range(2))
    assert [record.arguments_json for record in first.records] == [record.arguments_json for record in second.records]
    assert repr(first.blocks) == repr(second.blocks)


def test_a_violation_is_printed_with_its_seed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    machine = CommandedMachine(5)
    machine.require(False, "something")
    monkeypatch.setattr(random_commands, "lives", lambda _steps, _seed: iter([machine]))
    assert main(["30"]) == 1
    printed = capsys.readouterr().out.splitlines()
    assert printed[0] == "seed 5 cycle 0: something"
    assert printed[1].startswith("30 steps from seed 1 in ") and printed[1].endswith("machines with a violation: 1")


def test_a_stop_that_nobody_obeys_is_a_violation(monkeypatch: pytest.MonkeyPatch) -> None:
    machine = moving_machine()
    monkeypatch.setattr(random_commands, "MOST_STOPPING", 1)
    monkeypatch.setattr(type(machine.offline), "stop", lambda _machine: None)
    assert machine.finish()[0] == "seed 7 cycle 1300: still in motion after a stop: c"


def test_an_axis_in_error_that_does_not_brake_is_a_violation() -> None:
    machine = moving_machine()
    blocks = {name: output.block for name, output in machine.tick().items()}
    block = blocks["c"]
    assert isinstance(block, AxisBlock)
    block.state = [S.ERROR_STOP] * block.count
    machine.check_owners(blocks)
    assert machine.violations == ["seed 7 cycle 310: c does not brake in ErrorStop, at 20"]


def moving_machine() -> CommandedMachine:
    """The turntable of ptp.yaml turns with 20 deg/s."""
    machine = CommandedMachine(7, "config/ptp.yaml")
    machine.give("c", "move_velocity", {"velocity": 20.0})
    machine.run(30)
    assert machine.violations == []
    return machine


def test_the_command_counts_its_steps(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["30", "4"]) == 0
    assert capsys.readouterr().out.startswith("30 steps from seed 4 in ")


@pytest.mark.parametrize("seed", [40003, *long([22, 1010])])
def test_a_life_that_has_found_a_replay_with_another_refusal(seed: int) -> None:
    """A source, and a direction, that were not a number came back from the recording as a text; a `change_cam` that the
    PLC had refused was carried out.
    """
    machine = CommandedMachine(seed, freed=0.0)
    for _ in range(random_commands.LIFE):
        machine.step()
    assert machine.finish() == []
