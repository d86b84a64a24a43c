"""Entry points of the command line. Everything that takes time to load comes behind the handler of the interrupt."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable
from pathlib import Path

from cnc_ptp import KERNEL
from cnc_ptp.interrupt import end_command
from cnc_ptp.one_thread import use_one_thread


def _entry(*command: str) -> Callable[[], object]:
    """`cnc_ptp`, or one of its commands for itself, so that `ros2 run cnc_ptp simulate ...` serves the same."""

    def call() -> object:
        signal.signal(signal.SIGINT, end_command)
        use_one_thread()
        try:
            from cnc_ptp.cli import main

            if KERNEL.remedy:
                print(f"{KERNEL}; {KERNEL.remedy}", file=sys.stderr)
            return main.main(args=[*command, *sys.argv[1:]], prog_name="cnc_ptp")
        except ImportError as error:
            if is_our_mistake(error):
                raise
            print(f"cnc_ptp is not installed completely ({error}); call `make setup` first", file=sys.stderr)
            sys.exit(2)

    return call


def is_our_mistake(error: ImportError) -> bool:
    """Neither a package of others nor the ROS interfaces are missing, and no library of theirs is unusable."""
    if (error.name or "").partition(".")[0] == "cnc_ptp":
        interfaces = Path(__file__).with_name("msg") / "__init__.py"
        return interfaces.is_file()
    if isinstance(error.__cause__, ImportError):  # packages tell it in their own words
        return is_our_mistake(error.__cause__)
    return not isinstance(error, ModuleNotFoundError) and not (error.path or "").endswith(".so")


main = _entry()
simulate = _entry("simulate")
run = _entry("run")
status = _entry("status")
do = _entry("do")
jog = _entry("jog")
watch = _entry("watch")
web = _entry("web")
users = _entry("users")
enter = _entry("enter")
check = _entry("check")
explain = _entry("explain")
format = _entry("format")
replay = _entry("replay")
verify = _entry("verify")
diff = _entry("diff")
report = _entry("report")
export = _entry("export")
recover = _entry("recover")
plot = _entry("plot")
layout = _entry("layout")
params = _entry("params")
init = _entry("init")
identify = _entry("identify")
circle = _entry("circle")
curve = _entry("curve")
lists = _entry("lists")
sweep = _entry("sweep")

if __name__ == "__main__":
    main()
