"""Firmware: the C library with a robot's numbers, tested on a recorded collision."""
