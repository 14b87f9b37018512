"""Common to all rooms: errors and checks, units, atomic files, words and tables for a terminal.

Nothing here depends on robots or FMUs; `native` locates the native parts.
"""
