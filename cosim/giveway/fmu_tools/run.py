"""`giveway fmu run`: any FMU, Co-Simulation or Model Exchange, with FMPy, in a separate process."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from giveway.base.checks import finite, whole
from giveway.base.errors import FileError, GivewayError, UnknownNameError
from giveway.base.files import check_file
from giveway.fmu_tools.archive import Archive, shown
from giveway.fmu_tools.check import open_safely
from giveway.fmu_tools.check.binaries import binary_of, needed_functions
from giveway.fmu_tools.description import Description, effective
from giveway.fmu_tools.inputs import assigned, read_inputs
from giveway.fmu_tools.limits import Limits
from giveway.fmu_tools.process import FmuStoppedError, run_in_child, temporary_folder

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["INTERFACES", "FmuRun", "FmuStoppedError", "check_run_output", "run_fmu"]

INTERFACES = {"cs": "CoSimulation", "me": "ModelExchange"}
ENDINGS = (".csv", ".html")
MOST_STEPS = 2_000_000
DEFAULT_STOP_S, DEFAULT_STEPS = 1.0, 500
LONGEST_WAIT_S = 1e7
_UNPLOTTABLE = ("String", "Binary", "Clock")
_FEW = 5  # variables that are recorded of an FMU without outputs


@dataclass(frozen=True)
class FmuRun:
    """The results.

    Attributes:
        traces: structured array; field "time" in s, then one field per recorded variable.
        units: per variable, "" if it has none.
        plotted: variables that the user chose; empty: the default.
        note: deviations from the FMU's default experiment; empty if there are none.
        stopped: fault of the FMU's process after the run was complete; empty if it ended normally.
    """

    path: Path
    interface: str
    step_s: float
    traces: NDArray[Any]
    units: dict[str, str]
    description: str
    plotted: tuple[str, ...] = ()
    note: str = ""
    stopped: str = ""


def check_run_output(out: Path) -> None:
    """Refuse, before any work is done, what `write_run` could not write."""
    if out.suffix not in ENDINGS:
        raise GivewayError("--out", out, f"a file that ends in {' or '.join(ENDINGS)}")
    check_file(out)


def run_fmu(
    path: Path,
    interface: str | None = None,
    stop_s: float | None = None,
    step_s: float | None = None,
    assignments: Sequence[str] | None = None,
    progress: Callable[[float, float], None] | None = None,
    *,
    inputs: Path | None = None,
    plot: Sequence[str] = (),
    limits: Limits | None = None,
    time_limit_s: float | None = None,
    most_steps: int = MOST_STEPS,
) -> FmuRun:
    """Run the FMU at ``path`` from its start values, in a process of its own, after a check that it is safe to unpack.

    Args:
        interface: "cs" or "me"; None: Co-Simulation if it has one.
        stop_s: simulated time at the end in s; None: the FMU's default experiment, else 1 s.
        step_s: communication step, in Model Exchange the output interval, in s; None: that of the FMU's default
            experiment, doubled until there are no more than ``most_steps``, else its fixed internal step, else a 500th
            of the time.
        assignments: "NAME=VALUE" for inputs and parameters.
        progress: called now and then with the simulated time and the end, in s.
        inputs: CSV file of inputs over time; see `fmu_inputs.read_inputs`. Others are held.
        plot: names, or patterns with * and ?, of variables to record in addition to the outputs, and to draw.
        limits: for unpacking.
        time_limit_s: wall time, 0.1 to 1e7 s; None: unlimited.
        most_steps: 1 to 1e9.

    Raises GivewayError for wrong input, FileError for a file that is refused, SimulationError if the FMU refuses or
    fails, FmuStoppedError if it crashes or takes too long. Nothing is left in the temporary folder.
    """
    whole("--max-steps", most_steps, 1, 1_000_000_000)
    if time_limit_s is not None:
        finite("--time-limit", time_limit_s, 0.1, LONGEST_WAIT_S, "s")
    archive, description = open_safely(path, limits)
    with archive:
        kind = _interface(path, description, interface)
        times = _times(description, kind, stop_s, step_s, most_steps)
        values = assigned(description, assignments or ())
        signals = None if inputs is None else read_inputs(inputs, description)
        output, plotted = _recorded(description, plot)
        _check_binary(archive, description, kind)
        with temporary_folder() as folder:
            archive.extract(folder.path / "fmu")
            if signals is not None:
                import numpy as np

                np.save(folder.path / "input.npy", signals, allow_pickle=False)
            job = {
                "interface": kind,
                "start_s": times.start,
                "stop_s": times.stop,
                "step_s": times.step,
                "values": values,
                "output": output,
                "has_input": signals is not None,
            }
            traces, stopped = run_in_child(path.name, folder, job, time_limit_s, progress)
    names = [name for name in traces.dtype.names or () if name != "time"]
    units = {name: effective(description, description.by_name[name], "unit") for name in names}
    about = description.attributes.get("description") or description.attributes.get("modelName", "")
    return FmuRun(path, kind, times.step, traces, units, about, plotted, times.note, stopped)


def _interface(path: Path, description: Description, wanted: str | None) -> str:
    offered = [name for name, interface in INTERFACES.items() if interface in description.interfaces]
    if not offered:
        alone = "ScheduledExecution" in description.interfaces
        reason = (
            "has Scheduled Execution alone: a scheduler of the importer activates its parts by clocks"
            if alone
            else "has no interface"
        )
        raise FileError(path, f"cannot be run: it {reason}", "this runs Co-Simulation and Model Exchange")
    if wanted is None:
        return INTERFACES[offered[0]]
    if wanted not in offered:
        raise GivewayError("--interface", wanted, f"{' or '.join(offered)}: what this FMU has")
    return INTERFACES[wanted]


@dataclass(frozen=True)
class _Times:
    start: float
    stop: float
    step: float
    note: str


def _times(description: Description, kind: str, stop_s: float | None, step_s: float | None, most_steps: int) -> _Times:
    experiment = description.experiment
    begin = _own(experiment.get("startTime"), "startTime") or 0.0
    own_stop = _own(experiment.get("stopTime"), "stopTime")
    own_step = _own(experiment.get("stepSize"), "stepSize") or _own(
        description.interfaces[kind].get("fixedInternalStepSize"), "fixedInternalStepSize"
    )
    stop = finite("--stop", (begin + DEFAULT_STOP_S if own_stop is None else own_stop) if stop_s is None else stop_s)
    if not stop > begin:
        raise GivewayError("--stop", stop, f"a time in s after the start at {begin:g} s")
    span, note = stop - begin, ""
    if step_s is not None:
        step = finite("--step", step_s, min(1e-9, span), span, "s")
        if span / step > most_steps:
            allowed = f"at least {span / most_steps:g} s: no more than {most_steps} steps, unless --max-steps allows"
            raise GivewayError("--step", step, allowed)
        return _Times(begin, stop, step, note)
    step = own_step if own_step is not None and 0.0 < own_step <= span else span / DEFAULT_STEPS
    wanted = step
    while span / step > most_steps:
        step *= 2.0
    if step > wanted:
        note = f"steps of {step:g} s, not {wanted:g} s: those would be more than {most_steps} (--step, --max-steps)"
    return _Times(begin, stop, step, note)


def _own(text: str | None, name: str) -> float | None:
    """A number of the FMU's default experiment."""
    if text is None:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise GivewayError(f"{name} in modelDescription.xml", shown(text, 40), "a finite number")
    return value


def _recorded(description: Description, plot: Sequence[str]) -> tuple[list[str], tuple[str, ...]]:
    """Names of the recorded variables, and of those that the user chose."""
    numeric = {v.name: v for v in description.variables if v.type not in _UNPLOTTABLE and v.causality != "independent"}
    plotted: dict[str, None] = {}
    for pattern in plot:
        expression = re.compile(re.escape(pattern).replace(r"\*", ".*").replace(r"\?", "."), re.DOTALL)
        found = [pattern] if pattern in numeric else [name for name in numeric if expression.fullmatch(name)]
        if not found:
            raise UnknownNameError("--plot", pattern, numeric)
        plotted |= dict.fromkeys(found)
    outputs = [v.name for v in numeric.values() if v.causality == "output"]
    if not outputs and not plotted:
        by_key = {description.key(v): v for v in numeric.values()}
        states = [
            by_key[int(v.get("derivative"))].name for v in numeric.values() if _is_state(v.get("derivative"), by_key)
        ]
        outputs = (states or list(numeric))[:_FEW]
    return list(dict.fromkeys([*outputs, *plotted])), tuple(plotted)


def _is_state(derivative: str, by_key: dict[int, Any]) -> bool:
    return derivative.isascii() and derivative.isdigit() and int(derivative[:20]) in by_key


def _check_binary(archive: Archive, description: Description, kind: str) -> None:
    """FileError unless the FMU has a library that this machine can load, with the functions of the interface."""
    from giveway.fmu_tools.binaries import PLATFORMS, platform_here

    platform = platform_here(description.version)
    if platform not in PLATFORMS[description.version]:
        raise FileError(archive.path, f"cannot be run on this machine: FMI {description.version} has no name for it")
    machine, system, ending = PLATFORMS[description.version][platform]
    identifier = description.interfaces[kind].get("modelIdentifier", "")
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", identifier):
        raise FileError(archive.path, f"cannot be run: its model identifier {shown(identifier)!r} is not a name in C")
    name = f"binaries/{platform}/{identifier}{ending}"
    if name not in archive.files:
        parts = [n.split("/") for n in archive.files if n.startswith("binaries/")]
        others = ", ".join(sorted({shown(p[1]) for p in parts if len(p) > 2})) or "none at all"
        raise FileError(
            archive.path, f"cannot be run on this machine: {name} is missing", f"it has binaries for {others}"
        )
    binary = binary_of(archive, name)
    if isinstance(binary, FileError):
        raise FileError(archive.path, f"cannot be run: {name} {binary.value}")
    if binary.system != system or machine not in binary.machines:
        raise FileError(
            archive.path, f"cannot be run: {name} is for {binary.system}, {'/'.join(sorted(binary.machines))}"
        )
    missing = sorted(needed_functions(description.version, (kind,)) - binary.exported)
    if missing:
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        raise FileError(archive.path, f"cannot be run: {name} does not export {missing[0]}{more}")
