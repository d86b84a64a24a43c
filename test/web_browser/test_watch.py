"""Watch and recordings: backplot, progress, time slider."""

from fake_machine import Fake
from web_browser_support import InThread, eventually, open_page, until

SEGMENTS = 150_000


def test_a_backplot_of_150000_segments_is_shown(browser):
    fake = Fake(points=SEGMENTS)
    with InThread(fake.app) as server:
        page = open_page(browser, server.url + "#watch")
        page.wait_for_selector("[data-ms]")
        assert f"{SEGMENTS - 1:,} segments" in page.inner_text(".backplot")
        drawn = page.evaluate("document.querySelector('.backplot').scene._renderer.info.render.lines")
        assert drawn >= SEGMENTS - 1
        assert page.complaints.texts == []
        page.close()


def test_views_colours_and_keys(look):
    page = look("watch")
    page.wait_for_selector("[data-ms]")
    page.wait_for_selector(".legend >> text=mm/min")
    page.select_option("[aria-label='Colour of the path']", "block")
    page.wait_for_selector(".legend >> text=line 1")
    page.select_option("[aria-label=View]", "turning")
    frames = page.evaluate("document.querySelector('.backplot').scene.frames")
    page.focus("canvas")
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("+")
    until(page, f"document.querySelector('.backplot').scene.frames > {frames}")


def test_only_what_is_done_is_drawn(look, server, fake):
    page = look("watch", command=True)
    page.wait_for_selector("[data-ms]")
    page.evaluate("app.command('channel', 'start')")
    page.click("text=Executed part only")
    until(
        page,
        "document.querySelector('.backplot').scene._shown < 2990 && document.querySelector('.backplot').scene._shown > 0",
    )
    page.wait_for_selector("text=left · line")


def test_an_older_path_does_not_overwrite_a_newer_one_and_an_error_leaves_none(look, server, fake):
    page = look("watch")
    page.wait_for_selector("text=2,999 segments")
    fake.backplot_delays = [1.0, 0.0]
    told = {"type": "program", "channel": "channel", "name": "bracket.nc"}
    server.do(fake.tell(told))
    page.wait_for_timeout(300)
    fake.points = 100
    server.do(fake.tell(told))
    page.wait_for_selector("text=/^[0-9]+ segments/")
    shown = page.inner_text(".backplot >> [role=status]")
    page.wait_for_timeout(1200)
    assert page.inner_text(".backplot >> [role=status]") == shown
    fake.backplot_fails = True
    server.do(fake.tell(told))
    page.wait_for_selector("text=No program is loaded.")
    assert page.evaluate("document.querySelector('.backplot').scene._shown") == 0
    page.complaints.texts.clear()  # the browser logs the refusal 404


def test_a_path_is_drawn_again_when_zero_offsets_change_once_for_many_changes(look, server, fake):
    page = look("watch")
    page.wait_for_selector("text=2,999 segments")
    drawn, fake.points = fake.drawn, 100
    told = {"type": "zero_offsets", "axes": ["X", "Y", "Z"], "offsets": []}
    server.do(fake.tell({**told, "channel": "another"}))
    page.wait_for_timeout(1300)
    assert fake.drawn == drawn
    for _ in range(5):
        server.do(fake.tell({**told, "channel": "channel"}))
    page.wait_for_selector("text=/^99 segments/")
    page.wait_for_timeout(1300)
    assert fake.drawn <= drawn + 2  # of the first, and of the others together


def test_paths_are_broken_where_a_point_has_no_place(look):
    page = look("alarms")
    found = page.evaluate(
        """async () => {
        const it = await import('/static/watch/toolpath.js');
        const rows = Float32Array.from([0, 0, 0, 0, 1, 1, 0, 0, 100, 2, NaN, NaN, NaN, 0, 0, 5, 5, 5, 0, 4, 6, 5, 5, 200, 5]);
        const path = { count: 5, rows };
        const { pairs, box } = it.geometry(path);
        const coarse = it.coarser(Uint32Array.from([0, 1, 1, 2, 2, 3, 3, 4, 6, 7]), 3);
        return [[...pairs], box.min, box.max, [...coarse], it.colours(path, 'feed').fastest];
    }"""
    )
    assert found == [[0, 1, 3, 4], [0, 0, 0], [6, 5, 5], [0, 3, 3, 4, 6, 7], 200]


def test_what_is_done_are_the_pairs_of_lines_up_to_the_active_one_also_behind_breaks(look):
    """Lines 1 to 9, a motion each, after the start at line 0; homing in lines 2, 4 and 6, as older servers say it too."""
    page = look("alarms")
    found = page.evaluate(
        """async () => {
        const it = await import('/static/watch/toolpath.js');
        const shown = (atBreak) => {
            const lines = Array.from({ length: 10 }, (_, line) => line);
            const place = (line) => ([2, 4, 6].includes(line) ? [NaN, NaN, NaN, 0, atBreak(line)] : [line, 0, 0, 100, line]);
            const path = { count: lines.length, rows: Float32Array.from(lines.flatMap(place)) };
            const { pairs } = it.geometry(path);
            return [[...pairs], lines.map((line) => it.pairsUpTo(path, pairs, line))];
        };
        return [shown((line) => line), shown(() => 0)];
    }"""
    )
    assert found == [[[0, 1, 7, 8, 8, 9], [0, 1, 1, 1, 1, 1, 1, 1, 2, 3]]] * 2


def test_of_a_coarser_level_no_more_is_drawn_than_is_done(look):
    page = look("watch")
    page.wait_for_selector("text=2,999 segments")
    found = page.evaluate(
        """() => {
        const { scene } = document.querySelector('.backplot');
        const drawn = () => {
            const { count } = scene._shape.drawRange;
            return [scene._shape.index.count / 2, count / 2, count ? scene._shape.index.array[count - 1] : null];
        };
        scene._setStep(64, 0.4);
        return [0, 63, 64, 1000, 2998, 2999].map((pairs) => { scene.setShown(pairs); return drawn(); })
            .concat((scene.setShown(1000), scene._setStep(8, 0.5), [drawn()]), (scene._setStep(1, 1), [drawn()]));
    }"""
    )
    assert found == [
        [47, 0, None],
        [47, 0, None],
        [47, 1, 64],
        [47, 15, 960],
        [47, 46, 2944],
        [47, 47, 2999],
        [375, 125, 1000],
        [2999, 1000, 1000],
    ]


def test_a_recording_has_a_time_and_nothing_to_operate(browser):
    fake = Fake(recording=True)
    with InThread(fake.app) as server:
        page = open_page(browser, server.url)
        page.wait_for_selector("main.watch")
        page.click("text=Measured path")
        until(page, "document.querySelector('.backplot').scene._trail?.geometry.attributes.position.count === 2000")
        assert page.locator("nav.pages a").all_inner_texts() == ["Watch", "Scope", "Alarms"]
        assert page.locator("text=Take command").is_hidden()
        page.click("text=Scope")
        page.evaluate(
            "() => { const slider = document.querySelector('.recording-bar input'); slider.value = 12; slider.dispatchEvent(new Event('input')); }"
        )
        page.wait_for_selector("text=12.000 s of 30.0 s")
        until(page, "document.querySelector('main').innerText.includes('2000 samples')")
        eventually(page, lambda: fake.has_received(type="seek", time=12))
        page.click("button:text-is('Play')")
        until(page, "Number(document.querySelector('.recording-bar input').value) > 12.2")
        page.click("button:text-is('Pause')")
        assert page.complaints.texts == []
        page.close()
