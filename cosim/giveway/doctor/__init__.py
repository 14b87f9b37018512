"""`giveway doctor`: what is installed here, and whether a run has the bits that it should have."""
