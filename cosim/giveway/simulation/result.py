"""The result of a run: labelled traces with units, metrics, and a manifest of their origin."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from giveway.base.errors import FileError
from giveway.base.files import read_json, replace_folder, write_text
from giveway.base.in_notebooks import ShownInNotebooks
from giveway.base.parquet import open_parquet, read_table
from giveway.scenario.body_regions import Judgement, judge
from giveway.simulation.metric_names import RENAMED, current_name
from giveway.simulation.metrics import Metric
from giveway.simulation.run_warnings import RunWarning

if TYPE_CHECKING:
    import xarray

__all__ = ["Result", "load"]

SCHEMA_VERSION = 1
HINT = "give a folder that `giveway run --out` wrote"
TRACES_FILE = "traces.parquet"
MANIFEST_FILE = "manifest.json"
METRICS_FILE = "metrics.json"


@dataclass(frozen=True)
class Result(ShownInNotebooks):
    """One run.

    Attributes:
        traces: one variable per FMU output, named ``testbed.truth.x``, over the coordinate ``time`` (s);
            the attributes ``units`` and ``long_name`` come from the variable tables.
        metrics: in the order of the printed table.
        manifest: versions, hashes, seeds, parameters, solver options, scenario.
        warnings: deviations from the request.
        pushes: the estimate of each push of the scenario's schedule, see
            `giveway.simulation.push_response.push_metrics`.
    """

    traces: xarray.Dataset
    metrics: tuple[Metric, ...]
    manifest: dict[str, Any]
    warnings: tuple[RunWarning, ...] = ()
    pushes: tuple[tuple[Metric, ...], ...] = ()

    @property
    def interrupted(self) -> bool:
        """True if the run was stopped before its end time."""
        return bool(self.manifest["interrupted"])

    def metric(self, name: str) -> Metric:
        """The metric called ``name``."""
        name = current_name("metric", name)
        for metric in self.metrics:
            if metric.name == name:
                return metric
        from giveway.base.errors import UnknownNameError

        raise UnknownNameError("metric", name, [metric.name for metric in self.metrics])

    @property
    def judgement(self) -> Judgement | None:
        """The contact against the limits of the scenario's body region; None if it names none."""
        scenario = self.manifest["scenario"]
        region = scenario.get("body_region") or scenario.get("judge_as")
        if region is None:
            return None
        time_s, force_n = (self.traces[name].values for name in ("time", "testbed.truth.contact_force"))
        return judge(time_s, force_n, region, contact_area_m2=scenario.get("contact_area_m2"))

    def save(self, folder: Path | str) -> Path:
        """Write traces (Parquet), metrics and manifest (JSON) to ``folder``, all of them or nothing."""
        with replace_folder(Path(folder)) as temporary:
            self.write_into(temporary)
        return Path(folder)

    def write_into(self, folder: Path) -> None:
        """Write the files of this result into an existing folder."""
        import pyarrow
        import pyarrow.parquet

        columns = {"time": self.traces["time"], **self.traces.data_vars}
        fields = [
            pyarrow.field(str(name), pyarrow.from_numpy_dtype(array.dtype), metadata=_text_attributes(array.attrs))
            for name, array in columns.items()
        ]
        metadata = {"schema_version": str(SCHEMA_VERSION), "scenario": self.manifest["scenario"]["name"]}
        schema = pyarrow.schema(fields, metadata=metadata)
        data = pyarrow.table([array.values for array in columns.values()], schema=schema)
        with (folder / TRACES_FILE).open("wb") as file:  # pyarrow itself refuses a path that is not UTF-8
            pyarrow.parquet.write_table(data, file, compression="zstd")
        metrics = {
            "schema_version": SCHEMA_VERSION,
            "metrics": [asdict(metric) for metric in self.metrics],
            "warnings": [asdict(warning) for warning in self.warnings],
            "pushes": [[asdict(metric) for metric in push] for push in self.pushes],
        }
        write_text(folder / METRICS_FILE, json.dumps(metrics, indent=2, allow_nan=False) + "\n")
        write_text(folder / MANIFEST_FILE, json.dumps(self.manifest, indent=2, allow_nan=False) + "\n")


def load(folder: Path | str) -> Result:
    """Read a result that `Result.save` wrote."""
    import pyarrow
    import xarray

    folder = Path(folder)
    manifest = read_json(folder / MANIFEST_FILE, SCHEMA_VERSION, HINT)
    judged = read_json(folder / METRICS_FILE, SCHEMA_VERSION, HINT)
    metrics = tuple(
        Metric(**{**entry, "name": RENAMED.get(entry["name"], entry["name"])}) for entry in judged["metrics"]
    )
    warnings = tuple(RunWarning(**entry) for entry in judged.get("warnings", ()))  # older files have none
    pushes = tuple(tuple(Metric(**entry) for entry in push) for push in judged.get("pushes", ()))
    path = folder / TRACES_FILE
    try:
        with path.open("rb") as file:
            data = read_table(open_parquet(file))
    except (OSError, pyarrow.ArrowException) as error:
        raise FileError(path, f"cannot be read: {error}") from None
    variables: dict[str, Any] = {}
    for field, column in zip(data.schema, data.columns, strict=True):
        attributes = {name: (field.metadata or {}).get(name.encode(), b"").decode() for name in ("units", "long_name")}
        variables[field.name] = ("time", column.to_numpy(), attributes)
    time = variables.pop("time")
    return Result(xarray.Dataset(variables, coords={"time": time}), metrics, manifest, warnings, pushes)


def _text_attributes(attributes: dict[Any, Any]) -> dict[str, str]:
    return {str(key): str(value) for key, value in attributes.items()}
