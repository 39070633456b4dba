"""Scenes, settings, renders and films."""

import os
import pickle
import signal
import struct
import threading
import time
import warnings
import zlib
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import photonmap as pm

QUICK = {"size": (24, 20), "passes": 2, "photons": 4000}

FLOOR = [[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]]


def room():
    scene = pm.Scene()
    scene.quad("floor", FLOOR, pm.Lambert((0.8, 0.6, 0.4)))
    scene.point_light((0, 1, 0), 10)
    return scene.camera((0, 2, 3), to=(0, 0, 0), fov=50)


@pytest.fixture(scope="module")
def film():
    return pm.render("cornell-glass", **QUICK)


def test_a_film_has_arrays(film):
    assert film.shape == (20, 24) and film.passes == 2 and film.contains == [(0, range(0, 2))]
    assert film.beauty.shape == (20, 24, 3) and film.beauty.dtype == np.float32
    assert list(film.layers) == ["emission", "direct", "caustic", "indirect"]
    np.testing.assert_array_equal(sum(film.layers.values()), film.beauty)
    assert film.beauty.mean() > 0.05 and film.layers["caustic"].max() > 0
    for name, most in [("error", np.inf), ("alpha", 1), ("depth", np.inf)]:
        values = getattr(film, name)
        assert values.shape == (20, 24) and (values >= 0).all() and (values <= most).all(), name
    np.testing.assert_allclose(np.linalg.norm(film.normal[film.alpha > 0], axis=-1), 1, atol=1e-5)
    with pytest.raises(pm.InputError, match="errors=True"):
        film.error_bound


def test_a_film_is_saved_and_pickled(film, tmp_path):
    for name in ["a.exr", "a.png", "a.film"]:
        film.save(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 500
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG") and film._repr_png_().startswith(b"\x89PNG")
    film.save(tmp_path / "b.png", exposure=2.0, tonemap="agx")
    assert (tmp_path / "b.png").read_bytes() != (tmp_path / "a.png").read_bytes()
    film.save(tmp_path / "c.png", exposure=None)
    assert (tmp_path / "c.png").read_bytes() == (tmp_path / "a.png").read_bytes() == film._repr_png_()
    for other in [pm.Film.load(tmp_path / "a.film"), pickle.loads(pickle.dumps(film))]:
        np.testing.assert_array_equal(other.beauty, film.beauty)
        np.testing.assert_array_equal(other.error, film.error)
    whole = (tmp_path / "a.film").read_bytes()
    (tmp_path / "b.film").write_bytes(whole[: len(whole) // 2])
    for call, kind, words in [
        (lambda: film.save(tmp_path / "a.jpg"), pm.InputError, "a.jpg"),
        (lambda: film.save(tmp_path / "no" / "a.png"), pm.FileError, "no"),
        (lambda: film.save(tmp_path / "a.png", tonemap="x"), pm.InputError, "neutral"),
        (lambda: film.save(tmp_path / "a.png", exposure=np.nan), pm.InputError, "exposure"),
        (lambda: pm.Film.load(tmp_path / "none.film"), pm.FileError, "none.film"),
        (lambda: pm.Film.load(tmp_path / "b.film"), pm.InputError, "b.film"),
    ]:
        with pytest.raises(kind, match=words):
            call()


def test_a_scene_of_arrays():
    scene = room()
    film = pm.render(scene, size=(32, 32), passes=4, photons=20_000)
    # Direct light on the floor below the light: intensity · albedo / π.
    center = film.layers["direct"][15:17, 15:17].mean((0, 1))
    np.testing.assert_allclose(center, 10 * np.array([0.8, 0.6, 0.4]) / np.pi, rtol=0.05)
    again = pickle.loads(pickle.dumps(scene))
    assert again.digest == scene.digest and again.cameras == ["camera"] and again.warnings == []
    np.testing.assert_array_equal(pm.render(again, size=(32, 32), passes=4, photons=20_000).beauty, film.beauty)
    # Any layout and type of arrays is the same scene; another vertex is another one.
    corners = np.asfortranarray(np.array(FLOOR, np.float32))
    other = pm.Scene().mesh("floor", corners, np.array([[0, 1, 2], [0, 2, 3]], np.int8)[:, ::1], pm.Lambert((0.8, 0.6, 0.4)))
    other.point_light([0, 1, 0], 10)
    assert other.digest == scene.digest
    assert other.quad("more", np.array(FLOOR) + [0, -1, 0]).digest != scene.digest


def test_all_objects_of_a_scene():
    scene = pm.Scene()
    for at, material in enumerate(
        [
            pm.Lambert(0.5, clearcoat=1.0),
            pm.Mirror((0.9, 0.8, 0.7)),
            pm.Glass(1.5, thin=True),
            pm.Metal((0.9, 0.7, 0.3), 0.3),
            pm.Plastic(0.5, 0.1, ior=1.4),
            pm.Plastic(0.5, 0.1, transmission=0.5, absorption=(1, 2, 3), sheen=0.3, sheen_roughness=0.5),
            pm.Lambert(0.5, diffuse_transmission=0.4, diffuse_transmission_color=(0.2, 0.8, 0.1)),
            pm.Lambert(0, emission=(5, 4, 3), emits_both_sides=True),
        ]
    ):
        scene.quad(f"quad {at}", np.array(FLOOR) + [0, -0.5 * at, 0], material)
    normals = np.tile([0.0, 2.0, 0.0], (4, 1))
    scene.mesh("smooth", np.array(FLOOR) + [0, 1, 0], [[0, 1, 2]], normals=normals)
    scene.point_light((0, 2, 0), (1, 2, 3)).spot_light((0, 3, 0), (0, -1, 0), 5, inner=10, outer=20)
    scene.directional_light((0, -1, 0), 0.5).environment(0.1).environment("sky:30,3", rotate=20)
    scene.sun((0, -1, 1), 3).environment(np.ones((4, 8, 3)), scale=0.5)
    scene.portal(FLOOR).portal(FLOOR[:3], name="half").portal("smooth")
    scene.camera((0, 2, 5), to=(0, 0, 0), aperture=0.1, name="lens")
    scene.camera((0, 2, 5), direction=(0, 0, -1), height=3, name="flat")
    assert scene.cameras == ["lens", "flat"]
    assert pm.render(scene, camera="flat", **QUICK).beauty.max() > 0
    assert pickle.loads(pickle.dumps(scene)).digest == scene.digest


def test_a_translucent_sheet():
    """A sheet that lets the share t of the light through is as bright from behind as t times one that reflects it all."""

    def seen(material, side):
        scene = pm.Scene()
        scene.quad("sheet", FLOOR, material)
        scene.directional_light([0, -1, 0], 10).camera([0, side * 3, 0.01], to=[0, 0, 0])
        return pm.render(scene, size=(16, 16), passes=2, photons=2000).beauty[8, 8]

    lit = seen(pm.Lambert(1.0), 1)
    through = seen(pm.Lambert(1.0, diffuse_transmission=0.25, diffuse_transmission_color=(0.5, 1.0, 0.0)), -1)
    np.testing.assert_allclose(lit, 10 / np.pi, rtol=1e-5)
    np.testing.assert_allclose(through, lit * [0.125, 0.25, 0.0], rtol=1e-5)
    assert pm.Plastic(0.5, transmission=0.5) != pm.Plastic(0.5)
    refused = [pm.Plastic(0.5, transmission=1.5), pm.Glass(sheen=0.5), pm.Lambert(diffuse_transmission=-1)]
    # Also what belongs to a layer that is absent.
    refused += [pm.Lambert(diffuse_transmission_color=2), pm.Mirror(sheen_roughness=-1)]
    refused += [pm.Plastic(absorption=1), pm.Plastic(transmission=0.5, absorption="x")]
    for wrong in refused:
        with pytest.raises(pm.InputError, match="transmission|sheen|absorption"):
            pm.Scene().quad("quad", FLOOR, wrong).build()


def test_a_scene_of_a_file(tmp_path):
    (tmp_path / "floor.obj").write_text("v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n")
    (tmp_path / "more.toml").write_text(
        '[[lights]]\ntype = "point"\nposition = [0, 1, 0]\nintensity = [9, 9, 9]\n'
    )
    scene = pm.Scene.load(tmp_path / "floor.obj", overrides=tmp_path / "more.toml")
    assert any("camera" in line for line in scene.report)
    film = pm.render(tmp_path / "floor.obj", overrides=tmp_path / "more.toml", **QUICK)
    np.testing.assert_array_equal(film.beauty, pm.render(scene, **QUICK).beauty)
    data = pickle.dumps(scene)
    assert pickle.loads(data).digest == scene.digest
    (tmp_path / "floor.obj").write_text("v -1 0 1\nv 1 0 1\nv 1 0 -1\nf 1 2 3\n")
    with pytest.raises(pm.InputError, match="changed since it was pickled"):
        pickle.loads(data).build()
    with pytest.raises(pm.FileError, match="none.obj"):
        pm.Scene.load(tmp_path / "none.obj")


def test_the_camera_of_an_override_file_is_the_only_one(tmp_path):
    (tmp_path / "floor.obj").write_text("v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n")
    light = '[[lights]]\ntype = "point"\nposition = [0, 1, 0]\nintensity = [9, 9, 9]\n'
    camera = '[[cameras]]\nname = "side"\nfrom = [3, 2, 0]\nto = [0, 0, 0]\nfov_degrees = 40\n'
    (tmp_path / "lit.toml").write_text(light)
    (tmp_path / "seen.toml").write_text(light + camera)
    lit = pm.Scene.load(tmp_path / "floor.obj", overrides=tmp_path / "lit.toml")
    seen = pm.Scene.load(tmp_path / "floor.obj", overrides=tmp_path / "seen.toml")
    assert lit.cameras == ["automatic"] and seen.cameras == ["side"] and lit.digest == seen.digest
    assert any("camera" in line for line in lit.report) and not any("camera" in line for line in seen.report)
    beauty = pm.render(seen, **QUICK).beauty
    by_hand = pm.Scene.load(tmp_path / "floor.obj", overrides=tmp_path / "lit.toml")
    by_hand.camera((3, 2, 0), to=(0, 0, 0), fov=40, name="other")
    np.testing.assert_array_equal(beauty, pm.render(by_hand, camera="other", **QUICK).beauty)
    assert (beauty != pm.render(lit, **QUICK).beauty).any()


def test_reading_a_scene_within_limited_memory(tmp_path):
    path, more, sky = tmp_path / "floor.obj", tmp_path / "more.toml", tmp_path / "sky.hdr"
    path.write_text("v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n")
    light = '[[lights]]\ntype = "point"\nposition = [0, 1, 0]\nintensity = [9, 9, 9]\n'
    more.write_text(light)
    sky.write_bytes(b"#?RADIANCE\n\n-Y 16 +X 32\n" + bytes([128, 128, 128, 128]) * 512)
    free = pm.Scene.load(path, overrides=more).environment(sky)
    limited = pm.Scene.load(path, overrides=more, memory=np.int64(1 << 20)).environment(sky, memory=1 << 20)
    assert free.digest == limited.digest
    with pytest.raises(pm.OutOfMemoryError, match="floor.obj.*20 bytes are left.*allow more memory"):
        pm.Scene.load(path, memory=20)
    # The override file is read before the scene.
    with pytest.raises(pm.OutOfMemoryError, match="more.toml.*allow more memory"):
        pm.Scene.load(path, overrides=more, memory=30)
    with pytest.raises(pm.OutOfMemoryError, match="sky.hdr.*allow more memory"):
        pm.Scene.load(path).environment(sky, memory=4000).build()
    # Limits are part of the pickle, and hold where it is loaded.
    data = pickle.dumps(limited)
    assert pickle.loads(data).digest == limited.digest
    more.write_text(light + "# \n" * (1 << 18))
    with pytest.raises(pm.OutOfMemoryError, match="more.toml"):
        pickle.loads(data).build()
    more.write_text(light)
    sky.write_bytes(b"#?RADIANCE\n\n-Y 256 +X 512\n" + bytes([128, 128, 128, 128]) * (256 * 512))
    with pytest.raises(pm.OutOfMemoryError, match="sky.hdr"):
        pickle.loads(data).build()


def _textured(folder):
    """A scene file with a texture of 2048 by 2048 texels, 16 MiB, and an override file with a light."""
    size, checks = 2048, np.kron([[0.2, 0.8], [0.8, 0.2]], np.ones((1024, 1024)))
    rows = b"".join(b"\0" + row.tobytes() for row in np.repeat((checks * 255).astype(np.uint8)[..., None], 3, 2))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0))
    (folder / "floor.png").write_bytes(
        b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b"")
    )
    (folder / "floor.mtl").write_text("newmtl floor\nmap_Kd floor.png\n")
    (folder / "floor.obj").write_text(
        "mtllib floor.mtl\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "usemtl floor\nf 1/1 2/2 3/3 4/4\n"
    )
    (folder / "lit.toml").write_text('[[lights]]\ntype = "point"\nposition = [0, 1, 0]\nintensity = [9, 9, 9]\n')
    return {"scene": folder / "floor.obj", "overrides": folder / "lit.toml"}


def test_the_memory_of_a_render_limits_reading_its_scene(tmp_path):
    job = {**_textured(tmp_path), **QUICK}
    free, plenty = (pm.render(**job, memory=memory).beauty for memory in (None, 1 << 28))
    np.testing.assert_array_equal(free, plenty)
    # Half of the limit is for the texture, whose edge between dark and bright is then blurred.
    reduced = pm.render(**job, memory=8 << 20).beauty
    assert (reduced != free).any()
    by_hand = pm.Scene.load(job["scene"], job["overrides"], memory=4 << 20)
    assert any("reduced" in line for line in by_hand.report)
    np.testing.assert_array_equal(reduced, pm.render(by_hand, **QUICK).beauty)
    with pytest.raises(pm.OutOfMemoryError, match="allow more memory"):
        pm.render(**job, memory=1000)


def test_counts_may_be_floats_without_a_fraction():
    job = dict(size=(8, 8), passes=1, photons=1000, device="cpu")
    np.testing.assert_array_equal(pm.render("cornell", **{**job, "passes": 1.0, "photons": 1e3}).beauty, pm.render("cornell", **job).beauty)
    assert pm.Settings(photons=1e5, caustic_photons=2e3, memory=2e9) == pm.Settings(
        photons=100_000, caustic_photons=2000, memory=2_000_000_000
    )
    for fields, words in [
        ({"photons": 1.5}, "photons is 1.5, but must be a whole number"),
        ({"photons": -1}, "photons is -1, but must be a whole number"),
        ({"shadow_rays": 1e300}, r"shadow_rays is 1e\+?300, but must be a whole number"),
        ({"alpha": "steep"}, 'alpha is "steep", but must be a number'),
        ({"errors": 1}, "errors is 1, but must be a boolean"),
    ]:
        with pytest.raises(pm.InputError, match=words):
            pm.Settings(**fields)
    for count in ["passes", "threads"]:
        with pytest.raises(pm.InputError, match=f"{count} is 1.5, but must be a whole number"):
            pm.render("cornell", **{**job, count: 1.5})


def test_a_pass_keeps_to_the_time():
    begun = time.monotonic()
    with pytest.warns(RuntimeWarning, match="shadow rays instead of 4096"):
        film = pm.render("cornell", size=64, time=0.4, shadow_rays=4096, photons=1000, device="cpu", threads=1)
    # Each pass would take many seconds.
    assert film.passes >= 1 and time.monotonic() - begun < 4


@pytest.mark.parametrize("wrong", [0, -1, 1.5, float("nan"), True, "1 GB", 2**64])
def test_limits_that_are_no_number_of_bytes(tmp_path, wrong):
    with pytest.raises(pm.InputError, match="memory is .* whole number of bytes"):
        pm.Scene.load(tmp_path / "none.obj", memory=wrong)
    with pytest.raises(pm.InputError, match="memory is .* whole number of bytes"):
        pm.Scene().environment(1.0, memory=wrong)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: pm.render("cornel"), ["cornel", "cornell-glass"]),
        (lambda: pm.render("x.abc"), ["x.abc", ".gltf"]),
        (lambda: pm.render(5), ["scene is 5"]),
        (lambda: pm.render(pm.Scene().quad("floor", FLOOR).environment(0), **QUICK), ["no light"]),
        (lambda: pm.render(pm.Scene().quad("floor", FLOOR), environment=1), ["environment=", "method"]),
        (lambda: pm.render("cornell", environment="sky:high"), ["sky:high", "sky:30,3"]),
        (lambda: pm.render("cornell", environment="constant:1,2"), ["constant:1,2", "three numbers"]),
        (lambda: pm.render("cornell", radius=0.1), ["'radius'", "estimator="]),
        (lambda: pm.render("cornell", size=(0, 5)), ["size is 0"]),
        (lambda: pm.render("cornell", size="big"), ["size is 'big'"]),
        (lambda: pm.render("cornell", size=5.5), ["size is 5.5"]),
        (lambda: pm.render("cornell", passes=-1), ["passes is -1"]),
        (lambda: pm.render("cornell", passes=2.5), ["passes is 2.5"]),
        (lambda: pm.render("cornell", time=float("nan")), ["time is nan"]),
        (lambda: pm.render("cornell", target_error=-1), ["target-error", "-1"]),
        (lambda: pm.render("cornell", device="tpu"), ["device", "tpu"]),
        (lambda: pm.render("cornell", camera="rear", **QUICK), ["rear"]),
        (lambda: pm.render("cornell", photon=5), ["photon", "photons"]),
        (lambda: pm.render("cornell", photons=-5), ["-5"]),
        (lambda: pm.render("cornell", photons=0), ["photons"]),
        (lambda: pm.render("cornell", alpha=float("nan")), ["alpha is nan"]),
        (lambda: pm.render("cornell", indirect="magic"), ["magic", "gather"]),
        (lambda: pm.render("cornell", kernel=object()), ["object"]),
        (lambda: pm.render("cornell", preset="best"), ["best", "balanced"]),
        (lambda: pm.render("cornell", progress=3), ["progress is 3"]),
        (lambda: pm.render("cornell", settings=pm.Settings(), preset="final"), ["preset"]),
        (lambda: pm.render("cornell", film="a.exr"), ["a.exr", ".film"]),
        (lambda: pm.render("cornell", grain=3, passes=4), ["grain 3"]),
        (lambda: pm.render("cornell", grain=2, time=5), ["time", "passes"]),
        (lambda: pm.render("cornell", grain=2, passes=4, target_error=0), ["target-error", "0"]),
        (lambda: pm.render("cornell", grain=1, errors=True, bandwidth="per-pixel"), ["bandwidth", "shared"]),
        (lambda: pm.render("cornell", grain=1, size=8, photons=10**9, memory=2 * 10**7), ["memory", "photons="]),
        (lambda: pm.render("cornell", executor=5), ["executor is 5"]),
        (lambda: pm.Scene().mesh("m", [[0, 0]], [[0, 0, 0]]), ["'m'", "(1, 2)"]),
        (lambda: pm.Scene().mesh("m", FLOOR, [[0, 1, 4]]), ["triangle 0", "4 vertices"]),
        (lambda: pm.Scene().mesh("m", FLOOR, [[0, 1, -1]]), ["triangle 0"]),
        (lambda: pm.Scene().mesh("m", FLOOR, [[0.0, 1.0, 2.0]]), ["whole numbers"]),
        (lambda: pm.Scene().mesh("m", FLOOR, [[0, 1, 2]], "gold"), ["'gold'", "Lambert"]),
        (lambda: pm.Scene().mesh("m", FLOOR, [[0, 1, 2]], normals=[[0, 0, 1]]), ["1 normals for 4"]),
        (lambda: pm.Scene().mesh("m", [[0, 0, np.nan]] * 3, [[0, 1, 2]]).build(), ["m", "NaN"]),
        (lambda: pm.Scene().quad("q", FLOOR[:3]), ["(3, 3)"]),
        (lambda: pm.Scene().quad("q", FLOOR, pm.Lambert(2)).build(), ["albedo", "2"]),
        (lambda: pm.Scene().quad("q", FLOOR, pm.Lambert("red")).build(), ["'red'"]),
        (lambda: pm.Scene().quad("q", FLOOR, pm.Lambert(emission=-1)).build(), ["emi", "-1"]),
        (lambda: pm.Scene().quad("q", FLOOR, pm.Material()).build(), ["Lambert"]),
        (lambda: pm.Scene().quad("q", FLOOR, pm.Metal(0.5, 7)).build(), ["roughness", "7"]),
        (lambda: pm.Scene().point_light((0, 0), 1), ["position"]),
        (lambda: pm.Scene().point_light((0, 0, 0), -1).build(), ["intensity", "-1"]),
        (lambda: pm.Scene().camera((0, 0, 0)), ["to="]),
        (lambda: pm.Scene().camera((0, 0, 0), to=(0, 0, 0)).build(), ["camera", "direction"]),
        (lambda: pm.Scene().camera((0, 0, 0), direction=(0, 0, 1), aperture=1), ["focus="]),
        (lambda: pm.Scene().environment("sky:high"), ["sky:30,3"]),
        (lambda: pm.Scene().environment(np.zeros((4, 4, 3))).build(), ["twice as wide"]),
        (lambda: pm.Scene().environment(-1).build(), ["radiance"]),
        (lambda: pm.Scene().portal(FLOOR[:2]), ["(2, 3)"]),
        (lambda: pm.Scene().portal("window").build(), ["portal 'window'"]),
        (lambda: pm.Scene().quad("q", FLOOR).portal([(0, 0, 0)] * 3, name="gap").build(), ["portal 'gap'", "area"]),
        (lambda: pm.Scene.builtin("x"), ["x", "ring"]),
    ],
)
def test_bad_input_is_named(call, words):
    with pytest.raises(pm.InputError) as caught:
        call()
    assert all(word in str(caught.value) for word in words), caught.value


def test_settings():
    settings = pm.Settings(photons=np.int64(5000), estimator={"knn": {"k": 9}}, kernel="constant")
    assert settings.photons == 5000 and settings.kernel == "constant" and settings.alpha == pm.Settings().alpha
    again = pickle.loads(pickle.dumps(settings))
    assert again == settings and hash(again) == hash(settings) and again != settings.replace(seed=1)
    assert "photons=5000" in repr(settings) and "alpha" not in repr(settings)
    assert pm.Settings(preset="balanced", size=(100, 100)).area == "surface"
    assert pm.Settings(preset="balanced", area="disc").area == "disc"
    assert set(settings.to_dict()) <= set(dir(settings))
    with pytest.raises(AttributeError, match="photons"):
        settings.photon
    with pytest.raises(AttributeError, match="replace"):
        settings.photons = 3
    film = pm.render("cornell", settings=settings, **QUICK)
    expected = pm.render("cornell", estimator={"knn": {"k": 9}}, kernel="constant", **QUICK)
    np.testing.assert_array_equal(film.beauty, expected.beauty)
    assert (film.beauty != pm.render("cornell", **QUICK).beauty).any()


def test_the_error_target_ends_a_render(tmp_path):
    film = pm.render("cornell", size=(16, 16), photons=20_000, passes=90, target_error=0.9, share=0.5)
    assert 8 <= film.passes < 90
    bound = film.error_bound
    assert bound.shape == (16, 16) and np.median(bound) > 0 and not np.isnan(bound).any()
    again = pickle.loads(pickle.dumps(film))
    np.testing.assert_array_equal(again.error_bound, bound)
    # Two passes are too few for an estimate.
    assert np.isposinf(pm.render("cornell", errors=True, **QUICK).error_bound).all()


def test_progress_is_reported_and_may_stop():
    seen = []
    pm.render("cornell", progress=seen.append, **QUICK)
    assert seen[-1] == pm.Progress(passes=2, total=2, fraction=0.0, error=None)
    assert [progress.passes for progress in seen] == [0, 0, 1, 1, 2]
    stopped = pm.render("cornell", progress=lambda progress: progress.passes < 3, size=8, passes=50, photons=2000)
    assert stopped.passes == 3
    # Within the first pass: a film that can be shown, but not stored.
    cut = pm.render("cornell", progress=lambda progress: progress.fraction == 0, size=8, passes=50, photons=2000)
    assert cut.passes == 1 and cut.beauty.shape == (8, 8, 3)

    class Stop(Exception):
        pass

    def fail(progress):
        raise Stop("here")

    with pytest.raises(Stop, match="here"):
        pm.render("cornell", progress=fail, **QUICK)


def test_a_progress_bar(capsys, monkeypatch):
    pm.render("cornell", progress=True, **QUICK)
    assert "2" in capsys.readouterr().err
    # Without tqdm, a line of text.
    monkeypatch.setitem(__import__("sys").modules, "tqdm.auto", None)
    pm.render("cornell", progress=True, **QUICK)
    assert "2 of 2 passes" in capsys.readouterr().err


def test_ctrl_c_keeps_the_passes():
    """Raised by the progress function as the interpreter raises it, after two passes; in blocks of two within the second."""
    scene = room()

    def interrupt(progress):
        if progress.passes >= 2 + bool(progress.fraction):
            raise KeyboardInterrupt

    job = {"size": (16, 12), "photons": 3000}
    expected = pm.render(scene, passes=2, grain=2, **job).beauty
    with ThreadPoolExecutor(2) as pool:
        for extra in ({}, {"grain": 2}, {"executor": pool, "grain": 2}):
            with pytest.raises(KeyboardInterrupt, match="film has 2 passes") as caught:
                pm.render(scene, passes=20, device="cpu", progress=interrupt, **extra, **job)
            assert isinstance(caught.value, pm.Interrupted) and caught.value.film.passes == 2
            assert pickle.loads(pickle.dumps(caught.value)).film.passes == 2
            if extra:
                np.testing.assert_array_equal(caught.value.film.beauty, expected)
            # What comes next is not affected.
            np.testing.assert_array_equal(pm.render(scene, passes=2, grain=2, **job).beauty, expected)

    def at_once(progress):
        raise KeyboardInterrupt

    with pytest.raises(pm.Interrupted) as caught:
        pm.render(scene, passes=20, grain=2, progress=at_once, **job)
    assert caught.value.film is None


@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.parametrize("extra", [{}, {"grain": 5}])
def test_ctrl_c_stops_within_a_pass(extra):
    """One interrupt, while passes of many batches are rendered."""
    timer = threading.Timer(0.7, os.kill, (os.getpid(), signal.SIGINT))
    begun = time.monotonic()
    # A shell that starts the tests in the background lets them ignore it.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(pm.Interrupted) as caught:
            timer.start()
            pm.render("cornell", size=8, passes=5, photons=50_000_000, device="cpu", **extra)
        # Of a block that was not finished nothing is kept; without blocks, the paths of the first pass until then are.
        film = caught.value.film
        assert film is None if extra else film.passes == 1 and 0 < film.counts["paths"]["emitted"] < 50_000_000
    finally:
        signal.signal(signal.SIGINT, before)
    assert time.monotonic() - begun < 20
    timer.join()


def test_other_threads_run_during_a_render():
    """The lock of the interpreter is released."""
    counts = []
    done = threading.Event()

    def count():
        while not done.is_set():
            counts.append(time.monotonic())
            time.sleep(0.005)

    thread = threading.Thread(target=count)
    thread.start()
    begun = time.monotonic()
    pm.render("cornell", size=8, passes=1, photons=400_000)
    ended = time.monotonic()
    done.set()
    thread.join()
    during = sum(begun < at < ended for at in counts)
    assert during > 5, (during, ended - begun)


def test_the_gpu_renders_the_same_picture():
    try:
        film = pm.render("cornell", device="gpu", **QUICK)
    except pm.DeviceError:
        if os.environ.get("PHOTON_REQUIRE_VULKAN", "0") != "0":
            raise
        pytest.skip("no Vulkan")
    expected = pm.render("cornell", device="cpu", **QUICK)
    np.testing.assert_allclose(film.beauty.mean(), expected.beauty.mean(), rtol=1e-3)


def test_warnings_are_python_warnings():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pm.render("cornell", **QUICK)
