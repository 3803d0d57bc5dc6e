"""Many cases of the law or of the UMAT, through Dask where they are many: a grid or a list in, one table out, resumable."""
