"""A seeded fuzz of FMU files: archives, XML and binaries that are broken or made to do harm.

`make` makes them, `trial` gives one to `giveway fmu check`, `info` and `run` and judges what happened, `__main__` tries
many in processes that may die, `faults` plants faults in the commands to show that it can fail.
"""
