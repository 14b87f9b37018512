"""The batch library in JavaScript engines: what tests and benchmarks need of them."""
