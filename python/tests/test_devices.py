"""Devices by name, and several at a time."""

import os
from concurrent.futures import ThreadPoolExecutor

import pytest

import photonmap as pm
from test_blocks import JOB, bits, interrupt

ONE = "gpu:" + os.environ.get("PHOTON_VK_DEVICE", "0")
TWO = f"{ONE},{ONE[4:]}"


@pytest.fixture(scope="module")
def expected():
    """The film of one GPU, if there is one."""
    try:
        return bits(pm.render(**JOB, device=ONE))
    except pm.DeviceError:
        if os.environ.get("PHOTON_REQUIRE_VULKAN", "0") != "0":
            raise
        pytest.skip("no Vulkan")


def test_devices_share_the_blocks(expected, tmp_path):
    seen = []
    assert bits(pm.render(**JOB, device=TWO, progress=seen.append)) == expected
    assert max(progress.passes for progress in seen) == 8
    # The comparison notices another order of sums, and another backend.
    assert bits(pm.render(**{**JOB, "grain": 4}, device=TWO)) != expected
    assert bits(pm.render(**JOB)) != expected
    # Into a film, in two runs, with checkpoints; the second one by workers with a device each.
    path = tmp_path / "a.film"
    assert pm.render(**{**JOB, "passes": 4}, device=TWO, film=path, checkpoint=0).passes == 4
    with ThreadPoolExecutor(2) as pool:
        film = pm.render(**JOB, device=ONE, film=path, executor=pool)
    assert bits(film) == expected == bits(pm.Film.load(path))
    assert film.counts["passes"] == 8


def test_devices_stop_together(expected, tmp_path):
    path = tmp_path / "a.film"
    # Enough passes that those after the first progress take longer than it takes to stop on a busy machine.
    job = {**JOB, "passes": 40}
    with pytest.raises(KeyboardInterrupt):
        pm.render(**job, device=TWO, film=path, progress=interrupt)
    if path.exists():
        assert pm.Film.load(path).passes in range(2, 40, 2)
    assert bits(pm.render(**job, device=TWO, film=path)) == bits(pm.render(**job, device=ONE))
    # A target error ends it at the pass of one device.
    job = {**JOB, "passes": 64, "target_error": 0.12, "share": 0.8}
    one, two = (pm.render(**job, device=device) for device in (ONE, TWO))
    assert one.passes == two.passes < 64 and bits(one) == bits(two)


def test_one_device_by_name_searches_and_traces(expected):
    points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    assert pm.KDTree(points, device=ONE).query([[0.1, 0.0, 0.0]], 1)[1].tolist() == [0]
    assert len(pm.trace("cornell", photons=1000, device=ONE).position) > 0


@pytest.mark.parametrize("wrong", ["tpu", "gpu:", "gpu:0,", "gpu:all,0", "GPU", 0, None, ["gpu"]])
def test_other_names_are_refused(wrong):
    for call in (
        lambda: pm.render("cornell", device=wrong),
        lambda: pm.KDTree([[0.0, 0.0, 0.0]], device=wrong),
        lambda: pm.trace("cornell", device=wrong),
    ):
        with pytest.raises(pm.InputError, match="device is .*gpu:0,1"):
            call()


def test_what_does_not_fit_several_devices_is_refused():
    for call, words in (
        (lambda: pm.KDTree([[0.0, 0.0, 0.0]], device="gpu:0,1"), "only render"),
        (lambda: pm.trace("cornell", device="gpu:all"), "only render"),
        (lambda: pm.render("cornell", device="gpu:0,1", time=1), "time: .*several devices"),
        (lambda: pm.render("cornell", device="gpu:0,1", bandwidth="per-pixel", errors=True), "shared"),
        (lambda: pm.render("cornell", device="gpu:0,1", passes=3, grain=2), "multiple of the grain"),
        (lambda: pm.render("cornell", device="gpu:0,1", executor=ThreadPoolExecutor(1)), "each worker .*one device"),
    ):
        with pytest.raises(pm.InputError, match=words):
            call()
    with pytest.raises(pm.DeviceError, match="gpu:no such GPU"):
        pm.render("cornell", device="gpu:no such GPU")


def test_all_devices_are_gpus_or_an_error():
    """Software drivers are not among them."""
    try:
        assert pm.render(**JOB, device="gpu:all").passes == JOB["passes"]
    except pm.DeviceError as why:
        assert "gpu:all" in str(why) and "--" not in str(why)
