"""One run: the FMUs stepped by the master, labelled traces, metrics, and the files of a result.

`runner` makes a `result` of a scenario with `master` and `fmu`; `metrics`, `push_response`, `run_warnings` judge it.
"""
