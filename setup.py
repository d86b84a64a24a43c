"""Package of build type ament_python that also generates its ROS interfaces and compiles its kernel.

`pip install .`, `pip install -e .` and `colcon build` all end in build_ext: it lets CMake generate the interfaces,
takes their Python part into the package and hands libraries and share files on as data files of the prefix. Then it
compiles the kernel (cnc_ptp/compiled), which is no failure where that cannot be done.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Distribution, Extension, find_packages, setup
from setuptools.command.build_ext import build_ext

PACKAGE = "cnc_ptp"
ROOT = Path(__file__).parent.resolve()
COMMANDS = (
    "simulate", "run", "status", "jog", "check", "explain", "format", "replay", "report", "plot", "layout", "recover",
    "params", "identify", "circle", "curve", "lists", "sweep",
)  # fmt: skip
"""Executables of their own. Not `do` and `export`, words of the shell, nor `watch`, `init`, `diff`, which Linux has."""
NODES = ("nc_channel", "axis", "spindle", "plc_bridge", "clock", "recorder", "player")


class BuildInterfacesAndKernel(build_ext):
    """Configures, builds and stages the interfaces with CMake; compiles the kernel."""

    def build_extension(self, ext: Extension) -> None:
        ninja = shutil.which("ninja", path=os.pathsep.join([str(Path(sys.prefix) / "bin"), os.environ["PATH"]]))
        build = ROOT / "build" / f"interfaces-{'ninja' if ninja else 'make'}-{sys.implementation.cache_tag}"
        stage = build / "stage"
        shutil.rmtree(stage, ignore_errors=True)
        prefixes = os.pathsep.join(filter(None, [os.environ.get("AMENT_PREFIX_PATH"), sys.prefix]))
        path = os.pathsep.join([str(Path(sys.prefix) / "bin"), os.environ["PATH"]])
        environment = os.environ | {"AMENT_PREFIX_PATH": prefixes, "PATH": path}
        configure = [
            "cmake",
            "-S", str(ROOT),
            "-B", str(build),
            f"-DCMAKE_INSTALL_PREFIX={stage}",
            f"-DCMAKE_PREFIX_PATH={prefixes.replace(os.pathsep, ';')}",
            f"-DPython3_EXECUTABLE={sys.executable}",
            "-DCMAKE_BUILD_TYPE=Release",
            "-DBUILD_TESTING=OFF",
            f"-DALL_TYPE_SUPPORTS={'OFF' if self.with_pip else 'ON'}",
            "-DCMAKE_C_FLAGS_RELEASE=-O1",  # blocks do not pass through this code
            "-DCMAKE_CXX_FLAGS_RELEASE=-O1",
            *(["-GNinja", f"-DCMAKE_MAKE_PROGRAM={ninja}"] if ninja else []),
        ]  # fmt: skip
        jobs = str(os.cpu_count() or 1)
        kernel = self.compile_kernel()  # meanwhile: generating interfaces takes one processor
        try:
            for command in (
                configure,
                ["cmake", "--build", str(build), "-j", jobs],
                ["cmake", "--install", str(build)],
            ):
                subprocess.run(
                    command, check=True, env=environment, stdout=None if self.verbose > 1 else subprocess.DEVNULL
                )
        except BaseException:
            kernel.kill()
            raise
        if kernel.wait():
            print(f"{PACKAGE}: the kernel could not be compiled and runs interpreted; build/kernel.log says why")
        self.take_python_part(stage)
        self.hand_on(prefix_part(stage))
        if self.with_pip:  # colcon puts the scripts there itself
            self.hand_on(ros_executables(build.parent / "executables"))

    @property
    def with_pip(self) -> bool:
        return bool({"bdist_wheel", "editable_wheel"} & {*self.distribution.commands})

    @property
    def package_folder(self) -> Path:
        """Where the package is put together: in the build folder, or in the source tree if editable."""
        return ROOT / PACKAGE if self.inplace or self.editable_mode else Path(self.build_lib).absolute() / PACKAGE

    def compile_kernel(self) -> "subprocess.Popen[bytes]":
        """Starts it. A kernel that was not compiled runs interpreted; `cnc_ptp --version` says why."""
        command = [sys.executable, "-m", f"{PACKAGE}.compiled.build", str(self.package_folder / "compiled" / "library")]
        environment = os.environ | {"CNC_PTP_PURE": "1"}
        log = ROOT / "build" / "kernel.log"
        log.parent.mkdir(exist_ok=True)
        with log.open("w") as output:
            return subprocess.Popen(command, cwd=ROOT, env=environment, stdout=output, stderr=output)

    def take_python_part(self, stage: Path) -> None:
        """Copies the generated modules into the package."""
        generated = next(stage.glob(f"**/{PACKAGE}/msg/__init__.py")).parent.parent
        package = self.package_folder
        for entry in generated.iterdir():
            if entry.is_dir() and entry.name in ("msg", "srv", "action"):
                shutil.rmtree(package / entry.name, ignore_errors=True)
                shutil.copytree(entry, package / entry.name, ignore=shutil.ignore_patterns("*.c", "*.pyc"))
            elif entry.suffix == ".so":
                shutil.copy2(entry, package / entry.name)

    def hand_on(self, files: dict[str, list[str]]) -> None:
        """Adds data files, folder of the prefix -> files, to what setup() names."""
        data_files = self.distribution.data_files or []
        known = {folder for folder, _ in data_files}
        data_files.extend((folder, names) for folder, names in files.items() if folder not in known)
        self.distribution.data_files = data_files

    def copy_extensions_to_source(self) -> None:
        """Nothing to copy: take_python_part has written into the source tree."""

    def get_outputs(self) -> list[str]:
        return []

    def get_output_mapping(self) -> dict[str, str]:
        return {}


class BinaryDistribution(Distribution):
    """The wheel holds compiled type support, and an editable install its data files as well."""

    def has_ext_modules(self) -> bool:
        return True

    def has_data(self) -> bool:
        return True


def prefix_part(stage: Path) -> dict[str, list[str]]:
    """Libraries and share files that CMake has staged."""
    files: dict[str, list[str]] = {}
    for folder in ("lib", "share"):
        for path in sorted((stage / folder).rglob("*")):
            relative = path.relative_to(stage)
            inside_python = any(part.startswith("python3") or part == "site-packages" for part in relative.parts)
            if path.is_file() and not inside_python and path.name != "package.xml":
                files.setdefault(str(relative.parent), []).append(os.path.relpath(path, ROOT))
    return files


def ros_executables(folder: Path) -> dict[str, list[str]]:
    """Writes what `ros2 run` and launch look for, lib/cnc_ptp/NAME: it calls bin/NAME of the same prefix."""
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for name in (script.partition(" = ")[0] for script in console_scripts()):
        file = folder / name
        file.write_text(f'#!/bin/sh\nexec "$(dirname "$(readlink -f "$0")")/../../bin/{name}" "$@"\n')
        file.chmod(0o755)
        files.append(os.path.relpath(file, ROOT))
    return {f"lib/{PACKAGE}": files}


def share(folder: str, pattern: str) -> tuple[str, list[str]]:
    return f"share/{PACKAGE}/{folder}".rstrip("/"), sorted(str(path.relative_to(ROOT)) for path in ROOT.glob(pattern))


def console_scripts() -> list[str]:
    scripts = [f"{PACKAGE} = {PACKAGE}.__main__:main"]
    scripts += [f"{name} = {PACKAGE}.__main__:{name}" for name in COMMANDS]
    scripts += [f"{name} = {PACKAGE}.nodes.{name}:main" for name in NODES]
    return scripts


setup(
    name=PACKAGE,
    version="0.1.0",
    description="A CNC and axis kernel as a ROS 2 node graph",
    license="Apache-2.0",
    maintainer="cnc_ptp maintainers",
    maintainer_email="maintainers@cnc-ptp.example.org",
    packages=find_packages(
        include=[PACKAGE, f"{PACKAGE}.*"], exclude=[f"{PACKAGE}.{part}" for part in ("msg", "srv", "action")]
    ),
    package_data={
        PACKAGE: [
            "parameters/declare/*.yaml",
            "catalogue/*.yaml",
            "catalogue/entries/*.yaml",
            "commands/language/*.yaml",
            "commands/init/*.yaml",
            "nc/cycles/*.nc",
            "nodes/*.xml",
            "plots/*.js",
            "web/static/**/*",
            "py.typed",
        ]
    },
    ext_modules=[Extension(f"{PACKAGE}._interfaces", sources=[])],
    cmdclass={"build_ext": BuildInterfacesAndKernel},
    distclass=BinaryDistribution,
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        share("launch", "launch/*.launch.py"),
        share("config", "config/*.yaml"),
        share("tools", "tools/*.json"),
        share("config/tools", "config/tools/*.yaml"),
        share("examples", "examples/*.*"),
        share("examples/lists", "examples/lists/*.lis"),
    ],
    python_requires=">=3.11,<3.14",
    extras_require={
        "data": ["pandas>=2.2,<4", "pyarrow>=18"],  # tables and Parquet of recordings
        "foxglove": ["foxglove-sdk>=0.30,<0.31"],  # live stream
        "web": ["aiohttp>=3.11,<4", "argon2-cffi>=23.1,<26"],  # pages for browsers, hashes of passwords
        "sweep": ["dask[distributed]>=2025.2", "optuna>=4.2,<6", "pyarrow>=18"],
    },
    entry_points={"console_scripts": console_scripts()},
    zip_safe=False,
)
