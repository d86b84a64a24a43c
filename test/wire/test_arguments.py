"""Arguments of commands as JSON, and back."""

import json
import math

import pytest

from cnc_ptp.protocol.blocks import arguments_of, json_of

EVERYTHING = {
    "a": math.inf, "b": [-math.inf, 1, 2.5, True, None, "nan"], "c": {"d": [[math.inf]]}, "e": "Infinity", "f": {},
}  # fmt: skip


def test_every_argument_comes_back_as_it_was():
    text = json_of(EVERYTHING)
    assert arguments_of(text) == EVERYTHING
    assert json.loads(text)["a"] == {"$numberDouble": "Infinity"}
    (value,) = arguments_of(json_of({"a": math.nan})).values()
    assert math.isnan(value)


def test_what_is_finite_is_plain_json():
    assert json_of({"b": 1.5, "a": "é"}) == '{"a": "é", "b": 1.5}'


@pytest.mark.parametrize("other", ["NAN", "1.5", "", 1.5, None, ["NaN"]])
def test_another_object_of_that_key_remains_one(other):
    arguments = {"a": {"$numberDouble": other}, "b": {"$numberDouble": "NaN", "c": 1}}
    assert arguments_of(json.dumps(arguments)) == arguments


def test_a_value_that_is_no_json_is_its_repr():
    assert arguments_of(json_of({"a": {1}, "b": math.inf})) == {"a": "{1}", "b": math.inf}


@pytest.mark.parametrize("text", ["[1]", "1", "null", '{"$numberDouble": "NaN"}'])
def test_anything_but_an_object_is_refused(text):
    with pytest.raises(ValueError, match="no JSON object"):
        arguments_of(text)
