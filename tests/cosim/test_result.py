"""Results keep their labels and numbers on disk, and say where they come from."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import giveway
import numpy as np
import pytest
from giveway.base import native
from giveway.base.errors import FileError, UnknownNameError
from giveway.robot.variables import table
from giveway.simulation.result import Result


def test_every_output_is_a_labelled_trace(short_run: Result) -> None:
    for model in native.MODELS:
        for variable in table(model).select("output"):
            trace = short_run.traces[f"{model}.{variable.name}"]
            assert trace.dims == ("time",)
            assert trace.attrs == {"units": variable.unit or "1", "long_name": variable.description}
    assert short_run.traces["time"].attrs["units"] == "s"
    assert np.allclose(np.diff(short_run.traces["time"]), 0.001, rtol=0.0, atol=1e-12)
    assert short_run.traces.sizes["time"] == 501


def test_save_and_load_return_the_same(short_run: Result, tmp_path: Path) -> None:
    loaded = giveway.load(short_run.save(tmp_path / "run"))
    assert short_run.traces.identical(loaded.traces)
    assert loaded.metrics == short_run.metrics
    assert loaded.manifest == short_run.manifest


def test_units_are_in_the_parquet_columns(short_run: Result, tmp_path: Path) -> None:
    import pyarrow.parquet

    schema = pyarrow.parquet.read_schema(short_run.save(tmp_path / "run") / "traces.parquet")
    assert schema.field("testbed.truth.contact_force").metadata[b"units"] == b"N"
    assert schema.metadata[b"schema_version"] == b"1"


def test_the_manifest_says_what_ran(short_run: Result) -> None:
    manifest = short_run.manifest
    for model in native.MODELS:
        path = native.fmu(model, 3)
        assert manifest["fmus"][model]["sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()
        assert manifest["fmus"][model]["token"]
        assert set(manifest["parameters"][model]) == {v.name for v in table(model).select("parameter")}
    assert manifest["robot"]["sha256"] == hashlib.sha256(native.robot().read_bytes()).hexdigest()
    assert manifest["parameters_set"]["testbed"]["bumper.kind"] == 2
    assert manifest["versions"]["giveway"] == giveway.__version__
    assert set(manifest["versions"]) >= {"python", "fmpy", "numpy"}
    assert manifest["seed"] == table("testbed")["electronics.seed"].start
    assert manifest["solver"]["relative_tolerance"] > 0.0
    assert manifest["schema_version"] == 1
    assert manifest["interrupted"] is False
    json.dumps(manifest, allow_nan=False)


def test_a_folder_that_is_no_result_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="no such file"):
        giveway.load(tmp_path)
    (tmp_path / "manifest.json").write_text('{"schema_version": 99}')
    with pytest.raises(FileError, match="schema_version is 99"):
        giveway.load(tmp_path)


def test_a_damaged_trace_file_is_refused(short_run: Result, tmp_path: Path) -> None:
    folder = short_run.save(tmp_path / "run")
    path = folder / "traces.parquet"
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(FileError, match=r"traces\.parquet"):
        giveway.load(folder)


def test_a_metric_is_found_by_the_name_it_had_before(short_run: Result, tmp_path: Path) -> None:
    with pytest.warns(FutureWarning, match='"bumper travel" is called "bumper compression" now'):
        assert short_run.metric("bumper travel") is short_run.metric("bumper compression")
    folder = short_run.save(tmp_path / "old")
    file = folder / "metrics.json"
    file.write_text(file.read_text().replace("bumper compression", "bumper travel"))
    assert giveway.load(folder).metrics == short_run.metrics


def test_unknown_metric_offers_the_nearest(short_run: Result) -> None:
    assert short_run.metric("detection time").unit == "ms"
    with pytest.raises(UnknownNameError, match="detection time"):
        short_run.metric("detection tim")
