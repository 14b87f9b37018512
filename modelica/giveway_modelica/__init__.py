"""Tools around the Modelica package: its parameter record, lint, check of units, and comparison with the FMUs."""
