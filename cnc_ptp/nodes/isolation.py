"""A run in namespaces of its own: no other process of this computer reaches its DDS domain.

A network namespace with a loopback of its own keeps datagrams apart, a mount namespace with a /dev/shm of its own the
shared memory of whoever chooses that transport, an IPC namespace queues. What was opened before stays open: the
socket of the web face still listens on the loopback of the computer. Programs come in by `cnc_ptp enter`.
"""

from __future__ import annotations

import ctypes
import fcntl
import hashlib
import os
import socket
import struct
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Final

from cnc_ptp.errors import CncError

NOT_PERMITTED: Final = 26214
"""The system does not permit namespaces."""
ALREADY_ISOLATED: Final = 26215
"""An isolated run of this domain and namespace is under way."""
NO_ISOLATED_RUN: Final = 26216
FOREIGN_RUN: Final = 26217
"""The run of another user."""

NEW_MOUNTS, NEW_IPC, NEW_USER, NEW_NET = 0x00020000, 0x08000000, 0x10000000, 0x40000000
"""Flags of unshare(2)."""
REST = NEW_NET | NEW_MOUNTS | NEW_IPC
MOUNT_NO_SETUID, MOUNT_NO_DEVICES, MOUNT_RECURSIVE, MOUNT_SLAVE = 0x2, 0x4, 0x4000, 0x80000
"""Flags of mount(2)."""
SET_INTERFACE_FLAGS, INTERFACE_UP = 0x8914, 0x1
"""netdevice(7)."""
ENTERED: Final = ("user", "mnt", "net", "ipc")
"""Namespaces that `enter` joins, in this order: the first one gives the rights to join the others."""
NOTHING = "nothing was started"


def claim_name(namespace: str) -> str:
    """The abstract socket by which an isolated run of this ROS domain and `namespace` is found from outside."""
    domain = os.environ.get("ROS_DOMAIN_ID") or "0"
    place = hashlib.sha256(f"{domain} {namespace}".encode()).hexdigest()  # names of sockets are short
    return f"\0cnc_ptp/isolated/{place}"


def place_of(namespace: str) -> str:
    """Domain and namespace in words."""
    domain = os.environ.get("ROS_DOMAIN_ID") or "0"
    return f"ROS domain {domain}{f' in namespace {namespace}' if namespace else ''}"


@contextmanager
def isolated(namespace: str) -> Iterator[None]:
    """Puts this process into namespaces of its own, and what it starts from now on; they end with the last of them.

    To be entered before any thread is started: the namespaces are those of the calling thread. Raises CncError 26214
    where the system does not permit it, 26215 while another one is under way in this domain and `namespace`.
    """
    with socket.socket(socket.AF_UNIX) as claim:
        try:
            claim.bind(claim_name(namespace))
        except OSError:
            reason = f"an isolated run is under way on {place_of(namespace)} of this computer"
            remedy = "Wait for its end, choose another --namespace, or set ROS_DOMAIN_ID to another number"
            raise CncError(ALREADY_ISOLATED, reason, f"{NOTHING}. {remedy}") from None
        try:
            leave_the_computer()
            use_own_shared_memory()
            start_loopback()
        except OSError as error:
            raise not_permitted(error) from None
        yield


def not_permitted(error: OSError) -> CncError:
    reason = f"--isolated: the system does not permit a network namespace of its own ({error.strerror})"
    effect = f"{NOTHING}. Permit it: user.max_user_namespaces, kernel.apparmor_restrict_unprivileged_userns"
    return CncError(NOT_PERMITTED, reason, effect)


def leave_the_computer() -> None:
    """New namespaces; for ordinary users inside of a user namespace that keeps their number. Raises OSError."""
    try:
        call("unshare", REST)
    except PermissionError:
        user, group = os.geteuid(), os.getegid()
        call("unshare", NEW_USER | REST)
        for name, text in (("setgroups", "deny"), ("uid_map", f"{user} {user} 1"), ("gid_map", f"{group} {group} 1")):
            with open(f"/proc/self/{name}", "w") as file:
                file.write(text)


def use_own_shared_memory() -> None:
    """An empty /dev/shm; disks that are mounted on the computer later appear here as well. Raises OSError."""
    call("mount", None, b"/", None, MOUNT_RECURSIVE | MOUNT_SLAVE, None)
    call("mount", b"tmpfs", b"/dev/shm", b"tmpfs", MOUNT_NO_SETUID | MOUNT_NO_DEVICES, b"mode=1777")


def start_loopback() -> None:
    """Raises OSError."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        fcntl.ioctl(any_socket, SET_INTERFACE_FLAGS, struct.pack("16sh14x", b"lo", INTERFACE_UP))


def call(function: str, *arguments: int | bytes | None) -> None:
    """A function of the C library (os.unshare and os.setns come with Python 3.12). Raises OSError."""
    library = ctypes.CDLL(None, use_errno=True)
    if getattr(library, function)(*arguments):
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))


def join(namespace: str) -> None:
    """Puts this process into the namespaces of the isolated run, in the folder in which it is.

    Raises CncError 26216 when there is none, 26217 for that of another user, 26214 where the system does not let it.
    """
    process = run_of(namespace)
    folder = os.getcwd()
    try:
        doors = [os.open(f"/proc/{process}/ns/{kind}", os.O_RDONLY) for kind in ENTERED if is_other(process, kind)]
    except OSError:  # it has ended meanwhile
        raise no_run(namespace) from None
    for door in doors:
        try:
            call("setns", door, 0)
        except OSError as error:
            reason = f"enter: the system does not permit to enter the isolated run ({error.strerror})"
            raise CncError(
                NOT_PERMITTED, reason, f"{NOTHING}. Permit it: kernel.yama.ptrace_scope, or as root"
            ) from None
        finally:
            os.close(door)
    os.chdir(folder)


def run_of(namespace: str) -> int:
    """The process of the isolated run: who has the claim. Raises CncError 26216, 26217."""
    inode = claim_inode(claim_name(namespace))
    if inode is None:
        raise no_run(namespace)
    for process in filter(str.isdecimal, os.listdir("/proc")):
        with suppress(OSError):  # processes of others, and what has just ended
            if is_own(process) and has_socket(process, inode):
                return int(process)
    reason = f"enter: the isolated run on {place_of(namespace)} of this computer is that of another user"
    raise CncError(FOREIGN_RUN, reason, f"{NOTHING}. Only its own user enters it")


def claim_inode(name: str) -> str | None:
    """Number of the socket with an abstract name, in the network namespace of this process; None if there is none."""
    shown = name.replace("\0", "@")
    with open("/proc/net/unix") as sockets:
        rows = (line.split() for line in sockets)
        return next((row[6] for row in rows if row[-1] == shown), None)


def is_own(process: str) -> bool:
    """It runs as this user. Its files in /proc do not say so: those of a process may be root's, whoever's it is.

    Nobody is to be lured into the namespaces of somebody else, in which all files may be others. Raises OSError.
    """
    with open(f"/proc/{process}/status") as status:
        users = next(line.split()[1:] for line in status if line.startswith("Uid:"))
    return {*users} == {str(os.geteuid())}


def has_socket(process: str, inode: str) -> bool:
    """Raises OSError for a process of somebody else, or one that has ended."""
    folder = f"/proc/{process}/fd"
    return any(os.readlink(f"{folder}/{number}") == f"socket:[{inode}]" for number in os.listdir(folder))


def no_run(namespace: str) -> CncError:
    reason = f"enter: no isolated run is under way on {place_of(namespace)} of this computer"
    return CncError(NO_ISOLATED_RUN, reason, f"{NOTHING}. Start it with cnc_ptp run --isolated")


def is_other(process: int, kind: str) -> bool:
    """A namespace of another process is not the one of this process."""
    return os.readlink(f"/proc/{process}/ns/{kind}") != os.readlink(f"/proc/self/ns/{kind}")
