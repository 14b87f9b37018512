"""One run: the FMUs stepped by the master, traces with labels, what they are judged by, and the files of a result.

`runner` makes a `result` of a scenario with `master` and `fmu`; `metrics`, `push_response`, `run_warnings` judge it.
"""
