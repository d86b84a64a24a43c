"""Schema texts as MCAP embeds them, and the fields in them."""

import pytest

from cnc_ptp.errors import CncError
from cnc_ptp.wire.schemas import (
    DIVIDER,
    Field,
    full_name,
    load_schema,
    parse_schema,
    recorded_schema,
    schema_text,
    short_name,
)


def test_names():
    assert short_name("cnc_ptp/msg/AxisState") == short_name("cnc_ptp/AxisState") == "cnc_ptp/AxisState"
    assert full_name("cnc_ptp/msg/AxisState") == full_name("cnc_ptp/AxisState") == "cnc_ptp/msg/AxisState"


def test_text_holds_every_used_type_once():
    text = schema_text("cnc_ptp/msg/ChannelBlock")
    parts = text.split(f"{DIVIDER}\n")
    assert parts[0].startswith("# One block of the NC channel")
    assert [part.splitlines()[0] for part in parts[1:]] == [
        "MSG: std_msgs/Header",
        "MSG: cnc_ptp/ChannelOffsets",
        "MSG: cnc_ptp/CommandRequest",
        "MSG: cnc_ptp/HandshakeRequest",
        "MSG: cnc_ptp/JobEvent",
        "MSG: cnc_ptp/CommandAnswer",
        "MSG: cnc_ptp/ControlUnitState",
        "MSG: builtin_interfaces/Time",
    ]


def test_fields_of_all_kinds():
    text = """
# comment
uint8 CONSTANT=3
string NAME = "a # b"
int32 plain 7   # default value
string<=10 bounded_text
float64[] free
float64[<=5] bounded
float64[9] fixed
Header header
Part[] parts
"""
    text += f"{DIVIDER}\nMSG: my/Part\nbool on\n{DIVIDER}\nMSG: std_msgs/Header\nstring frame_id\n"
    schema = parse_schema("my/msg/Thing", text)
    assert schema.fields == (
        Field("plain", "int32"),
        Field("bounded_text", "string"),
        Field("free", "float64", -1),
        Field("bounded", "float64", -1),
        Field("fixed", "float64", 9),
        Field("header", "std_msgs/Header"),
        Field("parts", "my/Part", -1),
    )
    assert schema.types["my/Part"] == (Field("on", "bool"),)


@pytest.mark.parametrize("name", ["AxisState", "SpindleState", "ChannelState", "Event", "CommandRecord"])
def test_state_columns_are_the_fields_of_the_contract(name):
    assert load_schema(f"cnc_ptp/msg/{name}").fields[:2] == (
        Field("header", "std_msgs/Header"),
        Field("cycle", "uint64"),
    )


def test_a_recorded_definition_that_is_no_text():
    with pytest.raises(CncError) as error:
        recorded_schema("nowhere/msg/Thing", b"float64 x\xff")
    assert str(error.value) == (
        "P-ERR-26005 recording: message type nowhere/msg/Thing: its definition is no UTF-8 at byte 9; "
        "the schema is not usable"
    )
    assert recorded_schema("nowhere/msg/Thing", b"float64 x").fields == (Field("x", "float64"),)


def test_unknown_type_is_refused():
    with pytest.raises(CncError) as error:
        schema_text("nowhere/msg/Thing")
    assert error.value.number == 26005
    assert str(error.value).startswith(
        "P-ERR-26005 recording: message type nowhere/msg/Thing is not installed (looked for msg/Thing.msg in the "
        "ROS prefixes and "
    )
    assert str(error.value).endswith("; it cannot be recorded, install package nowhere")


def test_line_that_is_no_field_is_refused():
    with pytest.raises(CncError) as error:
        parse_schema("my/msg/Thing", "float64\n")
    assert str(error.value) == (
        "P-ERR-26005 recording: message type my/msg/Thing: 'float64' is not a field; the schema is not usable"
    )


@pytest.mark.parametrize("used", ["wstring", "my/Other"])
def test_type_that_is_not_defined_is_refused(used):
    with pytest.raises(CncError) as error:
        parse_schema("my/msg/Thing", f"{used} part\n")
    assert str(error.value) == (
        f"P-ERR-26005 recording: message type my/msg/Thing: type {used} of field my/msg/Thing.part is neither "
        "defined in the "
        "schema nor supported; the schema is not usable"
    )
