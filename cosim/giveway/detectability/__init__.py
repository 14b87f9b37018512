"""What a robot can feel (`giveway detectability`): the smallest push and impulse that it notices, and what limits them.

`robots` draws robots that differ from their file, `probes` says how each is pushed, `search` halves the force until it
is no longer noticed, `alarms` lets the same robots drive untouched, `causes` takes away one limit after the other,
`found` puts all of it together; `record` and `figure` write it.
"""
