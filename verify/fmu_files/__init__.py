"""A seeded fuzz of FMU files: archives, XML and binaries that are broken or made to do harm.

`make` makes the files, `trial` passes one to `giveway fmu check`, `info` and `run` and judges the outcome, `__main__`
tries many in processes that may die, and `faults` plants faults in the commands to show that the fuzz can fail.
"""
