"""Wheels, source archive and bills of materials in dist/: see __main__.py and README.md."""
