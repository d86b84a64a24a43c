"""What nodes tell of themselves on the wire: how often they announce themselves, and that nobody looks up types."""

import socket
import struct
import time

import pytest
from rclpy.node import Node
from ros_support import ros

from cnc_ptp.nodes import process

PARTICIPANT_WRITER = bytes.fromhex("000100c2")
BUILTIN_ENDPOINTS = 0x58
TYPE_LOOKUP = 0b1111 << 12
"""Bits of the set of built-in endpoints (DDS-XTypes 1.3, 7.6.3.3.4): readers and writers of requests and replies."""
PEER = 50
"""A participant that nobody has: its port is free, and gets the announcements of all."""


@pytest.fixture
def announcements(ros_domain, monkeypatch):
    """Time and parameters of each announcement that arrives in 8 s from the making of a node on."""
    for name in (process.RANGE, process.PROFILE):
        monkeypatch.delenv(name, raising=False)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
        peer.bind(("127.0.0.1", 7400 + 250 * ros_domain + 10 + 2 * PEER))
        peer.settimeout(0.2)
        with ros():
            node = Node("announced", enable_rosout=False)
            try:
                return [*received(peer, 8.0)]
            finally:
                node.destroy_node()


def received(peer, seconds):
    began = time.monotonic()
    while time.monotonic() - began < seconds:
        try:
            datagram = peer.recv(65536)
        except TimeoutError:
            continue
        for parameters in participant_data(datagram):
            yield time.monotonic() - began, parameters


def participant_data(datagram):
    """Parameters of each DATA(p) of an RTPS message: header of 20 bytes, then submessages, little endian."""
    at = 20
    while at + 4 <= len(datagram):
        kind, _, length = struct.unpack_from("<BBH", datagram, at)
        length = length or len(datagram) - at - 4
        body = datagram[at + 4 : at + 4 + length]
        if kind == 0x15 and body[8:12] == PARTICIPANT_WRITER:
            yield parameters_of(body[24:])
        at += 4 + length


def parameters_of(data):
    found, at = {}, 0
    while at + 4 <= len(data):
        number, length = struct.unpack_from("<HH", data, at)
        found[number] = data[at + 4 : at + 4 + length]
        at += 4 + length
        if number == 1:  # the end of the list
            break
    return found


def test_announcements(announcements):
    """30 in 3 s, then one per second; a busy computer may be late with some."""
    times = [moment for moment, _ in announcements]
    assert sum(moment < 4.5 for moment in times) >= 20
    assert sum(moment >= 4.5 for moment in times) >= 2, "one in 3 s would not do"
    endpoints = {struct.unpack("<I", parameters[BUILTIN_ENDPOINTS])[0] for _, parameters in announcements}
    assert all(bits & 0b111111 and not bits & TYPE_LOOKUP for bits in endpoints), endpoints
