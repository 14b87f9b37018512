"""Mutation testing of c_core: small faults, one at a time, that its tests have to see. See verify/README.md."""
