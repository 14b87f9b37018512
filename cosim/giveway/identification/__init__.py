"""Roller friction (28) of a user's own robot, from logs of its free motion: `giveway calibrate`.

`motion_log` reads a log, `torque_model` is (27), `roller_fit` the fit, `roller_friction` its evaluation, `command` the
command.
"""
