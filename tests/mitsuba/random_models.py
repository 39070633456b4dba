"""Compares random glTF files of many features with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/random_models.py target/release/photonmap 0 20
    python tests/mitsuba/random_models.py target/release/photonmap 7 1 --without wraps,second-set

renders the scenes of the seeds 0 to 19. Each seed has a random subset of FEATURES, which are on or off in the scene as a
whole and then used by random objects; `--without` removes some of them and leaves what the others draw as it is, so that a
difference can be reduced; what a feature excludes does not come back when it is left out. Plastics and metals have the BSDF
of gloss.py in Mitsuba, textures that of gltf_texture.py. Fails if the mean of a channel differs by more than one per cent and
4.5 standard errors, or that of a block of 8×8 pixels by more than 4 % and 4.5 standard errors (relative to the block, or to a
twentieth of the mean of the picture where it is darker), if a value is infinite or NaN, or if photonmap reports that it left
out or approximated a part of the file. Before that it checks that the comparison fails for a picture 10 % too bright in red,
for one with more than half of its blocks 25 % too bright, and for NaN and infinity; a seed too noisy for that is undecided.
Unknown options are those of `photonmap render`. Features are printed for objects where they have an effect.

Point, spot and directional lights exclude smooth glass and emission in it, whose caustics a path tracer cannot find.
"""

import argparse
import pathlib
import subprocess
import sys

import numpy as np

import block_comparison
import exported
import gloss
import gltf_texture
from model_scenes import make
from random_choices import FEATURES


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the photonmap program")
    parser.add_argument("first", type=int, help="the first seed")
    parser.add_argument("count", type=int, help="the number of scenes")
    parser.add_argument("--without", default="", help="features to leave out, separated by commas")
    parser.add_argument("--only", help="leave out all features but these")
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("out/models"))
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--samples", type=int, default=128, help="paths per pixel and run of Mitsuba")
    parser.add_argument("--runs", type=int, default=6, help="runs of each with different seeds, at least 4")
    parser.add_argument("--passes", type=int, default=10)
    args, further = parser.parse_known_args()
    if args.runs < 4:
        parser.error("at least 4 runs are needed")
    if args.count < 1 or args.first < 0:
        parser.error("seeds are at least 0, and the number of scenes is at least 1")
    if args.only is not None and args.without:
        parser.error("--only and --without exclude each other")
    named = {name for name in (args.only or args.without).split(",") if name}
    if named - set(FEATURES):
        parser.error(f"unknown: {', '.join(sorted(named - set(FEATURES)))}; features are {', '.join(FEATURES)}")
    without = named if args.only is None else set(FEATURES) - named

    import drjit as dr
    import mitsuba as mi

    mi.set_variant(args.variant)
    gloss.make_bsdf(mi, dr)
    gltf_texture.register(mi, dr)
    args.folder.mkdir(parents=True, exist_ok=True)
    different, undecided = [], []
    for seed in range(args.first, args.first + args.count):
        scene, integrator, size, options, described = make(mi, seed, args.folder, without)
        path = mi.load_dict({"type": integrator, "max_depth": -1, "rr_depth": 32})
        ours, theirs, missing = [], [], []
        for run in range(args.runs):
            theirs.append(np.array(mi.render(scene, integrator=path, spp=args.samples, seed=run), dtype=np.float64))
            picture = args.folder / f"ours-{run}.exr"
            command = [args.program, "render", args.folder / "scene.gltf", "--size", f"{size[0]}x{size[1]}", *options]
            command += ["--passes", args.passes, "--seed", run, "-o", picture]
            # Mitsuba's shadow rays start at the triangles.
            command += [*exported.OURS, "--no-terminator-offset", *further]
            missing += render([*map(str, command)])
            layers = dict(mi.Bitmap(str(picture)).split())
            ours.append(np.array(layers["<root>"], dtype=np.float64)[..., :3])
        ours, theirs = np.array(ours), np.array(theirs)[..., :3]
        for name, pictures in (("ours", ours), ("theirs", theirs)):
            mi.Bitmap(pictures.mean(axis=0).astype(np.float32)).write(str(args.folder / f"{seed}-{name}.exr"))
        unnoticed = block_comparison.unnoticed(ours, theirs)
        if unnoticed:
            # Too noisy to tell: neither an agreement nor a difference.
            print(f"seed {seed}: undecided, would pass: {', '.join(unnoticed)}; use more samples or passes", flush=True)
            undecided.append(seed)
            continue
        lines, differ = block_comparison.compare(ours, theirs)
        lines, differ = [*dict.fromkeys(missing), *lines], differ or bool(missing)
        print(f"seed {seed}: {'DIFFERS' if differ else 'agrees'}", *lines, *described, sep="\n  ", flush=True)
        different += [seed] if differ else []
    if different or undecided:
        sys.exit(f"the pictures differ: seeds {different}; undecided: seeds {undecided}")


def render(command):
    """Runs photonmap; the lines of its report about what is not as in the file, which should be none."""
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit status {done.returncode}\n{done.stderr}")
    return [line for line in done.stderr.splitlines() if "left out" in line or "approximated" in line]


if __name__ == "__main__":
    main()
