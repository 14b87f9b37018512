"""Parts of the work on other processes and machines: workers of Dask, accepted by what they compute."""
