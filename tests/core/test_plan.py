"""Plans: what is chosen, said and kept, of any scene too, what is forced, and the pings on which they measure."""

import math
import re
from functools import lru_cache
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from drawn_scenes import scenes
from insonify.explanation.plan_page import write_plan_page
from insonify.packing.packed_scene import Model, pack
from insonify.planning import MOST_PLANES, plan, probe
from insonify.planning.case import Case
from insonify.planning.effects import BY_SUBJECT
from insonify.planning.plan_entries import percent
from insonify.planning.probe import MEASURED, MOST, add_loud_pings, trace_model
from insonify.planning.probe_pings import SPREAD, choose_probe_pings, spread_over_track
from insonify.planning.selection import check_request, choose_for_case, choose_model
from insonify.scene import Scene, SceneError, edit, load_scene
from insonify.simulation import prepare, simulate
from insonify.statistics.record_errors import compare_records
from insonify.terrain import build_ground
from insonify.tow.poses import make_poses
from insonify.tracers import sweep
from insonify.tracers.azimuth_fan import lay_planes
from insonify.tracers.plane_counts import AS_ESTIMATED, Trust, empty_squares
from insonify.tracers.target_planes import find_pings_met
from random_scenes import planned_scene

DEFAULT = load_scene("default")
THERMOCLINE = {"water": {"kind": "profile", "depth": [0.0, 14.0, 22.0], "sound_speed": [1510.0, 1510.0, 1500.0]}}
BARE = edit(DEFAULT, {"targets": []})


@pytest.fixture(scope="module")
def usual():
    """The plan of the default scene."""
    return plan(DEFAULT)


def test_a_knife_or_a_bed_without_detail_needs_one_plane_and_a_plain_scene_the_bare_sweep():
    knife = plan(edit(DEFAULT, {"sonar.beam": "knife"}))
    assert (knife.method, knife.planes) == ("sweep", 1)
    assert any("no width" in line for line in knife.lines())
    assert plan(edit(BARE, {"seabed.relief": "flat"})).planes == 1
    simulation = prepare(edit(BARE, {"sonar.beam": "knife"}))
    assert (simulation.plan.method, simulation.plan.settings) == ("sweep", {"planes": 1})
    bare = simulation.reduced
    assert (bare.water.bent, bare.multipath.enabled, bare.bounces, bare.solids.shape.size) == (False, False, 0, 0)
    assert bare.bed.heights is simulation.arrays.bed.heights


@pytest.mark.parametrize(
    ("less", "more", "setting"),
    [
        ({}, {"sonar.beam.width": 2.5}, "planes"),
        ({}, {"sonar.range": 74.0}, "planes"),
        ({}, {"seabed.relief.beta": 1.0}, "planes"),
        ({}, {"seabed.relief.rms": 0.2}, "planes"),
        ({"seabed.spacing": 0.2}, {"seabed.spacing": 0.1}, "planes"),
    ],
)
def test_more_detail_across_a_wider_beam_needs_more_planes(less, more, setting):
    before = edit(BARE, less)
    assert getattr(plan(edit(before, more)).model, setting) > getattr(plan(before).model, setting)


def test_a_glint_takes_more_planes_of_its_own_pings():
    def planes(material):
        ball = {"kind": "sphere", "position": [0, 20], "material": material}
        simulation = prepare(edit(BARE, {"targets": [ball], "seabed.relief": "flat"}))
        return simulation.trace_pings(simulation.poses(np.arange(0, 12, 2))).planes

    dull, bright = planes("silt"), planes("steel")
    assert (bright >= dull).all()
    assert bright.sum() > dull.sum()
    assert (bright[3:] == 1).all()  # the level bed beside it is alike across the beam


@pytest.mark.parametrize(
    "changes",
    [
        {
            "sonar": {"beam": {"kind": "fan", "width": 1.25, "squint": -7.5}, "range": 18.0, "bins": 240}
            | {"vertical": {"kind": "fan", "tilt": 26.0, "width": 26.0}},
            "track.altitude": 1.0,
        },
        {"sonar.beam": {"kind": "fan", "width": 0.5, "squint": -9.5}},
        {"track.motion": {"kind": "pitch", "amplitude": 9.5, "period": 20.0}},
    ],
    ids=["vertical lobe", "squint", "pitch"],
)
def test_one_plane_stands_for_a_beam_over_a_level_bed_only_if_its_planes_are_alike(changes):
    level = {"seabed.relief": "flat", "targets": [], "track.pings": 64}
    simulation = prepare(edit(DEFAULT, level | changes), tolerance=0.01)
    poses = simulation.poses(np.arange(0, 64, 8))
    found, right = simulation.trace(poses), sweep.trace(simulation.reduced, poses, planes=256)
    errors = compare_records(simulation.arrays, poses, found, right)
    assert errors.beyond <= 0.01
    assert errors.all_bins <= 0.01


def test_what_planes_estimate_is_trusted_apart_in_pings_that_meet_targets():
    simulation = prepare(load_scene("targets"))
    poses, trust = simulation.poses(np.arange(0, 460, 20)), Trust(1.0, 2.0)
    both = [empty_squares(poses.x.size) for _ in range(2)]
    for squares, own in zip(both, (AS_ESTIMATED, trust)):
        sweep.trace(simulation.reduced, poses, planes=4, across=4, squares=squares, trust=own)
    met = find_pings_met(simulation.reduced, poses, lay_planes(simulation.reduced, poses, 4, 4))
    assert 0 < met.sum() < met.size
    np.testing.assert_allclose(both[1][..., 0], both[0][..., 0] * np.where(met, 4.0, 1.0)[:, None, None])
    np.testing.assert_array_equal(both[1][..., 1], both[0][..., 1])


@pytest.mark.parametrize("planes", [5, 7, 12])
def test_the_error_of_any_number_of_planes_follows_from_few_and_many(planes):
    packed = pack(load_scene("ripples"))
    made = choose_model(packed, 0.03, "auto", {"planes": str(planes)})
    assert made.entry("planes").reason.startswith("4 and 16 planes differ by")
    poses = make_poses(packed.scene, packed.ground, spread_over_track(packed.scene, 16))
    some, many = (trace_model(packed, made.model._replace(planes=count), poses) for count in (planes, 256))
    missed = compare_records(packed.arrays, poses, some, many).beyond
    assert 0.7 * missed < made.entry("planes").error < 1.4 * missed


def test_a_finer_tolerance_takes_more_rays_and_shorter_steps_and_never_fewer_planes_which_are_in_bounds():
    assert plan(DEFAULT, 0.01, method="rays").settings["rays"] > plan(DEFAULT, 0.1, method="rays").settings["rays"]
    small = edit(DEFAULT, {"sonar.bins": 100})
    assert plan(small, 0.1, method="march").settings["step"] < plan(small, 1.0, method="march").settings["step"]
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


@pytest.mark.parametrize("method", ["sweep", "march", "rays"])
def test_a_method_asked_for_is_taken_and_explained(method):
    chosen = plan(DEFAULT, 0.5, method=method)
    assert chosen.method == method
    assert "as requested" in "\n".join(chosen.lines())
    assert all(len(line) < 200 and "\n" not in line for line in chosen.lines())


@pytest.mark.parametrize("tolerance", [0.5, 0.01, 1e-9])
@pytest.mark.parametrize("method", ["march", "rays"])
def test_models_of_any_fineness_are_judged_by_little_work(method, tolerance, monkeypatch):
    trace = Mock(wraps=probe.trace_model)
    monkeypatch.setattr(probe, "trace_model", trace)
    plan(DEFAULT, tolerance, method=method)
    work = [poses.x.size * probe.work_of(packed, model) for (packed, model, poses), _ in trace.call_args_list]
    assert max(work) <= MOST
    assert sum(work) <= 2.5 * MOST  # each finer model takes twice the work


@pytest.mark.parametrize(("method", "field", "steps"), [("march", "step", -2), ("rays", "rays", 3)])
def test_errors_predicted_beyond_those_measured_are_near_them(method, field, steps, monkeypatch):
    case = Case(pack(edit(DEFAULT, {"sonar.bins": 200})), method, {})
    start = Model(method, rays=200 if method == "march" else 8000, step=0.1 * (method == "march"))
    fine = start._replace(**{field: getattr(start, field) * 2**steps})
    measured = BY_SUBJECT[field].error(case, fine)
    monkeypatch.setattr(probe, "MOST", MEASURED * case.work(start._replace(rays=2 * start.rays)) * 2.0)
    assert BY_SUBJECT[field].error(case, fine) == pytest.approx(measured, rel=0.5)
    assert BY_SUBJECT[field].error(case, fine) != measured


COHERENT = {"receiver.speckle": "coherent"}
SECTION = {"water": {"kind": "section"}}
WRONG_TOLERANCE = r"^tolerance: .* give a share such as 0\.03$"


@pytest.mark.parametrize(
    ("changes", "options", "sentence"),
    [
        *(({}, {"tolerance": share}, WRONG_TOLERANCE) for share in (0.0, -0.1, math.nan, math.inf)),
        (COHERENT, {"method": "march"}, r"^receiver\.speckle: 'coherent' .* 'march'; take another speckle$"),
        (COHERENT, {"method": "rays"}, r"^receiver\.speckle: 'coherent' .* 'rays'; take another speckle$"),
        (COHERENT | {"sonar.bounces": 2}, {}, r"^receiver\.speckle: 'coherent' .*sonar\.bounces is 2\); take"),
        (COHERENT | THERMOCLINE, {}, r"^receiver\.speckle: 'coherent' sums waves along straight paths.*'uniform'$"),
        (SECTION, {"method": "sweep"}, r"^method: 'sweep' refracts sound by depth only.*take rays$"),
        *(
            ({}, {"forced": {subject: choice}}, sentence)
            for subject, choice, sentence in (
                ("colour", "red", r"^model: 'colour' is not a choice of a plan; choose one of method, planes, "),
                ("planes", "many", r"^model planes: 'many' is not valid; give a whole number from 1 to 512$"),
                ("planes", "2.5", r"^model planes: '2.5' is not valid; give a whole number from 1 to 512$"),
                ("step", "nan", r"^model step: 'nan' is not valid; give a number from 1e-06 to 10000$"),
                ("targets", "some", r"^model targets: 'some' is not known; choose one of on, off$"),
                ("method", "magic", r"^method: 'magic' is not known; choose one of auto, sweep, march, rays$"),
            )
        ),
    ],
)
def test_what_cannot_be_planned_is_refused(changes, options, sentence):
    with pytest.raises(SceneError, match=sentence):
        plan(edit(DEFAULT, changes), **options)


def test_scatterers_that_interfere_are_swept_at_their_cost_and_water_that_differs_along_the_level_is_for_rays():
    """Blocks of pings that the viewer traces between two looks at what is asked are cut by the cost of a ping."""
    coherent = plan(edit(DEFAULT, COHERENT | {"receiver.speckle.density": 2e4}))
    waves = coherent.entry("speckle")
    assert (coherent.method, waves.choice) == ("sweep", "scatterers")
    assert waves.cost > 10.0 * (coherent.cost - waves.cost) > 0.0
    assert plan(edit(DEFAULT, SECTION)).method == "rays"


def test_pings_farther_apart_than_the_beam_is_wide_are_remarked_on(usual):
    sparse = edit(DEFAULT, {"track.speed": 20.0})
    assert any("at every range" in line for line in plan(sparse).lines())
    near = next(line for line in usual.lines() if line.startswith("pings"))
    assert f"up to {0.2 / (2 * math.sin(math.radians(0.5))):.3g} m" in near
    dense = edit(DEFAULT, {"track.speed": 1.0})
    assert not any(line.startswith("pings") for line in plan(dense).lines())


def test_sound_that_bends_is_followed_and_what_it_matters_is_said(usual):
    simulation = prepare(edit(DEFAULT, THERMOCLINE))
    entry = simulation.plan.entry("bending")
    assert (entry.choice, entry.modelled) == ("refraction", True)
    measured = r"on \d+ pings straight rays are [\d.e+]+ % from refracted ones"
    assert re.fullmatch(rf"tables of apparent positions; {measured}", entry.reason)
    entry = simulation.plan.entry("rays")
    folds = r"where several eigenrays or none reach a place, a ping is traced with \d+ rays per side"
    assert re.fullmatch(folds, entry.reason)
    assert simulation.plan.method == "sweep"
    assert simulation.arrays.water.bent
    entry = plan(edit(DEFAULT, THERMOCLINE), method="rays").entry("bending")
    assert entry.reason.startswith("rays follow circular arcs; on ")
    assert usual.entry("bending") is None


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


PERIODIC = {"seabed.relief.period": 51.2, "seabed.relief.peaks": [[12.0, 6.0]]}
SMALL = edit(DEFAULT, PERIODIC | {"seabed.spacing": 0.4, "sonar.bins": 200})
PINGS = np.arange(0, 512, 64)


def test_what_is_forced_is_taken_and_marked_but_for_what_the_scene_leaves_no_choice_about(usual):
    forced = {"planes": "16", "spacing": "2", "targets": "off"}
    chosen = plan(DEFAULT, forced=forced)
    assert (chosen.planes, chosen.model.every, chosen.model.targets) == (16, 2, ())
    marked = {entry.subject for entry in chosen.entries if entry.forced}
    assert marked == set(forced)
    assert not chosen.entry("targets").modelled
    assert not any(entry.forced for entry in usual.entries)
    assert plan(DEFAULT, forced={"bending": "on", "surface_echo": "on", "bounces": "off"}) == usual
    # A method may be forced like any other choice.
    assert plan(DEFAULT, forced={"method": "rays", "rays": "5000"}).settings == {"rays": 5000}
    assert plan(DEFAULT, forced={"method": "march", "step": "0.25"}).settings["step"] == 0.25


@pytest.mark.parametrize(
    ("scene", "forced"),
    [
        ("default", {"planes": "1"}),
        ("default", {"spacing": "8"}),
        ("thermocline", {"bending": "off"}),
        ("thermocline", {"spacing": "8", "bending": "off"}),
    ],
    ids=lambda each: " ".join(each) if isinstance(each, dict) else each,
)
def test_for_what_is_forced_nothing_else_is_finer(scene, forced):
    """Though its error, which the plan reports, exceeds the tolerance."""
    declared = load_scene(scene)
    made = plan(declared, forced=forced)
    assert made.error > 0.03
    if "bending" in forced:  # planes have the errors of water in which sound goes straight
        speed = pack(declared).arrays.water.reference
        declared = edit(declared, {"water": {"kind": "uniform", "sound_speed": speed}})
    usual = plan(declared)
    assert made.planes == (1 if "planes" in forced else usual.planes)
    assert made.model.misplaced == usual.model.misplaced
    assert made.model.every == int(forced.get("spacing", usual.model.every))


def test_what_is_forced_off_is_not_heard_and_the_record_tells_it():
    without = prepare(SMALL, forced={"targets": "off"})
    bare = prepare(edit(SMALL, {"targets": []}), forced={"planes": str(without.plan.planes)})
    np.testing.assert_array_equal(without.intensity(PINGS), bare.intensity(PINGS))
    sea = edit(SMALL, {"water.surface": {"kind": "flat"}})
    some = prepare(sea, forced={"surface_bottom": "off", "surface_echo": "off"})
    declared = prepare(edit(sea, {"water.surface": {"kind": "flat", "surface_bottom": False, "surface_echo": False}}))
    np.testing.assert_array_equal(some.intensity(PINGS), declared.intensity(PINGS))
    scene = edit(SMALL, {"track.pings": 2})
    record = simulate(scene, tolerance=0.1, forced={"planes": "4", "targets": "off"})
    assert (record.method, record.tolerance, record.model) == ("auto", 0.1, "planes=4 targets=off")
    assert "model" not in simulate(scene).attrs


def test_a_thinned_bed_has_the_same_nodes():
    whole, thinned = prepare(SMALL), prepare(SMALL, forced={"spacing": "4"})
    np.testing.assert_array_equal(thinned.reduced.bed.heights, whole.arrays.bed.heights[::4, ::4])
    assert thinned.reduced.bed.spacing == 4.0 * whole.arrays.bed.spacing
    # The bed of the scene, on which the platform and the targets stand, stays what it is.
    poses, same = whole.poses(PINGS), thinned.poses(PINGS)
    np.testing.assert_array_equal(whole.altitude(PINGS), thinned.altitude(PINGS))
    np.testing.assert_array_equal(poses.z, same.z)
    assert thinned.arrays.bed.spacing == whole.arrays.bed.spacing
    assert sweep.trace(thinned.reduced, poses).any()


def chosen(scene, targets=()):
    return choose_probe_pings(scene, build_ground(scene), targets)


@pytest.mark.parametrize("pings", [1, 3, 8, 9, 512, 100_000])
def test_pings_are_spread_over_the_track(pings):
    found = chosen(edit(BARE, {"track.pings": pings})).all
    assert found.size == np.unique(found).size == min(pings, SPREAD)
    assert (found == chosen(edit(BARE, {"track.pings": pings, "seed": 9})).all).all()
    edges = np.arange(found.size + 1) * pings // found.size
    assert ((edges[:-1] <= found) & (found < edges[1:])).all()


def test_no_period_falls_in_step_with_them_and_the_greatest_excursions_of_the_fish_are_among_them():
    # The mean of the phases as vectors: 1 for pings in step with the period, 0 for phases all around the circle.
    found = chosen(edit(BARE, {"track.pings": 64 * 13})).all
    for period in range(2, 105):
        assert abs(np.exp(2j * np.pi * (found % period) / period).mean()) < 0.8, period
    rolling = edit(BARE, {"track.pings": 5000, "track.motion": {"kind": "roll", "amplitude": 5.0, "period": 9.0}})
    many = chosen(rolling)
    roll = make_poses(rolling, build_ground(rolling), many.spread).roll
    assert np.degrees(np.abs(roll).max()) > 4.9


def test_a_target_that_one_ping_in_a_thousand_meets_is_crossed_and_many_targets_by_few_pings():
    ball = {"kind": "sphere", "position": [1234.0, 30.0], "radius": 0.3}
    for squint in (0.0, 8.0):
        scene = edit(BARE, {"targets": [ball], "track.pings": 20_000, "sonar.beam.squint": squint})
        found = chosen(scene, (0,)).across
        step = scene.track.speed / scene.sonar.ping_rate
        start = scene.track.start[0]
        ahead = 1234.0 - (start + found * step) - np.tan(np.radians(squint)) * (30.0 - scene.track.start[1])
        assert 1 <= found.size <= 3
        assert (np.abs(ahead) <= 0.3 + step).all()
    balls = [{"kind": "sphere", "position": [3.0 * k, 10.0 + k]} for k in range(30)]
    found = chosen(edit(BARE, {"targets": balls}), tuple(range(30))).across
    assert 6 <= found.size <= 12


@pytest.mark.parametrize("share", [0.0, 0.5, -0.25])
def test_of_a_wide_beam_a_target_lies_on_the_axis_and_on_one_of_two_and_of_four_planes(share):
    ball = {"kind": "sphere", "position": [200.0, 80.0], "radius": 0.3}
    scene = edit(BARE, {"targets": [ball], "track.pings": 4000})
    half_width = np.radians(6.0)
    found = choose_probe_pings(scene, build_ground(scene), (0,), half_width).across
    step, away = scene.track.speed / scene.sonar.ping_rate, 80.0 - scene.track.start[1]
    azimuths = np.arctan((200.0 - scene.track.start[0] - found * step) / away) / half_width
    assert np.abs(np.abs(azimuths) - abs(share)).min() < 0.06


def test_pings_are_spread_where_a_measured_bed_is_heard_and_a_tow_that_never_comes_near_it_is_refused(tmp_path):
    # The bed ends after a tenth of the track.
    np.save(tmp_path / "bed.npy", np.full((40, 60), -20.0))
    spec = {"seabed.relief": {"kind": "dem", "path": str(tmp_path / "bed.npy")}, "seabed.spacing": 0.5}
    scene = edit(BARE, {**spec, "track.start": [0.0, 5.0], "track.heading": 0.0, "track.pings": 6000})
    found = chosen(scene).spread
    ahead = found * scene.track.speed / scene.sonar.ping_rate
    assert found.size == SPREAD
    assert (ahead <= 30.0).all()
    away = edit(scene, {"track.start": [900.0, 0.0], "track.pings": 4})
    sentence = r"^track\.start: .* never comes within 50 m of the bed.*start it over the bed$"
    with pytest.raises(SceneError, match=sentence):
        prepare(away)


def test_a_face_that_glints_into_few_pings_is_among_them_and_a_level_bed_has_none(tmp_path):
    # A bank square to the sound that comes 45° down, over 6 m of a track of 200 m, of a material with a narrow lobe.
    heights = np.full((201, 401), -20.0)
    away, along = 0.5 * np.arange(201)[:, None], 0.5 * np.arange(401)[None, :]
    bank = np.clip(away - 70.0, 0.0, 3.0) * ((along > 120.0) & (along < 126.0))
    np.save(tmp_path / "bank.npy", heights + bank)
    spec = {
        "seabed.relief": {"kind": "dem", "path": str(tmp_path / "bank.npy")},
        "seabed.spacing": 0.5,
        "seabed.material": {"name": "rock", "diffuse": 0.1, "specular": 0.9, "shininess": 400.0},
        "track": {"start": [-100.0, 0.0], "pings": 1000, "speed": 2.0, "altitude": 20.0},
        "sonar": {"range": 50.0, "bins": 500, "ping_rate": 10.0, "beam": {"kind": "knife"}},
    }
    packed = pack(edit(BARE, spec))
    plain = chosen(packed.scene)
    found = add_loud_pings(packed, plain).spread
    added = packed.scene.track.start[0] + np.setdiff1d(found, plain.spread) * 0.2
    assert 1 <= added.size <= 2
    assert ((added > 18.0) & (added < 28.0)).all()
    level = pack(edit(BARE, {"seabed.relief": "flat"}))
    assert (add_loud_pings(level, chosen(level.scene)).all == chosen(level.scene).all).all()


@pytest.mark.parametrize(
    ("name", "changes", "place"),
    [
        ("targets", {}, "the tetrapod, targets.2"),
        ("pipe-on-bed", {"sonar.beam": {"kind": "fan", "width": 1.0}, "track.pings": 60}, ""),
        ("ripples", {"track.pings": 40}, ""),
    ],
)
def test_the_page_of_a_plan_states_the_numbers_of_its_record(name, changes, place):
    scene = edit(load_scene(name), changes)
    page = "\n".join(write_plan_page(scene))
    found = prepare(scene).record_whole(False, None).columns
    errors, planes = found["ping_error"], found["planes"]
    assert f"Error      {percent(float(found['record_error']))} of the record; {percent(errors.max())} of ping " in page
    assert f"of ping {int(errors.argmax())}, the worst" in page
    least, most = planes.min(), planes.max()
    counts = f"{least} least, {int(np.median(planes))} median, {most} most"
    assert (counts if least < most else f"{most} across the beam in every ping") in page
    assert place in page
    for line, entry in ((line, entry) for line in page.splitlines() for entry in plan(scene).entries):
        if line.strip().startswith(entry.choice) and not entry.modelled:
            assert f" {percent(entry.error)} (" in line
    assert all(len(line) <= 80 for line in page.splitlines())


def test_a_page_says_which_cheaper_model_is_not_taken_and_why():
    next_cheaper = " ".join(write_plan_page(edit(load_scene("ghosts"), {"track.pings": 24}))).partition(
        "Next cheaper: "
    )[2]
    error, allowed = map(float, re.search(r"errs by ([\d.]+) % and may err by ([\d.]+) %", next_cheaper).groups())
    assert error > allowed == 0.5
    knife = write_plan_page(edit(BARE, {"sonar.beam": "knife", "seabed.relief": "flat", "track.pings": 8}))
    assert knife[-1] == "Next cheaper: none; no coarser setting takes less work"
    assert not any(line.startswith("Planes") for line in knife) or "1 across the beam" in "".join(knife)


TOLERANCES = st.floats(math.log(1e-4), math.log(0.5)).map(math.exp)
LONGEST = 100.0  # range of a drawn scene, in spacings of the grid


def drawn(values):
    """A drawn scene of short range, in which a plan has the same choices as in a long one, for less work."""
    values["sonar"]["range"] = min(values["sonar"]["range"], LONGEST * values["seabed"]["spacing"])
    try:
        return Scene.model_validate(values)
    except (ValidationError, SceneError):
        assume(False)


@lru_cache(maxsize=8)  # scenes are drawn more than once
def case_of(scene):
    """What is measured of a scene, which does not depend on the tolerance."""
    check_request(scene, 0.03, "auto", {})
    return Case(pack(scene), "auto", {})


def planned(scene, tolerance):
    try:
        return choose_for_case(case_of(scene), tolerance)
    except SceneError:
        assume(False)


@pytest.mark.parametrize("count", [2, pytest.param(40, marks=pytest.mark.slow)])
def test_more_tolerance_never_means_more_work(count):
    @settings(
        max_examples=count,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
        phases=[Phase.generate],  # scenes take minutes to shrink
        deadline=None,
    )
    @given(scenes(), TOLERANCES, TOLERANCES)
    def compare(values, one, other):
        scene = drawn(values)
        fine, coarse = (planned(scene, tolerance) for tolerance in sorted((one, other)))
        assert coarse.work <= fine.work

    compare()


@pytest.mark.parametrize("seed", [*range(10), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(10, 40))])
def test_a_plan_of_a_rough_bed(seed, tmp_path):
    """It works less the more it tolerates, whatever was measured before; it says and adds up all that it chooses."""
    scene, _ = planned_scene(seed, tmp_path)
    tolerances = np.geomspace(0.01, 0.5, 12)
    plans = [planned(scene, tolerance) for tolerance in tolerances]
    work = [made.work for made in plans]
    assert work == sorted(work, reverse=True)
    chosen = plan(scene)
    assert planned(scene, 0.03).model == chosen.model
    assert chosen.error == pytest.approx(math.sqrt(sum(entry.error**2 for entry in chosen.entries)))
    assert chosen.cost > 0.0
    assert sum(each.cost for each in chosen.entries if each.modelled) == pytest.approx(chosen.cost)
    assert len({entry.subject for entry in chosen.entries}) == len(chosen.entries)
    assert all(entry.choice and entry.reason for entry in chosen.entries)
    assert all(min(entry.error, entry.cost) >= 0.0 for entry in chosen.entries)
    assert all(entry.options for entry in chosen.entries if entry.modelled is False)
    share = chosen.model.misplaced
    forced = {"planes": str(chosen.planes), "spacing": str(chosen.model.every), "method": chosen.method}
    forced["segments"] = "whole" if math.isinf(share) else str(share)
    forced["target_planes"] = str(chosen.model.across)
    again = plan(scene, forced=forced)
    assert again.settings == chosen.settings
    assert (again.model.every, again.model.bent) == (chosen.model.every, chosen.model.bent)
    assert again.work == chosen.work


@pytest.mark.parametrize("share", [0.9, 0.5, 0.25, -0.5])
def test_the_trend_of_a_record_that_converges_geometrically_is_its_ratio(share):
    """Aitken's process: changes of a + λⁿ b have the ratio λ, and the limit is λ/(1 − λ) times the last change away."""
    limit, off = np.arange(40.0), np.linspace(-1.0, 2.0, 40)
    coarser, coarse, fine = (limit + share**n * off for n in range(3))
    found = probe._trend(coarser, coarse, fine)
    assert found == pytest.approx(share)
    np.testing.assert_allclose(fine - (coarse - fine) * found / (1.0 - found), limit, atol=1e-12)


def test_pings_without_an_estimate_leave_the_law_of_planes_finite():
    errors = np.array([[0.02, 0.03], [math.inf, 0.04], [math.inf, math.inf]])
    law = probe._fit_law(4, 16, errors, np.zeros(2, np.bool_), np.zeros(2, np.bool_))
    assert math.isfinite(law.power)
    assert math.isfinite(law.usual(4))
