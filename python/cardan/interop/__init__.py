"""Results in the arrays of other libraries: labels of xarray, later computation by dask."""
