"""Random programs with what they programme as segments, and runs of them for the path checker.

The machine has X, Y, Z and the rotary axis A with limits drawn anew for each program, far apart on purpose.
"""

from __future__ import annotations

import math
import random
from dataclasses import replace
from math import inf, pi, tau

import numpy as np
from machine_support import MachineBench
from path_checker import Array, Axis, Findings, PathChecker, Run, Segment

from cnc_ptp.parameters import MachineParameters
from cnc_ptp.parameters.loader import load_machine

NAMES = ("x", "y", "z", "a")
AXIS = """
/{name}:
  ros__parameters:
    kopf: {{achs_nr: {number}}}
    kenngr: {{achs_typ: {kind}, antr_typ: 4, swe_neg: -1000000000, swe_pos: 1000000000}}
    getriebe:
      "0":
        kv: 50000
        vb_eilgang: 300000
        dynamik: {{vb_max: 500000, a_max: 50000, tr_min: 0}}
        slope_profil: {{a_beschl: 2000, a_brems: 2400, tr_beschl_zu: 40000}}
    simulation: {{drive_time_constant: 0, encoder: false}}
"""
MACHINE = """
/machine: {ros__parameters: {cycle_time_us: 1000, block_cycles: 10, watchdog_ms: 200, channels: [channel], axes: [x, "y", z, a], spindles: []}}
/channel:
  ros__parameters:
    gruppe:
      "0":
        achs_anzahl: 4
        achse: {"0": {bezeichnung: X, log_achs_nr: 1}, "1": {bezeichnung: "Y", log_achs_nr: 2}, "2": {bezeichnung: Z, log_achs_nr: 3}, "3": {bezeichnung: A, log_achs_nr: 4}}
    m_synch: {"60": MOS, "61": MVS_SVS, "62": MVS_SNS, "63": MNS_SNS, "64": MVS_SLP, "65": NO_SYNCH}
    max_vb_override: 1500
""" + "".join(
    AXIS.format(name=name, number=n + 1, kind="ACHSTYP_ROTATOR" if name == "a" else "ACHSTYP_TRANSLATOR")
    for n, name in enumerate(NAMES)
)
STOPPING = ("M61", "M62", "M63")
"""Functions whose acknowledgement the path waits for at their place."""
PLANES = {17: (0, 1), 18: (2, 0), 19: (1, 2)}
CENTERS = ("I", "J", "K")


def machine_of(draw: random.Random) -> MachineParameters:
    """Each axis with its own limits, up to 1 : 30 apart."""
    source = load_machine(MACHINE, "random.yaml")
    axes = {}
    for name, axis in source.axes.items():
        velocity = 10 ** draw.uniform(1.3, 2.8)
        axes[name] = replace(
            axis,
            max_velocity=velocity,
            rapid_velocity=velocity * draw.uniform(0.3, 1.0),
            acceleration=10 ** draw.uniform(2.3, 3.8),
            deceleration=10 ** draw.uniform(2.3, 3.8),
            jerk=10 ** draw.uniform(3.5, 5.5),
        )
    return replace(source, axes=axes)


def axes_of(machine: MachineParameters) -> list[Axis]:
    return [
        Axis(a.max_velocity, a.rapid_velocity, a.acceleration, a.deceleration, a.jerk) for a in machine.axes.values()
    ]


class RandomProgram:
    """Lines of a program and the segments that they mean."""

    def __init__(self, seed: int) -> None:
        self.draw = random.Random(seed)
        self.machine = machine_of(self.draw)
        self.steps = self.draw.random() < 0.08
        self.lines: list[str] = []
        self.subroutines: list[str] = []
        self.segments: list[Segment] = []
        self.place = np.zeros(4)
        self.feed = 0.0
        self.direction = np.array([1.0, 0.0, 0.0])
        self.mode = "through"
        self.contour = (1.0, 0.0)
        """Deviation that contouring permits: of the path, of other axes."""
        self.smoothing: tuple[float, float] | None = None
        self.tracks = self.draw.random() < 0.4
        if self.steps:
            self.lines.append("#SLOPE [TYPE=STEP]")
        self.new_feed()
        for _ in range(self.draw.randint(3, 9)):
            self.chapter()

    @property
    def text(self) -> str:
        return "\n".join([*self.subroutines, "%P", *self.lines, "M30"])

    # lines

    def new_feed(self) -> None:
        self.feed = round(10 ** self.draw.uniform(2.8, 4.3), 1)
        self.lines.append(f"F{self.feed}")

    def chapter(self) -> None:
        draw = self.draw
        self.transition()
        kind = draw.choice(
            ("lines", "lines", "lines", "mixed", "mixed", "short", "smooth", "tiny", "rapid", "called", "loop")
        )
        if kind == "smooth":
            self.smooth()
        elif kind == "called":
            self.called()
        elif kind == "loop":
            self.loop()
        else:
            for _ in range(draw.randint(2, 8)):
                self.element(kind)
                if draw.random() < 0.12:
                    self.between()

    def between(self) -> None:
        draw = self.draw
        kind = draw.choice(("feed", "dwell", "wait", "pass", "pass", "once", "same"))
        if kind == "feed":
            self.new_feed()
        elif kind == "dwell":
            self.lines.append("G04 0.01")
            self.stop_here()
        elif kind == "wait":
            self.lines.append(draw.choice(STOPPING))
            self.stop_here()
        elif kind == "pass":
            self.lines.append(draw.choice(("M60", "M64", "M65")))
        elif kind == "once":
            code = draw.choice(("G09", "G61"))
            self.line(self.next_point(draw.uniform(0.5, 20.0)), code=code)
        else:
            self.line(self.place)

    def stop_here(self) -> None:
        if self.segments:
            self.segments[-1].stop = True

    def transition(self) -> None:
        draw = self.draw
        code = draw.choice(("", "G60", "G360", "G359", "G261", "G261", "G261", "mode", "mode", "off"))
        if code in ("G60", "G360"):
            self.mode = "exact"
        elif code == "G359":
            self.mode = "through"
        elif code == "G261":
            self.contour_words(switch=False)
            self.mode = "contour"
        elif code == "mode":
            self.contour_words(switch=True)
            self.mode = "contour"
        elif code == "off":
            self.mode = "through"
            self.lines.append(draw.choice(("G260", "#CONTOUR MODE OFF", "#CONTOUR MODE [OFF]")))
        if code.startswith("G"):
            self.lines.append(code)

    def contour_words(self, *, switch: bool) -> None:
        draw = self.draw
        track = round(10 ** draw.uniform(-2.0, 1.0), 4) if draw.random() < 0.6 else None
        if draw.random() < 0.7:
            dev = round(10 ** draw.uniform(-3.0, 0.0), 4)
            words = f"DEV PATH_DEV={dev}"
        else:
            before, behind = (round(10 ** draw.uniform(-2.0, 1.0), 4) for _ in range(2))
            if draw.random() < 0.5:
                behind = before
            words = f"DIST PRE_DIST={before} POST_DIST={behind}"
            dev = max(before, behind)
        words += f" TRACK_DEV={track}" if track is not None else ""
        words += f" REMAIN_PART={draw.choice((0, 20, 90))}" if draw.random() < 0.3 else ""
        words += f" MAX_ANGLE={draw.choice((20, 100, 180))}" if draw.random() < 0.2 else ""
        self.lines.append(f"#CONTOUR MODE{' ON' if switch else ''} [{words}]")
        self.contour = (dev, self.contour[1] if track is None else track)

    # motions

    def next_point(self, length: float) -> Array:
        """Straight on, by a small angle, back, or anywhere; sometimes with A, or A alone."""
        draw = self.draw
        turn = draw.choice(("straight", "slight", "slight", "back", "any", "any", "any", "square"))
        if turn == "back":
            self.direction = -self.direction
        elif turn == "slight":
            self.direction = self.direction + 0.05 * np.array([draw.gauss(0, 1) for _ in range(3)])
        elif turn == "any":
            self.direction = np.array([draw.gauss(0, 1) for _ in range(3)])
        elif turn == "square":
            self.direction = np.eye(3)[draw.randrange(3)] * draw.choice((-1.0, 1.0))
        self.direction = self.direction / np.linalg.norm(self.direction)
        point = self.place.copy()
        alone = self.tracks and draw.random() < 0.1
        if not alone:
            point[:3] += length * self.direction
        if alone or (self.tracks and draw.random() < 0.6):
            point[3] += draw.choice((-1.0, 1.0)) * draw.choice((length, 10.0 * length, draw.uniform(0.0, 30.0)))
        return np.round(point, 9)

    def element(self, kind: str) -> None:
        draw = self.draw
        length = draw.uniform(0.5, 40.0)
        if kind == "short":
            length = 10 ** draw.uniform(-3.0, 0.0)
        elif kind == "tiny":
            length = 10 ** draw.uniform(-6.0, -2.0) if draw.random() < 0.7 else draw.uniform(1.0, 10.0)
        if kind == "mixed" and draw.random() < 0.5:
            self.arc(10 ** draw.uniform(-1.0, 1.5))
        else:
            self.line(self.next_point(length), rapid=kind == "rapid")

    def line(self, target: Array, *, rapid: bool = False, code: str = "") -> None:
        target = np.round(target, 9)
        words = " ".join(f"{name.upper()}{value:.9f}" for name, value in zip(NAMES, target, strict=True))
        self.lines.append(f"{code} G0{0 if rapid else 1} {words}".strip())
        self.add(Segment(self.place, target, inf if rapid else self.feed / 60.0), code)

    def arc(self, radius: float) -> None:
        draw = self.draw
        code = draw.choice(list(PLANES))
        first, second = PLANES[code]
        sign = draw.choice((-1, 1))
        sweep = sign * draw.choice((tau, pi, draw.uniform(0.02, 2.0 * pi), draw.uniform(0.02, 1.0)))
        begin = draw.uniform(-pi, pi)
        if draw.random() < 0.4:  # on from the last direction, if that is in the plane
            heading = math.atan2(self.direction[second], self.direction[first])
            begin = heading - sign * pi / 2
        center = np.round([-radius * math.cos(begin), -radius * math.sin(begin)], 9)
        target = self.place.copy()
        if abs(sweep) < tau:
            x, y = -center
            target[first] += center[0] + x * math.cos(sweep) - y * math.sin(sweep)
            target[second] += center[1] + x * math.sin(sweep) + y * math.cos(sweep)
        if draw.random() < 0.4:
            third = 3 - first - second
            target[third] += draw.uniform(-1.0, 1.0) * radius
        if self.tracks and draw.random() < 0.5:
            target[3] += draw.uniform(-20.0, 20.0)
        target = np.round(target, 9)
        words = " ".join(f"{name.upper()}{value:.9f}" for name, value in zip(NAMES, target, strict=True))
        words += f" {CENTERS[first]}{center[0]:.9f} {CENTERS[second]}{center[1]:.9f}"
        self.lines.append(f"G{code} G0{3 if sweep > 0.0 else 2} {words}")
        middle = (self.place[first] + center[0], self.place[second] + center[1])
        self.add(Segment(self.place, target, self.feed / 60.0, middle, (first, second), sweep))
        heading = np.zeros(3)
        angle = begin + sweep + sign * pi / 2
        heading[first], heading[second] = math.cos(angle), math.sin(angle)
        self.direction = heading

    def add(self, segment: Segment, code: str = "") -> None:
        mode = {"G09": "exact", "G61": "contour"}.get(code, self.mode)
        if mode == "contour":
            segment.deviation, segment.track = self.contour
        if self.smoothing is not None and not segment.arc and segment.feed < inf:
            segment.everywhere, segment.track_everywhere = self.smoothing
        elif mode == "exact":
            segment.stop = True
        self.segments.append(segment)
        self.place = segment.end

    def smooth(self) -> None:
        """Chords of a curve between #HSC ON and #HSC OFF, sometimes with corners, noise, long and double points."""
        draw = self.draw
        dev = round(10 ** draw.uniform(-3.0, -1.0), 5)
        track = round(10 ** draw.uniform(-2.0, 0.7), 4) if draw.random() < 0.6 else None
        words = f" TRACK_DEV={track}" if track is not None else ""
        self.lines.append(f"#HSC ON [BSPLINE PATH_DEV={dev}{words}]")
        self.smoothing = (dev, inf if track is None else track)
        begin, size, chord = self.place.copy(), draw.uniform(2.0, 30.0), 10 ** draw.uniform(-2.0, 0.0)
        frequency, noise = draw.uniform(0.2, 2.0), draw.choice((0.0, 0.0005))
        for n in range(1, draw.randint(20, 150)):
            t = n * chord / size
            x, y = size * math.sin(t), size * (1.0 - math.cos(t))
            if draw.random() < 0.02:
                y += draw.uniform(-1.0, 1.0)
            wave = (x, y, 0.3 * size * math.sin(frequency * t), 10.0 * math.sin(t) if self.tracks else 0.0)
            self.line(np.round(begin + wave + draw.choice((0.0, noise)), 3))
            if draw.random() < 0.02:
                self.line(self.place)
            if draw.random() < 0.01:
                self.new_feed()
            if draw.random() < 0.01:
                self.lines.append("M60")
        self.lines.append("#HSC OFF")
        self.smoothing = None

    def called(self) -> None:
        main, self.lines = self.lines, []
        for _ in range(self.draw.randint(2, 6)):
            self.element(self.draw.choice(("lines", "mixed", "short")))
        name = f"SUB{len(self.subroutines)}"
        self.subroutines.append("\n".join([f"%L {name}", *self.lines, "M29"]))
        self.lines = main
        self.lines.append(f"LL {name}")

    def loop(self) -> None:
        """The same relative motions again and again."""
        draw = self.draw
        steps = [np.round([draw.uniform(-8, 8), draw.uniform(-8, 8), draw.uniform(-1, 1), 0.0], 3) for _ in range(3)]
        count = draw.randint(1, 4)
        self.lines += [f"$FOR P1 = 1, {count}, 1", "G91"]
        self.lines += ["G01 " + " ".join(f"{n}{v:.3f}" for n, v in zip("XYZ", step[:3], strict=True)) for step in steps]
        self.lines += ["G90", "$ENDFOR"]
        for _ in range(count):
            for step in steps:
                self.add(Segment(self.place, self.place + step, self.feed / 60.0))
        self.direction = steps[-1][:3] / np.linalg.norm(steps[-1][:3])
        self.line(self.place)

    # run

    def checker(self) -> PathChecker:
        return PathChecker(self.segments, axes_of(self.machine), steps=self.steps)

    def bench(self, **options: bool) -> MachineBench:
        return MachineBench(self.text, machine=self.machine, **options)

    def check(self) -> Findings:
        """Runs the program to its end and checks the run."""
        bench = self.bench().run()
        found = self.checker().check(run_of(bench))
        if bench.failed or bench.errors():
            found.texts += ["failed", *bench.errors()]
        return found


def run_of(bench: MachineBench, override: float = 1.0) -> Run:
    names = ("position", "velocity", "acceleration", "jerk")
    columns = [np.column_stack([bench.column(axis, f"set_{name}") for axis in bench.machine.axes]) for name in names]
    return Run(*columns, override=override)
