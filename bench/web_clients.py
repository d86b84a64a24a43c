"""Clients of the web face for its bench: pages without a picture over WebSockets, and who sees when an axis moves."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
from aiohttp import ClientSession, ClientWebSocketResponse, CookieJar, WSMsgType

from bench.jobs import long_program
from cnc_ptp.recording.node_figures import LATENESS_P99
from cnc_ptp.web.faces.scope import HEAD

SIGNALS = [
    *(f"{axis}.{field}" for axis in "xyz" for field in ("set_position", "following_error")),
    "channel.path_velocity",
    "s.actual_speed_rpm",
]
"""Eight, at 1 kHz."""
CLIENTS = 2
SETTLING = 3.0
KEPT_BLOCKS = 6000
"""Of an axis: a minute."""
PATIENCE = 30.0
LOOK_PERIOD = 0.002
SLOW, BETWEEN = 1.0, 0.35
"""mm/s of the axis whose override changes, s between two changes."""


@dataclass(frozen=True, slots=True)
class Moved:
    """A block of an axis: when it was published (ns of the wall clock), its first cycle, its set velocities."""

    at: int
    cycle: int
    velocities: npt.NDArray[np.float64]


class Observer:
    """The blocks of an axis as DDS gives them, with the times at which they were published; read by a thread."""

    def __init__(self, axis: str = "x") -> None:
        from rclpy.serialization import deserialize_message

        from cnc_ptp import msg
        from cnc_ptp.nodes.polling_node import PollingNode
        from cnc_ptp.nodes.topics import BLOCKS, block_topic

        self._node = PollingNode("web_bench")
        self._subscription = self._node.poll(msg.AxisBlock, block_topic(axis), lambda _: None, BLOCKS)
        self._read = deserialize_message
        self._blocks: deque[Moved] = deque(maxlen=KEPT_BLOCKS)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        handle: Any = self._subscription.handle
        while not self._ended.wait(LOOK_PERIOD):
            while True:
                with handle:
                    taken = handle.take_message(self._subscription.msg_type, True)
                if taken is None:
                    break
                block = self._read(taken[0], self._subscription.msg_type)
                self._blocks.append(
                    Moved(taken[1]["source_timestamp"], block.first_cycle, np.array(block.set_velocity))
                )

    def since(self, moment: int) -> list[Moved]:
        """Blocks that were published after a moment (ns)."""
        return [block for block in list(self._blocks) if block.at > moment]

    @property
    def velocity(self) -> float:
        """The newest one, mm/s."""
        return float(self._blocks[-1].velocities[-1]) if self._blocks else 0.0

    def wait(self, condition: Callable[[], Any], patience: float = PATIENCE) -> None:
        """Raises TimeoutError."""
        deadline = time.monotonic() + patience
        while not condition():
            if time.monotonic() > deadline:
                raise TimeoutError("the machine does not what was expected")
            time.sleep(LOOK_PERIOD)

    def changed(self, moment: int, velocity: float) -> float | None:
        """Milliseconds from a moment to the publication of the first block with another velocity; None: not yet."""
        for block in self.since(moment):
            if np.any(np.abs(block.velocities - velocity) > 1e-9):
                return 1e-6 * (block.at - moment)
        return None

    def close(self) -> None:
        self._ended.set()
        self._thread.join()
        self._node.destroy_node()


@dataclass(slots=True)
class Client:
    """A page without a picture."""

    socket: ClientWebSocketResponse
    samples: int = 0
    lost: int = 0
    """Cycles of the scope that have not come."""
    states: int = 0
    """Messages with a new position of x."""
    nodes: dict[str, Mapping[str, str]] = field(default_factory=dict)
    _next: int = -1
    _ids: int = 0
    _answers: dict[int, asyncio.Future[Any]] = field(default_factory=dict)

    async def listen(self) -> None:
        async for message in self.socket:
            if message.type is WSMsgType.BINARY:
                self._take_frame(message.data)
            else:
                self._take(json.loads(message.data))

    def _take_frame(self, data: bytes) -> None:
        _, low, high, _, count = HEAD.unpack_from(data)
        first = low + (high << 32)
        self.lost += max(0, first - self._next) if self._next >= 0 else 0
        self.samples += count
        self._next = first + count

    def _take(self, message: dict[str, Any]) -> None:
        if message["type"] == "state":
            self.states += "set_position" in message["units"].get("x", {})
        elif message["type"] == "diagnostics":
            self.nodes |= {node["name"]: node["values"] for node in message["nodes"]}
        elif message["type"] == "answer":
            self._answers.pop(message["id"]).set_result(message)

    async def ask(self, kind: str, **fields: Any) -> Any:
        """The answer. Raises RuntimeError for a refusal."""
        self._ids += 1
        self._answers[self._ids] = asyncio.get_running_loop().create_future()
        await self.socket.send_json({"type": kind, "id": self._ids, **fields})
        answer = await asyncio.wait_for(self._answers[self._ids], PATIENCE)
        if not answer["ok"]:
            raise RuntimeError(f"{kind}: {answer['text']}")
        return answer

    async def command(self, unit: str, command: str, **arguments: Any) -> Any:
        return await self.ask("command", unit=unit, command=command, arguments=arguments)

    @property
    def lateness(self) -> float:
        """p99 of the latest node since the start of the machine, ms."""
        return max((float(values[LATENESS_P99]) for values in self.nodes.values() if LATENESS_P99 in values), default=0)


async def open_client(session: ClientSession, address: str) -> Client:
    await session.get(address)
    token = (await (await session.get(f"{address}/api/session")).json())["token"]
    socket = await session.ws_connect(f"{address}/ws")
    await socket.send_json({"type": "hello", "token": token})
    while True:
        message = await asyncio.wait_for(socket.receive(), PATIENCE)
        told = json.loads(message.data)
        if told["type"] == "hello" and told["machine"]:
            return Client(socket)


@dataclass(slots=True)
class ClientRun:
    """What the clients have seen."""

    samples: int = 0
    lost: int = 0
    states_per_second: float = 0.0
    """Of the client that got the fewest."""
    core: float = 0.0
    lateness_p99_ms: float = 0.0
    reactions: list[float] = field(default_factory=list)
    """ms from a command to the first changed setpoint."""


async def watch(
    address: str, seconds: float, commands: int, observer: Observer, processor_seconds: Callable[[], float]
) -> ClientRun:
    """Two scopes for `seconds` while a program runs, then so many commands; `processor_seconds` of the server."""
    run = ClientRun()
    async with ClientSession(cookie_jar=CookieJar(unsafe=True)) as session:
        clients = [await open_client(session, address) for _ in range(CLIENTS)]
        listening = [asyncio.create_task(client.listen()) for client in clients]
        for client in clients:
            await client.ask("scope", signals=SIGNALS, bits=64)
        first = clients[0]
        await first.ask("take_command")
        await first.ask("load", name="rounds.nc", text=long_program(seconds + 2.0 * SETTLING))
        await first.command("channel", "start")
        await asyncio.sleep(SETTLING)
        states = [client.states for client in clients]
        begin, used = time.monotonic(), processor_seconds()
        await asyncio.sleep(seconds)
        wall = time.monotonic() - begin
        run.core = (processor_seconds() - used) / wall
        run.states_per_second = min(
            (client.states - before) / wall for client, before in zip(clients, states, strict=True)
        )
        run.lateness_p99_ms = max(client.lateness for client in clients)
        await first.command("channel", "reset")
        await asyncio.sleep(SETTLING)
        run.reactions = await reactions(first, commands, observer)
        run.samples, run.lost = (sum(values) for values in zip(*((c.samples, c.lost) for c in clients), strict=True))
        for client, task in zip(clients, listening, strict=True):
            await client.socket.close()
            await task
    return run


async def reactions(client: Client, commands: int, observer: Observer) -> list[float]:
    """Milliseconds from an override that a page commands to the first changed setpoint of x, which moves slowly."""
    await client.command("x", "move_absolute", target=-250.0, velocity=SLOW)
    await asyncio.sleep(SETTLING)
    found = []
    for number in range(commands):
        velocity, moment = observer.velocity, time.time_ns()
        await client.command("x", "set_override", percent=50.0 + 25.0 * (number % 2))
        await asyncio.to_thread(observer.wait, lambda m=moment, v=velocity: observer.changed(m, v) is not None)
        milliseconds = observer.changed(moment, velocity)
        assert milliseconds is not None
        found.append(milliseconds)
        await asyncio.sleep(BETWEEN + 0.0137 * (number % 7))  # at any moment of a block
    await client.command("x", "set_override", percent=100.0)
    await client.command("x", "halt")
    return found
