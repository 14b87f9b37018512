"""The fit of the robot's open parameters to what the paper measured: one set of values for all experiments.

`quantities`: what is computed and what it should be. `parameters`: what may move, and how far an estimate is believed.
`search`: the fit. `record`: what is printed and kept.
"""
