"""Cost and error of the integration methods: what the bench measures is sound, and a page shows it."""

from __future__ import annotations

from pathlib import Path

import pytest
from giveway.bench.solvers import HEADER, METHODS, SWEEPS, Measurement, measure_solvers

PAGE = Path(__file__).parents[2] / "docs/site/explanation/decisions/explicit_runge_kutta.md"
BEGIN, END = "<!-- table: giveway bench -->\n", "<!-- end of table -->"


@pytest.fixture(scope="module")
def measured() -> dict[tuple[str, float, str], Measurement]:
    return {(m.sweep, m.scale, m.method): m for m in measure_solvers(1, 3)}


def test_every_method_on_every_design(measured: dict[tuple[str, float, str], Measurement]) -> None:
    designs = [(sweep, scale) for sweep, (_, scales) in SWEEPS.items() for scale in scales]
    assert set(measured) == {(*design, method) for design in designs for method in METHODS}
    for m in measured.values():
        assert m.wall_ms > 0
        assert (m.jacobian_calls > 0) == (m.method == "BDF")
    # On the design as it is, all of them come near the reference: each step adds at most 1e-6 of its own.
    for method in METHODS:
        assert 0 < measured["springs", 1.0, method].error < 1e-6 * measured["springs", 1.0, method].steps


def test_bdf_bears_stiffness_and_the_others_do_not(measured: dict[tuple[str, float, str], Measurement]) -> None:
    mild, stiff = SWEEPS["damper"][1][0], SWEEPS["damper"][1][-1]
    growth = {name: measured["damper", stiff, name].steps / measured["damper", mild, name].steps for name in METHODS}
    assert growth["BDF"] < 2
    assert growth["ERK"] > 10
    assert growth["Adams"] > 10


def test_the_page_shows_the_measured_table(measured: dict[tuple[str, float, str], Measurement]) -> None:
    text = PAGE.read_text(encoding="utf-8")
    lines = text.split(BEGIN)[1].split(END)[0].splitlines()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    assert tuple(rows[0]) == HEADER
    assert [(sweep, float(times), method) for sweep, times, method, *_ in rows[2:]] == list(measured)
    for sweep, times, method, wall_ms, steps, rhs_calls, jacobian_calls, error in rows[2:]:
        m = measured[sweep, float(times), method]
        assert float(wall_ms) > 0  # the machine's own affair
        # The C library's pow() sets the steps' lengths, and its last bit depends on the processor: hence not exact.
        shown = [int(steps), int(rhs_calls), int(jacobian_calls)]
        assert shown == pytest.approx([m.steps, m.rhs_calls, m.jacobian_calls], rel=0.05), (sweep, times, method)
        assert m.error / 3 < float(error) < 3 * m.error, (sweep, times, method)
