"""What a viewer offers to the panels of its window."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from insonify.scene import Scene
from insonify_viewer.panels.panel import Workbench

if TYPE_CHECKING:
    from insonify_viewer.viewer import Viewer


def make_workbench(viewer: Viewer) -> Workbench:
    """Return what the panels of a viewer are made with."""

    def open_scene(scene: Scene, file: str, *, ask: bool) -> bool:
        if ask and not viewer.saving.may_leave():
            return False
        viewer.open(scene, file)
        return True

    def add_actions(actions: Sequence[Any]) -> None:
        viewer.window.addActions(actions)
        viewer.window.menus.group("Record", actions)

    return Workbench(
        session=viewer.session,
        simulator=viewer.simulator,
        files=viewer.files,
        say=viewer.window.say,
        complain=viewer.window.complain,
        copy_details=viewer.window.status.copy_details,
        pause=lambda: viewer.run(False),
        go_to=viewer.go_to,
        record_views=(viewer.window.waterfall, viewer.window.record_a),
        add_actions=add_actions,
        drape=lambda strip: viewer.seabed.drape(strip),
        open_panel=viewer.window.open_panel,
        inspection=viewer.inspection,
        jobs=viewer.jobs,
        recordings=viewer.recordings,
        comparison=viewer.comparison,
        contacts=viewer.contacts,
        open_contacts=lambda: viewer.opening.ask_for_contacts(),
        save_contacts=viewer.saving.save_contacts,
        open_scene=open_scene,
        light_fields=lambda paths: viewer.panels.tell("fields_lit", paths),
        project=viewer.window.projector.setChecked,
    )
