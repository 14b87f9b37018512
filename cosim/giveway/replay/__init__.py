"""`giveway replay`: a log of a robot's wheels, played through the controller that the FMUs have."""
