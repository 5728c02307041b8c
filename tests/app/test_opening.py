"""The window opens before libraries are loaded that only the record or the 3-D view needs."""

import subprocess
import sys

from commands import PATIENCE

OPENED = """
import sys
from insonify.scene import load_scene
from insonify_viewer.application import has_opengl, make_application
from insonify_viewer.viewer import Viewer
application = make_application()
viewer = Viewer(load_scene("default"), accelerated=has_opengl())
viewer.window.show()
application.processEvents()
loaded = sorted({"numba", "pyvista", "matplotlib", "xarray", "pandas"} & set(sys.modules))
viewer.window.close()
sys.exit(f"loaded {loaded}" if loaded else 0)
"""


def test_the_window_opens_before_kernels_and_three_dimensions_are_loaded():
    """Numba alone takes a third of a second to import."""
    done = subprocess.run([sys.executable, "-c", OPENED], capture_output=True, text=True, check=False, timeout=PATIENCE)
    assert (done.returncode, done.stderr) == (0, "")
