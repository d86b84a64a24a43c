"""Makes ids.py, the constants of the parameter ids, from declarations.yaml: `make ids` calls this file as a script.

It imports nothing from the package, so that it runs even if a constant that the package uses is missing.
"""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

FOLDER = Path(__file__).parent
HEAD = '"""The parameter ids by their names in the lists. Made by `make ids` from declarations.yaml; do not edit."""\n'


def ids_module(parameters: Mapping[str, Mapping[str, Any]]) -> str:
    """Text of ids.py: one constant per parameter with its full name as a comment, by list and in order of the ids."""
    lists = dict.fromkeys(entry["list"] for entry in parameters.values())
    return HEAD + "".join(line for name in lists for line in list_lines(name, parameters))


def list_lines(list_name: str, parameters: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    yield f"\n# {list_name} list\n"
    for number, entry in sorted(parameters.items()):
        if entry["list"] == list_name:
            yield f'{constant(entry["name"])} = "{number}"  # {entry["name"]}\n'


def constant(name: str) -> str:
    """The last two parts of a name: getriebe[i].dynamik.vb_max -> DYNAMIK_VB_MAX."""
    return "_".join(re.sub(r"\[[ij]\]", "", name).upper().split(".")[-2:])


def declared() -> dict[str, Any]:
    """The entries of declarations.yaml by id."""
    parameters: dict[str, Any] = yaml.safe_load((FOLDER / "declarations.yaml").read_text(encoding="utf-8"))[
        "parameters"
    ]
    return parameters


if __name__ == "__main__":
    (FOLDER / "ids.py").write_text(ids_module(declared()), encoding="utf-8")
