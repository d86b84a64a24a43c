"""Requests as `ros2 service call` makes them: a YAML mapping set on the fields; the meaning of an empty request."""

import pytest
import yaml

from cnc_ptp import msg, srv
from cnc_ptp.nodes.topics import COUPLING_SERVICES, SERVICES
from cnc_ptp.nodes.unit.requests import contradiction, given_arguments
from cnc_ptp.protocol.commands import COMMANDS


def set_message_fields(message: object, values: dict[str, object]) -> None:
    """As rosidl_runtime_py.set_message does for plain fields (it is not on the package registry)."""
    for name, value in values.items():
        setattr(message, name, type(getattr(message, name))(value))


ALL = [
    (kind, command, service)
    for kind, services in ({**SERVICES, "axis": SERVICES["axis"] | COUPLING_SERVICES}).items()
    for command, service in services.items()
]


@pytest.mark.parametrize(("text", "enabled"), [("{enabled: false}", False), ("{enabled: on}", True), ("{}", False)])
def test_a_switch_is_set_from_yaml(text: str, enabled: bool) -> None:
    request = srv.SetSwitch.Request()
    set_message_fields(request, yaml.safe_load(text))
    assert request.enabled is enabled


def test_a_switch_topic_is_set_from_yaml() -> None:
    message = msg.Switch()
    set_message_fields(message, yaml.safe_load("{valid: true, enabled: yes}"))
    assert (message.valid, message.enabled) == (True, True)


@pytest.mark.parametrize(("kind", "command", "service"), ALL, ids=lambda value: value if isinstance(value, str) else "")
def test_no_field_has_a_name_that_yaml_takes_for_something_else(kind, command, service) -> None:  # type: ignore[no-untyped-def]
    for part in (service.Request, service.Response):
        for name in part.get_fields_and_field_types():
            assert yaml.safe_load(name) == name and name not in ("y", "n", "Y", "N")


MOVES = [
    "move_absolute",
    "move_relative",
    "move_modulo",
    "move_additive",
    "move_velocity",
    "move_superimposed",
    "set_position",
    "new_target",
    "new_velocity_and_target",
    "orient",
]


@pytest.mark.parametrize(("kind", "command", "service"), [row for row in ALL if row[1] in MOVES])
def test_an_empty_request_has_no_target(kind, command, service) -> None:  # type: ignore[no-untyped-def]
    """The unit then refuses it with 22001: `argument 'target' is missing`."""
    given = given_arguments(COMMANDS[kind][command], service.Request())
    needed = {name for name, argument in COMMANDS[kind][command].items() if argument.required}
    assert not needed & {"target", "distance", "position", "position_deg"} & given.keys()
    assert command != "move_velocity" or not given


@pytest.mark.parametrize("command", ["feed_hold", "single_block", "optional_stop"])
def test_an_empty_request_holds(command: str) -> None:
    assert given_arguments(COMMANDS["channel"][command], SERVICES["channel"][command].Request()) == {"enabled": True}


def test_decouple_says_whether_it_has_a_target() -> None:
    known, request = COMMANDS["axis"]["decouple"], srv.Decouple.Request
    assert given_arguments(known, request()) == {}
    assert given_arguments(known, request(has_target=True, target=0.0)) == {"target": 0.0}
    assert contradiction(known, request(has_target=True, target=0.0)) == ""
    assert contradiction(known, request()) == ""
    assert contradiction(known, request(has_target=True)) == "has_target is true and target is not given"
    assert contradiction(known, request(target=5.0)) == "target = 5.0 is given and has_target is false"
