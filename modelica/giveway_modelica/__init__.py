"""Tools around the Modelica package: its parameter record, its lint, its check of units, its comparison with the FMUs."""
