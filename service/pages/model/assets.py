"""Scripts and styles of the pages of parts and trees: files beside this module, under an address with their digest."""

from __future__ import annotations

import hashlib
from pathlib import Path

from fastapi import Response
from starlette.responses import FileResponse

from service.http.routing import router_of
from service.messages.answers import FOR_EVER
from service.messages.refusals import not_found
from service.pages.html import Html, html, tag
from service.pages.layout import POLICY

FOLDER = Path(__file__).with_name("static")
MEDIA = {
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".txt": "text/plain; charset=utf-8",
}
FILES = {path.relative_to(FOLDER).as_posix(): path for path in sorted(FOLDER.rglob("*")) if path.suffix in MEDIA}
DIGEST = hashlib.sha256(b"".join(path.read_bytes() for path in FILES.values())).hexdigest()[:16]
ROOT = f"/assets/{DIGEST}"

router = router_of(include_in_schema=False)


@router.get("/assets/{digest}/{name:path}")
def asset(digest: str, name: str) -> Response:
    """A file; of another digest, which is that of an older or newer server, too, to be asked for again."""
    path = FILES.get(name)
    if path is None:
        raise not_found(f"there is no file '{name[:80]}'", "unknown-asset")
    kept = FOR_EVER if digest == DIGEST else "no-store"
    headers = {"Cache-Control": kept, "X-Content-Type-Options": "nosniff"}
    return FileResponse(path, headers=headers, media_type=MEDIA[path.suffix])


def head(script: str) -> Html:
    """What the head of a page has to load a script and the style."""
    return html(
        tag("link", rel="stylesheet", href=f"{ROOT}/model.css"),
        tag("script", type="module", src=f"{ROOT}/{script}"),
    )


def scripted(page: bytes, script: str) -> bytes:
    """A page that loads a script and the style."""
    return page.replace(b"</head>", str(head(script)).encode() + b"</head>", 1)


def policy(compiles: bool = True) -> str:
    """The policy of a page that loads modules of this server, and where it ``compiles`` WebAssembly; nothing else."""
    kept = [each for each in POLICY.split("; ") if not each.startswith(("script-src", "style-src"))]
    style = next(each for each in POLICY.split("; ") if each.startswith("style-src"))
    own = "script-src 'self' 'wasm-unsafe-eval'" if compiles else "script-src 'self'"
    images = [] if compiles else ["img-src 'self' blob:"]  # of files that are not stored yet
    kept = [each for each in kept if compiles or not each.startswith("img-src")]
    scripts = [own, *images, "require-trusted-types-for 'script'", "trusted-types 'none'"]
    return "; ".join([*kept, f"{style} 'self'", *scripts])


def with_scripts(response: Response, compiles: bool = True) -> Response:
    """The response under that policy."""
    response.headers["Content-Security-Policy"] = policy(compiles)
    return response
