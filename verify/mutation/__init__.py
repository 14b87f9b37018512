"""Mutation testing of c_core: small faults are planted one at a time, and the tests have to see them. See
docs/site/explanation/mutants.md."""
