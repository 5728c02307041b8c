"""Plans: what is chosen, said and kept."""

import math
import re

import numpy as np
import pytest

from insonify.acoustics.water import estimate_refraction
from insonify.packing.packed_scene import Model, pack
from insonify.planning import MOST_PLANES, plan, probe
from insonify.planning.choices import CHOICES
from insonify.planning.choices.base import Case
from insonify.planning.probe import FEW, MOST
from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.tracers import sweep

DEFAULT = load_scene("default")
THERMOCLINE = {"water": {"kind": "profile", "depth": [0.0, 14.0, 22.0], "sound_speed": [1510.0, 1510.0, 1500.0]}}
BARE = edit(DEFAULT, {"targets": []})


def test_a_knife_or_a_bed_without_detail_needs_one_plane():
    knife = plan(edit(DEFAULT, {"sonar.beam": "knife"}))
    assert (knife.method, knife.planes) == ("sweep", 1)
    assert any("no width" in line for line in knife.lines())
    assert plan(edit(BARE, {"seabed.relief": "flat"})).planes == 1


@pytest.mark.parametrize(
    ("less", "more"),
    [
        ({}, {"sonar.beam.width": 2.5}),
        ({}, {"sonar.range": 74.0}),
        ({}, {"seabed.relief.beta": 1.0}),
        ({}, {"seabed.relief.rms": 0.2}),
        ({"seabed.spacing": 0.2}, {"seabed.spacing": 0.1}),
        ({"targets": [{"kind": "sphere", "position": [0, 20], "material": "silt"}]}, {"targets.0.material": "steel"}),
    ],
)
def test_more_detail_across_a_wider_beam_needs_more_planes(less, more):
    before = edit(BARE, less)
    assert plan(edit(before, more)).planes > plan(before).planes


def test_a_finer_tolerance_never_takes_fewer_planes_and_all_are_in_bounds():
    # Over the same nodes: with fewer of them more planes may be cheaper.
    same = {"spacing": "1"}
    counts = [plan(DEFAULT, tolerance, forced=same).planes for tolerance in np.geomspace(0.5, 1e-3, 8)]
    assert counts == sorted(counts)
    assert 1 <= plan(DEFAULT, 10.0).planes <= counts[0]
    assert plan(DEFAULT, 1e-7).planes == MOST_PLANES


@pytest.mark.parametrize("changes", [{}, {"targets": []}, {"seed": 5, "seabed.relief.rms": 0.1}])
def test_the_loud_echo_of_the_surface_itself_changes_nothing_else(changes):
    # Its 20 m above the sonar lie beyond 1.4 altitudes, where errors are measured.
    loud = plan(edit(DEFAULT, {"water.surface": "flat"} | changes)).model
    silent = plan(edit(DEFAULT, {"water.surface": {"kind": "flat", "surface_echo": False}} | changes)).model
    assert silent == loud._replace(ways=loud.ways - {"surface_echo"})
    assert silent.ways


def test_too_few_planes_comb_a_small_target_and_the_plan_lays_more_across_it():
    # A ball of 5 cm in a beam 1.7 m wide: a ping hears it where a plane meets it, and not in between.
    ball = {"kind": "sphere", "position": [5.0, 38.0], "radius": 0.05}
    scene = edit(DEFAULT, {"targets": [ball], "seabed.relief": "flat", "sonar.beam.width": 2.5, "track.speed": 0.1})
    simulation = prepare(scene)
    assert simulation.plan.settings["across"] >= 4
    poses = simulation.poses(np.arange(440, 560, 2))
    near = math.hypot(38.0, 10.0 - 0.05) - 0.05
    echo = slice(int(near / 0.05), int(near / 0.05) + 2)
    settings = {"planes": 4}, simulation.plan.settings
    few, planned = (sweep.trace(simulation.arrays, poses, **each)[:, 0, echo].sum(axis=1) for each in settings)
    bed = sweep.trace(prepare(edit(scene, {"targets": []})).arrays, poses)[0, 0, echo].sum()
    assert (few / bed - 1.0).std() > 5.0 * (planned / bed - 1.0).std()


def test_the_cost_of_a_ping_includes_its_scatterers():
    """Blocks of pings that the viewer traces between two looks at what is asked are cut by it."""
    dense = edit(DEFAULT, {"receiver.speckle": "coherent", "receiver.speckle.density": 2e4})
    made = plan(dense)
    waves = made.entry("speckle").cost
    assert waves > 10.0 * (made.cost - waves) > 0.0


@pytest.mark.parametrize("method", ["sweep", "march", "rays"])
def test_a_method_asked_for_is_taken_and_explained(method):
    chosen = plan(DEFAULT, 0.5, method=method)
    assert chosen.method == method
    assert "as requested" in "\n".join(chosen.lines())
    assert all(len(line) < 200 and "\n" not in line for line in chosen.lines())


def test_a_finer_tolerance_takes_more_rays_and_shorter_steps():
    assert plan(DEFAULT, 0.01, method="rays").settings["rays"] > plan(DEFAULT, 0.1, method="rays").settings["rays"]
    small = edit(DEFAULT, {"sonar.bins": 100})
    assert plan(small, 0.1, method="march").settings["step"] < plan(small, 1.0, method="march").settings["step"]


@pytest.mark.parametrize("tolerance", [0.5, 0.2, 0.01, 1e-4, 1e-9])
@pytest.mark.parametrize("method", ["march", "rays"])
def test_models_of_any_fineness_are_judged_by_little_work(method, tolerance, monkeypatch):
    traced = []

    def trace(packed, model, poses):
        traced.append(poses.x.size * probe.work_of(packed, model))
        return whole(packed, model, poses)

    whole = probe.trace_model
    monkeypatch.setattr(probe, "trace_model", trace)
    plan(DEFAULT, tolerance, method=method)
    assert max(traced) <= MOST
    assert sum(traced) <= 2.5 * MOST  # each finer model takes twice the work


@pytest.mark.parametrize(("method", "field", "steps"), [("march", "step", -2), ("rays", "rays", 3)])
def test_errors_predicted_beyond_those_measured_are_near_them(method, field, steps, monkeypatch):
    case = Case(pack(edit(DEFAULT, {"sonar.bins": 200})), method, {})
    choice = next(one for one in CHOICES if one.field == field)
    start = Model(method, rays=200 if method == "march" else 8000, step=0.1 * (method == "march"))
    fine = start._replace(**{field: getattr(start, field) * 2**steps})
    measured = choice.error(case, fine)
    monkeypatch.setattr(probe, "MOST", FEW * case.work(start._replace(rays=2 * start.rays)) * 2.0)
    assert choice.error(case, fine) == pytest.approx(measured, rel=0.5)
    assert choice.error(case, fine) != measured


COHERENT = {"receiver.speckle": "coherent"}
SECTION = {
    "water": {
        "kind": "section",
        "distance": [0.0, 9.0],
        "depth": [0.0, 30.0],
        "sound_speed": [[1520, 1500], [1500, 1500]],
    }
}


@pytest.mark.parametrize(
    ("changes", "options", "sentence"),
    [
        *(({}, {"tolerance": share}, r"^tolerance: .* give a share such as 0\.03$") for share in (0.0, -0.1)),
        *(({}, {"tolerance": share}, r"^tolerance: .* give a share such as 0\.03$") for share in (math.nan, math.inf)),
        *(
            (COHERENT, {"method": method}, rf"^receiver\.speckle: 'coherent' .* '{method}'; take another speckle$")
            for method in ("march", "rays")
        ),
        (COHERENT | {"sonar.bounces": 2}, {}, r"^receiver\.speckle: 'coherent' .*sonar\.bounces is 2\); take"),
        (COHERENT | THERMOCLINE, {}, r"^receiver\.speckle: 'coherent' sums waves along straight paths.*'uniform'$"),
        (SECTION, {"method": "sweep"}, r"^method: 'sweep' refracts sound by depth only.*take rays$"),
    ],
)
def test_what_cannot_be_planned_is_refused(changes, options, sentence):
    with pytest.raises(SceneError, match=sentence):
        plan(edit(DEFAULT, changes), **options)


def test_scatterers_that_interfere_are_swept_and_water_that_differs_along_the_level_is_for_rays():
    coherent = plan(edit(DEFAULT, COHERENT))
    assert coherent.method == "sweep"
    assert coherent.entry("speckle").choice == "scatterers"
    assert plan(edit(DEFAULT, SECTION)).method == "rays"


def test_pings_farther_apart_than_the_beam_is_wide_are_remarked_on():
    sparse = edit(DEFAULT, {"track.speed": 20.0})
    assert any("at every range" in line for line in plan(sparse).lines())
    near = next(line for line in plan(DEFAULT).lines() if line.startswith("pings"))
    assert f"up to {0.2 / (2 * math.sin(math.radians(0.5))):.3g} m" in near
    dense = edit(DEFAULT, {"track.speed": 1.0})
    assert not any(line.startswith("pings") for line in plan(dense).lines())


def test_a_tow_that_never_comes_near_the_bed_is_refused():
    away = edit(load_scene("real-bed"), {"track.start": [900.0, 0.0], "track.pings": 4})
    with pytest.raises(
        SceneError, match=r"^track\.start: .* never comes within 75 m of the bed.*start it over the bed$"
    ):
        prepare(away)


def test_sound_that_bends_is_followed_and_what_it_matters_is_said():
    entry = plan(edit(DEFAULT, THERMOCLINE)).entry("bending")
    assert (entry.choice, entry.modelled) == ("refraction", True)
    measured = r"on \d+ pings straight rays are [\d.e+]+ % from refracted ones"
    assert re.fullmatch(rf"tables of apparent positions; {measured}", entry.reason)
    entry = plan(edit(DEFAULT, THERMOCLINE)).entry("rays")
    assert re.fullmatch(
        r"where several eigenrays or none reach a place, a ping is traced with \d+ rays per side", entry.reason
    )
    simulation = prepare(edit(DEFAULT, THERMOCLINE))
    assert simulation.plan.method == "sweep"
    assert simulation.arrays.water.bent
    entry = plan(edit(DEFAULT, THERMOCLINE), method="rays").entry("bending")
    assert entry.reason.startswith("rays follow circular arcs; on ")
    assert plan(DEFAULT).entry("bending") is None


def test_bending_that_matters_less_than_the_tolerance_is_left_out():
    scene = edit(DEFAULT, {"water": {"kind": "profile", "depth": [0.0, 40.0], "sound_speed": [1500.0, 1500.05]}})
    entry = plan(scene).entry("bending")
    assert (entry.choice, entry.modelled) == ("refraction", False)
    assert re.fullmatch(r"on \d+ pings straight rays are [\d.]+ % from refracted ones", entry.reason)
    assert not prepare(scene).arrays.water.bent
    # What is left out is less than the tolerance.
    precise = prepare(scene, tolerance=1e-6)
    assert precise.arrays.water.bent
    pings = np.arange(3)
    one, other = prepare(scene).arrays, precise.arrays
    poses = precise.poses(pings)
    left_out = compare_records(other, poses, sweep.trace(one, poses), sweep.trace(other, poses)).beyond
    assert 0.0 < left_out < 0.03


@pytest.mark.parametrize("gradient", [0.05, -0.4])
def test_the_shift_of_the_farthest_echo_is_that_of_bent_rays(gradient):
    # Two points of one gradient: τ = (2/|g|) asinh(|g| D / (2 √(c0 c1))).
    speeds = [1500.0 - 20.0 * gradient, 1500.0 + 10.0 * gradient]
    scene = edit(DEFAULT, {"water": {"kind": "profile", "depth": [0.0, 30.0], "sound_speed": speeds}})
    time = 2.0 / abs(gradient) * math.asinh(abs(gradient) * 50.0 / (2.0 * math.sqrt(1500.0 * speeds[1])))
    assert estimate_refraction(scene).shift == pytest.approx(abs(1500.0 * time - 50.0), rel=0.03)
