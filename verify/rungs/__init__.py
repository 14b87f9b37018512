"""One file per rung, in the order of their numbers. See verify/README.md."""
