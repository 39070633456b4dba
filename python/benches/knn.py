"""k-NN and counts beside scipy and pykdtree, in one process, on points of a wavy sheet as photons lie.

    python benches/knn.py [--points 1000000] [--queries 200000] [--k 50] [--gpu]

Prints seconds, best of three, and how many times as long the others take. Results are compared.
"""

import argparse
import time

import numpy as np

import photonmap as pm


def best(work, rounds=3):
    """The shortest time of several, and the result."""
    seconds = []
    for _ in range(rounds):
        begun = time.perf_counter()
        result = work()
        seconds.append(time.perf_counter() - begun)
    return min(seconds), result


def sheet(random, count):
    plane = random.random((count, 2))
    height = 0.1 * np.sin(7 * plane[:, :1]) * np.cos(5 * plane[:, 1:])
    return np.ascontiguousarray(np.concatenate([plane, height], axis=1))


def contenders(gpu):
    yield "photonmap", lambda points: pm.KDTree(points)
    if gpu:
        yield "photonmap, gpu", lambda points: pm.KDTree(points, device="gpu")
    try:
        from scipy.spatial import KDTree
    except ImportError:
        print("scipy is not installed")
    else:
        yield "scipy", lambda points: KDTree(points)
    try:
        from pykdtree.kdtree import KDTree as Pykdtree
    except ImportError:
        print("pykdtree is not installed")
    else:
        yield "pykdtree", lambda points: Pykdtree(points)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--queries", type=int, default=200_000)
    parser.add_argument("--k", type=int, default=50)
    parser.add_argument("--gpu", action="store_true")
    args = parser.parse_args()
    random = np.random.default_rng(1)
    points, x = sheet(random, args.points), sheet(random, args.queries)
    radius = 0.4 * np.sqrt(args.k / args.points)
    print(f"{args.points} points, {args.queries} queries, k = {args.k}, radius {radius:.5f}")
    print(f"{'':16}{'build':>9}{'query':>9}{'count':>9}   times as long")
    ours, expected = None, None
    for name, make in contenders(args.gpu):
        build, tree = best(lambda: make(points))
        if name == "pykdtree":
            query, (distances, ids) = best(lambda: tree.query(x, k=args.k))
            count = float("nan")
        else:
            query, (distances, ids) = best(lambda: tree.query(x, k=args.k, workers=-1))
            count, counts = best(lambda: tree.query_ball_point(x, radius, return_length=True, workers=-1))
        times = (build, query, count)
        if expected is None:
            ours, expected = times, (distances, ids, counts)
        ratios = " ".join(f"{mine:6.2f}" for mine in np.divide(times, ours))
        print(f"{name:16}" + "".join(f"{seconds:9.3f}" for seconds in times) + f"   {ratios}")
        np.testing.assert_array_equal(ids, expected[1])
        np.testing.assert_allclose(distances, expected[0], rtol=1e-12)
        if name != "pykdtree":
            np.testing.assert_array_equal(counts, expected[2])


if __name__ == "__main__":
    main()
