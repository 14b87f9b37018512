"""The ladder of `make verify`: every claim of c_core/README.md, checked by a tool of its own."""
