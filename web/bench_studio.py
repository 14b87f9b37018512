"""How soon the studio answers: from the move of a slider to new curves on the screen, measured in the page itself."""

from __future__ import annotations

import statistics
import tempfile
from pathlib import Path
from typing import Any

from giveway.studio.filled import studio_page

from web.browser import Browser
from web.studio_page import Studio

__all__ = ["MOVES", "answer_times_ms", "quantiles_ms"]

MOVES, WARM_UP = 100, 20
PARAMETER = "testbed.bumper.spring_rate"
# Each move is one of its own: the next one comes when the curves of this one have been painted. A message that is
# sent at the start of the next frame is heard when that frame has been painted.
MEASURE = """async ([name, moves]) => {
  const slider = document.querySelector(`[data-name="${name}"] input[type=range]`);
  const curves = document.getElementById("curves");
  const painted = () => new Promise((done) => {
    const seen = new MutationObserver(() => {
      seen.disconnect();
      const { port1, port2 } = new MessageChannel();
      port1.onmessage = () => done(performance.now());
      requestAnimationFrame(() => port2.postMessage(0));
    });
    seen.observe(curves, { attributeFilter: ["data-drawn"] });
  });
  const found = [];
  for (let i = 0; i < moves; i++) {
    const began = performance.now();
    const end = painted();
    slider.value = String(300 + ((i * 37) % 400));
    slider.dispatchEvent(new Event("input", { bubbles: true }));
    found.push((await end) - began);
    await new Promise((done) => setTimeout(done, 20 + (i % 7) * 3));
  }
  return found;
}"""


def answer_times_ms() -> list[float]:
    """Of 100 moves, in the order in which they were made."""
    with tempfile.TemporaryDirectory() as folder, Browser() as browser:
        path = Path(folder) / "studio.html"
        path.write_text(studio_page(), encoding="utf-8")
        with browser.page(path) as tab:
            Studio(tab).row(PARAMETER)
            found: Any = tab.evaluate(MEASURE, [PARAMETER, WARM_UP + MOVES])
    return [float(time) for time in found[WARM_UP:]]


def quantiles_ms(times: list[float]) -> tuple[float, float]:
    """Median and 95th percentile."""
    return statistics.median(times), statistics.quantiles(times, n=20)[-1]
