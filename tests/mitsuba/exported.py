"""Compares a scene with what `photonmap export` writes of it for Mitsuba 3 (Jakob et al. 2022), by colour channel.

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/exported.py target/release/photonmap cornell-glass
    python tests/mitsuba/exported.py target/release/photonmap scene.obj --overrides scene.toml

Both render several pictures with different seeds, whose spread gives standard errors: caustics and the edges of visible
lights are noisy in a path tracer, so that a picture of 64 × 64 pixels and 64 paths per pixel is off by 1 to 2 % as a
whole. Fails if the mean of a channel differs by more than half a per cent and 4.5 standard errors, or that of a block of
pixels by more than 4 % and 4.5 standard errors. Before that it checks that the comparison fails for a picture that is 6 %
too bright in red.

Point, spot and directional lights need more samples than there are behind mirrors or glass, as in check.py. Our estimates
are biased in corners and at edges; `--area surface` and a small `--radius-factor` keep that below the limits. Unknown options
are those of `photonmap render`.
"""

import argparse
import pathlib
import subprocess
import sys

import numpy as np

OURS = ["--area", "surface", "--radius-factor", "0.6"]


def statistics(pictures, block):
    """Means and standard errors of the channels, and of those of blocks of pixels."""
    runs, size = len(pictures), pictures.shape[1]
    cells = pictures.reshape(runs, size // block, block, size // block, block, 3).mean(axis=(2, 4))
    return [(x.mean(axis=0), x.std(axis=0, ddof=1) / runs**0.5) for x in (pictures.mean(axis=(1, 2)), cells)]


def compare(ours, theirs, block, limits=(0.005, 0.04)):
    """Lines that describe the differences, and whether they exceed the limits."""
    lines, differ = [], False
    for name, limit, (a, a_error), (b, b_error) in zip(
        ("channels", "blocks"), limits, statistics(ours, block), statistics(theirs, block)
    ):
        off, error = a / b - 1, np.hypot(a_error, b_error) / b
        # Not >: NaN differs too.
        differ |= not bool((np.abs(off) <= limit + 4.5 * error).all())
        if off.ndim == 1:
            each = ", ".join(f"{c} {100 * o:+.2f} ± {100 * e:.2f} %" for c, o, e in zip("RGB", off, error))
            lines.append(f"{name}, ours against theirs: {each}")
        else:
            worst = np.unravel_index(np.abs(off).argmax(), off.shape)
            z = (off / error).ravel()
            lines.append(
                f"{name} of {block} pixels: worst {100 * off[worst]:+.1f} ± {100 * error[worst]:.1f} %, "
                f"rms {100 * np.sqrt((off**2).mean()):.2f} %, rms z {np.sqrt((z**2).mean()):.2f}"
            )
    return lines, differ


def run(command, *further):
    """Runs a command; what it says is shown if it fails."""
    done = subprocess.run([*map(str, command), *further], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{done.stderr}{command[0]} failed")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the photonmap program")
    parser.add_argument("scene", help="a built-in scene or a file")
    parser.add_argument("--overrides", help="an override file")
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("out/exported"))
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--size", type=int, default=64)
    parser.add_argument("--block", type=int, default=16)
    parser.add_argument("--samples", type=int, default=512, help="paths per pixel and run of Mitsuba")
    parser.add_argument("--runs", type=int, default=8, help="runs of each with different seeds, at least 4")
    parser.add_argument("--passes", type=int, default=64)
    args, further = parser.parse_known_args()
    if args.runs < 4 or args.size % args.block:
        parser.error("at least 4 runs, and blocks that divide the picture, are needed")

    import mitsuba as mi

    mi.set_variant(args.variant)
    args.folder.mkdir(parents=True, exist_ok=True)
    common = [args.scene, *(["--overrides", args.overrides] if args.overrides else [])]
    common += ["--size", f"{args.size}x{args.size}"]
    exported = args.folder / "scene.xml"
    subprocess.run([str(args.program), "export", *common, "-o", str(exported)], check=True)
    scene = mi.load_file(str(exported))
    absorbs = 'type="homogeneous"' in exported.read_text()
    path = mi.load_dict({"type": "volpath" if absorbs else "path", "max_depth": -1, "rr_depth": 32})
    ours, theirs = [], []
    for seed in range(args.runs):
        theirs.append(np.array(mi.render(scene, integrator=path, spp=args.samples, seed=seed), dtype=np.float64))
        picture = args.folder / f"ours-{seed}.exr"
        command = [args.program, "render", *common, *OURS, "--passes", args.passes, "--seed", seed, "-o", picture]
        run(command, *further)
        layers = dict(mi.Bitmap(str(picture)).split())
        ours.append(np.array(layers["<root>"], dtype=np.float64)[..., :3])
    ours, theirs = np.array(ours), np.array(theirs)[..., :3]
    if not compare(ours * [1.06, 1.0, 1.0], theirs, args.block)[1]:
        sys.exit("too noisy: a picture 6 % too bright in red would pass; use more samples, passes or runs")
    lines, differ = compare(ours, theirs, args.block)
    print("\n".join(lines))
    if differ:
        sys.exit("the pictures differ")


if __name__ == "__main__":
    main()
