"""``python -m giveway`` is the command line."""

from giveway.cli import main

main()
