"""The studio: one HTML file in which a collision is computed while its design is dragged.

The page is bundled from `web/src/studio`; this room fills in the tables of variables, robots and body regions.
"""
