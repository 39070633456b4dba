"""Photons out, and photons in."""

import os

import numpy as np
import pytest

import photonmap as pm


def scene():
    """A cube of glass over a floor, beside a wall."""
    cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 0.3
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    scene = pm.Scene().mesh(
        "cube", cube, [[a, b, c] for a, *rest in sides for b, c in zip(rest, rest[1:])], pm.Glass(1.5)
    )
    scene.quad("floor", [[-1, -1, 1], [1, -1, 1], [1, -1, -1], [-1, -1, -1]], pm.Lambert(0.8))
    scene.quad("wall", [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1]], pm.Lambert(0.8))
    return scene.point_light((0, 2, 0), 10)


SCENE = scene()


@pytest.fixture(scope="module", params=["cpu", "gpu"])
def photons(request):
    try:
        return pm.trace(SCENE, 400_000, device=request.param), request.param
    except pm.DeviceError:
        if os.environ.get("PHOTON_REQUIRE_VULKAN", "0") != "0":
            raise
        pytest.skip("no Vulkan")


def test_photons_carry_the_light_of_the_scene(photons):
    photons, _ = photons
    count = len(photons)
    assert count > 20_000
    for name, kind in [("position", np.float64), ("normal", np.float32), ("direction", np.float32), ("power", np.float64)]:
        array = getattr(photons, name)
        assert array.shape == (count, 3) and array.dtype == kind, name
    for name in ["normal", "direction"]:
        np.testing.assert_allclose(np.linalg.norm(getattr(photons, name), axis=1), 1, atol=1e-5)
    # They arrive at the front of the surface.
    assert ((photons.normal * photons.direction).sum(1) > -1e-3).all()
    assert set(photons.kind.tolist()) == {0, 1, 2}
    # The flux on the floor and the wall, by the solid angles that they fill: the light passes the cube, but for a few per
    # cent that it reflects elsewhere.
    first = photons[photons.kind < 2].power.sum(0)
    floor = 10 * 4 * np.arcsin(1 / (1 + 9))
    corner = lambda a, b, d: np.arctan(a * b / (d * np.sqrt(a * a + b * b + d * d)))
    wall = 10 * 2 * (corner(1, 3, 1) - corner(1, 1, 1))
    np.testing.assert_allclose(first, floor + wall, rtol=0.06)
    assert len(photons[:5]) == 5 and len(photons[3]) == 1


def test_both_devices_trace_the_same_photons(photons):
    photons, device = photons
    expected = pm.trace(SCENE, 400_000)
    assert abs(len(photons) - len(expected)) <= 0.001 * len(expected)
    same = pm.trace(SCENE, 400_000, device=device)
    np.testing.assert_array_equal(same.position, photons.position)
    other = pm.trace(SCENE, 400_000, seed=1)
    assert len(other) != len(expected) or (other.position != expected.position).any()


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_irradiance_of_an_even_field(photons, scale):
    _, device = photons
    random = np.random.default_rng(5)
    n, flux = 40_000, 5.0
    position = np.zeros((n, 3))
    position[:, :2] = random.random((n, 2))
    normal = np.tile([0.0, 0, 3], (n, 1))
    power = np.full(n, flux / n)
    photon_map = pm.PhotonMap(position * scale, normal, power, device=device)
    assert len(photon_map) == n
    x = np.zeros((9, 9, 3))
    x[..., :2] = random.random((9, 9, 2)) * 0.6 + 0.2
    expected = flux / scale**2
    toward = np.broadcast_to([0, 0, 1], x.shape)
    for search in [{"k": 400}, {"radius": 0.05 * scale}, {"k": 400, "radius": 0.5 * scale}]:
        found = photon_map.irradiance(x * scale, toward, **search)
        assert found.shape == (9, 9) and found.dtype == np.float64
        # 400 and 314 photons: a standard error of 0.06 each, 81 points.
        np.testing.assert_allclose(found.mean(), expected, rtol=0.03)
        assert (np.abs(found / expected - 1) < 0.35).all()
    # The definition, with scipy's neighbours in mind: photons within the radius over the area.
    radius = 0.05
    squared = ((x[0, 0] - position) ** 2).sum(1)
    by_hand = flux / n * (squared <= radius**2).sum() / (np.pi * radius**2) / scale**2
    found = photon_map.irradiance(x[0, 0] * scale, [0, 0, 1], radius=radius * scale)
    np.testing.assert_allclose(found, by_hand, rtol=0.02)
    # From behind, and from far away, nothing.
    assert (photon_map.irradiance(x * scale, -toward, radius=0.05 * scale) == 0).all()
    assert photon_map.irradiance(np.array([1e30, 0, 0]) * scale, [0, 0, 1], radius=scale) == 0
    smooth = photon_map.irradiance(x * scale, toward, radius=0.05 * scale, kernel="epanechnikov")
    np.testing.assert_allclose(smooth.mean(), expected, rtol=0.03)


def test_traced_photons_give_irradiance(photons):
    photons, device = photons
    # In a corner of the floor, with direct light alone: intensity times cosine over the squared distance.
    at = np.array([0.8, -1, 0.8])
    direct = photons[photons.kind == 0]
    photon_map = pm.PhotonMap(direct.position, direct.normal, direct.power, device=device)
    away = at - [0, 2, 0]
    expected = 10 * 3 / np.linalg.norm(away) ** 3
    found = photon_map.irradiance(at, [0, 1, 0], radius=0.2)
    assert found.shape == (3,)
    np.testing.assert_allclose(found, expected, rtol=0.25)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda m: pm.trace("cornell", 0), ["photons is 0"]),
        (lambda m: pm.trace("cornell", 10, colour=3), ["colour"]),
        (lambda m: pm.trace("cornell", 10, device="x"), ["device"]),
        (lambda m: pm.trace(pm.Scene().quad("q", [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]).environment(0), 10), ["light"]),
        (lambda m: pm.PhotonMap(np.zeros((2, 3)), np.zeros((2, 3)), [1, 1]), ["normal[0]", "direction"]),
        (lambda m: pm.PhotonMap(np.zeros((2, 3)), np.ones((3, 3)), [1, 1]), ["(2, 3)", "(3, 3)"]),
        (lambda m: pm.PhotonMap(np.zeros((2, 3)), np.ones((2, 3)), [1]), ["(1,)"]),
        (lambda m: pm.PhotonMap([[0, 0, np.nan]], [[0, 0, 1]], [1]), ["position[0]"]),
        (lambda m: pm.PhotonMap([[0, 0, 0]], [[0, 0, 1]], [np.inf]), ["power[0]"]),
        (lambda m: m.irradiance([0, 0, 0], [0, 0, 1]), ["k= or radius="]),
        (lambda m: m.irradiance([0, 0, 0], [0, 0, 1], k=1), ["k is 1"]),
        (lambda m: m.irradiance([0, 0, 0], [0, 0, 1], k=-1), ["k is -1"]),
        (lambda m: m.irradiance([0, 0, 0], [0, 0, 1], radius=-1), ["radius is -1"]),
        (lambda m: m.irradiance([0, 0, 0], [0, 0, 1], radius=np.inf), ["radius is inf"]),
        (lambda m: m.irradiance([0, 0, 0], [[0, 0, 1]], k=2), ["(3,)", "(1, 3)"]),
        (lambda m: m.irradiance([0, 0, 0], [0, 0, 0], k=2), ["normals[0]"]),
        (lambda m: m.irradiance([0, np.nan, 0], [0, 0, 1], k=2), ["x[0]"]),
        (lambda m: m.irradiance([0, 0, 0], [0, 0, 1], k=2, kernel="box"), ["box", "epanechnikov"]),
        (lambda m: m.irradiance([0, 0, 0], [0, 0, 1], k=2, min_normal_cosine=2), ["min_normal_cosine is 2"]),
    ],
)
def test_bad_input_is_named(call, words):
    photon_map = pm.PhotonMap(np.zeros((2, 3)), np.ones((2, 3)), [1, 1])
    with pytest.raises(pm.InputError) as caught:
        call(photon_map)
    assert all(word in str(caught.value) for word in words), caught.value


def test_no_photons():
    photon_map = pm.PhotonMap(np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3)))
    assert (photon_map.irradiance([0, 0, 0], [0, 0, 1], k=5) == 0).all()
