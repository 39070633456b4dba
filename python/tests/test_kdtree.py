"""`KDTree` beside `scipy.spatial.KDTree`, and its promises: ties, exactness, bad input."""

import math
import os
import pickle

import numpy as np
import pytest
from scipy.spatial import KDTree as Scipy

import photonmap as pm

RANDOM = np.random.default_rng(1)
POINTS = RANDOM.random((3000, 3))
QUERIES = RANDOM.random((400, 3)) * 1.2 - 0.1


def brute(points, x, k, bound=np.inf):
    """Distances and indices by sorting all, equal distances by index."""
    squared = ((x[:, None, :] - points[None]) ** 2).sum(-1)
    order = np.argsort(squared, axis=1, kind="stable")[:, :k]
    distances = np.sqrt(np.take_along_axis(squared, order, 1))
    missing = distances >= bound
    distances[missing], order[missing] = np.inf, len(points)
    return distances, order


@pytest.fixture(scope="module", params=["cpu", "gpu"])
def make(request):
    """Makes trees on each device."""
    try:
        pm.KDTree(POINTS[:5], device=request.param)
    except pm.DeviceError:
        if os.environ.get("PHOTON_REQUIRE_VULKAN", "0") != "0":
            raise
        pytest.skip("no Vulkan")
    return lambda points: pm.KDTree(points, device=request.param)


@pytest.fixture(scope="module")
def tree(make):
    return make(POINTS)


@pytest.mark.parametrize("k", [1, 2, 50, [1], [2, 7], [50]])
@pytest.mark.parametrize("bound", [np.inf, 0.05, 0.0])
def test_neighbours_are_those_of_scipy(tree, k, bound):
    distances, ids = tree.query(QUERIES, k, distance_upper_bound=bound)
    expected, expected_ids = Scipy(POINTS).query(QUERIES, k, distance_upper_bound=bound)
    assert distances.dtype == np.float64 and ids.dtype == np.int64
    np.testing.assert_array_equal(distances, expected)
    np.testing.assert_array_equal(ids, expected_ids)


def test_shapes_are_those_of_scipy(tree):
    theirs = Scipy(POINTS)
    cube = QUERIES[:24].reshape(2, 3, 4, 3)
    for x in [QUERIES[0], QUERIES[:0], QUERIES[:1], cube, cube[:, :0]]:
        for k in [1, [1], 3, [3, 1]]:
            for mine, expected in zip(tree.query(x, k), theirs.query(x, k)):
                assert np.shape(mine) == np.shape(expected)
                np.testing.assert_array_equal(mine, expected)
        count = tree.query_ball_point(x, 0.1, return_length=True)
        expected = theirs.query_ball_point(x, 0.1, return_length=True)
        np.testing.assert_array_equal(count, expected)
        assert np.shape(count) == np.shape(expected)
    distance, index = tree.query(QUERIES[0])
    assert isinstance(distance, np.float64) and isinstance(index, np.int64)


def test_more_than_there_are():
    tree = pm.KDTree(POINTS[:3])
    distances, ids = tree.query(QUERIES, 5)
    np.testing.assert_array_equal(distances[:, 3:], np.inf)
    np.testing.assert_array_equal(ids[:, 3:], 3)
    np.testing.assert_array_equal(distances[:, :3], brute(POINTS[:3], QUERIES, 3)[0])


def test_no_points(make):
    tree = make(np.empty((0, 3)))
    distances, ids = tree.query(QUERIES[:2], 2)
    assert (distances == np.inf).all() and (ids == 0).all()
    assert tree.count(QUERIES[0], 1e9) == 0 and tree.query_ball_point(QUERIES[0], 1.0) == []
    assert tree.n == 0 and tree.data.shape == (0, 3)


@pytest.mark.parametrize("layout", ["fortran", "strided", "reversed", "float32", "big-endian", "integers", "list"])
def test_any_layout(layout):
    points = np.round(POINTS * 1000)
    queries = np.round(QUERIES * 1000)
    change = {
        "fortran": np.asfortranarray,
        "strided": lambda a: np.repeat(np.repeat(a, 2, 0), 2, 1)[::2, ::2],
        "reversed": lambda a: a[::-1].copy()[::-1],
        "float32": lambda a: a.astype(np.float32),
        "big-endian": lambda a: a.astype(">f8"),
        "integers": lambda a: a.astype(np.int32),
        "list": lambda a: a.tolist(),
    }[layout]
    distances, ids = pm.KDTree(change(points)).query(change(queries), 4)
    expected, expected_ids = brute(points, queries, 4)
    np.testing.assert_array_equal(distances, expected)
    np.testing.assert_array_equal(ids, expected_ids)


def test_of_equal_distances_the_lower_index_is_first(make):
    # A grid, each point four times: most k-th neighbours are ties.
    axis = np.arange(6.0)
    grid = np.repeat(np.stack(np.meshgrid(axis, axis, axis), -1).reshape(-1, 3), 4, axis=0)
    grid = grid[np.random.default_rng(2).permutation(len(grid))]
    queries = np.concatenate([grid[:60], grid[:60] + 0.5])
    tree = make(grid)
    for k in [1, 3, 4, 9, 30, 31]:
        distances, ids = tree.query(queries, [k] if k == 1 else k)
        expected, expected_ids = brute(grid, queries, k)
        np.testing.assert_array_equal(distances, expected)
        np.testing.assert_array_equal(ids, expected_ids)
    # Balls whose surface goes through points.
    count = tree.count(queries[:60], 1.0)
    squared = ((queries[:60, None] - grid[None]) ** 2).sum(-1)
    np.testing.assert_array_equal(count, (squared <= 1.0).sum(1))
    # The bound of a query is exclusive, the radius of a ball inclusive.
    line = make([[0, 0, 0], [1, 0, 0], [2, 0, 0]])
    assert line.query([0, 0, 0], 3, distance_upper_bound=1)[1].tolist() == [0, 3, 3]
    assert line.query_ball_point([0, 0, 0], 1) == [0, 1]


@pytest.mark.parametrize("offset", [4e6, 1e12])
def test_distances_are_those_of_the_given_numbers(make, offset):
    """Far from the origin, f32 alone would find other neighbours."""
    points = POINTS * 100 + offset
    queries = QUERIES * 100 + offset
    tree = make(points)
    distances, ids = tree.query(queries, 9)
    expected, expected_ids = brute(points, queries, 9)
    np.testing.assert_array_equal(distances, expected)
    np.testing.assert_array_equal(ids, expected_ids)
    # The comparison would notice it.
    rounded = brute(points.astype(np.float32).astype(float), queries, 9)
    assert (rounded[1] != expected_ids).any()
    radius = expected[:, 4]
    squared = ((queries[:, None] - points[None]) ** 2).sum(-1)
    np.testing.assert_array_equal(tree.count(queries, radius), (squared <= (radius**2)[:, None]).sum(1))


def test_points_that_f32_cannot_tell_apart(make):
    """A cluster far smaller than the rounding of f32 in the box of all points."""
    points = np.concatenate([POINTS[:500] * 1e-9, [[5.0, 5.0, 5.0]]])
    queries = QUERIES[:50] * 1e-9
    distances, ids = make(points).query(queries, 7)
    expected, expected_ids = brute(points, queries, 7)
    np.testing.assert_array_equal(distances, expected)
    np.testing.assert_array_equal(ids, expected_ids)


@pytest.mark.parametrize("size", [1e-290, 1e-120, 1e120, 1e290])
def test_extreme_units(size):
    distances, ids = pm.KDTree(POINTS * size).query(QUERIES * size, 5)
    expected, expected_ids = brute(POINTS, QUERIES, 5)
    np.testing.assert_array_equal(ids, expected_ids)
    np.testing.assert_allclose(distances, expected * size, rtol=1e-12)


def test_queries_far_away(make):
    tree = make(POINTS)
    assert tree.device == "cpu" or len(tree.device) > 3
    for away in [1e5, 1e8, 1e200]:
        queries = QUERIES[:5] + [away, 0, 0]
        distances, ids = tree.query(queries, 3)
        assert (ids >= 0).all() and (ids < len(POINTS)).all()
        np.testing.assert_allclose(distances, away, rtol=3e-5)
        if away < 1e10:
            np.testing.assert_array_equal(ids, brute(POINTS, queries, 3)[1])
        np.testing.assert_array_equal(tree.count(queries, away * 2), len(POINTS))
        np.testing.assert_array_equal(tree.count(queries, away / 2), 0)


def test_balls_are_those_of_scipy(tree):
    theirs = Scipy(POINTS)
    radii = RANDOM.random(len(QUERIES)) * 0.2
    for r in [0.0, 0.1, radii, 10, np.inf]:
        expected = theirs.query_ball_point(QUERIES, r, return_sorted=True)
        found = tree.query_ball_point(QUERIES, r)
        assert found.dtype == object and found.tolist() == expected.tolist()
        count = tree.count(QUERIES, r)
        assert count.dtype == np.int64
        np.testing.assert_array_equal(count, [len(row) for row in expected])
        start, ids = tree.within(QUERIES, r)
        assert start.dtype == ids.dtype == np.int64 and start.shape == (len(QUERIES) + 1,)
        assert [ids[a:b].tolist() for a, b in zip(start, start[1:])] == expected.tolist()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda t: pm.KDTree(np.zeros((4, 2))), ["(4, 2)", "three dimensions", "scipy"]),
        (lambda t: pm.KDTree(np.zeros(3)), ["(3,)", "(n, 3)"]),
        (lambda t: pm.KDTree(5.0), ["()", "3"]),
        (lambda t: pm.KDTree([[0, 0, 0], [0, math.nan, 0]]), ["points[1]", "not finite"]),
        (lambda t: pm.KDTree([[0, 0, -math.inf]]), ["points[0]", "not finite"]),
        (lambda t: pm.KDTree([[0, 0, 1e301]]), ["points[0]", "larger unit"]),
        (lambda t: pm.KDTree(np.zeros((4, 3), complex)), ["complex", "real"]),
        (lambda t: pm.KDTree([[1, 2, 3], [4]]), ["points is not an array"]),
        (lambda t: pm.KDTree([["a", "b", "c"]]), ["real numbers"]),
        (lambda t: pm.KDTree(POINTS, boxsize=1.0), ["boxsize"]),
        (lambda t: pm.KDTree(POINTS, device="tpu"), ["tpu", "cpu"]),
        (lambda t: t.query([0, math.nan, 0]), ["x[0]", "not finite"]),
        (lambda t: t.query(np.zeros((5, 4))), ["x", "(5, 4)"]),
        (lambda t: t.query(QUERIES, 0), ["k is 0"]),
        (lambda t: t.query(QUERIES, -3), ["k is -3"]),
        (lambda t: t.query(QUERIES, 2.5), ["k is 2.5"]),
        (lambda t: t.query(QUERIES, [0, 1]), ["k is [0, 1]"]),
        (lambda t: t.query(QUERIES, []), ["k is []"]),
        (lambda t: t.query(QUERIES, p=1), ["p is 1", "scipy"]),
        (lambda t: t.query(QUERIES, eps=-1), ["eps is -1"]),
        (lambda t: t.query(QUERIES, workers=0), ["workers is 0"]),
        (lambda t: t.query(QUERIES, distance_upper_bound=math.nan), ["distance_upper_bound is nan"]),
        (lambda t: t.query(QUERIES, distance_upper_bound=-1), ["distance_upper_bound is -1"]),
        (lambda t: t.query_ball_point(QUERIES, -1.0), ["r is -1"]),
        (lambda t: t.count(QUERIES, math.nan), ["r is NaN"]),
        (lambda t: t.count(QUERIES, [1.0, 2.0]), ["r has the shape (2,)", "(400,)"]),
        (lambda t: t.within(QUERIES, "far"), ["r has the type"]),
    ],
)
def test_bad_input_is_named(tree, call, words):
    with pytest.raises(pm.InputError) as caught:
        call(tree)
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, pm.Error)
    assert all(word in str(caught.value) for word in words), caught.value


def test_too_many_results_are_an_error():
    with pytest.raises(pm.OutOfMemoryError) as caught:
        pm.KDTree(POINTS).query(np.zeros((1 << 16, 3)), 1 << 32)
    assert isinstance(caught.value, MemoryError)


def test_accepted_for_compatibility(tree):
    other = pm.KDTree(POINTS, 16, compact_nodes=False, copy_data=True, balanced_tree=False)
    for workers in [1, 2, -1]:
        np.testing.assert_array_equal(
            other.query(QUERIES, 3, eps=0.1, p=2.0, workers=workers)[1], tree.query(QUERIES, 3)[1]
        )
    assert other.m == 3 and other.n == len(POINTS)
    np.testing.assert_array_equal(other.data, POINTS)


def test_pickle():
    tree = pm.KDTree(POINTS)
    other = pickle.loads(pickle.dumps(tree))
    np.testing.assert_array_equal(other.query(QUERIES, 3)[1], tree.query(QUERIES, 3)[1])
    assert repr(other) == repr(tree)
