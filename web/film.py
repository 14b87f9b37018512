"""`python -m web.film`: the README's moving picture of the studio, `docs/studio.webp`, from the page itself."""

from __future__ import annotations

import io
import tempfile
from pathlib import Path

from giveway.base.files import replace_file
from giveway.studio.filled import studio_page
from PIL import Image

from web.browser import ROOT, Browser
from web.studio_page import Studio

FILM = ROOT / "docs" / "studio.webp"
MAXIMUM_BYTES = 600_000
SECOND = "b.testbed.bumper.kind=1&b.around=0.17&b.region=lower+leg"
DESIGN = f"#robot=trikey&region=lower+leg&around=0.17&speed_mps=0.5&{SECOND}"
WIDTH, HEIGHT = 1300, 800
SIZE = (975, 600)
FIRST_MS, LAST_MS, STEP_MS, SHOWN_MS, REST_MS = 120, 560, 11, 70, 1500


def frames() -> list[Image.Image]:
    """The collision from shortly before the contact, line and curves with it."""
    found = []
    with tempfile.TemporaryDirectory() as folder, Browser() as browser:
        path = Path(folder) / "studio.html"
        path.write_text(studio_page(), encoding="utf-8")
        with browser.page(path, width=WIDTH, height=HEIGHT, hash=DESIGN) as tab:
            Studio(tab).settle()
            tab.locator(".bench").evaluate("(bench) => scrollTo(0, bench.offsetTop - 8)")
            time = tab.get_by_label("time", exact=True)
            move = "(slider, value) => { slider.value = value; slider.dispatchEvent(new Event('input')); }"
            for at_ms in range(FIRST_MS, LAST_MS, STEP_MS):
                time.evaluate(move, str(round(at_ms / 0.6)))  # in thousandths of 0.6 s
                tab.wait_for_timeout(50)
                picture = Image.open(io.BytesIO(tab.screenshot())).convert("RGB")
                found.append(picture.resize(SIZE, Image.Resampling.LANCZOS))
    return found


def main() -> None:
    first, *others = frames()
    durations = [SHOWN_MS] * len(others) + [REST_MS]
    with replace_file(FILM) as temporary:
        first.save(temporary, save_all=True, append_images=others, duration=durations, loop=0, quality=55, method=6)
        size = temporary.stat().st_size
        if size > MAXIMUM_BYTES:
            raise SystemExit(f"{size} bytes: at most {MAXIMUM_BYTES}")
    print(f"{FILM.relative_to(ROOT)}: {size / 1e3:.0f} kB, {len(durations)} frames of {SIZE[0]} x {SIZE[1]}")


if __name__ == "__main__":
    main()
