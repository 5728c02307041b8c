"""Actions on recordings beside the scene."""

from insonify_viewer.viewer import Viewer
from soak.actions import Random, Steps, action
from soak.input import wheel


@action(1.0)
def look_at_recording(viewer: Viewer, random: Random) -> Steps:
    """Open a recording, look along it while it is read or played, and mostly close it again."""
    viewer.window.open_recording.trigger()
    yield float(random.choice([20.0, 1500.0]))
    for _ in range(random.integers(0, 6)):
        viewer.recordings.look_back(int(random.integers(-40, 40)))
        wheel(viewer.window.waterfall, int(random.choice([-120, 120])))
        yield 100.0
    if random.random() < 0.7:
        viewer.recordings.close()
        yield 50.0
