"""The documentation site: `site/` is written by hand, the modules beside it write what comes from the sources."""
