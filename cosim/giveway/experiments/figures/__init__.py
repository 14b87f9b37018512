"""Figures that a single experiment draws; `giveway.report` has those of any run."""
