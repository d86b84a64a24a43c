"""`make audit` tells what it has looked up: nothing found is no good news where nothing was looked up."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "tools" / "audit_result.py"
GOOD = {"name": "numpy", "version": "2.4.0", "vulns": []}
UNKNOWN = {"name": "rclpy", "skip_reason": "Dependency not found on PyPI"}
BAD = {
    "name": "aiohttp",
    "version": "3.11.0",
    "vulns": [{"id": "PYSEC-1", "fix_versions": ["3.11.9"]}, {"id": "PYSEC-2", "fix_versions": []}],
}


@pytest.mark.parametrize(
    "packages, status, text",
    [
        ([GOOD], 0, "1 of 1 packages were looked up, 0 known vulnerabilities.\n"),
        (
            [GOOD, UNKNOWN],
            0,
            "1 of 2 packages were looked up, 0 known vulnerabilities.\nNot known to it: rclpy\n",
        ),
        (
            [UNKNOWN],
            1,
            "0 of 1 packages were looked up, 0 known vulnerabilities.\n"
            "The service that knows vulnerabilities does not answer, or knows none of them. Nothing was audited.\n",
        ),
        (
            [GOOD, BAD],
            1,
            "aiohttp 3.11.0: PYSEC-1, mended in 3.11.9\naiohttp 3.11.0: PYSEC-2, mended in no version yet\n"
            "2 of 2 packages were looked up, 2 known vulnerabilities.\n",
        ),
    ],
    ids=["good", "partly unknown", "nothing looked up", "bad"],
)
def test_the_result_of_an_audit(tmp_path, packages, status, text):
    file = tmp_path / "audit.json"
    file.write_text(json.dumps({"dependencies": packages, "fixes": []}), encoding="utf-8")
    told = subprocess.run([sys.executable, SCRIPT, file], capture_output=True, text=True, check=False)
    assert (told.returncode, told.stdout, told.stderr) == (status, text, "")
