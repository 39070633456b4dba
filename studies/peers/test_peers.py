"""Checks of the comparison itself: what it must refuse, and measures with closed forms.

python -m pytest studies/peers
"""

import json
import math
import struct

import numpy as np
import pytest

from . import equal_error, errors, everyday, measures, povray, process, records, reference, scene, table

SHAPE = (64, 64, 3)


@pytest.fixture
def picture():
    """Radiance between 0.2 and 1.8."""
    return np.random.default_rng(1).uniform(0.2, 1.8, SHAPE)


def row(variant="mitsuba-path", budget=4.0, renderer="mitsuba"):
    return records.Row("cornell", renderer, variant, budget, 5.0, 1.0, 3.0, 2, "Mitsuba", "8 samples")


def test_a_picture_agrees_with_itself(picture):
    means = measures.compare_means(picture, picture)
    assert means.verdict == "agrees" and means.ratio == (1.0, 1.0, 1.0)


@pytest.mark.parametrize("channel", range(3))
def test_a_reference_with_one_brighter_channel_is_refused(picture, channel):
    brighter = np.ones(3)
    brighter[channel] = 1.05
    noisy = picture * (1.0 + 0.1 * np.random.default_rng(2).standard_normal(SHAPE))
    assert measures.compare_means(noisy, picture).verdict == "agrees"
    assert measures.compare_means(noisy, picture * brighter).verdict == "differs"


def test_means_of_a_very_noisy_picture_are_no_confirmation(picture):
    # Standard error 8/64 = 12 %.
    noisy = picture * (1.0 + 8.0 * np.random.default_rng(3).standard_normal(SHAPE))
    assert measures.compare_means(noisy, picture).verdict == "too noisy"


def test_a_picture_that_is_a_pixel_off_is_refused(picture):
    noisy = picture * (1.0 + 0.1 * np.random.default_rng(6).standard_normal(SHAPE))
    for axis in (0, 1):
        assert measures.compare_means(np.roll(noisy, 1, axis=axis), picture).verdict == "shifted"


def test_standard_error_of_the_mean_has_its_closed_form(picture):
    sigma = 0.3
    flat = np.ones(SHAPE)
    noisy = flat + sigma * np.random.default_rng(4).standard_normal(SHAPE)
    _, error, _ = measures.differs(noisy, flat)
    # The relative standard error of a standard deviation of n values is 1/√(2n).
    assert np.abs(error / (sigma / 64) - 1.0).max() < 4.5 / math.sqrt(2 * 64 * 64)


def test_relmse_of_known_perturbations():
    flat = np.full(SHAPE, 2.0)
    # (0.1 · 2)²/(2² + 2²/100)
    assert measures.relmse(flat * 1.1, flat) == pytest.approx(0.01 / 1.01, rel=1e-12)
    # A quarter of the pixels is off: the mean is a quarter, the median 0.
    part = flat.copy()
    part[:32, :32] *= 1.1
    found = measures.errors(part, flat, np.zeros(SHAPE[:2], bool))
    assert found.all == pytest.approx(0.25 * 0.01 / 1.01, rel=1e-12)
    assert found.median == 0.0 and found.caustic is None
    mask = np.zeros(SHAPE[:2], bool)
    mask[:32, :64] = True
    assert measures.errors(part, flat, mask).caustic == pytest.approx(0.5 * 0.01 / 1.01, rel=1e-12)
    # As in the test of `photonmap compare`: pixels 1 and 3, of which the first is 2 instead.
    two = np.array([[[1.0] * 3, [3.0] * 3]])
    assert measures.relmse(two + [[[1.0] * 3, [0.0] * 3]], two) == pytest.approx(0.5 / 1.04, rel=1e-12)


def test_block_differences_separate_bias_from_noise():
    flat, draw = np.ones((256, 256, 3)), np.random.default_rng(7)
    noisy = flat + 0.2 * draw.standard_normal((256, 256, 1))
    found, expected = measures.block_differences(noisy, flat)
    # 0.2/32 for each of 64 blocks, with the relative standard error 1/√128 of their root mean square.
    assert abs(found / (0.2 / 32) - 1.0) < 4.5 / math.sqrt(128)
    assert abs(expected / (0.2 / 32) - 1.0) < 4.5 / math.sqrt(2 * 256 * 256)
    noisy[:, :128] *= 1.05
    found, expected = measures.block_differences(noisy, flat)
    assert found > 4.5 * expected


def test_caustic_pixels_have_more_than_a_fifth_from_caustics():
    layers = {"RGB": np.full((1, 3, 3), 1.0), "caustic": np.array([[[0.19] * 3, [0.21] * 3, [1.0] * 3]])}
    assert measures.caustic_pixels(layers).tolist() == [[False, True, True]]


def test_noise_of_a_reference_is_that_of_the_mean_of_its_halves():
    sigma, flat = 0.1, np.ones((256, 256, 3))
    draw = np.random.default_rng(5)
    halves = [{"RGB": flat + sigma * draw.standard_normal(flat.shape), "caustic": 0 * flat} for _ in range(2)]
    found = reference.combine(*halves)
    # Mean of RGB, and of two halves: σ²/6; of n squares the relative standard error is √(2/n).
    expected = sigma**2 / 6 / 1.01
    assert abs(found.noise.all / expected - 1.0) < 4.5 * math.sqrt(2) / 256
    assert abs(measures.relmse(found.picture, flat) / expected - 1.0) < 4.5 * math.sqrt(2) / 256
    with pytest.raises(errors.PeersError, match="differ in size"):
        reference.combine(halves[0], {"RGB": flat[:8], "caustic": flat[:8]})


def test_pictures_that_are_none_are_refused(picture):
    assert measures.checked(picture, 64, "x").shape == SHAPE
    with pytest.raises(errors.RunFailed, match="shape"):
        measures.checked(picture[:8], 64, "x")
    picture[3, 4, 1] = math.nan
    with pytest.raises(errors.RunFailed, match="1 pixels are not finite"):
        measures.checked(picture, 64, "x")


def test_equal_error_times():
    # error = 1/t: an error of 1/8 after 8 s.
    ladder = [(t, 1.0 / t) for t in (2.0, 4.0, 16.0)]
    assert equal_error.time_for(0.125, ladder).value == pytest.approx(8.0)
    assert equal_error.ratio((24.0, 0.125), ladder) == equal_error.Ratio(pytest.approx(3.0))
    assert str(equal_error.ratio((24.0, 0.9), ladder)) == "> 12"
    assert str(equal_error.ratio((24.0, 0.01), ladder)) == "< 1.5"


def test_rows_are_kept_and_damaged_ones_refused(tmp_path, picture):
    store = records.Store(tmp_path)
    assert store.load("cornell", "mitsuba-path", 4.0) is None
    store.save(row(), picture)
    assert store.load("cornell", "mitsuba-path", 4.0) == row() and store.rows() == [row()]
    assert np.abs(store.picture(row()) - picture).max() < 1e-6
    store.path("cornell", "mitsuba-path", 4.0, "json").write_text('{"scene": "cornell"}')
    with pytest.raises(errors.Malformed, match="delete the file"):
        store.rows()


def test_only_another_renderer_confirms_a_reference(picture):
    def entry(renderer, off):
        found = measures.errors(picture * off, picture, np.zeros(SHAPE[:2], bool))
        return table.Entry(
            row(renderer=renderer), found, measures.compare_means(picture * off, picture), (0.0, 0.0), found
        )

    assert table.unconfirmed([entry("ours", 1.0), entry("mitsuba", 1.05)]) == ["cornell"]
    assert table.unconfirmed([entry("ours", 1.05), entry("mitsuba", 1.0)]) == []


def test_missing_tools_are_named_with_a_remedy():
    with pytest.raises(errors.ToolMissing, match="no-such-program.*install"):
        process.run(["no-such-program"])
    with pytest.raises(errors.RunFailed, match="ended with 3"):
        process.run(["sh", "-c", "exit 3"])


def test_processor_time_is_that_of_the_child():
    # A loop that ends after half a second of its own processor time.
    code = "import time\nwhile time.process_time() < 0.5: pass"
    assert 0.5 <= process.run(["python3", "-c", code]).processor < 1.5
    assert process.run(["sleep", "0.3"]).processor < 0.2


def test_models_lose_their_textures():
    texture, indices = {"index": 0}, {"POSITION": 1, "NORMAL": 2, "TEXCOORD_0": 3}
    root = {"materials": [{"normalTexture": texture}, {}], "meshes": [{"primitives": [{"attributes": indices}]}]}
    everyday.without_textures(root)
    assert "Texture" not in json.dumps(root) and len(root["materials"]) == 2
    assert root["meshes"][0]["primitives"][0]["attributes"] == {"POSITION": 1}


def test_relative_error_is_that_of_compare():
    reference, found = np.full((2, 2, 3), 2.0), np.full((2, 2, 3), 3.0)
    assert everyday.rel_mse(found, reference) == pytest.approx(1 / (4 + 0.04))
    assert everyday.rel_mse(reference, reference) == 0


def test_spotlights_become_point_lights():
    exact = {"type": "spot", "direction": [0], "inner_angle": 0, "outer_angle": 1, "intensity": [1]}
    root = {"extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}, "intensity": 2}]}}}
    root["nodes"] = [{}, {"extras": {"photonmap": {"light": exact}}}]
    text = json.dumps(root).encode()
    glb = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text), len(text), 0x4E4F534A) + text + b"rest"
    found = scene.edited(glb, scene.with_point_lights)
    length = struct.unpack_from("<4sIIII", found)[3]
    read = json.loads(found[20 : 20 + length])
    assert read["extensions"]["KHR_lights_punctual"]["lights"] == [{"type": "point", "intensity": 2}]
    assert read["nodes"][1]["extras"]["photonmap"]["light"] == {"type": "point", "intensity": [1]}
    assert found.endswith(b"rest") and len(found) % 4 == 0
    with pytest.raises(errors.Malformed):
        scene.edited(b"PK\3\4" + bytes(32), scene.with_point_lights)


def test_converters_refuse_what_they_do_not_know(tmp_path):
    view = '<transform><lookat origin="0,0,1" target="0,0,0" up="0,1,0"/></transform><float name="fov" value="40"/>'
    view = f"<sensor>{view}</sensor>"
    path = tmp_path / "scene.xml"
    path.write_text(f'<scene>{view}<emitter type="spot"/></scene>')
    with pytest.raises(errors.Unsupported, match="light spot"):
        scene.parse(path, "x", "x")
    path.write_text(f'<scene>{view}<shape><bsdf type="principled"/></shape></scene>')
    with pytest.raises(errors.Unsupported, match="BSDF principled"):
        scene.parse(path, "x", "x")
    glass = scene.Mesh(tmp_path / "a.ply", "glass", (1.0,) * 3, 1.5, None)
    header = (
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    )
    header += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    body = np.arange(9, dtype="<f4").tobytes() + struct.pack("<B3i", 3, 0, 1, 2)
    glass.path.write_bytes(header.encode() + body)
    points, triangles = scene.read_ply(glass.path)
    assert points.tolist() == [[0, 1, 2], [3, 4, 5], [6, 7, 8]] and triangles.tolist() == [[0, 1, 2]]
    with pytest.raises(errors.Unsupported, match="glass"):
        povray.mesh_text(glass)
    glass.path.write_bytes(b"ply\nformat ascii 1.0\nend_header\n")
    with pytest.raises(errors.Malformed, match="PLY"):
        scene.read_ply(glass.path)
