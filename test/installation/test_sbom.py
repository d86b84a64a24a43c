"""The list of parts has the libraries of the pages, in the versions that were fetched and with the bytes that are shipped."""

import hashlib
import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
VENDOR = ROOT / "cnc_ptp" / "web" / "static" / "vendor"


def libraries():
    return json.loads((VENDOR / "libraries.json").read_text())


def test_the_libraries_of_the_pages_are_added(tmp_path):
    file = tmp_path / "sbom.json"
    file.write_text(json.dumps({"components": [{"name": "numpy"}]}))
    for expected in (3, 5):  # what is there stays
        subprocess.run([sys.executable, ROOT / "tools" / "sbom_web.py", file], check=True)
        assert len(json.loads(file.read_text())["components"]) == expected
    added = json.loads(file.read_text())["components"][1:3]
    assert [each["purl"] for each in added] == ["pkg:npm/three@0.187.0", "pkg:npm/uplot@1.6.32"]


def test_versions_and_files_are_those_that_were_fetched():
    script = (ROOT / "tools" / "fetch_web_libraries.sh").read_text()
    sums = dict(reversed(line.split()) for line in (VENDOR / "SHA256SUMS").read_text().splitlines())
    for library in libraries():
        assert f'"{library["name"]}": "{library["version"]}"' in script
        for name in library["files"]:
            assert hashlib.sha256((VENDOR / name).read_bytes()).hexdigest() == sums.pop(name)
    assert not sums, "shipped, and in no list"
