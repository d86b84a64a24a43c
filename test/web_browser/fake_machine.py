"""A server that speaks to the pages as `cnc_ptp web` does, with a machine that is only made up: fast and always the same.

`python test/web_browser/fake_machine.py [PORT]` serves it to look at. What pages send is in `Fake.received`.
"""

from __future__ import annotations

import asyncio
import json
import struct
import sys
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
from aiohttp import WSMsgType, web

STATIC = Path(__file__).parents[2] / "cnc_ptp/web/static"
CSP = "default-src 'self'; img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'"
CYCLES = 50
"""Of a frame of the scope."""
FIELDS = ("set_position", "actual_position", "set_velocity", "actual_velocity", "following_error", "command_velocity")
NASTY = "<script>window.hacked = true</script>.nc"
WORDS = (
    ("G00", "Straight at rapid speed."),
    ("G01", "Straight at the feed."),
    ("G54", "Zero offset 1."),
    ("M03", "Spindle clockwise."),
    ("#TIMER START", "Starts a timer."),
)
SNAPSHOT = bytes(range(256)) * 40
PROGRAM = "\n".join(["%demo", *(f"N{10 * i} G1 X{i % 100} Y{i % 37} F1200" for i in range(1, 400)), "N9999 M30"])


def axis(name: str) -> dict[str, Any]:
    limits = {
        "positions": [-500.0, 500.0],
        "velocity": 200.0,
        "rapid": 166.0,
        "reference_velocity": 166.0,
        "acceleration": 1000.0,
        "jerk": 20000.0,
        "override": 150,
        "position_window": 0.05,
        "kv": 83.3,
    }
    return {
        "name": name,
        "kind": "axis",
        "rotary": False,
        "unit": "mm",
        "modulo": False,
        "facing": False,
        "limits": limits,
    }


def argument(
    kind: str, required: bool = False, choices: tuple[str, ...] = (), *, unit: str = "", left_out: str = ""
) -> dict[str, Any]:
    texts = {"unit": unit, "meaning": "largest value", "left_out": left_out}
    return {"kind": kind, "required": required, "choices": list(choices), **texts}


COMMANDS = {
    "axis": {
        "power": {"enabled": argument("switch", True)},
        "reset": {},
        "move_absolute": {
            "target": argument("number", True, unit="mm, °"),
            "velocity": argument("number", unit="mm/s, °/s", left_out="P-AXIS-00212"),
            "acceleration": argument("number", unit="mm/s², °/s²", left_out="P-AXIS-00001"),
            "jerk": argument("number", unit="mm/s³, °/s³"),
        },
        "halt": {},
        "couple": {"factor": argument("number", True), "master": argument("text", True)},
        "decouple": {"target": argument("number")},
        "compensation_start": {"length": argument("number", True), "difference": argument("number", True)},
        "external_enable": {"mode": argument("text", True, ("absolute", "relative"))},
        "write_parameter": {"parameter": argument("text", True), "value": argument("number", True)},
    },
    "spindle": {},
    "channel": {},
    "plc": {},
}


class Fake:
    """The machine and its pages. `points`: of the backplot; `recording`: it has been recorded; `axes`: a letter each."""

    def __init__(self, *, points: int = 3000, recording: bool = False, axes: str = "xyz") -> None:
        self.points, self.recording, self.axes = points, recording, axes
        self.received: list[dict[str, Any]] = []
        self.pings: list[dict[str, Any]] = []
        self.delay = 0.0
        """Seconds until a ping is answered."""
        self.role, self.has_login, self.logged_in = "commissioner", False, True
        self.refusals: dict[str, dict[str, Any]] = {}
        """Type of a message -> number and text with which it is refused."""
        self.snapshots: list[dict[str, str]] = []
        """`seconds` and `until` of each snapshot that was asked for."""
        self.breaks_off = False
        """A snapshot ends before all of it was sent."""
        self.kept_from = 0
        """The first cycle that the recorder still has."""
        self.drawn = 0
        """How often a backplot was asked for."""
        self.task = 0
        self.needs_welcome = False
        """Who is not logged in is by looking at the page."""
        self.backplot_delays: list[float] = []
        self.backplot_fails = False
        self.sockets: list[web.WebSocketResponse] = []
        self.programs = {"bracket.nc": PROGRAM, NASTY: "N10 (<script>window.hacked = true</script>)\nN20 M30"}
        self.holder: int | None = None
        self.time = 0.0
        self.cycle = 0
        self.lag = (0.004, 0.004)
        self.arrives = False
        """Axes are in the range of their target."""
        self.signals: dict[int, list[str]] = {}
        self.state = {
            "plc": {"scenario_done": True, "run_done": False, "emergency_stop": False},
            "channel": {"state": "ready", "active": False, "line": 0, "block_number": 0, "feed": 0.0, "programmed_feed": 0.0, "override": 100.0, "distance_to_go": 0.0, "blocks_done": 0, "blocks_total": 400, "progress": 0.0, "time_left": -1.0, "job": "", "error": 0, "program": "", "file": "", "text": "", "manual": False},
            "s": {"state": "Standstill", "set_speed": 0.0, "speed": 0.0, "programmed_speed": 0.0, "set_position": 0.0, "actual_position": 0.0, "distance_to_go": 0.0, "following_error": 0.0, "override": 100.0, "gear": 1, "modes": ["stop"], "speed_reached": True, "speed_zero": True, "in_position": True, "referenced": True, "gear_change_active": False, "status_bits": 0, "master": "", "job": "", "error": 0},
            **{name: {"state": "Standstill", "override": 100.0, "feedforward": 0.0, "set_acceleration": 0.0, "torque": 0.5, "torque_digits": 20.0, "error": 0, "status_bits": 16, "master": "", "job": ""} for name in axes},
        }  # fmt: skip
        self.alarm = 0
        self.app = web.Application(client_max_size=10_000_000)
        self.app.router.add_get("/", self._index)
        self.app.router.add_get("/api/session", self._session)
        self.app.router.add_post("/api/logout", self._log_out)
        self.app.router.add_get("/api/programs", self._list)
        self.app.router.add_post("/api/programs", self._upload)
        self.app.router.add_get("/api/programs/{name}", self._program)
        self.app.router.add_get("/api/backplot", self._backplot)
        self.app.router.add_get("/api/parameters", self._parameters)
        self.app.router.add_get("/api/curve", self._curve)
        self.app.router.add_get("/api/words", self._words)
        self.app.router.add_get("/api/recorded", self._recorded)
        self.app.router.add_get("/api/snapshot.mcap", self._snapshot)
        self.app.router.add_get("/ws", self._socket)
        self.app.router.add_static("/static", STATIC)
        self.app.on_response_prepare.append(self._headers)
        self.app.on_startup.append(self._begin)
        self.app.on_cleanup.append(self._end)

    async def _headers(self, _request: web.Request, response: web.StreamResponse) -> None:
        response.headers["Content-Security-Policy"] = CSP

    async def _begin(self, _app: web.Application) -> None:
        self._task = asyncio.create_task(self._live())

    async def _end(self, _app: web.Application) -> None:
        self._task.cancel()

    # HTTP

    async def _index(self, _request: web.Request) -> web.StreamResponse:
        self.logged_in = self.logged_in or self.needs_welcome
        return web.FileResponse(STATIC / "index.html")

    async def _session(self, _request: web.Request) -> web.Response:
        if not self.logged_in:
            return web.json_response({"number": 26238, "text": "there is no login"}, status=401)
        return web.json_response({"user": "web", "role": self.role, "token": "token", "login": self.has_login})

    async def _log_out(self, request: web.Request) -> web.Response:
        assert request.headers["X-Token"] == "token"
        self.logged_in = False
        for socket in [*self.sockets]:
            await socket.close()
        return web.json_response({})

    async def _list(self, _request: web.Request) -> web.Response:
        return web.json_response(
            {
                "programs": [{"name": name, "size": len(text)} for name, text in self.programs.items()],
                "limit": 32 << 20,
                "endings": [".nc", ".ngc", ".cnc", ".tap", ".mpf", ".spf"],
            }
        )

    async def _upload(self, request: web.Request) -> web.Response:
        name = request.query["name"]
        self.programs[name] = await request.text()
        return web.json_response({"name": name, "size": len(self.programs[name])})

    async def _program(self, request: web.Request) -> web.Response:
        return web.Response(text=self.programs[request.match_info["name"]])

    async def _backplot(self, _request: web.Request) -> web.Response:
        n = self.points  # as it was when it was asked for
        self.drawn += 1
        if self.backplot_delays:
            await asyncio.sleep(self.backplot_delays.pop(0))
        if self.backplot_fails:
            return web.json_response({"number": 26242, "text": "no program is loaded"}, status=404)
        i = np.arange(n)
        angle = i * 0.05
        radius = 20 + 30 * i / n
        rapid = i % 500 < 5
        rows = np.stack(
            [
                radius * np.cos(angle),
                radius * np.sin(angle),
                -10 * i / n,
                np.where(rapid, 0, 600 + 1400 * (i % 300) / 300),
                2 + i * 398 // n,
            ],
            axis=1,
        )
        return web.Response(body=struct.pack("<4I", 1, n, 0, 0) + rows.astype("<f4").tobytes())

    async def _parameters(self, request: web.Request) -> web.Response:
        rows = [
            {"id": "P-AXIS-00099", "name": "getriebe[0].kv", "value": 5000, "unit": "0.01/s", "min": 0, "max": 60000, "default": 1000, "text": "Kv of the position controller", "topic": "Position controller", "change": "now"},
            {"id": "P-AXIS-00099", "name": "getriebe[1].kv", "value": 2500, "unit": "0.01/s", "min": 0, "max": 60000, "default": 1000, "text": "Kv of the position controller", "topic": "Position controller", "change": "now"},
            {"id": "P-AXIS-00212", "name": "vb_max", "value": 200000, "unit": "µm/s", "min": 1, "max": 1e9, "default": 10000, "text": "largest velocity <b>", "topic": "Dynamics", "change": "start"},
        ]  # fmt: skip
        if request.query["unit"] == "plc":
            rows = [{"id": "P-MACH-00003", "name": "watchdog_ms", "value": 200, "unit": "ms", "min": 1, "max": 60000, "default": 200, "text": "Time without a block", "topic": "Machine", "change": "start"}]  # fmt: skip
        return web.json_response({"unit": request.query["unit"], "parameters": rows})

    async def _curve(self, _request: web.Request) -> web.Response:
        points = [
            {"speed": n, "acceleration": 6000 if n < 3000 else 18e6 / n, "break": n == 3000}
            for n in range(0, 12001, 500)
        ]
        return web.json_response({"gears": [{"gear": 1, "kind": "hyperbola", "points": points}]})

    async def _words(self, request: web.Request) -> web.Response:
        assert request.query["channel"] == "channel"
        return web.json_response({"words": [{"name": name, "meaning": meaning} for name, meaning in WORDS]})

    async def _recorded(self, request: web.Request) -> web.Response:
        names = request.query["signals"].split(",")
        begin, end = float(request.query["from"]), float(request.query["to"])
        step = max(1, round((end - begin) * 1000 / 2000))
        cycles = np.arange(round(begin * 1000), round(end * 1000), step)
        kind = "<f4" if request.query.get("bits") == "32" else "<f8"
        columns = np.concatenate([self.column(name, cycles) for name in names]).astype(kind)
        return web.Response(
            body=struct.pack("<5I", step, int(cycles[0]), 0, len(names), len(cycles)) + columns.tobytes()
        )

    async def _snapshot(self, request: web.Request) -> web.StreamResponse:
        query = dict(request.query)
        self.snapshots.append(query)
        if refusal := self.refusals.get("snapshot"):
            return web.json_response(refusal, status=400)
        end = round(float(query["until"]) * 1000) if "until" in query else self.cycle
        first = max(self.kept_from, end - round(float(query["seconds"]) * 1000))
        fields = {"X-First-Cycle": str(first)}
        if self.breaks_off:
            response = web.StreamResponse(headers={**fields, "Content-Length": str(len(SNAPSHOT))})
            await response.prepare(request)
            await response.write(SNAPSHOT[:1])
            assert request.transport is not None
            request.transport.close()
            return response
        return web.Response(body=SNAPSHOT, content_type="application/octet-stream", headers=fields)

    # the socket

    def hello(self, page: int) -> dict[str, Any]:
        channel = {
            "name": "channel",
            "kind": "channel",
            "axes": [{"unit": n, "name": n.upper()} for n in self.axes],
            "spindles": ["s"],
            "turning": False,
            "limits": {"override": 200.0},
        }
        spindle = {"name": "s", "kind": "spindle", "limits": {"speed": 12000.0, "gears": [1, 2], "override": 200.0}}
        units = [{"name": "plc", "kind": "plc"}, channel, spindle, *(axis(n) for n in self.axes)]
        signals = {n: [{"field": f, "unit": "mm"} for f in FIELDS] for n in self.axes} | {
            "s": [{"field": "actual_speed_rpm", "unit": "rpm"}]
        }
        machine = {
            "name": "Demo mill",
            "units": units,
            "commands": COMMANDS,
            "cycle_time": 0.001,
            "block_cycles": 10,
            "recording": self.recording,
            "signals": signals,
        }
        if self.recording:
            machine |= {"start": 0.0, "end": 30.0}
        offsets = {
            "channel": {
                "channel": "channel",
                "axes": ["X", "Y", "Z"],
                "zero_index": 1,
                "zero_name": "",
                "zero_offset": [12.5, 0.0, -3.0],
            }
        }
        return {
            "type": "hello",
            "offsets": offsets,
            "programs": [],
            "version": 1,
            "user": "web",
            "role": self.role,
            "page": page,
            "machine": machine,
            "operator": self.operator(),
            "alarms": [],
            "handshakes": [],
        }

    def operator(self) -> dict[str, Any]:
        return {"holder": None if self.holder is None else {"user": "web", "page": self.holder}, "asking": None}

    def has_received(self, **fields: Any) -> bool:
        """Whether any page has sent a message with these fields; what else a page sends meanwhile does not matter."""
        return any(fields.items() <= message.items() for message in list(self.received))

    async def _socket(self, request: web.Request) -> web.WebSocketResponse:
        socket = web.WebSocketResponse()
        await socket.prepare(request)
        self.sockets.append(socket)
        page = len(self.sockets)
        async for received in socket:
            if received.type is not WSMsgType.TEXT:
                continue
            message = json.loads(received.data)
            if message["type"] == "ping":
                self.pings.append(message)
                await asyncio.sleep(self.delay)
                await socket.send_json({"type": "pong", "time": message["time"]})
                continue
            self.received.append(message)
            await self._take(socket, page, message)
        self.signals.pop(page, None)
        return socket

    async def _take(self, socket: web.WebSocketResponse, page: int, message: dict[str, Any]) -> None:
        kind = message["type"]
        if refusal := self.refusals.get(kind):
            await socket.send_json({"type": "answer", "id": message["id"], "ok": False, **refusal})
            return
        if kind == "hello":
            await socket.send_json(self.hello(page))
            await socket.send_json({"type": "state", "time": self.time, "units": self.state})
            return
        fields: dict[str, Any] = {}
        if kind in ("take_command", "give_command"):
            self.holder = page if kind == "take_command" else None
            await self.tell({"type": "operator", **self.operator()})
        elif kind == "scope":
            self.signals[page] = message["signals"]
            fields = {"stream": page, "signals": message["signals"], "bits": 64}
        elif kind == "scope_stop":
            self.signals.pop(page, None)
        elif kind == "command":
            await self._command(message)
        elif kind == "load":
            self.state["channel"] |= {"program": message["name"], "state": "ready"}
            await self.tell({"type": "program", "channel": "channel", "name": message["name"]})
        elif kind in ("identify", "circle"):
            self.task += 1
            fields = {"task": self.task}
        elif kind == "accept":
            fields = {"file": f"/machines/{message['file']}"}
        elif kind == "offsets":
            values = {"X": 12.5, "Y": 0.0, "Z": -3.0}
            row = {"index": 1, "name": "G54", "values": values, "inactive": []}
            fields = {"axes": ["X", "Y", "Z"], "default": 1, "offsets": [row]}
        elif kind == "acknowledge":
            await self.tell(
                {
                    "type": "acknowledged",
                    "alarms": [message["alarm"]] if message.get("alarm") else [*range(1, self.alarm + 1)],
                    "user": "web",
                }
            )
        if message.get("id") is not None:
            await socket.send_json({"type": "answer", "id": message["id"], "ok": True, "cycle": self.cycle, **fields})

    async def _command(self, message: dict[str, Any]) -> None:
        unit, command, arguments = message["unit"], message["command"], message["arguments"]
        state = self.state[unit]
        if command == "start" and unit == "channel":
            state |= {"state": "running", "active": True, "line": 2}
        elif command == "set_override":
            state["override"] = arguments["percent"]
        elif command == "feed_hold":
            state["state"] = "hold" if arguments["enabled"] else "running"
        elif command == "home":
            asyncio.get_running_loop().call_later(0.1, state.update, {"state": "Homing"})  # until `arrive`
        elif command == "reset" and unit == "channel":
            state |= {"state": "ready", "active": False, "line": 0}
        elif command == "emergency_stop":
            state["emergency_stop"] = arguments["enabled"]

    async def arrive(self, axis: str) -> None:
        """Its homing ends."""
        self.state[axis] |= {"state": "Standstill"}

    async def raise_alarm(self, text: str, *, severity: str = "error", number: int = 70100, source: str = "x") -> None:
        self.alarm += 1
        event = {
            "time": self.time,
            "cycle": self.cycle,
            "source": source,
            "severity": severity,
            "number": number,
            "text": text,
            "cause": "The axis is blocked, or its limits are too tight.",
            "remedy": "Look for what blocks it; P-AXIS-00168.",
            "line": 12,
            "values": [],
        }
        await self.tell({"type": "event", **event, "alarm": self.alarm, "acknowledged": False, "acknowledged_by": ""})

    async def request(self, **fields: Any) -> None:
        await self.tell(
            {
                "type": "handshake",
                "id": 7,
                "channel": "channel",
                "kind": "M",
                "number": 6,
                "value": 0,
                "spindle": "",
                "line": 12,
                **fields,
            }
        )

    async def tell(self, message: dict[str, Any]) -> None:
        for socket in self.sockets:
            if not socket.closed:
                await socket.send_json(message)

    async def _live(self) -> None:
        while True:
            await asyncio.sleep(CYCLES / 1000)
            self.cycle += CYCLES
            self.time = self.cycle / 1000
            await self._tell_state()
            await self._tell_samples()
            if self.cycle % 1000 == 0:
                values = {"lateness p99 [ms]": "2.1", "lateness, largest [ms]": "4.7", "lost blocks": "0"}
                nodes = [
                    {"name": name, "level": 0, "text": "Standstill", "values": values}
                    for name in ("channel", "x", "y", "z", "s", "plc", "clock")
                ]
                await self.tell({"type": "diagnostics", "nodes": nodes})

    async def step(self) -> None:
        """The state as it is with the next cycles."""
        await self._tell_state()

    async def _tell_state(self) -> None:
        angle = self.time * 0.5
        places = (50 * cos(angle), 50 * sin(angle), -5.0)
        for name, place in zip(self.axes, places, strict=False):
            self.state[name] |= {
                "set_position": round(place, 6),
                "actual_position": round(place - 0.004, 6),
                "work_position": round(place - 10, 6),
                "distance_to_go": 1.25,
                "following_error": 0.004,
                "set_velocity": 25.0,
                "velocity": 24.8,
                "command_velocity": 25.1,
                "target_velocity": 25.0,
                "lag_low": self.lag[0],
                "lag_high": self.lag[1],
                "target": place if self.arrives else 60.0,
            }
        channel = self.state["channel"]
        if channel["state"] == "running":
            channel["line"] = 2 + int(self.time * 5) % 390
            channel |= {
                "progress": round(channel["line"] / 400, 4),
                "time_left": 80 - channel["line"] / 5,
                "feed": 1180.0,
                "programmed_feed": 1200.0,
            }
        await self.tell({"type": "state", "time": self.time, "units": self.state})

    async def _tell_samples(self) -> None:
        cycles = np.arange(self.cycle - CYCLES, self.cycle)
        for page, names in self.signals.items():
            socket = self.sockets[page - 1]
            columns = np.concatenate([self.column(name, cycles) for name in names]).astype("<f8")
            if not socket.closed:
                await socket.send_bytes(
                    struct.pack("<5I", page, self.cycle - CYCLES, 0, len(names), CYCLES) + columns.tobytes()
                )

    @staticmethod
    def column(name: str, cycles: Any) -> Any:
        """A sine of 2 Hz for positions, with one of 25 Hz on actual values."""
        angle = 2 * pi * 2 * cycles / 1000
        shift = 0.0 if name.startswith("x") else pi / 2
        return 10 * np.sin(angle + shift) + (np.sin(2 * pi * 25 * cycles / 1000) if "actual" in name else 0.0)


if __name__ == "__main__":
    web.run_app(
        Fake(points=150_000, recording="recording" in sys.argv).app,
        host="127.0.0.1",
        port=int(sys.argv[1]) if len(sys.argv) > 1 else 8099,
    )
