"""The one exception of this package."""


class TableError(Exception):
    """A variable table or robot file that cannot be used; the message names file, variable and key."""
