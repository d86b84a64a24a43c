"""Adds the libraries of the pages, which are shipped and in no lock file, to a list of parts (CycloneDX, JSON)."""

import json
import sys
from pathlib import Path

VENDOR = Path(__file__).parents[1] / "cnc_ptp" / "web" / "static" / "vendor"


def main(file: str) -> int:
    path = Path(file)
    parts = json.loads(path.read_text(encoding="utf-8"))
    libraries = json.loads((VENDOR / "libraries.json").read_text(encoding="utf-8"))
    parts.setdefault("components", []).extend(component(library) for library in libraries)
    path.write_text(json.dumps(parts, indent=2, sort_keys=True) + "\n", encoding="utf-8")
    return 0


def component(library: dict[str, str]) -> dict[str, object]:
    """As CycloneDX names a package of npm."""
    name, version = library["name"], library["version"]
    reference = f"pkg:npm/{name}@{version}"
    licences = [{"license": {"id": library["licence"]}}]
    known_as = {"type": "library", "bom-ref": reference, "purl": reference}
    return {**known_as, "name": name, "version": version, "licenses": licences}


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
