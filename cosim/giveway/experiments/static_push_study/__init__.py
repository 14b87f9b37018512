"""Experiment 5.1: static pushes on many simulated robots.

`placements` says where is pushed, `robots` on what, `trials` runs it; `study` is all of it, `groups` judges fours of
pushes as the paper did, `statics` asks the static model which parameter would have to be what.
"""
