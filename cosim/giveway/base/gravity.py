"""Gravity, as the plant has it; a test holds both together."""

__all__ = ["GRAVITY_MPS2"]

GRAVITY_MPS2 = 9.81
