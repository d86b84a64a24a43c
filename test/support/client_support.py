"""A ROS client beside a running graph: calls services, writes PLC topics, waits for what blocks and events show."""

import time
from collections.abc import Sequence
from contextlib import contextmanager

from graph_support import LAST_WORDS, TIMEOUT, Running
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from ros_support import ros

from cnc_ptp import msg
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes import process
from cnc_ptp.nodes.topics import BLOCK_TYPES, BLOCKS, COMMAND, EVENT, EVENTS, PLC_INPUT, SERVICES, block_topic
from cnc_ptp.parameters import read_machine


class Blocks(Sequence):
    """Messages as they came; only what a test looks at is deserialised: 600 come a second."""

    def __init__(self, message_type):
        self._type = message_type
        self._looked_at = b"", None
        self.serialised = []

    def __len__(self):
        return len(self.serialised)

    def __getitem__(self, index):
        data = self.serialised[index]
        if data is not self._looked_at[0]:
            self._looked_at = data, deserialize_message(data, self._type)
        return self._looked_at[1]


class Client(Node):
    """`blocks[unit]`: the blocks that came so far; `events`, `commands`: likewise."""

    def __init__(self, machine):
        super().__init__("test_client", enable_rosout=False)
        self.kinds = unit_kinds(machine)
        self.blocks = {unit: Blocks(BLOCK_TYPES[kind]) for unit, kind in self.kinds.items()}
        self.events, self.records = [], []
        for unit, kind in self.kinds.items():
            received = self.blocks[unit].serialised.append
            self.create_subscription(BLOCK_TYPES[kind], block_topic(unit), received, BLOCKS, raw=True)
        self.create_subscription(msg.Event, EVENT, self.events.append, EVENTS)
        self.create_subscription(msg.CommandRecord, COMMAND, self.records.append, EVENTS)
        self._writers = {}
        self._askers = {}
        self._since = dict.fromkeys(self.kinds, 0)

    def start(self):
        self.executor_of_test = process.EventsExecutor()
        self.executor_of_test.add_node(self)

    def spin_until(self, condition, what):
        deadline = time.monotonic() + TIMEOUT
        while not condition():
            self.executor_of_test.spin_once(timeout_sec=0.02)
            assert time.monotonic() < deadline, f"{what} did not come"

    def wait_blocks(self, unit, number=2):
        """Waits for so many more blocks of a unit."""
        wanted = len(self.blocks[unit]) + number
        self.spin_until(lambda: len(self.blocks[unit]) >= wanted, f"{number} blocks of {unit}")

    def wait_last(self, unit, condition, what):
        """Waits until the last block of a unit, computed after its last command, fulfils a condition; returns it."""

        def fulfilled():
            block = self.blocks[unit][-1] if len(self.blocks[unit]) else None
            return block and block.first_cycle >= self._since[unit] and condition(block)

        self.spin_until(fulfilled, f"{unit}: {what}")
        return self.blocks[unit][-1]

    def shows(self, unit, field, value):
        """Waits until a per-cycle field of a unit has a value."""
        self.wait_last(unit, lambda block: getattr(block, field)[-1] == value, f"{field} = {value}")

    def ask(self, service, name, **fields):
        """The response of any service."""
        if name not in self._askers:
            self._askers[name] = self.create_client(service, name)
            self.spin_until(self._askers[name].service_is_ready, name)
        answer = self._askers[name].call_async(service.Request(**fields))
        self.spin_until(answer.done, f"the answer of {name}")
        return answer.result()

    def call(self, unit, command, **fields):
        """The response of a command service."""
        return self.ask(SERVICES[self.kinds[unit]][command], f"/{unit}/{command}", **fields)

    def done(self, unit, command, **fields):
        """As `call`, for commands that are to be accepted."""
        response = self.call(unit, command, **fields)
        assert response.accepted and response.error_id == 0, response.message
        self._since[unit] = response.cycle
        return response

    def refused(self, unit, command, error_id, message, **fields):
        response = self.call(unit, command, **fields)
        assert response.message == message
        assert (response.accepted, response.error_id) == (False, error_id)
        return response

    def write(self, topic, message_type, *, readers=1, **fields):
        """Publishes one message on a PLC topic and waits until it has had the time to act: some PLC blocks."""
        if topic not in self._writers:
            writer = self._writers[topic] = self.create_publisher(message_type, topic, PLC_INPUT)
            self.spin_until(lambda: writer.get_subscription_count() >= readers, f"{readers} readers of {topic}")
        self._writers[topic].publish(message_type(**fields))
        self.wait_blocks("plc", 10)

    def override(self, unit, percent, **fields):
        self.write(f"/{unit}/override", msg.Override, percent=float(percent), **{"valid": True, **fields})

    def switch(self, topic, on, **fields):
        self.write(topic, msg.Switch, enabled=on, **{"valid": True, **fields})

    def action(self, action_type, name, **fields):
        """Sends a goal; returns its handle and the feedback that comes."""
        if name not in self._askers:
            self._askers[name] = ActionClient(self, action_type, name)
            self.spin_until(self._askers[name].server_is_ready, name)
        feedback = []
        goal = self._askers[name].send_goal_async(action_type.Goal(**fields), feedback_callback=feedback.append)
        self.spin_until(goal.done, f"the answer of {name}")
        return goal.result(), feedback

    def result_of(self, goal):
        """Status and result of an accepted goal."""
        assert goal.accepted
        answer = goal.get_result_async()
        self.spin_until(answer.done, "the result of the action")
        return answer.result().status, answer.result().result

    def commands(self, target, command):
        """Arguments and acceptance of the commands of one kind so far."""
        return [
            (record.arguments_json, record.accepted)
            for record in self.records
            if record.target == target and record.command == command
        ]

    def state_at(self, unit, cycle, field):
        """The value of a per-cycle field at a cycle that has come or comes."""
        self.wait_last(unit, lambda block: block.first_cycle + block.count > cycle, f"cycle {cycle}")
        blocks = self.blocks[unit]
        block = blocks[(cycle - blocks[0].first_cycle) // blocks[0].count]
        return getattr(block, field)[cycle - block.first_cycle]


@contextmanager
def connected(make, machine):
    """A client beside a run (`make` of the machine); it is closed with the block, however that ends."""
    with ros():
        client = make(read_machine(str(machine)))
        client.start()
        try:
            yield client
        finally:
            client.destroy_node()
            client.executor_of_test.shutdown()


@contextmanager
def beside_composed_run(machine):
    """A client beside a run of the machine in one process; both end with the block."""
    with Running(machine, "--duration", "600", "--composed") as graph:
        with connected(Client, machine) as client:
            client.wait_blocks("plc", 3)
            yield client
        graph.process.terminate()
        graph.process.wait(timeout=LAST_WORDS)
