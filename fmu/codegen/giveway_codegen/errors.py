"""The one exception of this package."""


class TableError(Exception):
    """An unusable variable table or robot file; the message names file, variable and key."""
