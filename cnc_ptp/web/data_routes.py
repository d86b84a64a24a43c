"""Parameters, words of the NC language and recorded samples over HTTP."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from aiohttp import web

from cnc_ptp.client.faults import unknown_unit
from cnc_ptp.errors import CncError
from cnc_ptp.parameters import ParameterSet, ros_descriptors
from cnc_ptp.parameters.declare.declarations import catalogue
from cnc_ptp.parameters.view.channel_view import channel_view
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.web.access.access import Access
from cnc_ptp.web.access.guard import HEADERS
from cnc_ptp.web.access.rights import require_role
from cnc_ptp.web.commissioning.spindle_curve import spindle_curve
from cnc_ptp.web.faces.recorded_face import RecordedFace
from cnc_ptp.web.faces.scope import read_signals
from cnc_ptp.web.hub import Hub
from cnc_ptp.web.numbers import A_RECORDING, BAD_MESSAGE, TOO_MANY_MESSAGES
from cnc_ptp.web.protocol import NOTHING, frame
from cnc_ptp.web.rate import Rate
from cnc_ptp.web.session import LONGEST_STALL

MOST_SNAPSHOTS = 4
"""That are made or sent at one time: each has a file until it was taken."""
PIECE = 1 << 18
"""Bytes of a file that are sent together."""
Words = Callable[[str], Sequence[tuple[str, str]]]
"""A vocabulary, twincat or iso -> its words, each with its meaning: the tables of the language are a floor above."""
NOT_STORED = {"Cache-Control": "no-store"}


class DataRoutes:
    """/api/parameters, /api/curve, /api/words, /api/recorded, /api/snapshot.mcap"""

    def __init__(self, hub: Hub, access: Access, words: Words) -> None:
        self._hub, self._access, self._words_of = hub, access, words
        self._snapshot_runs = asyncio.Lock()
        self._snapshots = asyncio.Semaphore(MOST_SNAPSHOTS)
        self._rate = Rate(10.0, 50.0)

    def add_to(self, app: web.Application) -> None:
        app.router.add_get("/api/parameters", self._parameters)
        app.router.add_get("/api/curve", self._curve)
        app.router.add_get("/api/words", self._words)
        app.router.add_get("/api/recorded", self._recorded)
        app.router.add_get("/api/snapshot.mcap", self._snapshot)

    async def _parameters(self, request: web.Request) -> web.StreamResponse:
        """`?unit=x`: all its parameters, as the machine file has them; of the plc those of the machine."""
        self._access.login_of(request)
        face, unit = self._hub.require_face(), request.query.get("unit", "")
        sets = {**face.sets, PLC: face.machine_set}
        if unit not in sets:
            raise unknown_unit(unit, sets)
        self._require_rate()
        listed = await asyncio.to_thread(lambda: [*described(sets[unit])])
        text = frame({"unit": unit, "parameters": listed})
        response = web.Response(text=text, content_type="application/json", headers=NOT_STORED)
        response.enable_compression()
        return response

    def _require_rate(self) -> None:
        """Raises CncError 26234."""
        if not self._rate.permits():
            raise CncError(TOO_MANY_MESSAGES, "too many requests in a short time", "nothing was read; wait")

    async def _curve(self, request: web.Request) -> web.StreamResponse:
        """`?spindle=s`: acceleration over speed of each gear."""
        self._access.login_of(request)
        face, spindle = self._hub.require_face(), request.query.get("spindle", "")
        face.require_kind(spindle, "spindle")
        gears = spindle_curve(face.sets[spindle], face.cycle_time)
        return web.json_response({"spindle": spindle, "gears": gears}, headers=NOT_STORED)

    async def _words(self, request: web.Request) -> web.StreamResponse:
        """`?channel=C`: the words that its programs know, with their meaning."""
        self._access.login_of(request)
        face, channel = self._hub.require_face(), request.query.get("channel", "")
        face.require_kind(channel, "channel")
        self._require_rate()
        dialect = channel_view(face.sets[channel], face.sets, Path()).dialect
        listed = await asyncio.to_thread(self._words_of, dialect)
        words = [{"name": name, "meaning": meaning} for name, meaning in listed]
        response = web.json_response({"words": words}, headers=NOT_STORED)
        response.enable_compression()
        return response

    async def _recorded(self, request: web.Request) -> web.StreamResponse:
        """`?signals=x.set_position,…&from=s&to=s&points=N`: a frame as of the scope, `&bits=32` with half the bytes."""
        self._access.login_of(request)
        face, query = self._hub.require_face(), request.query
        if not isinstance(face, RecordedFace):
            raise CncError(A_RECORDING, "recorded samples: this machine runs", f"{NOTHING}; use the scope")
        self._require_rate()
        signals = read_signals(query.get("signals", "").split(","), face.kinds)
        begin, end = number(query.get("from", "0")), number(query.get("to", str(face.end)))
        points = int(number(query.get("points", "10000")))
        bits = 32 if query.get("bits") == "32" else 64
        data = await asyncio.to_thread(face.file.samples, signals, begin, end, max(1, points), bits=bits)
        return web.Response(body=data, content_type="application/octet-stream", headers=NOT_STORED)

    async def _snapshot(self, request: web.Request) -> web.StreamResponse:
        """`?seconds=N&until=S`: seconds of the machine up to a time, now without it, where it has a recorder.

        `X-First-Cycle` of the answer: where it begins; later than asked for where the recorder has kept less.
        """
        login = self._access.login_of(request)
        require_role("snapshot", login.user, login.role, "operator")
        seconds, until = (number(request.query.get(name, "0")) for name in ("seconds", "until"))
        if self._snapshot_runs.locked() or self._snapshots.locked():
            raise CncError(TOO_MANY_MESSAGES, "snapshot: others are being made or sent", f"{NOTHING}; wait for them")
        async with self._snapshots:
            with tempfile.TemporaryDirectory(prefix="cnc_ptp-") as folder:
                file = Path(folder) / "snapshot.mcap"
                async with self._snapshot_runs:  # not while it is sent: who takes it slowly holds up nobody
                    first = await self._hub.require_face().snapshot(str(file), seconds, until)
                return await sent(request, file, {"X-First-Cycle": str(first)})


async def sent(request: web.Request, file: Path, fields: Mapping[str, str]) -> web.StreamResponse:
    """Piece by piece: it may be larger than the memory. `fields`: of its head."""
    headers = {**HEADERS, **NOT_STORED, **fields, "Content-Disposition": f'attachment; filename="{file.name}"'}
    response = web.StreamResponse(headers=headers)
    response.content_type, response.content_length = "application/octet-stream", file.stat().st_size
    await response.prepare(request)
    with file.open("rb") as stream:
        while piece := await asyncio.to_thread(stream.read, PIECE):
            try:
                async with asyncio.timeout(LONGEST_STALL):
                    await response.write(piece)
            except TimeoutError:  # whoever takes nothing keeps no file on the disk
                if request.transport is not None:
                    request.transport.abort()
                break
    return response


def number(text: str) -> float:
    """Raises CncError 26233."""
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not -1e12 < value < 1e12:
        raise CncError(BAD_MESSAGE, f"'{text[:40]}' is not a number", NOTHING)
    return value


def described(parameters: ParameterSet) -> Iterator[dict[str, Any]]:
    """Every parameter of a unit: id, name, value, unit, range, text, and when a new value takes effect."""
    declarations = catalogue().by_id
    for each in ros_descriptors(parameters):
        declaration = declarations[each.number]
        yield {
            "id": each.number,
            "name": each.ros_name,
            "value": [*each.value] if isinstance(each.value, tuple) else each.value,
            "default": [*declaration.default] if isinstance(declaration.default, tuple) else declaration.default,
            "given": each.ros_name in parameters.given,
            "type": each.type,
            "unit": each.unit,
            "min": each.minimum,
            "max": each.maximum,
            "range": each.constraints,
            "text": each.text,
            "topic": declaration.topic,
            "change": declaration.change_for(parameters.axis_type) or "start",
        }
