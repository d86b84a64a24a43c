"""Scope: every sample, triggers, measures, spectrum, formulas, views, CSV; and the modules that compute them."""

import math
from pathlib import Path

from web_browser_support import eventually, until

SAMPLES = "Number((/([0-9]+) samples/.exec(document.querySelector('main').innerText) || [0, 0])[1])"


def module(page, name, body):
    """The result of a function of a module, in the browser."""
    return page.evaluate(f"async () => {{ const it = await import('/static/{name}'); {body} }}")


def test_no_sample_is_lost_and_peaks_are_measured(look):
    page = look("scope")
    page.wait_for_selector(".measures tbody tr")
    until(page, f"{SAMPLES} > 2500")
    assert "lost" not in page.inner_text("main")
    cells = page.locator(".measures tbody tr").first.locator("td").all_inner_texts()
    assert (cells[0], cells[1], cells[4]) == ("−10", "10", "20")
    assert abs(float(cells[3]) - 10 / math.sqrt(2)) < 0.2


def test_an_edge_holds_the_picture_with_what_was_before(look):
    page = look("scope")
    page.fill("label:text-is('Level') + input", "5")
    page.press("label:text-is('Level') + input", "Enter")
    page.select_option("label:text-is('Mode') + select", "single")
    page.wait_for_selector("text=Frozen")
    page.click("button:text-is('Arm')")
    page.wait_for_selector("text=Frozen")
    page.fill("[data-cursor=A]", "-0.001")
    page.press("[data-cursor=A]", "Enter")
    page.fill("[data-cursor=B]", "0")
    page.press("[data-cursor=B]", "Enter")
    row = page.locator(".measures tbody tr").first.locator("td")
    eventually(page, lambda: all(text.strip("–") for text in row.all_inner_texts()[6:8]))
    before, after = (float(text.replace("−", "-")) for text in row.all_inner_texts()[6:8])
    assert before < 5 <= after
    assert after - before < 0.13  # one cycle
    assert page.inner_text(".u-legend").count("x.set_velocity") == 1


def test_an_error_holds_the_picture(look, server, fake):
    page = look("scope")
    page.select_option("label:text-is('Mode') + select", "single")
    page.select_option("label:text-is('Kind') + select", "error")
    page.wait_for_selector("text=Waiting for the trigger")
    server.do(fake.raise_alarm("axis x: following error"))
    page.wait_for_selector("text=Frozen")


def test_a_math_channel_and_a_view_that_is_kept(look):
    page = look("scope")
    page.click("summary:text-is('Math channel')")
    page.fill("label:text-is('Name') + input", "twice")
    page.fill("label:text-is('Formula') + input", "2 * x.set_velocity +")
    page.click("text=Add channel")
    page.wait_for_selector(".notice >> text=Formula: the formula ends too early.")
    page.fill("label:text-is('Formula') + input", "2 * x.set_velocity")
    page.click("text=Add channel")
    until(page, "document.querySelectorAll('.measures tbody tr').length === 3")
    until(page, "document.querySelectorAll('.measures tbody tr')[2].innerText.includes('20')")
    page.fill("[aria-label='Name of the view']", "mine")
    page.click("button:text-is('Save')")
    page.reload()
    until(page, "window.app && app.store.machine !== null")
    page.select_option("[aria-label='Saved views']", "mine")
    page.wait_for_selector(".channels >> text=twice = 2 * x.set_velocity")


SPECTRUM = "section:has-text('Spectrum') >> label:text-is('Signal') + select"
X, Y = "label:text-is('X') + select", "label:text-is('Y') + select"


def chosen(page):
    """Signals of the spectrum and of the XY plot, and the cursors."""
    values = [page.input_value(choice) for choice in (SPECTRUM, X, Y)]
    return values + [page.input_value(f"[data-cursor={name}]") for name in "AB"]


def choose_view(page, name):
    page.reload()
    until(page, "window.app && app.store.machine !== null && app._mounted")
    page.select_option("[aria-label='Saved views']", name)


def test_a_view_keeps_spectrum_xy_plot_and_cursors(look):
    page = look("scope")
    page.select_option(SPECTRUM, "x.set_velocity")
    page.select_option(X, "x.set_velocity")
    page.select_option(Y, "x.following_error")
    for name, time in (("A", "0.1"), ("B", "0.3")):
        page.fill(f"[data-cursor={name}]", time)
        page.press(f"[data-cursor={name}]", "Enter")
    page.fill("[aria-label='Name of the view']", "all")
    page.click("button:text-is('Save')")
    choose_view(page, "all")
    page.wait_for_selector("[aria-label=Spectrum] .uplot")
    page.wait_for_selector("[aria-label='One signal over another'] .uplot")
    assert chosen(page) == ["x.set_velocity", "x.set_velocity", "x.following_error", "0.100", "0.300"]
    page.wait_for_selector("text=B − A = 0.2 s")
    page.select_option(X, "x.following_error")
    page.wait_for_selector("[aria-label='One signal over another'] >> text=x.following_error over x.following_error")


def test_a_view_of_an_older_version_and_one_written_by_hand_are_loaded(look):
    page = look("scope")
    older = '{"channels": [{"name": "y.set_velocity", "graph": 1}], "window": 5}'
    odd = '{"channels": [{"name": "x.set_velocity"}], "window": 1, "spectrum": 7, "x": "q.gone", "cursors": {"A": "soon", "C": 1}}'
    page.evaluate("views => localStorage.setItem('scope-views', views)", f'{{"older": {older}, "odd": {odd}}}')
    choose_view(page, "odd")
    page.wait_for_selector(".channels li >> text=x.set_velocity")
    assert chosen(page) == ["", "", "", "", ""]
    page.select_option(SPECTRUM, "x.set_velocity")
    page.fill("[data-cursor=A]", "0.25")
    page.press("[data-cursor=A]", "Enter")
    page.select_option("[aria-label='Saved views']", "older")
    page.wait_for_selector(".channels li >> text=y.set_velocity")
    until(page, "document.querySelectorAll('.channels li').length === 1")
    assert page.input_value("label:text-is('Window') + select") == "5"
    assert chosen(page) == ["", "", "", "0.250", ""]  # it says nothing of cursors; its signals have no x


def test_export_has_every_cycle_of_the_frozen_window(look, fake):
    page = look("scope")
    until(page, f"{SAMPLES} > 2500")
    page.click("button:text-is('Freeze')")
    frozen = fake.cycle
    eventually(page, lambda: fake.cycle > frozen + 1000)
    with page.expect_download() as download:
        page.click("text=Export CSV")
    lines = Path(download.value.path()).read_text(encoding="utf-8").splitlines()
    assert lines[0] == "cycle,time,x.set_velocity,x.following_error"
    cycles = [int(line.split(",")[0]) for line in lines[1:]]
    assert cycles == [*range(cycles[0], cycles[0] + len(cycles))]
    assert len(cycles) >= 1900 and cycles[-1] < frozen + 200
    value = float(lines[1].split(",")[2])
    assert abs(value - 10 * math.sin(2 * math.pi * 2 * cycles[0] / 1000)) < 1e-12  # not rounded to 32 bits


def test_spectrum_and_xy_plot_are_drawn(look):
    page = look("scope")
    page.wait_for_selector(".channels li")
    page.select_option("section:has-text('Spectrum') >> label:text-is('Signal') + select", "x.set_velocity")
    page.wait_for_selector("[aria-label=Spectrum] .uplot")
    page.select_option("label:text-is('X') + select", "x.set_velocity")
    page.select_option("label:text-is('Y') + select", "x.following_error")
    page.wait_for_selector("[aria-label='One signal over another'] .uplot")


def test_formulas(look):
    page = look("alarms")
    evaluate = """
        const columns = new Map([["x.a", Float64Array.of(1, 2, 4)], ["b[0]", Float64Array.of(0, 0, 0)]]);
        return (text) => { try { return [...it.formula(text).evaluate(columns, 3, 0.5)]; } catch (error) { return error.message; } };"""
    results = module(
        page,
        "scope/expression.js",
        f"const run = (() => {{ {evaluate} }})(); return ['x.a + 1', '-x.a ^ 2', '2 * (x.a - 1) / 2', 'max(x.a, 2)', 'diff(x.a)', 'integral(x.a)', 'sqrt(pi * 0 + x.a * x.a)', '1e1', '2 ^ 3 ^ 0'].map(run);",
    )
    assert results[:4] == [[2, 3, 5], [-1, -4, -16], [0, 1, 3], [2, 2, 4]]
    assert results[4][1:] == [2, 4]
    assert results[5:] == [[0.5, 1.5, 3.5], [1, 2, 4], [10, 10, 10], [2, 2, 2]]
    refusals = module(
        page,
        "scope/expression.js",
        f"const run = (() => {{ {evaluate} }})(); return ['1 +', '1 2', '(1', 'alert(1)', 'min(1)', 'x;1', 'constructor(1)', '('.repeat(60), '1'.repeat(600)].map(run);",
    )
    assert refusals == [
        "the formula ends too early",
        "'2' is not expected here",
        "')' is missing at the end",
        "'alert' is no function; known: sin, cos, tan, atan2, sqrt, abs, exp, log, sign, round, floor, min, max, hypot, diff, integral, delay",
        "min takes 2 values, not 1",
        "';' is not expected here",
        "'constructor' is no function; known: sin, cos, tan, atan2, sqrt, abs, exp, log, sign, round, floor, min, max, hypot, diff, integral, delay",
        "more than 40 levels of brackets",
        "a formula has at most 500 characters",
    ]


def test_measures_and_spectrum_against_closed_forms(look):
    page = look("alarms")
    found = module(
        page,
        "scope/measures.js",
        """const line = Float32Array.from({ length: 101 }, (_, i) => 3 * i * 0.001 + 1);
        const wave = Float32Array.from({ length: 1024 }, (_, i) => 5 * Math.sin(2 * Math.PI * 32 * i / 1024) + 7);
        const { frequencies, amplitudes } = it.spectrum(wave, 0.001);
        const top = amplitudes.indexOf(Math.max(...amplitudes));
        return [it.measure(line, 0.001), it.measure(wave, 0.001), frequencies[top], amplitudes[top], amplitudes[100], it.measure(new Float32Array([NaN]), 1).min];""",
    )
    line, wave, frequency, amplitude, other, nothing = found
    assert abs(line["slope"] - 3) < 1e-3 and abs(line["mean"] - 1.15) < 1e-6
    assert abs(wave["rms"] - math.sqrt(49 + 12.5)) < 1e-4
    assert (frequency, nothing is None or math.isnan(nothing)) == (31.25, True)
    assert abs(amplitude - 5) < 1e-3 and other < 1e-3


def test_neighbouring_ticks_differ_and_none_is_minus_zero(look):
    page = look("alarms")
    found = module(
        page,
        "scope/graphs.js",
        """const of = (step, ...values) => it.ticks(null, values, 1, 50, step);
        return [of(0.001, 99.999, 100, 100.001), of(0.1, -1e-16, 0.1), of(50, 0, 50), of(2.5, 2.5, 5, 7.5), of(0.25, -0.25, 0.5), of(1e-8, 1e-8)];""",
    )
    assert found == [
        ["99.999", "100.000", "100.001"],
        ["0", "0.1"],
        ["0", "50"],
        ["2.5", "5.0", "7.5"],
        ["-0.25", "0.50"],
        ["1.00e-8"],
    ]


def test_measures_have_units(look):
    page = look("scope")
    page.wait_for_selector(".measures th:text-is('x.set_velocity in mm')")
    page.wait_for_selector(".measures th:text-is('x.following_error in mm')")


def test_rings_keep_what_came_and_fill_gaps(look):
    page = look("alarms")
    found = module(
        page,
        "scope/samples.js",
        """const ring = new it.Ring(1, 8);
        ring.push(10, [Float32Array.of(1, 2, 3)], 3);
        ring.push(15, [Float32Array.of(6, 7)], 2);
        const first = [...ring.slice(0, 0, 99)].map(String);
        ring.push(17, [Float32Array.of(8, 9, 10)], 3);
        const wide = new it.Ring(1, 4000);
        const values = new Float32Array(4000); values[1234] = 9; values[1235] = -9;
        wide.push(0, [values], 4000);
        const [, drawn] = it.drawn(wide, [0], 0, 4000, 100);
        return [first, ring.begin, ring.end, ring.lost, ring.at(0, 19), Math.max(...drawn), Math.min(...drawn), drawn.length];""",
    )
    assert found == [["1", "2", "3", "NaN", "NaN", "6", "7"], 12, 20, 2, 10, 9, -9, 200]


def test_triggers(look):
    page = look("alarms")
    found = module(
        page,
        "scope/trigger.js",
        """const fire = (options, blocks) => { const one = new it.Trigger(options); blocks.forEach((block, i) => one.takeSamples(10 * i, Float32Array.from(block))); return one.cycle; };
        const event = new it.Trigger({ kind: "event", text: "Limit" });
        return [fire({ level: 2 }, [[0, 1], [3]]), fire({ level: 2, direction: "falling" }, [[0, 3, 3], [1]]), fire({ level: 2 }, [[3, 4]]),
            fire({ kind: "level", level: 2 }, [[0], [1, 3]]), fire({ kind: "level", direction: "falling", level: 0 }, [[1, -1]]), fire({ direction: "both", level: 0 }, [[1, -1]]),
            event.takeEvent({ source: "x", text: "soft limit", number: 5, cycle: 77, severity: "info" }), event.cycle,
            new it.Trigger({ kind: "error" }).takeEvent({ severity: "warning", cycle: 1 })];""",
    )
    assert found == [10, 10, None, 11, 1, 1, True, 77, False]


def test_a_circle_through_points(look):
    page = look("alarms")
    found = module(
        page,
        "commission/circle.js",
        """const angles = Array.from({ length: 360 }, (_, i) => i * Math.PI / 180);
        const xs = angles.map((angle) => 3 + (20 + 0.01 * Math.cos(2 * angle)) * Math.cos(angle));
        const ys = angles.map((angle) => -1 + (20 + 0.01 * Math.cos(2 * angle)) * Math.sin(angle));
        const circle = it.fitCircle(xs, ys);
        const { least, most } = it.polar(xs, ys, circle, 100);
        return [circle.x, circle.y, circle.radius, least, most, it.fitCircle([0, 1, 2], [0, 1, 2])];""",
    )
    assert [round(value, 4) for value in found[:5]] == [3.0, -1.0, 20.0, -0.01, 0.01]
    assert found[5] is None
