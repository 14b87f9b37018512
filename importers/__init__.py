"""The FMUs in importers that others wrote: `make importers`."""
