"""Colours and matplotlib settings that all figures share."""

from __future__ import annotations

__all__ = ["BUMPER_LABELS", "COLOURS", "STYLE", "TRUTH_COLOUR"]

# What figures call a bumper, and its colour.
_BUMPERS = {
    "none": ("no bumper", "#c8500a"),
    "spring": ("spring bumper", "#0b64a8"),
    "magnetic": ("magnetic spring bumper", "#0a8a63"),
    "foam": ("foam bumper", "#8a5a9e"),
    "gas": ("gas spring bumper", "#2a9d9a"),
    "damper": ("damper bumper", "#a8324a"),
    "series": ("bumper of two springs in series", "#5c6f1f"),
    "lever": ("bumper with a lever", "#b08400"),
    "table": ("bumper as measured", "#4a5568"),
}
BUMPER_LABELS = {bumper: label for bumper, (label, _) in _BUMPERS.items()}
COLOURS = dict(_BUMPERS.values())
TRUTH_COLOUR = "#8a8f98"
STYLE = {
    "font.family": "sans-serif",
    "font.size": 9.5,
    "axes.grid": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#9aa0a8",
    "axes.labelcolor": "#2b2f36",
    "axes.titlesize": 10,
    "axes.titlelocation": "left",
    "grid.color": "#e4e7eb",
    "grid.linewidth": 0.7,
    "lines.linewidth": 1.5,
    "legend.frameon": False,
    "xtick.color": "#555b65",
    "ytick.color": "#555b65",
    "svg.fonttype": "none",  # text stays text: smaller, selectable, in the reader's font
    "svg.hashsalt": "giveway",  # the same run gives the same bytes
}
