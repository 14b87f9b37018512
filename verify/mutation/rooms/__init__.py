"""Mutation testing of the rooms outside c_core, in C++ and Python: all mutants in one build. See
docs/site/explanation/mutants.md."""
