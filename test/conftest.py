"""Helper modules (test/support), the packages `bench` and `figures`; property tests are seeded and never fail on time."""

import gc
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

HERE = Path(__file__).parent
IN_REAL_TIME = ("graph", "web", "web_browser", "sweep")
"""Folders whose tests wait for processes and pages: one that fails has a second attempt, which the summary lists (RERUN)."""
MOTION = pytest.StashKey[list[str]]()
"""What was checked of the motion of recordings, a line for each process."""
sys.path[:0] = [str(HERE / "support"), str(HERE.parent)]


@pytest.fixture
def blocks() -> Any:
    """Blocks of a machine as test data."""
    from recording_support import Blocks

    return Blocks(seed=2)


@pytest.fixture(autouse=True, scope="session")
def only_transitions_of_the_table() -> Iterator[None]:
    """No test of this process takes an axis or a spindle from a state to another by a transition that is not in the tables."""
    from cnc_ptp.protocol import transitions

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(transitions, "strict", True)
        yield


@pytest.fixture(autouse=True, scope="session")
def recorded_motion(tmp_path_factory: pytest.TempPathFactory, pytestconfig: pytest.Config) -> Iterator[Any]:
    """Knows each folder that tests get."""
    from recorded_motion import RecordedMotion

    motion = RecordedMotion()
    make = tmp_path_factory.mktemp

    def mktemp(basename: str, numbered: bool = True) -> Path:
        folder = make(basename, numbered)
        motion.folders.append(folder)
        return folder

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tmp_path_factory, "mktemp", mktemp)
        yield motion
    found = motion.violations(motion.all_new_files())
    pytestconfig.stash[MOTION] = [motion.summary()]
    assert not found, "\n".join(found)


@pytest.fixture(autouse=True, scope="module")
def motion_of_module(recorded_motion: Any, request: pytest.FixtureRequest) -> Iterator[None]:
    """The same of recordings that come to their end with what a module has made."""
    yield from checked(recorded_motion, request)


@pytest.fixture(autouse=True)
def motion_of_recordings(
    motion_of_module: None, recorded_motion: Any, request: pytest.FixtureRequest
) -> Iterator[None]:
    """No recording of the test has a step, exceeds a limit or moves without power (recording/motion_check).

    `motion_unchecked("why")` marks a test that bends recordings on purpose.
    """
    yield from checked(recorded_motion, request)


def checked(recorded_motion: Any, request: pytest.FixtureRequest) -> Iterator[None]:
    known = len(recorded_motion.folders)
    yield
    files = recorded_motion.new_files()
    if request.node.get_closest_marker("motion_unchecked") is None:
        found = recorded_motion.violations(files)
        assert not found, "\n".join(found)
    else:
        recorded_motion.forget(known)


def pytest_configure(config: pytest.Config) -> None:
    import long_support
    from approx_support import compare_at_once

    compare_at_once()
    long_support.SHORT = "not long" in config.option.markexpr
    settings.register_profile(
        "project",
        max_examples=long_support.examples(100),
        deadline=None,
        derandomize=True,
        suppress_health_check=[HealthCheck.too_slow],
    )
    settings.load_profile("project")


def pytest_collection_finish() -> None:
    """Twenty thousand collected tests stay to the end: nobody need look through them for garbage again and again."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)


def pytest_sessionfinish(session: pytest.Session) -> None:
    """A worker of pytest-xdist gives its line to the process that prints the summary."""
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["motion"] = session.config.stash.get(MOTION, [])


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    node.config.stash.setdefault(MOTION, []).extend(getattr(node, "workeroutput", {}).get("motion", []))


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    for line in config.stash.get(MOTION, []):
        terminalreporter.write_line(line)
    for report in terminalreporter.stats.get("rerun", []):
        crash = getattr(report.longrepr, "reprcrash", None)
        reason = f"{crash.path}:{crash.lineno}: {crash.message}" if crash else str(report.longrepr)
        terminalreporter.write_line(f"run again: {report.nodeid} ({report.when}): {reason}")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Marks tests in real time, and skips those that put something else in place of a part of a compiled kernel."""
    from cnc_ptp import KERNEL

    for item in items:
        if item.path.relative_to(HERE).parts[0] in IN_REAL_TIME:
            item.add_marker(pytest.mark.flaky(reruns=1))
    if not KERNEL.interpreted_because:
        skip = pytest.mark.skip(reason="needs the interpreted kernel: CNC_PTP_PURE=1 pytest -m interpreted")
        for item in items:
            if "interpreted" in item.keywords:
                item.add_marker(skip)


def pytest_report_header() -> str:
    from cnc_ptp import KERNEL

    return str(KERNEL)
