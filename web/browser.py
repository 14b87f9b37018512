"""Pages in Debian's Chromium, for tests, benchmarks and pictures: the console must stay silent, nothing is fetched.

    with Browser() as browser, browser.page(path) as tab:
        tab.get_by_role("button", name="Play").click()

A page's policy forbids `eval`: `tab.evaluate` works, `tab.wait_for_function` does not; wait with locators.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from web.engines import WEB, installed

if TYPE_CHECKING:
    from playwright.sync_api import Page

__all__ = ["HEIGHT", "WIDTHS", "Browser", "accessible", "pictures"]

ROOT = WEB.parent
TOOLS = ROOT / "build" / "web" / "node_modules"
WIDTHS, HEIGHT = (420, 1300), 900
PATIENCE_MS = 20_000.0


class Browser:
    """One Chromium; every page of it starts anew."""

    def __enter__(self) -> Browser:
        from playwright.sync_api import sync_playwright

        with ExitStack() as stack:
            playwright = stack.enter_context(sync_playwright())
            self._chromium = playwright.chromium.launch(executable_path=installed("chromium", "chromium"))
            stack.callback(self._chromium.close)
            self._open = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    @contextmanager
    def page(
        self, path: Path, *, width: int = WIDTHS[-1], height: int = HEIGHT, dark: bool = False, hash: str = ""
    ) -> Iterator[Page]:
        """The page in a file, when it is ready; in the end an error if it said anything or asked for anything."""
        context = self._chromium.new_context(
            viewport={"width": width, "height": height},
            color_scheme="dark" if dark else "light",
            accept_downloads=True,
            offline=True,
        )
        context.set_default_timeout(PATIENCE_MS)
        try:
            tab = context.new_page()
            said: list[str] = []
            tab.on("console", lambda message: said.append(message.text))
            tab.on("pageerror", lambda error: said.append(str(error)))
            own = path.resolve().as_uri()
            tab.on("request", lambda request: said.extend(_foreign(request.url, own)))
            tab.goto(own + hash)
            tab.locator("html[data-ready]").wait_for(state="attached")
            yield tab
            if said:
                raise AssertionError(f"{path.name} said: {said}")
        finally:
            context.close()


def _foreign(url: str, own: str) -> list[str]:
    known = url.split("#")[0] == own or url.startswith(("blob:", "data:"))
    return [] if known else [f"asked for {url}"]


def accessible(tab: Page) -> list[str]:
    """What axe-core finds wrong: rule, reason and element of each; nothing is as it should be."""
    tab.evaluate((TOOLS / "axe-core" / "axe.min.js").read_text())
    found: Any = json.loads(tab.evaluate("async () => JSON.stringify((await axe.run(document)).violations)"))
    nodes = [(rule["id"], node) for rule in found for node in rule["nodes"]]
    return [f"{rule}: {node['failureSummary']} {node['html'][:200]}" for rule, node in nodes]


def pictures(browser: Browser, path: Path, name: str, folder: Path = ROOT / "out" / "pictures") -> list[Path]:
    """The whole page at both widths, light and dark, as PNG."""
    folder.mkdir(parents=True, exist_ok=True)
    made = []
    for width in WIDTHS:
        for dark in (False, True):
            with browser.page(path, width=width, dark=dark) as tab:
                made.append(folder / f"{name}_{width}_{'dark' if dark else 'light'}.png")
                tab.screenshot(path=made[-1], full_page=True)
    return made
