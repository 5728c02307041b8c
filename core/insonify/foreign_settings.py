"""Settings of libraries in files of the current folder, which may be a stranger's: they are ignored."""

import os

NUMBA, MATPLOTLIB = ".numba_config.yaml", "matplotlibrc"
os.environ.setdefault("NCRCENV_IGNORE", "1")  # netCDF reads .ncrc, .daprc and .dodsrc
_ignored: set[str] = set()
_exists = os.path.exists


def ignore_settings(name: str) -> None:
    """Hide a file of the current folder from a library that looks for it as it is imported, and later on."""
    # Both libraries ask `os.path.exists` for the bare name, and have no option to leave the file out. Numba could end
    # with a traceback or interpret kernels, Matplotlib could look for an installation of TeX.
    _ignored.add(name)
    os.path.exists = lambda path: path not in _ignored and _exists(path)
