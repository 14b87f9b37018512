"""Commented files to start from: `giveway new scenario | study`."""
