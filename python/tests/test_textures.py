"""Textures from arrays: closed forms, and what is refused."""

import pickle

import numpy as np
import pytest

import photonmap as pm

CORNERS = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]


def picture(material, layer=None, size=8, **mesh):
    """A quadrilateral that fills the picture, under an even environment of radiance 1."""
    scene = pm.Scene().environment(1.0).camera([0, 0, 3], to=[0, 0, 0], height=2)
    if mesh:
        scene.mesh("quad", CORNERS, [[0, 1, 2], [0, 2, 3]], material, **mesh)
    else:
        scene.quad("quad", CORNERS, material)
    film = pm.render(scene, size=size, passes=4, photons=2000, shadow_rays=4)
    return film.beauty if layer is None else film.layers[layer]


def quadrants(image):
    """The means of the four quarters of a picture, without the rows between them."""
    half = image.shape[0] // 2
    inner = slice(1, half - 1)
    outer = slice(half + 1, -1)
    return np.array([[image[rows, columns].mean(axis=(0, 1)) for columns in (inner, outer)] for rows in (inner, outer)])


COLORS = np.array([[[1, 0, 0], [0, 1, 0]], [[0, 0, 1], [0.25, 0.5, 0.75]]])


def test_emission_shows_the_image_the_right_way_round():
    texture = pm.Texture(COLORS, nearest=True)
    found = picture(pm.Lambert(0.5, emission=[2, 2, 2], emission_texture=texture), "emission")
    assert np.allclose(quadrants(found), 2 * COLORS, rtol=1e-6)


def test_colors_reflect_an_even_environment():
    # A convex surface of albedo a has the radiance a; direct light is noisy, so that the mean of many pixels is compared.
    found = quadrants(picture(pm.Lambert(1.0, color_texture=pm.Texture(COLORS, nearest=True)), size=32))
    assert np.allclose(found, COLORS, atol=0.03) and not np.allclose(found, COLORS[::-1], atol=0.03)


def test_bytes_are_srgb_in_colors():
    grey = np.full((4, 4), 128, dtype=np.uint8)
    linear = ((128 / 255 + 0.055) / 1.055) ** 2.4
    shown = picture(pm.Lambert(0.5, emission=1.0, emission_texture=pm.Texture(grey)), "emission")
    assert np.allclose(shown, linear, rtol=1e-4)
    assert not np.allclose(shown, 128 / 255, rtol=1e-2)


def test_coordinates_wraps_and_sets():
    texture = pm.Texture(COLORS, nearest=True, wrap=("clamp", "repeat"), uv_set=1)
    shifted = np.array([[0, 1], [1, 1], [1, 0], [0, 0]]) + [2, 1]
    material = pm.Lambert(0.5, emission=1.0, emission_texture=texture)
    found = picture(material, "emission", uvs=[np.zeros((4, 2)), shifted])
    # Beyond the right edge there is the last column; a whole period down is the same row.
    assert np.allclose(quadrants(found), COLORS[:, [1, 1]], rtol=1e-6)


def test_alpha_makes_holes():
    alpha = np.array([[1.0, 0.2], [0.2, 1.0]])
    texture = pm.Texture(alpha, nearest=True)
    black = dict(albedo=0.0, emission=3.0)
    cut = quadrants(picture(pm.Lambert(**black, alpha_texture=texture, alpha_cutoff=0.5)))
    assert np.allclose(cut[..., 0], [[3, 1], [1, 3]], rtol=1e-5)
    blended = quadrants(picture(pm.Lambert(**black, alpha_texture=texture), size=64))
    # 0.2 of 3 and 0.8 of 1, with the noise of 4 × 900 choices: a deviation of 2 · 0.4 / 60.
    assert np.allclose(blended[..., 0], [[3, 1.4], [1.4, 3]], atol=4.5 * 2 * 0.4 / 60)


def test_roughness_is_green():
    rough = pm.Texture(np.full((2, 2), 0.5))
    full = np.ones((2, 2, 3))
    full[..., 1] = 0.5
    same = [picture(pm.Metal(0.8, roughness=1.0, roughness_texture=pm.Texture(image))) for image in (rough.image, full)]
    assert np.array_equal(*same)
    assert np.array_equal(same[0], picture(pm.Metal(0.8, roughness=0.5)))
    assert not np.array_equal(same[0], picture(pm.Metal(0.8, roughness=1.0)))


def test_scenes_with_textures_can_be_pickled():
    texture = pm.Texture(COLORS)
    scene = pm.Scene().environment(1.0).quad("quad", CORNERS, pm.Lambert(1.0, color_texture=texture))
    assert pickle.loads(pickle.dumps(scene)).digest == scene.digest
    other = pm.Scene().environment(1.0).quad("quad", CORNERS, pm.Lambert(1.0, color_texture=pm.Texture(COLORS[::-1])))
    assert other.digest != scene.digest


def test_one_texture_of_two_materials_is_stored_once():
    texture = pm.Texture(COLORS)
    materials = [pm.Lambert(a, color_texture=texture, emission_texture=texture, emission=1.0) for a in (0.2, 0.4)]
    added = []

    class Builder:
        def texture_floats(self, *arguments):
            added.append(arguments)
            return len(added) - 1

    textures = {}
    uses = [material._textures(Builder(), "quad", textures) for material in materials]
    assert len(added) == 1 and uses[0] == uses[1] == [("color_texture", 0, 0), ("emission_texture", 0, 0)]


@pytest.mark.parametrize(
    "material, words",
    [
        (pm.Lambert(1.0, color_texture=pm.Texture(np.zeros((2, 2, 2)))), r"color_texture.*shape \(2, 2, 2\)"),
        (pm.Lambert(1.0, color_texture=pm.Texture(np.zeros((0, 2)))), r"shape \(0, 2\)"),
        (pm.Lambert(1.0, color_texture=pm.Texture(np.zeros((2, 2), dtype=int))), "type int64"),
        (pm.Lambert(1.0, color_texture=pm.Texture(COLORS, wrap="border")), "wrap is 'border'"),
        (pm.Lambert(1.0, color_texture=pm.Texture(COLORS, uv_set=-1)), "uv_set is -1"),
        (pm.Lambert(1.0, color_texture=pm.Texture(COLORS, uv_set=3)), "(?i)uv"),
        (pm.Lambert(1.0, color_texture=COLORS), "must be a photonmap.Texture"),
        (pm.Lambert(1.0, color_texture=pm.Texture(np.full((2, 2), np.nan))), "(?i)texture"),
        (pm.Lambert(1.0, color_texture=pm.Texture(np.full((2, 2), 1.5))), "(?i)texture"),
        (pm.Lambert(0.5, emission=1, emission_texture=pm.Texture(np.full((2, 2), -1.0))), "(?i)texture"),
        (pm.Lambert(1.0, alpha_texture=pm.Texture(np.ones((2, 2))), alpha_cutoff=np.nan), "alpha_cutoff"),
    ],
)
def test_wrong_textures_are_named(material, words):
    with pytest.raises(pm.InputError, match=words):
        pm.Scene().environment(1.0).quad("quad", CORNERS, material).build()


@pytest.mark.parametrize("uvs", [[[0, 0]], np.zeros((4, 3)), np.zeros((2, 3, 2)), 7, [["a", "b"]] * 4])
def test_wrong_coordinates_are_named(uvs):
    with pytest.raises(pm.InputError, match="(?i)uv"):
        pm.Scene().mesh("quad", CORNERS, [[0, 1, 2]], uvs=uvs)
