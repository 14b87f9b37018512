"""Anybody's FMU (`giveway fmu check`, `info`, `run`), and ours as a System Structure Package (`giveway ssp`).

An FMU is read without trust: limits on its files, its libraries opened in processes of their own.
"""
