"""What pip-audit has found, from its JSON: fails where a package is known as bad, and where none was looked up."""

import json
import sys
from pathlib import Path


def main(file: str) -> int:
    """The status of the process: 0 when packages were looked up and none has a known vulnerability."""
    packages = json.loads(Path(file).read_text(encoding="utf-8"))["dependencies"]
    unknown = sorted(package["name"] for package in packages if "skip_reason" in package)
    bad = [(package, each) for package in packages for each in package.get("vulns", ())]
    for package, each in bad:
        versions = ", ".join(each["fix_versions"]) or "no version yet"
        print(f"{package['name']} {package['version']}: {each['id']}, mended in {versions}")
    looked_up = len(packages) - len(unknown)
    print(f"{looked_up} of {len(packages)} packages were looked up, {len(bad)} known vulnerabilities.")
    if not looked_up:
        print("The service that knows vulnerabilities does not answer, or knows none of them. Nothing was audited.")
    elif unknown:
        print(f"Not known to it: {', '.join(unknown)}")
    return 1 if bad or not looked_up else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
