"""A server of pages over an offline machine, and a page that talks to it."""

import asyncio
from contextlib import asynccontextmanager
from pathlib import Path

import numpy as np
from aiohttp.test_utils import TestClient, TestServer

from cnc_ptp.web.access.access import Access
from cnc_ptp.web.access.guard import Names
from cnc_ptp.web.access.users import Users, add_user
from cnc_ptp.web.faces.machine_face import offline_face
from cnc_ptp.web.faces.scope import HEAD
from cnc_ptp.web.hub import Hub
from cnc_ptp.web.programs.programs import ProgramFolder
from cnc_ptp.web.server import Server, no_words

ROOT = Path(__file__).parents[2]
MILL = str(ROOT / "config" / "mill.yaml")
EXAMPLES = str(ROOT / "examples")
PATIENCE = 10.0
PASSWORD = "long enough"


class Page:
    """The socket of a page; `waiting` has what has come and nobody has waited for yet."""

    def __init__(self, socket):
        self.socket = socket
        self.waiting = []
        self.frames = []
        self._ids = 0

    async def send(self, **message):
        await self.socket.send_json(message)

    async def next(self):
        while True:
            message = await asyncio.wait_for(self.socket.receive(), PATIENCE)
            if message.type.name == "TEXT":
                return message.json()
            assert message.type.name == "BINARY", message
            self.frames.append(message.data)

    async def frame(self, bits=32):
        """The next frame of the scope: its first cycle, and its samples by signal."""
        while not self.frames:
            self.waiting.append(await self.next())
        data = self.frames.pop(0)
        _, low, high, signals, samples = HEAD.unpack_from(data)
        values = np.frombuffer(data, dtype=f"<f{bits // 8}", offset=HEAD.size).reshape(signals, samples)
        return low + (high << 32), values

    async def wait_for(self, kind, condition=lambda message: True):
        """The first message of a type that fulfils a condition and was not waited for before."""
        for message in self.waiting:
            if message["type"] == kind and condition(message):
                self.waiting.remove(message)
                return message
        while True:
            message = await self.next()
            if message["type"] == kind and condition(message):
                return message
            self.waiting.append(message)

    async def ask(self, type, **fields):
        """The answer to a message."""
        self._ids += 1
        await self.send(type=type, id=self._ids, **fields)
        return await self.wait_for("answer", lambda answer: answer["id"] == self._ids)

    async def command(self, unit, command, **arguments):
        return await self.ask("command", unit=unit, command=command, arguments=arguments)

    async def state_of(self, unit, condition):
        """Fields of a unit as soon as a condition of them is true."""
        known = {}
        while True:
            message = await self.wait_for("state")
            known |= message["units"].get(unit, {})
            if known and condition(known):
                return known


class Site:
    """The server, its hub, and a client with the cookie of a page."""

    def __init__(self, hub, access, client):
        self.hub, self.access, self.client = hub, access, client

    async def token(self):
        await self.client.get("/")
        answer = await self.client.get("/api/session")
        return (await answer.json())["token"]

    async def page(self, *, commands=True):
        """A page that has said hello; `commands`: it holds the command."""
        token = await self.token()
        page = Page(await self.client.ws_connect("/ws"))
        await page.send(type="hello", token=token)
        page.hello = await page.wait_for("hello")
        if commands:
            assert (await page.ask("take_command"))["ok"]
        return page


@asynccontextmanager
async def site(machine=MILL, *, connect=None, users=None, programs=EXAMPLES, waits=True, words=no_words):
    """`connect` gives the face; the one of an offline machine without it."""
    hub = Hub(
        connect or (lambda: offline_face(machine)), name="mill", folder=ProgramFolder(programs), machine_file=machine
    )
    access = Access(None if users is None else Users(str(users)))
    server = Server(hub, access, Names(), words=words)
    client = TestClient(TestServer(server.app))
    await client.start_server()
    try:
        while hub.face is None and waits:
            await asyncio.sleep(0.01)
        yield Site(hub, access, client)
    finally:
        await client.close()


def waiting_mill(folder):
    """The mill, whose M6, M3, S and H12 wait for an acknowledgement of the PLC."""
    text = Path(MILL).read_text(encoding="utf-8")
    for before, after in (
        ("m3_synch: MVS_SVS\n", "m3_synch: MVS_SVS | PLC_INFO\n"),
        ("s_synch: MOS\n", "s_synch: MVS_SVS | PLC_INFO\n"),
        ("    m_synch:\n", '    h_synch: {"12": MVS_SVS}\n    m_synch:\n'),
    ):
        assert before in text
        text = text.replace(before, after)
    file = folder / "waiting_mill.yaml"
    file.write_text(text, encoding="utf-8")
    return str(file)


def users_file(folder):
    """One user of each role."""
    file = folder / "users.yaml"
    for name, role in (("vera", "viewer"), ("otto", "operator"), ("cora", "commissioner")):
        add_user(file, name, role, PASSWORD)
    return file


async def log_in(here, user, password=PASSWORD):
    return await here.client.post("/api/login", json={"user": user, "password": password})


async def page_of(here, user):
    """A page of a user, in the browser that all users of a test share."""
    assert (await log_in(here, user)).status == 200
    token = (await (await here.client.get("/api/session")).json())["token"]
    page = Page(await here.client.ws_connect("/ws"))
    await page.send(type="hello", token=token)
    page.hello = await page.wait_for("hello")
    return page
