"""The batch library (`fmu/batch`) as Python calls it: its functions, the layouts of its arrays, what it measures.

It is asked for runs, and for what the models know, so that no second copy of an equation stands in Python.
"""
