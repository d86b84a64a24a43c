"""A browser for the tests of a module, and pages of it. Other tests run event loops in this thread: it ends with its module."""

import sys
from pathlib import Path

import pytest

sys.path[:0] = [str(Path(__file__).parent)]

from web_browser_support import InThread, chromium, open_page, why_no_browser  # noqa: E402


@pytest.fixture(scope="module")
def browser():
    if reason := why_no_browser():
        pytest.skip(reason)
    with chromium() as found:
        yield found


@pytest.fixture
def fake():
    from fake_machine import Fake

    return Fake()


@pytest.fixture
def server(fake):
    with InThread(fake.app) as running:
        yield running


@pytest.fixture
def look(browser, server):
    """Opens a page of the made-up machine; all are closed at the end, and none may have complained."""
    pages = []

    def open_one(name="operate", **options):
        page = open_page(browser, f"{server.url}#{name}", **options)
        pages.append(page)
        return page

    yield open_one
    complaints = [text for page in pages for text in page.complaints.texts]
    for page in pages:
        page.close()
    assert complaints == []
