"""Parquet files are read in the calling thread alone: a thread of pyarrow's can keep a process from ending."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pyarrow
import pyarrow.parquet
from giveway.simulation.result import Result

READING = """
import sys
from pathlib import Path
import xarray
import giveway
from giveway.crowd.parts import read_records
from giveway.identification.log_rows import ParquetRows
from giveway.replay.parquet_log import ParquetLog
from giveway.study.results_table import read_part

def threads():  # but those of the allocator, which hold no Python object
    tasks = Path("/proc/self/task").iterdir()
    return {one.name for one in tasks if (one / "comm").read_text().strip() != "jemalloc_bg_thd"}


folder = Path(sys.argv[1])
traces = folder / "traces.parquet"
xarray.Dataset({"x": ("time", [0.0])})  # imports SciPy, whose OpenBLAS has threads of its own
before = threads()
for name, read in {
    "a log for identification": lambda: ParquetRows(traces, traces.read_bytes())._table,
    "a log to replay": lambda: next(ParquetLog(traces).blocks([0])).values,
    "a study's part": lambda: read_part(traces, ["time"]),
    "a crowd's records": lambda: read_records(folder),
    "a result": lambda: giveway.load(folder).traces["time"],
}.items():
    assert len(read()) == 501, name
    assert threads() == before, f"{name}: its reading started a thread"
"""


def test_reading_starts_no_thread(short_run: Result, tmp_path: Path) -> None:
    folder = short_run.save(tmp_path / "run")
    part = folder / "part-000000000-000000501.parquet"
    pyarrow.parquet.write_table(pyarrow.table({"record": ["{}"] * 501}), part)
    command = [sys.executable, "-c", READING, str(folder)]
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
