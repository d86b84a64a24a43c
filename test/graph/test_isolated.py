"""`run --isolated`: no process of this computer joins the graph; pages and `enter` are the only doors."""

import asyncio
import errno
import os
import shutil
import signal
import socket
import subprocess
import sys

import psutil
import pytest
from aiohttp import ClientSession, CookieJar
from aiohttp.test_utils import unused_port
from graph_support import Running, command, one_axis_machine, run
from network_support import LOOK, NOBODY, foreign, wide_open
from web_support import Page

from cnc_ptp.errors import CncError
from cnc_ptp.nodes import isolation
from cnc_ptp.nodes.isolation import claim_name
from cnc_ptp.recording.reader import read_recording


def why_not_isolated():
    """Why the system permits no namespaces of its own to this user; empty if it does."""
    words = ["--net", "--mount", "--ipc"] if os.geteuid() == 0 else ["--user", "--net", "--mount", "--ipc"]
    done = subprocess.run(["unshare", *words, "true"], capture_output=True, text=True, check=False)
    return done.stderr.strip()


pytestmark = pytest.mark.skipif(bool(why_not_isolated()), reason=why_not_isolated())


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("isolated")
    one_axis_machine(folder)
    return folder


@pytest.fixture
def isolated(folder):
    """A run with pages; its port and recording."""
    port, recording = unused_port(), folder / "isolated.mcap"
    recording.unlink(missing_ok=True)
    options = ("--isolated", "--stay", "--web", port, "--record", recording)
    with Running(folder / "one.yaml", *options) as running:
        wait_for_pages(running)
        yield running, port, recording


def wait_for_pages(running):
    lines = []
    for line in running.process.stdout:
        lines.append(line)
        if line.startswith("pages: "):
            return
    raise AssertionError("".join(lines))


def inside(*words):
    return [*command("enter"), *map(str, words)]


async def move_by_page(port):
    """A page moves the axis; its answer."""
    address = f"http://127.0.0.1:{port}"
    async with ClientSession(cookie_jar=CookieJar(unsafe=True)) as session:
        await session.get(address)
        token = (await (await session.get(f"{address}/api/session")).json())["token"]
        page = Page(await session.ws_connect(f"{address}/ws"))
        await page.send(type="hello", token=token)
        await page.wait_for("hello", lambda hello: hello["machine"])
        assert (await page.ask("take_command"))["ok"]
        answer = await page.command("x", "move_absolute", target=3)
        await page.state_of("x", lambda x: x.get("set_position") == 3.0)
        return answer


def test_nobody_joins_and_the_doors_are_open(isolated, ros_domain):
    running, port, recording = isolated
    shared = {*os.listdir("/dev/shm")}
    processes = [psutil.Process(running.process.pid), *psutil.Process(running.process.pid).children(True)]
    networks = {os.readlink(f"/proc/{process.pid}/ns/net") for process in processes}
    assert len(networks) == 1
    assert networks != {os.readlink("/proc/self/ns/net")}
    # nobody of this computer, with all transports and with those of our nodes
    assert foreign(LOOK, environment=wide_open(ROS_STATIC_PEERS="127.0.0.1")) == NOBODY
    assert run("status", expect=2).stderr.startswith("P-ERR-26135 ")
    # the doors
    assert asyncio.run(move_by_page(port))["ok"]
    status = subprocess.run(inside(*command("status")), capture_output=True, text=True, check=False)
    assert status.returncode == 0, status.stderr
    assert [line for line in status.stdout.splitlines() if line.startswith("x ")]
    moving = command("do", "x", "move_absolute", "target=4")
    assert subprocess.run(inside(*moving), capture_output=True, check=False).returncode == 0
    folder = subprocess.run(inside("pwd"), capture_output=True, text=True, check=True)
    assert folder.stdout.strip() == os.getcwd()
    # a second one
    assert run("run", recording.parent / "one.yaml", "--isolated", expect=2).stderr == (
        f"P-ERR-26215 an isolated run is under way on ROS domain {ros_domain} of this computer; nothing was started. "
        "Wait for its end, choose another --namespace, or set ROS_DOMAIN_ID to another number\n"
    )
    # the end leaves nothing
    running.process.send_signal(signal.SIGINT)
    running.finish(0)
    assert not [process for process in processes if process.is_running() and process.status() != psutil.STATUS_ZOMBIE]
    assert {*os.listdir("/dev/shm")} <= shared  # Fast DDS may clear away what was left before
    with socket.socket(socket.AF_UNIX) as claim, socket.socket() as pages:
        claim.bind(claim_name(""))
        pages.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        pages.bind(("127.0.0.1", port))
    moved = [record for record in read_recording(recording).commands if record.target == "x"]
    assert [record.command for record in moved if record.command != "stop"] == ["move_absolute"] * 2


def test_nothing_to_enter(ros_domain):
    assert run("enter", "true", expect=2).stderr == (
        f"P-ERR-26216 enter: no isolated run is under way on ROS domain {ros_domain} of this computer; nothing was "
        "started. Start it with cnc_ptp run --isolated\n"
    )


def test_a_system_that_does_not_let_enter(monkeypatch):
    def refuses(*_arguments):
        raise OSError(errno.EPERM, os.strerror(errno.EPERM))

    monkeypatch.setattr(isolation, "run_of", lambda _namespace: os.getpid())
    monkeypatch.setattr(isolation, "is_other", lambda _process, kind: kind == "net")
    monkeypatch.setattr(isolation, "call", refuses)
    with pytest.raises(CncError) as refused:
        isolation.join("")
    assert str(refused.value) == (
        "P-ERR-26214 enter: the system does not permit to enter the isolated run (Operation not permitted); nothing was "
        "started. Permit it: kernel.yama.ptrace_scope, or as root"
    )


HOLDER = """
import os, socket, sys
claim = socket.socket(socket.AF_UNIX)
claim.bind(sys.argv[1].replace("@", chr(0)))
os.setuid(65534)
print("held", flush=True)
input()
"""
"""A process of another user whose files in /proc are root's: nothing but its number says whose it is."""


def test_the_run_of_another_user_is_not_entered(ros_domain):
    if os.geteuid():
        pytest.skip("a process of another user takes root")
    words = [sys.executable, "-c", HOLDER, claim_name("").replace("\0", "@")]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout.readline() == "held\n"
        assert run("enter", "true", expect=2).stderr == (
            f"P-ERR-26217 enter: the isolated run on ROS domain {ros_domain} of this computer is that of another user; "
            "nothing was started. Only its own user enters it\n"
        )
        other.communicate("\n", timeout=30)


def test_a_system_that_permits_no_network_namespaces(folder):
    limited = 'echo 0 > /proc/sys/user/max_net_namespaces && exec "$@"'
    words = ["unshare", "--user", "--map-root-user", "sh", "-c", limited, "sh"]
    done = subprocess.run(
        [*words, *command("run", folder / "one.yaml", "--isolated")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stderr == (
        "P-ERR-26214 --isolated: the system does not permit a network namespace of its own (No space left on device); "
        "nothing was started. Permit it: user.max_user_namespaces, kernel.apparmor_restrict_unprivileged_userns\n"
    )


def test_an_ordinary_user(folder):
    """One who may not make namespaces: they are in a user namespace, which everybody may make."""
    if shutil.which("setpriv") is None:
        pytest.skip("setpriv is not installed (util-linux)")
    words = ["setpriv", "--bounding-set", "-sys_admin", "--inh-caps", "-sys_admin"] if os.geteuid() == 0 else []
    options = ("--isolated", "--composed", "--duration", "0.2")
    done = subprocess.run(
        [*words, *command("run", folder / "one.yaml", *options)],
        capture_output=True,
        text=True,
        timeout=150,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "machine time 0.200 s" in done.stdout


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (
            ("--isolated", "--foxglove"),
            "--isolated and --foxglove exclude each other: nobody outside reaches the stream.",
        ),
        (("--web-users", "users.yaml"), "--web-users needs --web."),
        (("--web-host", "::1"), "--web-host needs --web."),
        (("--web-name", "mill"), "--web-name needs --web."),
        (("--web-tls-cert", "c.pem"), "--web-tls-cert needs --web."),
    ],
)
def test_options_that_do_not_go_together(folder, options, text):
    assert f"Error: {text}\n" in run("run", folder / "one.yaml", *options, expect=2).stderr


@pytest.mark.parametrize("isolated", [(), ("--isolated",)])
def test_pages_that_others_reach_are_refused_before_anything_is_started(folder, isolated):
    words = ("run", folder / "one.yaml", "--web", unused_port(), *isolated)
    done = run(*words, "--web-host", "0.0.0.0", "--web-tls-key", "key.pem", expect=2)
    assert " ".join(done.stderr.split()) == (
        "P-ERR-26232 web: 0.0.0.0 can be reached by others, and --web-tls-cert, --web-users are missing; "
        "nothing was started; off loopback it needs TLS and users"
    )
    done = run(*words, "--web-tls-cert", "none.pem", "--web-tls-key", "none.pem", expect=2)
    assert " ".join(done.stderr.split()) == (
        "P-ERR-26247 web: certificate none.pem with key none.pem cannot be used: No such file or directory; "
        "nothing was started"
    )


def test_users_of_the_pages_are_read_before_anything_is_started(folder):
    done = run("run", folder / "one.yaml", "--web", unused_port(), "--web-users", folder / "none.yaml", expect=2)
    assert done.stderr.startswith("P-ERR-26246 ")


def test_commands_and_their_own_ros_arguments(folder):
    recording = folder / "entered.mcap"
    with Running(folder / "one.yaml", "--isolated", "--composed", "--stay", "--record", recording) as running:
        running.wait_until_recorded(recording, 1)
        done = run("enter", "no_such_command", expect=2)
        assert "Error: no_such_command cannot be run: No such file or directory.\n" in done.stderr
        shows = run("enter", sys.executable, "-c", "import sys; print(sys.argv[1:])", "-v", "--ros-args", "--unknown")
        assert shows.stdout == "['-v', '--ros-args', '--unknown']\n"
        running.process.send_signal(signal.SIGINT)
        running.finish(0)
