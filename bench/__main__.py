"""`python -m bench`: measures the topics, prints a table for each, writes JSON if asked."""

from __future__ import annotations

import json
import os
import platform
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import click
from rich.console import Console

from bench.figures import FULL, SHORT, Effort, Figure, ShowProgress, table

TOPICS = (
    "interpreter",
    "motion",
    "control",
    "smoothing",
    "lookahead",
    "paths",
    "streaming",
    "recording",
    "columns",
    "what_if",
    "recorder",
    "offline",
    "graph",
    "service",
    "plc",
    "web",
    "client",
    "slaves",
    "spindles",
    "lists",
    "sweep",
)


@contextmanager
def progress(topic: str) -> Iterator[ShowProgress]:
    """A line with the topic and what is measured at the moment; on a terminal only."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda text: None
        return
    with console.status(topic) as status:
        yield lambda text: status.update(f"{topic}: {text}")


def measure(topic: str, effort: Effort) -> list[Figure]:
    """All figures of a topic. A topic's module is loaded when its turn comes: not all need ROS."""
    figures: Callable[[Effort, ShowProgress], Iterator[Figure]] = import_module(f"bench.{topic}").figures
    with progress(topic) as show:
        return list(figures(effort, show))


def host() -> dict[str, Any]:
    """The computer of the measurement; other programs on it show in the load."""
    return {
        "python": platform.python_version(),
        "system": platform.platform(),
        "processors": os.cpu_count(),
        "load": list(os.getloadavg()),
    }


def write_json(path: str, effort: Effort, results: dict[str, list[Figure]]) -> None:
    figures = {
        topic: [asdict(figure) | {"ratio": figure.ratio, "met": figure.met} for figure in found]
        for topic, found in results.items()
    }
    Path(path).write_text(json.dumps({"host": host(), "effort": asdict(effort), "figures": figures}, indent=1) + "\n")


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("topics", nargs=-1, type=click.Choice(TOPICS))
@click.option("--short", is_flag=True, help="Fewer runs of smaller jobs, 15 s of the graph.")
@click.option("--seconds", type=click.FloatRange(1.0), help="Length of the real-time runs of the graph.")
@click.option("--json", "json_file", type=click.Path(dir_okay=False), help="Also write all figures to this file.")
def main(topics: tuple[str, ...], short: bool, seconds: float | None, json_file: str | None) -> None:
    """Measure speed and memory of TOPICS (all if none is given). Figures never fail; goals are shown next to them.

    Medians over several runs (control: the least). If another program does the same, it runs in turn with ours.
    """
    effort = SHORT if short else FULL
    if seconds is not None:
        effort = replace(effort, graph_seconds=seconds)
    console = Console(highlight=False, width=None if sys.stdout.isatty() else 140)
    results: dict[str, list[Figure]] = {}
    for topic in topics or TOPICS:
        results[topic] = measure(topic, effort)
        console.print(table(topic, results[topic]))
        if json_file is not None:
            write_json(json_file, effort, results)
    console.print(f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}, Python {platform.python_version()}")


if __name__ == "__main__":
    main()
