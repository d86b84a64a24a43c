"""Metadata of rosbag2: in the recording itself and the same in `metadata.yaml` next to it.

`ros2 bag info` and `ros2 bag play` take the file alone, and the folder when there is a `metadata.yaml` in it. That
describes one recording, the first of the folder: further ones leave it unchanged.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml
from mcap.records import Channel, Schema, Statistics

from cnc_ptp import yaml_text

VERSION = 9
"""Of the metadata, as rosbag2 of Jazzy and Kilted writes it."""
RECORD = "rosbag2"
"""Name of the metadata record in the file."""
FILE = "metadata.yaml"
INFORMATION = "rosbag2_bagfile_information"
QOS, TYPE_HASH = "offered_qos_profiles", "topic_type_hash"
"""Metadata of a channel."""


def bag_information(
    name: str, statistics: Statistics, channels: Sequence[Channel], schemas: Sequence[Schema]
) -> dict[str, Any]:
    """The metadata of a bag that consists of the file `name` alone."""
    types = {schema.id: schema.name for schema in schemas}
    counts = statistics.channel_message_counts
    span = {
        "starting_time": {"nanoseconds_since_epoch": statistics.message_start_time},
        "duration": {"nanoseconds": statistics.message_end_time - statistics.message_start_time},
        "message_count": statistics.message_count,
    }
    return {
        "version": VERSION,
        "storage_identifier": "mcap",
        **span,
        "topics_with_message_count": [
            {"topic_metadata": _topic(channel, types[channel.schema_id]), "message_count": counts.get(channel.id, 0)}
            for channel in channels
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [name],
        "files": [{"path": name, **span}],
        "custom_data": None,
        "ros_distro": os.environ.get("ROS_DISTRO", "kilted"),
    }


def _topic(channel: Channel, type_name: str) -> dict[str, Any]:
    return {
        "name": channel.topic,
        "type": type_name,
        "serialization_format": channel.message_encoding,
        QOS: _quality_of_service(channel),
        "type_description_hash": channel.metadata.get(TYPE_HASH, ""),
    }


def _quality_of_service(channel: Channel) -> list[Any]:
    """As the publishers offered it; none of a text that is no list."""
    try:
        offered = yaml_text.load(channel.metadata.get(QOS, ""))
    except yaml.YAMLError:
        return []
    return offered if isinstance(offered, list) else []


def metadata_text(information: dict[str, Any]) -> str:
    text: str = yaml.dump(information, Dumper=_Plain, sort_keys=False)
    return text


def write_beside(recording: Path, information: dict[str, Any]) -> None:
    """Writes `metadata.yaml` into the folder of a recording, unless one there is not this recording's.

    If it cannot be written there is none: the file itself holds the same.
    """
    if recording.is_file() and _may_write(recording):
        with contextlib.suppress(OSError):
            (recording.parent / FILE).write_text(metadata_text({INFORMATION: information}), encoding="utf-8")


def forget_beside(recording: Path) -> None:
    """Removes the `metadata.yaml` of a recording that is written again."""
    if _described(recording.parent / FILE) == [recording.name]:
        with contextlib.suppress(OSError):
            (recording.parent / FILE).unlink()


def _may_write(recording: Path) -> bool:
    """There is none, it is this recording's, or all files that it describes are gone."""
    beside = recording.parent / FILE
    if not beside.exists():
        return True
    described = _described(beside)
    return described == [recording.name] or (
        bool(described) and not any((recording.parent / name).exists() for name in described)
    )


def _described(beside: Path) -> list[str]:
    """The files that a `metadata.yaml` lists; none if it is not one of rosbag2."""
    try:
        paths = yaml_text.load(beside.read_text(encoding="utf-8"))[INFORMATION]["relative_file_paths"]
        return [str(path) for path in paths]
    except (OSError, UnicodeDecodeError, yaml.YAMLError, TypeError, KeyError):
        return []


class _Plain(yaml_text.WRITER):  # type: ignore[misc]
    """Writes equal parts twice: yaml-cpp does so, and not all readers know aliases."""

    def ignore_aliases(self, data: Any) -> bool:
        return True
