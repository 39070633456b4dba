"""Forked processes: searches work, and what cannot work is a typed error instead of a hang."""

import os
import signal
import traceback

import numpy as np
import pytest

import photonmap as pm

POINTS = np.random.default_rng(3).random((20_000, 3))

pytestmark = [
    pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here"),
    pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning"),
]


def in_child(work, seconds=60):
    """Runs `work` in a forked child; fails if it raises or hangs."""
    child = os.fork()
    if child == 0:
        signal.alarm(seconds)
        try:
            work()
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        os._exit(0)
    _, status = os.waitpid(child, 0)
    assert status == 0, f"the child ended with status {status}"


def test_the_helper_notices_a_hang():
    with pytest.raises(AssertionError, match="status"):
        in_child(lambda: signal.pause(), seconds=1)


def test_search_in_a_forked_child():
    tree = pm.KDTree(POINTS)
    expected = tree.query(POINTS, 3)[1]

    def work():
        assert (tree.query(POINTS, 3)[1] == expected).all()
        assert (pm.KDTree(POINTS).query(POINTS, 3)[1] == expected).all()
        in_child(lambda: tree.count(POINTS, 0.1))

    in_child(work)


def test_a_gpu_in_a_forked_child_is_a_typed_error():
    try:
        tree = pm.KDTree(POINTS, device="gpu")
    except pm.DeviceError:
        if os.environ.get("PHOTON_REQUIRE_VULKAN", "0") != "0":
            raise
        pytest.skip("no Vulkan")

    def work():
        for call in [lambda: tree.query(POINTS[:9], 3), lambda: pm.KDTree(POINTS, device="gpu")]:
            with pytest.raises(pm.ForkError) as caught:
                call()
            assert isinstance(caught.value, RuntimeError)
            assert "fork" in str(caught.value) and "spawn" in str(caught.value) or "this process" in str(caught.value)
        pm.KDTree(POINTS).query(POINTS, 3)

    in_child(work)
    tree.query(POINTS[:9], 3)
