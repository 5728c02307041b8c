"""Engine of surveys and data sets: jobs named by their content, run by dask.distributed, done whole or not at all."""
