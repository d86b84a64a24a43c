"""Fast DDS over TCP with TLS: whose certificate the accepting side takes, with and without tools/tls/openssl.cnf."""

import os
import socket
import ssl
import subprocess
import sys
import time
from pathlib import Path

import pytest
import trustme
from aiohttp.test_utils import unused_port

CONFIGURATION = Path(__file__).parents[2] / "tools" / "tls" / "openssl.cnf"
NODE = """
import rclpy
from rclpy.node import Node
rclpy.init()
node = Node("accepts", enable_rosout=False, start_parameter_services=False)
print("there", flush=True)
input()
"""
PROFILE = """<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns="http://www.eprosima.com"><profiles>
  <transport_descriptors><transport_descriptor>
    <transport_id>tls</transport_id><type>TCPv4</type>
    <listening_ports><port>{port}</port></listening_ports>
    <tls>
      <private_key_file>{folder}/own.key</private_key_file><cert_chain_file>{folder}/own.pem</cert_chain_file>
      <verify_file>{folder}/own_authority.pem</verify_file>
      <verify_mode><verify>VERIFY_PEER</verify><verify>VERIFY_FAIL_IF_NO_PEER_CERT</verify></verify_mode>
    </tls>
  </transport_descriptor></transport_descriptors>
  <participant profile_name="tls" is_default_profile="true"><rtps>
    <userTransports><transport_id>tls</transport_id></userTransports><useBuiltinTransports>false</useBuiltinTransports>
  </rtps></participant>
</profiles></dds>
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Certificates of two authorities."""
    folder = tmp_path_factory.mktemp("tls")
    for whose in ("own", "foreign"):
        authority = trustme.CA()
        authority.cert_pem.write_to_path(folder / f"{whose}_authority.pem")
        certificate = authority.issue_cert("localhost", "127.0.0.1")
        certificate.private_key_pem.write_to_path(folder / f"{whose}.key")
        (folder / f"{whose}.pem").write_bytes(b"".join(part.bytes() for part in certificate.cert_chain_pems))
    return folder


def is_taken(folder, port, whose):
    """A peer with a certificate of `whose` authority, None: without one, gets through the handshake."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.load_verify_locations(folder / "own_authority.pem")
    context.maximum_version = ssl.TLSVersion.TLSv1_2  # of 1.3 the refusal comes after the handshake
    if whose is not None:
        context.load_cert_chain(folder / f"{whose}.pem", folder / f"{whose}.key")
    with socket.create_connection(("127.0.0.1", port), timeout=30.0) as plain:
        try:
            with context.wrap_socket(plain, server_hostname="127.0.0.1"):
                return True
        except ssl.SSLError as error:
            assert error.reason in ("TLSV1_ALERT_UNKNOWN_CA", "SSLV3_ALERT_HANDSHAKE_FAILURE"), error
            return False


def peers_taken(folder, ros_domain, **more):
    """Peers that a participant takes: of its own authority, of a foreign one, without a certificate."""
    port = unused_port()
    profile = folder / "profile.xml"
    profile.write_text(PROFILE.format(port=port, folder=folder))
    environment = os.environ | {
        "ROS_DOMAIN_ID": str(ros_domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",
        "FASTDDS_DEFAULT_PROFILES_FILE": str(profile),
    }
    words = [sys.executable, "-c", NODE]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen(words, env=environment | more, **pipes) as node:
        try:
            assert node.stdout.readline() == "there\n"
            wait_for(port)
            return [is_taken(folder, port, whose) for whose in ("own", "foreign", None)]
        finally:
            node.kill()


def wait_for(port):
    deadline = time.monotonic() + 30.0
    while True:
        try:
            socket.create_connection(("127.0.0.1", port), timeout=1.0).close()
            return
        except OSError:
            assert time.monotonic() < deadline, "it does not listen"
            time.sleep(0.05)


def test_the_profile_alone_takes_everybody(folder, ros_domain):
    """Which is why TLS of a profile is no access control. A wheel that refuses has mended it: then docs/security.md changes."""
    assert peers_taken(folder, ros_domain) == [True, True, True]


def test_with_the_configuration_only_the_own_authority_counts(folder, ros_domain):
    assert peers_taken(folder, ros_domain, OPENSSL_CONF=str(CONFIGURATION)) == [True, False, False]
