"""The crowd: the reflex judged on many robots that its controller knows only by the robot file.

`population` states how the robots differ, `hits` what happens to them, `judged` the definitions by which that is
judged, `table` what is printed. `giveway crowd` runs all of it.
"""
