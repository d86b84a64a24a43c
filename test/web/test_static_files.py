"""The files of the pages: compressed, known again, nothing else."""

import asyncio
import gzip

from web_support import site

from cnc_ptp.web.static_files import STATIC


def visit(story):
    async def told():
        async with site() as here:
            await story(here.client)

    asyncio.run(told())


def test_files_are_compressed():
    async def story(client):
        answer = await client.get("/static/app.js", headers={"Accept-Encoding": "gzip"}, auto_decompress=False)
        body = await answer.read()
        assert (answer.status, answer.headers["Content-Encoding"]) == (200, "gzip")
        assert answer.content_type in ("text/javascript", "application/javascript")
        assert gzip.decompress(body) == (STATIC / "app.js").read_bytes()
        assert answer.headers["Content-Security-Policy"].startswith("default-src 'self'")

    visit(story)


def test_a_client_without_compression():
    async def story(client):
        answer = await client.get("/static/app.js", headers={"Accept-Encoding": "identity"}, auto_decompress=False)
        assert "Content-Encoding" not in answer.headers
        assert await answer.read() == (STATIC / "app.js").read_bytes()

    visit(story)


def test_a_file_that_the_browser_has():
    async def story(client):
        first = await client.get("/static/style.css")
        again = await client.get("/static/style.css", headers={"If-None-Match": first.headers["ETag"]})
        assert (again.status, await again.read()) == (304, b"")
        assert first.headers["Cache-Control"] == "no-cache"

    visit(story)


def test_no_other_file():
    async def story(client):
        for name in ("none.js", "..%2Fserver.py", "%2E%2E/server.py", "../server.py", ""):
            assert (await client.get(f"/static/{name}")).status == 404, name

    visit(story)


def test_all_pages_compressed_are_small():
    names = [path for path in STATIC.rglob("*") if path.is_file()]
    assert sum(len(gzip.compress(path.read_bytes())) for path in names) < 3_000_000
