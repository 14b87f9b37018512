"""The studio as tests, benchmark and film handle it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

__all__ = ["Studio"]

OPENED_MS = 200.0  # until groups that were opened have their rows


class Studio:
    """The page `tab`, opened and ready."""

    def __init__(self, tab: Page) -> None:
        self.tab = tab

    def row(self, name: str) -> Locator:
        """The row of a parameter, found by its name."""
        found = self.tab.locator(f'.parameter[data-name="{name}"]')
        if found.count() == 0 or not found.is_visible():
            self.tab.get_by_label("find a parameter", exact=True).fill(name)
            found.wait_for()
        return found

    def open_groups(self, count: int | None = None) -> list[str]:
        """Names of the parameters in the groups, all or the first ones, which are open then."""
        groups = "[...document.querySelectorAll('details.group')].slice(0, count)"
        self.tab.evaluate(f"(count) => {groups}.forEach((one) => (one.open = true))", count or 1000)
        self.tab.wait_for_timeout(OPENED_MS)
        rows = "() => [...document.querySelectorAll('.parameter[data-name]')].map((row) => row.dataset.name)"
        found: list[str] = self.tab.evaluate(rows)
        return found

    def set(self, name: str, text: str) -> None:
        """Type a parameter's value, or tick it, and wait for what comes of it."""
        row = self.row(name)
        box = row.locator('input[type="checkbox"]')
        if box.count() > 0:
            box.set_checked(text == "true")
        else:
            field = row.locator('input[type="text"]')
            field.fill(text)
            field.press("Enter")
            field.blur()
        self.settle()

    def value(self, name: str) -> str:
        """A parameter's value as its row shows it."""
        return self.row(name).locator('input[type="text"]').input_value()

    def move(self, label: str, to: str) -> None:
        """Move a slider of the hit."""
        self.tab.get_by_label(label, exact=True).fill(to)
        self.settle()

    def settle(self) -> None:
        """Until nothing more is computed or drawn, and the address is written, 0.3 s after a change."""
        self.tab.locator('#curves[data-settled="true"]').wait_for()

    def numbers(self, name: str) -> list[float]:
        """A metric of each design."""
        row = self.tab.locator("#numbers tr", has=self.tab.locator("th", has_text=re.compile(f"^{name}")))
        return [float(text.partition(" ")[0]) for text in row.locator("td").all_inner_texts()]

    def number(self, name: str) -> float:
        """A metric of the one design."""
        (value,) = self.numbers(name)
        return value

    def address(self) -> str:
        """What stands after the # of the address."""
        return self.tab.url.partition("#")[2]
