"""The page of a sweep in a real browser without a network: all plots are drawn, as SVG, and no script fails."""

import math
import re

import pytest
from browser_support import BROWSER, failures, open_page
from sweep_support import sweep_in

from cnc_ptp.sweep.page import sweep_page
from cnc_ptp.sweep.results import Results, Row

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium in PATH (apt-get install chromium)")
EVIL = "</script><script>document.title='taken over'</script>"


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sweep_page")
    goals = sweep_in(folder).goals
    rows = [Row(number, (number * 100, EVIL), (9.0 / (number + 1), number * 0.5)) for number in range(20)]
    rows.append(Row(20, (2000, EVIL), (math.nan, math.nan), 26187, EVIL))
    page = folder / "sweep.html"
    page.write_text(
        sweep_page(Results(["x.getriebe.0.kv", "x.name"], goals, rows), "sweep.parquet", "grid"), encoding="utf-8"
    )
    return open_page(page)


def test_no_script_fails(opened):
    assert failures(opened[1]) == []


def test_all_plots_are_drawn(opened):
    document, _ = opened
    lines = re.findall(r'<path class="js-line"[^>]* d="M', document)
    assert len(lines) == 20 + 1  # a line for each variant, the Pareto front
    assert document.count('class="point"') >= 20 + 20 + 4 * 20
    assert "gl-container" not in document or "<canvas" not in document


def test_texts_are_no_code(opened):
    assert "<title>sweep.parquet</title>" in opened[0]
