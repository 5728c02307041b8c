"""Actions in lessons."""

from insonify_viewer.viewer import Viewer
from soak.actions import Random, Steps, action
from soak.input import pick


@action(1.0)
def take_lesson(viewer: Viewer, random: Random) -> Steps:
    """Take a few steps of a lesson, now and then back, answer some of their questions, and mostly leave it."""
    viewer.window.open_panel("lessons")
    panel = viewer.panels["lessons"]
    page = panel.view.page
    panel.start(pick(panel._lessons, random).name)
    yield float(random.choice([100.0, 1500.0]))
    for _ in range(random.integers(1, 8)):
        if page.ask.isVisible() and random.random() < 0.5:
            page.ask.unknown.click()
        page.show_me.click()
        yield float(random.choice([20.0, 800.0]))
        (page.next if random.random() < 0.8 else page.back).click()
        yield float(random.choice([20.0, 800.0]))
    if random.random() < 0.7:
        page.left.click()
        yield 50.0
