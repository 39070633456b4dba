"""Compares our references with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo run --release -- export cornell --size 48x48 -o out/export/cornell.xml
    cargo run --release -p studies --bin tradeoff -- cornell --part reference --size 48
    python tests/mitsuba/check.py out/export/cornell.xml --results out/tradeoff

adds part-tracer-cornell.json to the results, from which `tradeoff --assemble` makes a table. Where the result is
known (furnace, integrating-sphere) no reference is needed: the closed form itself is checked.

A path tracer cannot sample paths from point, spot or directional lights via mirrors or glass, so that it cannot
render `ring` and `pool`.
"""

import argparse
import json
import math
import pathlib
import sys
import time
import xml.etree.ElementTree

import numpy as np

# Radiance of scenes with a known result, and whether it is that of light scattered at least once.
CLOSED = {"furnace": (2.0 / math.pi, False), "integrating-sphere": (0.8 / math.pi, True)}


def load(path, mi):
    """Returns the name, the side of the picture in pixels, and Mitsuba's scene."""
    kinds = {plugin.get("type") for plugin in xml.etree.ElementTree.parse(path).getroot().iter()}
    specular = kinds & {"conductor", "dielectric", "thindielectric"}
    if kinds & {"spot", "directional"} or ("point" in kinds and specular):
        sys.exit(f"{path.stem}: a path tracer cannot sample its lights")
    if "homogeneous" in kinds:
        sys.exit(f"{path.stem}: absorption needs the volumetric path tracer")
    scene = mi.load_file(str(path))
    width, height = scene.sensors()[0].film().size()
    if width != height:
        sys.exit("references are square pictures: export with --size NxN")
    return path.stem, int(width), scene


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=pathlib.Path, help="the .xml that `photonmap export` wrote")
    parser.add_argument("--results", type=pathlib.Path, default=pathlib.Path("out/tradeoff"))
    parser.add_argument("--variant", default="scalar_rgb")
    parser.add_argument("--samples", type=int, default=256, help="paths per pixel and run")
    parser.add_argument("--runs", type=int, default=8, help="runs with different seeds, at least 2")
    args = parser.parse_args()
    if args.runs < 2 or args.samples < 1:
        parser.error("at least 2 runs and 1 sample are needed")

    import mitsuba as mi

    mi.set_variant(args.variant)
    name, size, scene = load(args.scene, mi)
    radiance, scattered = CLOSED.get(name, (None, False))
    if radiance is None:
        record = json.loads((args.results / f"reference-{name}-{size}.json").read_text())
        ours = np.array(record["pixels"], dtype=np.float64).reshape(size, size, 3).mean(axis=2)
        claimed, backend = record["note"]["Reference"]["error"], record["backend"]
    else:
        ours, claimed, backend = np.full((size, size), radiance), 0.0, "closed form"

    whole = mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": 16})
    direct = mi.load_dict({"type": "path", "max_depth": 2, "rr_depth": 16})
    begun, runs = time.time(), []
    for seed in range(args.runs):
        picture = np.array(mi.render(scene, integrator=whole, spp=args.samples, seed=2 * seed), dtype=np.float64)
        if scattered:
            picture -= np.array(mi.render(scene, integrator=direct, spp=args.samples, seed=2 * seed + 1))
        runs.append(picture.mean(axis=2))
        print(f"{name}: run {seed + 1} of {args.runs}, {time.time() - begun:.0f} s", file=sys.stderr)
    runs = np.array(runs)
    theirs, error = runs.mean(axis=0), runs.std(axis=0, ddof=1) / math.sqrt(args.runs)
    floor = 0.01 * ours.mean() ** 2
    weight = 1.0 / (ours**2 + floor)
    relative = (theirs - ours) * np.sqrt(weight)
    difference, noise = float(np.mean(relative**2)), float(np.mean(weight * error**2))
    # Assumes that errors of pixels are independent, which holds for the path tracer.
    mean_error = math.sqrt((noise + claimed) / ours.size)
    row = {
        "scene": name,
        "reference": backend,
        "samples": args.runs * args.samples,
        "seconds": time.time() - begun,
        "mean": float(relative.mean()),
        "z": float(relative.mean()) / mean_error,
        "difference": difference,
        "noise": noise,
        "claimed": claimed,
    }
    print(json.dumps(row, indent=1))
    part = {"backend": "mitsuba", "device": f"Mitsuba {mi.__version__}, {args.variant}", "body": {"Tracer": [row]}}
    args.results.mkdir(parents=True, exist_ok=True)
    (args.results / f"part-tracer-{name}.json").write_text(json.dumps(part))


if __name__ == "__main__":
    main()
