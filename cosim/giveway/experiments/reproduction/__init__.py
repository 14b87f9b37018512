"""The paper in one run: what every experiment finds (`findings`), all of them (`reproduce`), and its `page`."""
