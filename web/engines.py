"""Calls of driver.js in Node and in Chromium: the module as it ships, in real engines."""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Protocol

from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.scenario.plan import Rest
from giveway.scenario.scenario import Scenario
from giveway.simulation.master import plan_table, push_table

__all__ = ["Chromium", "Engine", "Node", "spec_of"]

WEB = Path(__file__).parent
LIBRARY, DRIVER = WEB / "giveway_batch.js", WEB / "driver.js"
LONGEST_S = 300.0


class Engine(Protocol):
    """Somewhere to run JavaScript."""

    name: str

    def call(self, function: str, *given: Any) -> Any:
        """What the function of driver.js answers."""


class Node:
    """Node, with workers from node:worker_threads."""

    name = "Node"

    def call(self, function: str, *given: Any) -> Any:
        sent = {"library": LIBRARY.as_uri(), "wasm": str(module()), "call": function, "given": given}
        command = [installed("node", "nodejs"), str(DRIVER)]
        ended = subprocess.run(
            command, input=json.dumps(sent), capture_output=True, text=True, timeout=LONGEST_S, check=False
        )
        if ended.returncode != 0:
            raise RuntimeError(f"node ended with {ended.returncode}: {ended.stderr}")
        return json.loads(ended.stdout)


class Chromium:
    """Debian's Chromium, headless: one page from a file that holds everything, as a user opens it."""

    name = "Chromium"

    def call(self, function: str, *given: Any) -> Any:
        from playwright.sync_api import sync_playwright

        with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
            page_file = Path(folder) / "page.html"
            page_file.write_text(page())
            browser = playwright.chromium.launch(executable_path=installed("chromium", "chromium"))
            try:
                tab = browser.new_page()
                said: list[str] = []
                tab.on("console", lambda message: said.append(message.text))
                tab.on("pageerror", lambda error: said.append(str(error)))
                tab.goto(page_file.as_uri())
                tab.wait_for_function("window.ready || document.readyState === 'complete'")
                answer = tab.evaluate("([call, given]) => window.answer(call, given)", [function, json.dumps(given)])
            finally:
                browser.close()
        if said:
            raise RuntimeError(f"the page said: {said}")
        return json.loads(answer)


def module() -> Path:
    """giveway_batch.wasm, as it is in the wheel."""
    return native.file("giveway_batch.wasm")


def installed(command: str, package: str) -> str:
    found = shutil.which(command)
    if found is None:
        raise GivewayError(command, "not installed", f"Debian's package {package}: bash tests/system_packages.sh")
    return found


def page() -> str:
    """A page without a network: library, module and driver are in it."""
    library, driver = LIBRARY.read_text(), DRIVER.read_text()
    wasm = base64.b64encode(module().read_bytes()).decode()
    return f"""<!doctype html><meta charset="utf-8"><title>giveway</title>
<script type="text/plain" id="library">{library}</script>
<script type="module">
{library}
{driver}
const bytes = from_base64("{wasm}");
const calls = {{
  compute: (specs) => compute({{ Library, Workers }}, bytes, document.getElementById("library").textContent, specs),
  time: (spec, times) => time({{ Library, Workers }}, bytes, spec, times),
}};
window.answer = async (call, given) => JSON.stringify(await calls[call](...JSON.parse(given)));
window.ready = true;
</script>
"""


def spec_of(scenario: Scenario, traces: list[str], method: str = "event-exact") -> dict[str, Any]:
    """The scenario for JavaScript; its tables as base64."""
    plan, push, region = plan_table(scenario), push_table(scenario), scenario.judged
    if isinstance(scenario.plan, Rest):
        plan = plan[:1]
    spec = {
        "step_s": scenario.step_s,
        "step_count": scenario.steps,
        "settings": {
            f"{model}.{name}": float(value)
            for model in ("controller", "testbed")
            for name, value in scenario.parameters(model).items()
        },
        "plan": base64.b64encode(plan.tobytes()).decode(),
        "traces": traces,
        "method": method,
    }
    if push is not None:
        spec["push"] = base64.b64encode(push.tobytes()).decode()
    if region is not None:
        spec |= {"transient_limit_n": region.peak_limit_n, "lasting_limit_n": region.lasting_limit_n}
    return spec
