"""The messages of a recording as a live stream for Foxglove: `cnc_ptp run --foxglove`.

The process that records makes them, with the topics, types and bytes of the file. Foxglove connects to
ws://localhost:PORT.
"""

from __future__ import annotations

import errno
import importlib.util
import socket
from pathlib import Path
from typing import Any

from cnc_ptp.errors import CncError
from cnc_ptp.recording.mcap_file import HEAD_SIZE
from cnc_ptp.recording.writer import Recording
from cnc_ptp.wire.layout import Bytes
from cnc_ptp.wire.stamps import Times

NO_SDK = 26023
NO_PORT = 26024
HOST = "127.0.0.1"
"""This computer alone: the stream has no password."""
DEFAULT_PORT = 8765
BACKLOG = 20_000
"""Messages that a slow client may leave behind."""
LIVE_SECONDS = 0.05
NOTHING = "nothing was started"


def require_foxglove(port: int) -> None:
    """Raises CncError 26023 without the SDK, 26024 for a port that cannot be had."""
    if importlib.util.find_spec("foxglove") is None:
        raise CncError(
            NO_SDK,
            "--foxglove: foxglove-sdk is not installed",
            f"{NOTHING}, install it with: pip install 'cnc_ptp[foxglove]'",
        )
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except OSError as error:
            raise no_port(port, error) from None


def no_port(port: int, error: OSError) -> CncError:
    taken = "another program listens there" if error.errno == errno.EADDRINUSE else str(error.strerror)
    return CncError(NO_PORT, f"--foxglove: port {port}: {taken}", f"{NOTHING}, give another one: --foxglove PORT")


class LiveServer:
    """Takes what an MCAP file takes and sends it to the clients that have subscribed to it."""

    failed = False
    chunks_ready = False
    size = 0

    def __init__(self, port: int, name: str) -> None:
        """Raises CncError 26023 and 26024."""
        require_foxglove(port)
        import foxglove

        self._context = foxglove.Context()
        self._schema = foxglove.Schema
        self._channel = foxglove.Channel
        self._channels: list[Any] = []
        try:
            self._server = foxglove.start_server(
                name=name, host=HOST, port=port, context=self._context, message_backlog_size=BACKLOG
            )
        except Exception as error:  # of the SDK, which has no type of its own for it
            raise no_port(port, OSError(0, str(error))) from error

    def channel(self, topic: str, type_name: str, schema_text: str, metadata: dict[str, str]) -> int:
        schema = self._schema(name=type_name, encoding="ros2msg", data=schema_text.encode())
        made = self._channel(topic, schema=schema, message_encoding="cdr", metadata=metadata, context=self._context)
        self._channels.append(made)
        return len(self._channels) - 1

    def messages(self, channel_id: int, rows: Bytes, times: Times) -> None:
        channel = self._channels[channel_id]
        if not channel.has_sinks():
            return
        for row, time in zip(rows[:, HEAD_SIZE:], times.tolist(), strict=True):
            channel.log(row.tobytes(), log_time=time)

    def attachment(self, *_content: Any) -> None:
        """A stream has none."""

    metadata = attachment

    def close_chunk(self) -> None:
        """Messages are on their way when they come."""

    finish_chunks = close_chunk

    def close(self) -> None:
        self._server.stop()


def live_stream(server: LiveServer, start_ns: int, cycle_time_ns: int) -> Recording:
    """Takes what a recording takes."""
    return Recording(Path("live"), "", start_ns, cycle_time_ns, flush_seconds=LIVE_SECONDS, file=server)
