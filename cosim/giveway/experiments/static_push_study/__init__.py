"""Experiment 5.1: static pushes on many simulated robots.

`placements` has the points of the pushes, `robots` the robots, `trials` runs them; `study` is the whole study, `groups`
judges groups of four pushes as the paper did, `statics` finds with the static model which parameter values would
explain the paper's numbers.
"""
