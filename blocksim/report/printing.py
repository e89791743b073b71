"""Pages printed to PDF by a browser that is here; nothing else lays out pages as it does."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from blocksim.common.errors import MissingPart

BROWSERS = ("chromium", "chromium-browser", "chromium-headless-shell", "google-chrome",
            "google-chrome-stable", "chrome", "msedge", "microsoft-edge")  # fmt: skip
"""Commands that print without a window."""
PATIENCE = 300.0
"""How long a browser may take [s]."""
QUIET = ("--headless", "--disable-gpu", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--no-pdf-header-footer")  # fmt: skip


def require_browser() -> str:
    """Return the command of a browser; `MissingPart` where there is none."""
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if found is None:
        remedy = "install Chromium or Chrome, or write .html and print it from any browser"
        raise MissingPart("a browser that prints PDF", remedy)
    return found


def printed_page(page: str) -> bytes:
    """Return a page of HTML as PDF; `MissingPart` where no browser prints."""
    browser = require_browser()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        source, out = Path(folder, "page.html"), Path(folder, "page.pdf")
        source.write_text(page, encoding="utf-8")
        # The administrator of a machine has no sandbox; the page is our own, and loads nothing.
        root = ["--no-sandbox"] if getattr(os, "geteuid", int)() == 0 else []
        own = [f"--user-data-dir={folder}/profile", f"--print-to-pdf={out}"]
        command = [browser, *QUIET, *root, *own, source.as_uri()]
        try:
            # A browser of this machine, asked for a page of our own.
            subprocess.run(command, capture_output=True, timeout=PATIENCE, check=False)  # noqa: S603
        except (OSError, subprocess.TimeoutExpired) as error:
            raise MissingPart(f"a browser that prints PDF ({browser})", str(error)) from None
        if not out.is_file():
            remedy = f"{browser} wrote none; write .html and print it from any browser"
            raise MissingPart("a browser that prints PDF", remedy)
        return out.read_bytes()
