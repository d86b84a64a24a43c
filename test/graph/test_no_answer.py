"""Messages of commands when a machine, or a part of it, does not answer."""

from concurrent.futures import Future
from contextlib import nullcontext

import numpy as np
import pytest
from graph_support import MILL, run
from live_support import call
from ros_support import ros

from cnc_ptp import msg
from cnc_ptp.client.graph_link import GraphLink
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.nodes import player
from cnc_ptp.nodes.bridge.coupling_services import PATIENCE as COUPLING_PATIENCE
from cnc_ptp.nodes.client.latest_blocks import LatestBlocks
from cnc_ptp.nodes.client.machine_client import PATIENCE, MachineClient, services_of
from cnc_ptp.nodes.topics import REMEMBERED_BLOCKS
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import CycleTick
from cnc_ptp.protocol.commands import COMMANDS, INTEGER_RANGES
from cnc_ptp.wire.block_codec import encode_block
from cnc_ptp.wire.stamps import Stamps


@pytest.fixture(scope="module")
def patient_clients():
    """Here they are as impatient as those of users."""


@pytest.fixture
def client(monkeypatch):
    """It knows a machine that says nothing."""
    for command in ("jog", "status"):
        monkeypatch.setattr(f"cnc_ptp.commands.client.{command}.PATIENCE", 0.2)
    with ros():
        client = MachineClient()
        client.kinds = {"x": "axis", "plc": "plc"}
        monkeypatch.setattr(client, "_answer", lambda *_: None)
        for command in ("do", "jog", "status"):
            monkeypatch.setattr(f"cnc_ptp.commands.client.{command}.connected", lambda: nullcontext(client))
        yield client
        client.end()


@pytest.mark.parametrize(
    ("words", "seconds"),
    [(["move_absolute", "target=1"], PATIENCE), (["couple", "master=y", "factor=1"], COUPLING_PATIENCE + 1.0)],
)
def test_a_command_without_an_answer_may_have_been_carried_out(client, words, seconds):
    done = call("do", "x", *words)
    assert (done.exit_code, done.stdout) == (1, "")
    assert done.stderr == (
        f"P-ERR-26136 axis x: {words[0]}: no answer within {seconds:g} s; "
        "whether it was carried out is not known, see `cnc_ptp status`\n"
    )


def test_parameters_without_an_answer(client):
    with pytest.raises(CncError) as refused:
        client.parameters_of("x")
    text = f"axis x: its parameters: no answer within {PATIENCE:g} s; nothing was read"
    assert str(refused.value) == f"P-ERR-26136 {text}"


def test_an_answer_that_was_given_up_by_a_client_that_has_ended():
    link = object.__new__(GraphLink)
    link._gone, link._asked = None, {7: Future()}
    link._asked[7].cancel()
    with pytest.raises(CncError) as refused:
        link.answer(7)
    assert str(refused.value) == "P-ERR-26171 the client has ended; nothing was sent"


@pytest.mark.parametrize("value", [258, -1, 99999999999999999999999])
def test_an_integer_that_its_field_does_not_hold_is_not_sent(client, value):
    """ROS would wrap it round: 258 is type 2."""
    done = call("do", "x", "set_override_type", f"type={value}")
    text = f"axis x: set_override_type refused: type = {value} is not within 0 ... 255; nothing was sent"
    assert (done.exit_code, done.stdout, done.stderr) == (2, "", f"P-ERR-22001 {text}\n")


@pytest.mark.parametrize("kind", COMMANDS)
def test_integers_have_the_range_of_their_field(kind):
    """Where nothing is sent, a client refuses the same numbers."""
    for command, service in services_of(kind).items():
        fields = service.Request.get_fields_and_field_types()
        for name, argument in COMMANDS[kind][command].items():
            if argument.kind == "integer" and name in fields:
                limits = np.iinfo(fields[name])
                assert argument.field == fields[name], (command, name)
                assert INTEGER_RANGES[argument.field] == (limits.min, limits.max)


def test_a_unit_without_blocks_has_no_data(client):
    done = call("status")
    assert done.exit_code == 1
    assert done.stdout.splitlines()[-1].split() == ["x", "no", "data"]


def test_a_late_reader_sees_no_old_blocks(client):
    """Axes remember their blocks for slaves; who asks where an axis is gets the next one."""
    axis = build_units(read_machine(MILL))["x"]
    publisher = client.create_publisher(msg.AxisBlock, "x/block", REMEMBERED_BLOCKS)
    for first_cycle in range(0, 200, 10):
        publisher.publish(encode_block(axis.step(CycleTick(first_cycle, 10), {}), Stamps(0, 1_000_000)))
    blocks = LatestBlocks(client, client.kinds, rotary=())
    assert client.spin_until(lambda: publisher.get_subscription_count() == 1, 5.0)
    client.spin_for(0.2)
    assert blocks.views() == []
    publisher.publish(encode_block(axis.step(CycleTick(200, 10), {}), Stamps(0, 1_000_000)))
    assert client.spin_until(blocks.views, 5.0) and blocks.views()[0].cycle == 210


def test_a_jog_without_a_listener_moves_nothing(client):
    done = call("jog", "x", "+", "--speed", "5")
    assert (done.exit_code, done.stdout) == (1, "")
    assert done.stderr == "x: the machine does not listen, or shows nothing of the axis; nothing has moved\n"


def test_topics_whose_type_is_not_installed_are_not_played(monkeypatch, tmp_path):
    run("simulate", MILL, "--duration", "0.05", "--record", tmp_path / "run.mcap")
    known = player.message_class
    monkeypatch.setattr(player, "message_class", lambda name: None if name.endswith("/AxisState") else known(name))
    done = call("replay", tmp_path / "run.mcap", "--publish")
    assert done.exit_code == 0
    left_out = [line for line in done.stdout.splitlines() if line.startswith("note: ")]
    assert left_out == [f"note: /{axis}/state is left out, its message type is not installed" for axis in "xyz"]
