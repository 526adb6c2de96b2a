"""Results in the arrays of other libraries: labels of xarray and pandas, lazy arrays of dask."""
