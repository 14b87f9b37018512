"""What every room stands on: errors and checks, units, files that appear whole, words and tables for a terminal.

Nothing here knows robots or FMUs; `native` says where the native parts lie.
"""
