"""What computes items of jobs: a pool of runners on this machine, or a Dask cluster."""
