"""Checks of the FMUs that `make fmus ALL=1` cross-builds: see __main__.py."""
