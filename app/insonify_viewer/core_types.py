"""Types of the core, for annotations alone: their modules load Numba or Matplotlib, and the window opens before."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from insonify.accuracy.charts.kinds.accuracy import AccuracyChart as AccuracyChart
    from insonify.accuracy.charts.kinds.accuracy import AccuracyRow as AccuracyRow
    from insonify.display.normalisation import LevelBed as LevelBed
    from insonify.display.ray_diagram.diagram import RayDiagram as RayDiagram
    from insonify.explanation.cross_section import CrossSection as CrossSection
    from insonify.explanation.listeners import Listener as Listener
    from insonify.explanation.pixel import PixelExplanation as PixelExplanation
    from insonify.explanation.sonar_equation import Level as Level
    from insonify.explanation.sonar_equation import SonarEquation as SonarEquation
    from insonify.packing.packed_scene import PackedScene as PackedScene
    from insonify.planning import Plan as Plan
    from insonify.planning import PlanEntry as PlanEntry
    from insonify.simulation import Simulation as Simulation
    from insonify.terrain import AnyGround as AnyGround
    from insonify.terrain.ground import Ground as Ground
    from insonify.tow.line import TowLine as TowLine
    from insonify.tracers.labels import RecordLabels as RecordLabels
else:

    def __getattr__(name: str) -> Any:
        """Stand for each of them while the program runs."""
        return Any
