"""Tables of sweeps whose texts are damaged (found by bench.fuzz sweep-table, seed 2, numbers 25 and 311)."""

import pyarrow as pa
import pytest
from pyarrow import parquet

from cnc_ptp.errors import CncError
from cnc_ptp.sweep.journal import SWEEP
from cnc_ptp.sweep.table import read_table

DESCRIPTION = {"goals": ["program_time"]}
NEW_NAME = "; nothing was started, give another name"


def refusal(file):
    with pytest.raises(CncError) as caught:
        read_table(file, DESCRIPTION, 1)
    return str(caught.value)


def table(file, metadata, message):
    texts = pa.array([message], pa.binary()).view(pa.string())
    columns = {"variant": pa.array([0]), "program_time": pa.array([1.0]), "error": pa.array([0]), "message": texts}
    parquet.write_table(pa.table(columns).replace_schema_metadata({SWEEP: metadata}), file)


def test_a_description_that_is_no_text(tmp_path):
    file = tmp_path / "t.parquet"
    table(file, b"\xff", b"")
    assert refusal(file) == f"P-ERR-26183 {file} exists and is no table of a sweep{NEW_NAME}"


def test_a_message_that_is_no_text(tmp_path):
    file = tmp_path / "t.parquet"
    table(file, b'{"cnc_ptp sweep": {"goals": ["program_time"]}}', b"a\xf8")
    begin = f"P-ERR-26183 {file} exists and its rows cannot be read: 'utf-8' codec can't decode byte 0xf8 in position 1"
    assert refusal(file).startswith(begin) and refusal(file).endswith(NEW_NAME)
