"""Measures error over processor time beside other renderers; see README.md."""

import argparse
import pathlib
import sys

from . import luxcore, measures, mitsuba3, ours, plot, povray, reference, table
from .errors import PeersError, ToolMissing
from .records import Row, Store
from .renderer import Tools
from .scene import SCENES, SIZE, prepare

# photonmap also gets this part of the shortest time: equal-error times need runs as inaccurate as those of others.
SHORTER = 0.25
RENDERERS = {"ours": ours, "mitsuba": mitsuba3, "luxcore": luxcore, "povray": povray}


def arguments():
    parser = argparse.ArgumentParser(prog="python -m studies.peers", description=__doc__)
    parser.add_argument("--program", type=pathlib.Path, default=pathlib.Path("target/release/photonmap"))
    parser.add_argument("--povray", default="povray", help="the program POV-Ray")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/peers"))
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=["cornell", "cornell-glass", "ring-point"])
    parser.add_argument("--renderers", nargs="+", choices=RENDERERS, default=list(RENDERERS))
    budgets = "seconds of processor time after preparation, over all threads"
    parser.add_argument("--budgets", nargs="+", type=float, default=[3.0, 8.0, 20.0], help=budgets)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--beside", default="ours-balanced", help="the method that equal-error times refer to")
    parser.add_argument("--report-only", action="store_true", help="tables and plot of the runs that are there")
    args = parser.parse_args()
    if args.threads < 1 or any(budget <= 0.0 for budget in args.budgets):
        parser.error("threads and budgets are above 0")
    return args


def installed(args, tools):
    """Modules and versions of the renderers that can run; says which cannot, and what would help."""
    found = {}
    for name in args.renderers:
        try:
            found[name] = RENDERERS[name].version(tools)
            print(f"{name}: {found[name]}")
        except ToolMissing as error:
            if name == "ours":
                raise
            print(f"SKIPPED {name}: {error}")
    return found


def measure(args, tools, store, scene, versions):
    """Makes the runs of a scene that are missing; returns the number of those that failed."""
    failed = 0
    for name, version in versions.items():
        variants, reasons = RENDERERS[name].variants(scene)
        for reason in reasons:
            print(f"{scene.name}: LEFT OUT {reason}")
        budgets = sorted(args.budgets)
        if name == "ours":
            budgets = [SHORTER * budgets[0], *budgets]
        for variant in variants:
            for budget in budgets:
                if store.load(scene.name, variant, budget):
                    continue
                try:
                    result = RENDERERS[name].render(tools, scene, variant, budget)
                    picture = measures.checked(result.picture, SIZE, f"{scene.name}, {variant}")
                except PeersError as error:
                    failed += 1
                    print(f"{scene.name}: FAILED {variant}, {budget:g} s: {error}", flush=True)
                    continue
                times = (result.processor, result.preparation, result.wall, tools.threads)
                row = Row(scene.name, name, variant, budget, *times, version, result.settings)
                store.save(row, picture)
                print(f"{scene.name}: {variant}, {row.net:.1f} + {row.preparation:.1f} s, {row.settings}", flush=True)
    return failed


def report(args, store, references):
    """Writes peers.csv, peers.md and peers.png; returns the number of references that nobody confirms."""
    entries = table.evaluate(store, references)
    if not entries:
        raise PeersError(f"{args.out} has no runs of these scenes", "leave --report-only out")
    (args.out / "peers.csv").write_text(table.to_csv(entries))
    parts = [table.references_markdown(references), table.to_markdown(table.longest(entries))]
    parts.append(table.equal_error_markdown(entries, args.beside))
    (args.out / "peers.md").write_text("\n".join(parts))
    plot.draw(entries, args.out / "peers.png")
    print(f"wrote {args.out}/peers.csv, peers.md and peers.png")
    missing = table.unconfirmed(entries)
    for name in missing:
        print(f"{name}: UNCONFIRMED, the mean of no other renderer agrees with the reference")
    return len(missing)


def main():
    args = arguments()
    folder = args.out / "files"
    folder.mkdir(parents=True, exist_ok=True)
    tools = Tools(args.program.resolve(), args.povray, args.threads, folder.resolve())
    store, references, faults = Store(args.out / "rows"), {}, 0
    versions = installed(args, tools)
    for name in args.scenes:
        scene = prepare(tools.program, name, (args.out / "scenes").resolve())
        references[name] = reference.render(tools, scene, args.out / "references")
        if not args.report_only:
            faults += measure(args, tools, store, scene, versions)
    return 1 if report(args, store, references) + faults else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except PeersError as error:
        sys.exit(f"error: {error}")
