"""A PLC that dies, in a graph: its motions are halted, what moves on its own is held; or nothing, where that is off."""

import signal

from client_support import Client, connected
from graph_support import Running, one_axis_machine, small_machine, verified
from std_msgs.msg import Header

from cnc_ptp import msg
from cnc_ptp.nodes.topics import HLI_STATUS, PLC_INPUT
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.axis_states import AxisStateCode

UNHEARD_DURATION = 300


class StatusClient(Client):
    """With the newest status of each axis and spindle."""

    def __init__(self, machine):
        super().__init__(machine)
        self.status = {}
        for unit, kind in self.kinds.items():
            if kind in ("axis", "spindle"):
                self.create_subscription(
                    HLI_STATUS[kind], f"/{unit}/hli/status", lambda m, u=unit: self.status.update({u: m}), PLC_INPUT
                )


def send(client, topic, message):
    fields = {name: getattr(message, name) for name in message.get_fields_and_field_types()}
    client.write(topic, type(message), readers=2, **fields)


def told(client, number):
    return [event.text for event in client.events if event.error_id == number]


def command(kind, sequence, **fields):
    of, external = (
        (msg.AxisHliControl, msg.HliAxisCommand) if kind == "axis" else (msg.SpindleHliControl, msg.HliSpindleCommand)
    )
    header = Header(frame_id="p1")
    return of(header=header, valid=True, sequence=sequence, external=external(semaphore=True, **fields))


def test_a_timeout_of_0_watches_nothing(ros_domain, tmp_path):
    machine, recording = one_axis_machine(tmp_path), tmp_path / "run.mcap"
    text = machine.read_text()
    machine.write_text(
        text.replace("/machine:\n  ros__parameters:\n", "/machine:\n  ros__parameters:\n    life_sign_timeout_ms: 0\n")
    )
    assert read_machine(str(machine)).life_sign_timeout_ms == 0
    with Running(machine, "--duration", UNHEARD_DURATION, "--record", recording) as graph:
        graph.wait_for_nodes(3)
        with connected(StatusClient, machine) as client:
            client.wait_blocks("x", 1)
            client.write("/plc/life_sign", msg.LifeSign, readers=2, counter=1)
            override = msg.HliNumber(enable_w=True, command_w=40.0)
            client.write(
                "/x/hli/control",
                msg.AxisHliControl,
                readers=2,
                header=Header(frame_id="p1"),
                valid=True,
                override=override,
            )
            client.shows("x", "override_percent", 40.0)
            client.wait_blocks("plc", 100)
            assert told(client, 26103) == told(client, 26165) == []
            assert client.commands("x", "feed_hold") == []
            client.spin_until(lambda: client.status["x"].holder == "p1", "the holder")
        graph.process.send_signal(signal.SIGINT)
        graph.finish(expect=1)
        verified(recording)


def test_a_plc_that_dies_leaves_nothing_moving(ros_domain, tmp_path):
    """Its external commands are halted; what a service moves is held; the path stands; each hold ends by a command."""
    machine, recording = small_machine(tmp_path), tmp_path / "run.mcap"
    with Running(machine, "--duration", UNHEARD_DURATION, "--record", recording) as graph:
        graph.wait_for_nodes(7)
        with connected(StatusClient, machine) as client:
            client.wait_blocks("x", 1)
            client.done("y", "move_absolute", target=150.0, velocity=2.0)
            for number in range(1, 7):
                client.write("/plc/life_sign", msg.LifeSign, readers=2, counter=number)
                jog = command("axis", number, type=msg.HliAxisCommand.MOVE_VELOCITY, velocity=5.0)
                send(client, "/x/hli/control", jog)
                send(client, "/s/hli/control", command("spindle", number, type=msg.HliSpindleCommand.CW, speed=300.0))
            assert client.status["x"].set_velocity == 5.0 and client.status["s"].set_speed_rpm == 300.0
            client.spin_until(lambda: told(client, 26103) and len(told(client, 26165)) == 2, "the silence")
            assert told(client, 26103)[0].endswith(" ms; feed hold is set on channel, s, x, y")
            for unit in ("x", "y"):
                client.wait_last(unit, lambda block: block.set_velocity[-1] == 0.0, "standstill")
            client.wait_last("s", lambda block: block.set_speed_rpm[-1] == 0.0, "standstill")
            client.spin_until(lambda: client.status["x"].state == AxisStateCode.STANDSTILL, "the end of its motion")
            for unit in ("x", "s"):
                client.spin_until(lambda unit=unit: client.status[unit].holder == "", f"the end of the hold of {unit}")
            assert client.status["y"].feed_hold.state_r and client.status["y"].state == AxisStateCode.DISCRETE_MOTION
            client.switch("/y/feed_hold", False)
            client.wait_last("y", lambda block: block.set_velocity[-1] == 2.0, "the motion again")
        graph.process.send_signal(signal.SIGINT)
        graph.finish(expect=1)
        verified(recording)


def test_a_machine_without_a_channel_is_held_too(ros_domain, tmp_path):
    """And the next message of the PLC that serves the feed hold ends it: the axis continues to its target."""
    machine, recording = one_axis_machine(tmp_path), tmp_path / "run.mcap"
    with Running(machine, "--duration", UNHEARD_DURATION, "--record", recording) as graph:
        graph.wait_for_nodes(3)
        with connected(StatusClient, machine) as client:
            client.wait_blocks("x", 1)
            client.done("x", "move_absolute", target=5000.0, velocity=5.0)
            client.write("/plc/life_sign", msg.LifeSign, readers=2, counter=1)
            client.spin_until(lambda: told(client, 26103), "the silence")
            text = "plc: no life sign of the external PLC for 1000 ms; feed hold is set on x"
            assert told(client, 26103) == [text]
            client.wait_last("x", lambda block: block.set_velocity[-1] == 0.0, "standstill")
            assert client.status["x"].feed_hold.state_r
            control = msg.AxisHliControl(header=Header(frame_id="p1"), valid=True)
            control.feed_hold = msg.HliSwitch(enable_w=True, command_w=False)
            send(client, "/x/hli/control", control)
            client.wait_last("x", lambda block: block.set_velocity[-1] == 5.0, "the motion again")
            send(client, "/x/hli/control", msg.AxisHliControl(header=Header(frame_id="p1")))
            client.wait_blocks("plc", 50)
            assert client.blocks["x"][-1].set_velocity[-1] == 5.0  # given back, nothing holds it
        graph.process.send_signal(signal.SIGINT)
        graph.finish(expect=1)
        verified(recording)
