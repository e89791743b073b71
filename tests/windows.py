"""Windows of a browser that tests share."""

import time
from collections.abc import Callable
from typing import Any

PATIENCE = 300.0
"""Ends what waits for nothing; a machine that is busy elsewhere is no fault [s]."""


def wait_until(page: Any, true: Callable[[], bool]) -> None:
    """Playwright's own waiting evaluates text in the page, which pages of ours forbid."""
    deadline = time.monotonic() + PATIENCE
    while not true():
        assert time.monotonic() < deadline, "waited for nothing"
        page.wait_for_timeout(50)


def settle(page: Any) -> None:
    """Wait until what was done is drawn."""
    page.evaluate(
        "() => new Promise((d) => requestAnimationFrame(() => requestAnimationFrame(d)))"
    )


def hold_clock(page: Any) -> None:
    """Have pictures of a page drawn by `tick` alone, once those that wait are drawn."""
    page.evaluate("""() => {
      const draw = window.requestAnimationFrame.bind(window);
      window.held = [];
      window.requestAnimationFrame = (picture) => held.push(picture);
      return new Promise((done) => draw(() => draw(done)));
    }""")


def tick(page: Any, now: float) -> None:
    """Draw what waits as if it were that time [ms]."""
    page.evaluate("(now) => { for (const picture of held.splice(0)) picture(now); }", now)


def new_page(browser: Any, **options: Any) -> Any:
    """Return a page in a window of its own that waits as long as it takes."""
    context = browser.new_context(**options)
    context.set_default_timeout(1000 * PATIENCE)
    return context.new_page()


class Windows:
    """Windows of one browser, used again by each test; whatever they complain about is kept.

    A new one takes the browser longer than the page does.
    """

    def __init__(self, browser: Any) -> None:
        self._browser = browser
        self._pages: dict[str, list[Any]] = {}
        self._taken: dict[str, int] = {}
        self.complaints: list[str] = []

    def open(self, address: str, width: int, height: int, **options: Any) -> Any:
        """Open a page as if in a window of its own.

        It is still, if nothing else is asked for: else the browser draws all the time.
        """
        looks = {"color_scheme": "light", "reduced_motion": "reduce"}
        looks |= {name: options.pop(name) for name in [*looks] if name in options}
        kind = repr(sorted(options.items()))
        pages, taken = self._pages.setdefault(kind, []), self._taken.get(kind, 0)
        if taken == len(pages):
            pages.append(self._new(options))
        self._taken[kind] = taken + 1
        page = pages[taken]
        page.set_viewport_size({"width": width, "height": height})
        page.emulate_media(media="screen", **looks)
        page.goto(address)
        settle(page)
        return page

    def _new(self, options: Any) -> Any:
        page = new_page(self._browser, **options)
        page.on("console", lambda message: self.complaints.append(message.text))
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.complaints.append(request.url))
        return page

    def wrong(self, *own: str) -> list[str]:
        """Return complaints, and what was asked for that begins with none of these."""
        return [each for each in self.complaints if not each.startswith((*own, "data:"))]

    def leave(self) -> None:
        """Leave all pages, with the pointer in the corner."""
        for pages in self._pages.values():
            for page in pages:
                page.mouse.move(0, 0)
                page.goto("about:blank")
        self._taken.clear()
        self.complaints.clear()
