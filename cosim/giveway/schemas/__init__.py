"""`giveway schema`: JSON Schema of the files that giveway reads and writes, for editors and other programs."""
