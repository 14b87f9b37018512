"""The closed loop against MuJoCo: the controller FMU drives a robot that another simulator computes.

`mjcf` makes the robot from the testbed's parameters, `electronics` puts the drives of our testbed around it, `loop`
couples both with the controller. `closed_form` holds the robot against formulas, `situations` are what happens to it,
`table` says what the reflexes did. `undisturbed` writes logs of the robot, on which `tuned` tries `giveway tune`.
"""
