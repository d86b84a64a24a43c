"""The files of the pages: compressed once, told from older ones by their digest."""

from __future__ import annotations

import gzip
from dataclasses import dataclass
from hashlib import sha256
from mimetypes import guess_type
from pathlib import Path

from aiohttp import ETag, hdrs, web

STATIC = Path(__file__).parent / "static"
COMPRESSED = (".js", ".css", ".html", ".svg", ".json")


@dataclass(frozen=True, slots=True)
class Content:
    """A file as browsers get it."""

    data: bytes
    kind: str
    digest: str
    is_compressed: bool


class StaticFiles:
    """Keeps what it has read: the pages are some 100 small files, about 250 kB compressed."""

    def __init__(self, root: Path = STATIC) -> None:
        self._files = {path.relative_to(root).as_posix(): path for path in root.rglob("*") if path.is_file()}
        self._contents: dict[str, Content] = {}

    async def serve(self, request: web.Request) -> web.StreamResponse:
        """The file that `name` of the path says, 304 if the browser has it, 404 if there is none."""
        name = request.match_info["name"]
        if name not in self._files:
            raise web.HTTPNotFound
        return self.response(request, name)

    def response(self, request: web.Request, name: str) -> web.Response:
        content = self._content(name)
        known = any(tag.value in (content.digest, "*") for tag in request.if_none_match or ())
        takes_gzip = "gzip" in request.headers.get(hdrs.ACCEPT_ENCODING, "")
        response = web.Response(status=304 if known else 200, content_type=content.kind)
        response.etag = ETag(content.digest)
        response.headers[hdrs.CACHE_CONTROL] = "no-cache"
        response.headers[hdrs.VARY] = hdrs.ACCEPT_ENCODING
        if not known and content.is_compressed and takes_gzip:
            response.headers[hdrs.CONTENT_ENCODING] = "gzip"
            response.body = content.data
        elif not known:
            response.body = gzip.decompress(content.data) if content.is_compressed else content.data
        return response

    def _content(self, name: str) -> Content:
        if name not in self._contents:
            data, is_compressed = self._files[name].read_bytes(), name.endswith(COMPRESSED)
            kind = guess_type(name)[0] or "application/octet-stream"
            stored = gzip.compress(data, mtime=0) if is_compressed else data
            self._contents[name] = Content(stored, kind, sha256(data).hexdigest()[:32], is_compressed)
        return self._contents[name]
