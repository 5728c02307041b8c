"""Bounding volume hierarchy over triangles: whole, tight, and right by brute force."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from insonify.kernels.common.types import Mesh
from insonify.kernels.geometry.bvh import LEAF, SLABS, build_mesh, slab_of


def soup(n: int, seed: int = 1, *, scale=(20.0, 20.0, 4.0), size=0.5) -> np.ndarray:
    """(n, 3, 3) triangles strewn about."""
    random = np.random.default_rng(seed)
    return random.normal(size=(n, 1, 3)) * scale + size * random.normal(size=(n, 3, 3))


def mesh_of(corners: np.ndarray) -> Mesh:
    """Tree over triangles whose target is their number."""
    return build_mesh(corners, np.zeros(len(corners), np.int64), np.arange(len(corners)))


def search(mesh: Mesh, enters) -> list[int]:
    """Targets in the leaves of all branches whose box is entered."""
    found, node = [], 0
    while node < mesh.skip.size:
        if not enters(mesh.low[node], mesh.high[node]):
            node = mesh.skip[node]
            continue
        found += mesh.target[mesh.first[node] : mesh.first[node] + mesh.leaf_size[node]].tolist()
        node += 1
    return found


CASES = {
    "one": soup(1),
    "as many as a leaf holds": soup(LEAF),
    "one more": soup(LEAF + 1),
    "many": soup(3000),
    "along a line": soup(500, scale=(100.0, 0.0, 0.0), size=0.01),
    "all in one place": np.repeat(soup(1), 100, axis=0),
    "most in one place": np.concatenate([np.repeat(soup(1), 300, axis=0), soup(20)]),
    "sizes of every order": soup(400) * np.logspace(-6, 3, 400)[:, None, None],
    "level, but for next to nothing": soup(60) * (1.0, 1.0, 1e-311),
    "as small as the rounding of their places": np.add(soup(200, scale=(1e-9,) * 3, size=1e-10), (0.0, 5e5, -500.0)),
}


@pytest.mark.parametrize("corners", CASES.values(), ids=CASES)
def test_every_triangle_is_in_exactly_one_leaf_and_links_and_boxes_are_right(corners):
    mesh = mesh_of(corners)
    leaves = np.flatnonzero(mesh.leaf_size)
    assert mesh.leaf_size.max() <= LEAF
    # Leaves follow one another in memory, and a search that enters everything meets everything once.
    np.testing.assert_array_equal(mesh.first[leaves], np.cumsum(mesh.leaf_size[leaves]) - mesh.leaf_size[leaves])
    assert sorted(search(mesh, lambda low, high: True)) == list(range(len(corners)))
    np.testing.assert_array_equal(mesh.corners, corners[mesh.target])
    n = mesh.skip.size
    for node in range(n):
        after = mesh.skip[node]
        last = mesh.first[after] if after < n else len(corners)
        inside = mesh.corners[mesh.first[node] : last].reshape(-1, 3)
        np.testing.assert_array_equal(mesh.low[node], inside.min(axis=0))
        np.testing.assert_array_equal(mesh.high[node], inside.max(axis=0))
        if mesh.leaf_size[node]:
            assert after == node + 1
            assert last - mesh.first[node] == mesh.leaf_size[node]
        else:
            # Two branches, one after the other, end where their parent ends.
            assert mesh.first[node + 1] == mesh.first[node]
            assert mesh.skip[mesh.skip[node + 1]] == after


def test_a_centre_that_rounding_moves_out_of_all_slabs_lies_in_the_next():
    assert slab_of(5e5, 5e5, 1e6 + 1e-9, 8e9) == 0
    assert slab_of(5e5, 5e5 + 2e-9, 1e6, 8e9) in range(SLABS)
    assert slab_of(5e5, 5e5 + 1.0, 1e6, 8e9) == SLABS - 1


def test_the_same_triangles_make_the_same_tree_and_none_an_empty_one():
    one, other = mesh_of(CASES["many"]), mesh_of(CASES["many"].copy())
    assert all(map(np.array_equal, one, other))
    mesh = mesh_of(np.zeros((0, 3, 3)))
    assert mesh.corners.shape == (0, 3, 3)
    assert all(column.shape == (0, 3) and column.dtype == np.float64 for column in (mesh.normal, mesh.low, mesh.high))
    numbers = (mesh.material, mesh.target, mesh.skip, mesh.first, mesh.leaf_size)
    assert all(column.shape == (0,) and column.dtype == np.int64 for column in numbers)
    # Normals point to where corners run counter-clockwise.
    mesh = mesh_of(np.array([[[0.0, 0, 0], [2, 0, 0], [0, 3, 0]]]))
    np.testing.assert_array_equal(mesh.normal, [[0, 0, 1]])


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 300))
def test_planes_and_rays_find_what_brute_force_finds(seed, n):
    corners = soup(n, seed)
    mesh = mesh_of(corners)
    random = np.random.default_rng(seed)
    normal, place = random.normal(size=3), random.normal(size=3) * 5.0

    def on_plane(low, high):
        centre, half = 0.5 * (low + high) - place, 0.5 * (high - low)
        return abs(centre @ normal) <= half @ abs(normal) + 1e-12

    side = (corners - place) @ normal
    crossing = np.flatnonzero((side.min(axis=1) <= 0) & (side.max(axis=1) >= 0))
    assert set(crossing) <= set(search(mesh, on_plane))

    origin, direction = random.normal(size=3) * 30.0, random.normal(size=3)

    def on_ray(low, high):
        with np.errstate(divide="ignore"):
            near, far = np.sort([(low - origin) / direction, (high - origin) / direction], axis=0)
        return max(near.max(), 0.0) <= far.min() + 1e-9

    boxes = [on_ray(*bounds) for bounds in zip(corners.min(axis=1), corners.max(axis=1))]
    found = search(mesh, on_ray)
    assert set(np.flatnonzero(boxes)) <= set(found)
    assert len(found) < n or n < 30  # and passes something by
