"""Thresholds from logs of your own robot: `giveway tune`.

`logs` reads what the robot logged, `identified` finds friction, noise, drift and model error in it, `peaks` is the
statistics of rare peaks, `thresholds` chooses, `tuned` puts it together and writes the robot file, `judged` tries it
on robots of the crowd.
"""
