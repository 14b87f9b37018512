"""`giveway crowd curves`: delay against false alarms per hour, for the controller's detectors and those of textbooks.

`recorded` runs the crowd's robots with detectors that never react, `situations` tells where their ticks belong,
`candidates` lists what is compared; each of a textbook has a file of its own and works on the recorded residual behind
`noise`'s high-pass. `alarms` counts, `work` stores, `curve` puts intervals to it, `figure` draws.
"""
