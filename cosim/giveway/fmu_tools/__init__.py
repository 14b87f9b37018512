"""Anybody's FMU (`giveway fmu check`, `info`, `run`), and ours as a System Structure Package (`giveway ssp`).

FMUs are not trusted: there are limits on their files, and their libraries are opened in separate processes.
"""
