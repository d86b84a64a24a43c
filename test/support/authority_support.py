"""A machine of which an axis is closed to some sources of commands."""

import yaml
from graph_support import PTP

END = "; nothing was changed"


def closed_file(folder, *sources):
    """A machine of two axes, x closed to some sources."""
    machine = yaml.load(PTP.read_text(), yaml.BaseLoader)
    for axis in ("z", "c"):
        del machine[f"/{axis}"]
    machine["/machine"]["ros__parameters"]["axes"] = ["x", "y"]
    machine["/machine"]["ros__parameters"] |= {f"closed_to_{source}": ["x"] for source in sources}
    file = folder / "closed.yaml"
    file.write_text(yaml.dump(machine).replace("'", "").replace("- y\n", '- "y"\n'))
    return file
