"""Results in the arrays of other libraries: labels of xarray and pandas, later computation by dask."""
