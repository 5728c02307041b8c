"""Panels of the window: base class, what the window offers to them, and the events that they receive."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, ClassVar, NamedTuple, Protocol

from psygnal import Signal

from insonify.scene import Scene
from insonify_viewer.core_types import Plan, Simulation
from insonify_viewer.errors import Failure
from insonify_viewer.panels import find_panels
from insonify_viewer.record.comparison.comparison import Comparison
from insonify_viewer.record.comparison.recording_player import RecordingPlayer
from insonify_viewer.record.drape import RecordStrip
from insonify_viewer.record.marked_point import MarkedPoint
from insonify_viewer.record.record import RecordGrowth
from insonify_viewer.record.waterfall_view import WaterfallView
from insonify_viewer.state.inspection import Inspection
from insonify_viewer.state.session import ContactList, Session
from insonify_viewer.state.tow_clock import TowClock
from insonify_viewer.work.jobs import JobList
from insonify_viewer.work.simulator import Simulator


class Place(Enum):
    """Where the window puts a panel."""

    SIDE = "side"
    """A tab at the right side."""
    BELOW = "below"
    """Below scene and record, closed until its button or `Workbench.open_panel` opens it."""
    LEFT = "left"
    """At the left side, closed until its button or `Workbench.open_panel` opens it."""
    WINDOW = "window"
    """A window of its own, opened by its button or by `Workbench.open_panel`."""
    STATUS = "status"
    """The right end of the status bar."""


class Button(NamedTuple):
    """The command that opens a panel, in a menu and, with an icon, among the tools."""

    text: str  # words of the command and its key
    tooltip: str
    shortcut: str
    icon: str = ""  # name of a file in ``resources/icons``; empty if the command stands in the menu alone
    menu: str = "View"  # title of its menu: File, Edit, View, Record, Tools or Help


class Entry(NamedTuple):
    """What the command palette finds."""

    kind: str  # such as Scene or Parameter
    name: str
    about: str  # its tooltip
    do: Callable[[], object]


@dataclass(frozen=True)
class Workbench:
    """What the viewer offers to its panels."""

    session: Session  # the scene and its modelling, both editable
    simulator: Simulator  # the worker thread, for what takes longer than a few milliseconds
    ask_for_file: Callable[[str], str]  # asks for a file for the field at a dotted path; returns its path, or ""
    ask_for_dem: Callable[[Scene], bool]  # asks for a measured bed for a scene, and opens it; whether one was picked
    ask_for_recording: Callable[[], str]  # asks for a recording; returns its path, or ""
    keep_recent: Callable[[str], None]  # puts a file on top of the recent ones
    say: Callable[[str], None]  # shows a sentence in the status bar
    # Shows an error in the status bar, a `Failure` or an exception, with a button that copies details.
    complain: Callable[[Failure | Exception], None]
    copy_details: Callable[[Failure], None]  # copies the details of a `Failure` that is shown elsewhere
    pause: Callable[[], None]  # pauses the tow
    go_to: Callable[[int], None]  # pauses the tow, and puts a ping on top of the record
    # (WaterfallView, WaterfallView) views of the live record and of record A.
    record_views: tuple[WaterfallView, WaterfallView]
    # Puts actions into the menu of the record, so that their keys work in the whole window.
    add_actions: Callable[[Sequence[Any]], None]
    # Lays a `RecordStrip` over the bed of the 3-D view, or shows the bed as it is for None.
    drape: Callable[[RecordStrip | None], None]
    open_panel: Callable[[str], None]  # opens the panel of a name
    inspection: Inspection  # the pinned pixel, the picked place, and what is drawn of both
    tow: TowClock  # counts the pings, and is steered
    jobs: JobList  # runs commands in processes of their own
    recordings: RecordingPlayer  # opens a recording and plays it beside the simulated record
    comparison: Comparison  # record A beside the live record
    contacts: ContactList  # contacts of the session
    open_contacts: Callable[[], None]  # reads contacts from a file that the person names, in place of the present ones
    save_contacts: Callable[[], bool]  # writes the contacts to a file that the person names
    report_contacts: Callable[[], object]  # writes a report of the contacts to a file that the person names
    # Opens (scene, file) at the start of its track; with ``ask=True`` the person is asked first what becomes of
    # unsaved changes. Returns whether the scene was opened.
    open_scene: Callable[..., bool]
    # Puts the camera of the 3-D view on a place (x, y) of the bed, or behind the fish for None, and holds the tow.
    frame: Callable[[tuple[float, float] | None], None]
    # Lights the fields at some dotted paths wherever they are shown, and no others.
    light_fields: Callable[[tuple[str, ...]], None]
    lecture: Callable[[bool], None]  # switches the view for a lecture, full screen and in large type, on or off


class Panel(Protocol):
    """A part of the window with a task of its own: a controller and its widget.

    A panel is made with a `Workbench` before the window shows it. A panel class derives from this one and defines what
    it provides; it overrides the methods of the events it needs, all of which run on the main thread.

    Attributes
    ----------
    name : str
        By which `Workbench.open_panel` finds it; unique.
    title : str
        Of its tab or window.
    place : Place
        Where the window puts it.
    rank : int
        Panels of one place stand in the order of their ranks, then of their names.
    button : Button or None
        Opens the panel, for the places `BELOW`, `LEFT` and `WINDOW`.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    place: ClassVar[Place]
    rank: ClassVar[int] = 100
    button: ClassVar[Button | None] = None
    view: Any  # the widget, unless `widget` is overridden
    strip: Any = None  # QWidget with a few controls in one line, which a lecture shows below the views; None for none

    def __init__(self, workbench: Workbench) -> None: ...

    @property
    def widget(self) -> Any:
        """The QWidget to show; asked for when the window mounts the panel, or first opens it as a window."""
        return self.view

    def entries(self) -> Sequence[Entry]:
        """List what the command palette finds in the panel."""
        return ()

    @property
    def complete(self) -> bool:
        """Whether the panel shows the present state; a snapshot of the window waits for it."""
        return True

    @property
    def at_rest(self) -> bool:
        """Whether nothing is measured in the background; a snapshot of the window waits some seconds for it."""
        return True

    def scene_changed(self, scene: Scene, settled: bool) -> None:
        """Follow an edit of the scene or of its modelling; ``settled`` is False while a slider moves."""

    def scene_refused(self) -> None:
        """Return to the last valid state; the core refused the scene and the session took it back."""

    def record_grown(self, growth: RecordGrowth) -> None:
        """Follow pings that the record on screen has taken over."""

    def plan_made(self, plan: Plan) -> None:
        """Follow the plan by which the pings of the present scene are traced."""

    def point_marked(self, point: MarkedPoint | None) -> None:
        """Follow the point of the record under the mouse."""

    def part_added(self, path: str) -> None:
        """Show a part of the scene that was just added, by its dotted path."""

    def fields_lit(self, paths: tuple[str, ...]) -> None:
        """Light the fields at these dotted paths, bring the first into view, and light no others."""

    def in_lecture(self, large: bool) -> None:
        """Follow the view for a lecture, which shows text large."""

    def opened(self, shown: bool) -> None:
        """Follow the opening and closing of the panel."""

    def closing(self) -> None:
        """Stop all work; the window closes, and takes a window of the panel's own along."""
        if self.place is Place.WINDOW and self.view is not None:
            self.view.close()


class PanelSet(dict[str, Panel]):
    """Every panel that is found, by name, in the order in which the window shows them."""

    # The events of `Panel`, with the arguments of its methods.
    scene_changed = Signal(object, bool)
    scene_refused = Signal()
    plan_made = Signal(object)
    record_grown = Signal(object)
    point_marked = Signal(object)
    part_added = Signal(str)
    fields_lit = Signal(tuple)
    in_lecture = Signal(bool)
    closing = Signal()

    def __init__(self, workbench: Workbench) -> None:
        super().__init__({panel.name: panel(workbench) for panel in find_panels()})
        events = [name for name, event in vars(PanelSet).items() if isinstance(event, Signal)]
        for panel in self.values():
            for name in events:
                getattr(self, name).connect(getattr(panel, name))
            if not panel.widget.accessibleName():
                panel.widget.setAccessibleName(panel.title)
        self._planned: Simulation | None = None  # the one whose plan they show

    @property
    def complete(self) -> bool:
        """Whether every panel shows the present state."""
        return all(panel.complete for panel in self.values())

    @property
    def at_rest(self) -> bool:
        """Whether no panel measures anything in the background."""
        return all(panel.at_rest for panel in self.values())

    def show_growth(self, growth: RecordGrowth) -> None:
        """Announce new pings, after another plan if they are traced by one."""
        simulation = growth.answer.simulation
        if growth.current and simulation is not self._planned:
            self._planned = simulation
            self.plan_made.emit(simulation.plan)
        self.record_grown.emit(growth)
