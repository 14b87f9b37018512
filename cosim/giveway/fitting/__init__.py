"""The fit of the robot's unknown parameters to the paper's measurements: one set of values for all experiments.

`quantities`: the computed numbers and their targets. `parameters`: the fitted parameters, and the uncertainty of their
    estimates. `search`: the fit. `record`: printed and stored results.
"""
