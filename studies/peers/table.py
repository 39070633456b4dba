"""The table of all runs as CSV and Markdown, and that of equal-error times."""

import csv
import io
from dataclasses import dataclass

from . import equal_error, measures
from .records import Row

MEASURES = ("all", "caustic", "median")
# Errors below this many times the reference's noise are marked.
NOISE_FACTOR = 10.0


@dataclass(frozen=True)
class Entry:
    """A run with its errors beside the reference."""

    row: Row
    errors: measures.Errors
    means: measures.Means
    blocks: tuple
    noise: measures.Errors

    def near_noise(self, measure):
        error, noise = getattr(self.errors, measure), getattr(self.noise, measure)
        return error is not None and error < NOISE_FACTOR * noise


def evaluate(store, references):
    """Entries of all rows of scenes with a reference."""
    entries = []
    for row in store.rows():
        if row.scene in references:
            reference, picture = references[row.scene], store.picture(row)
            errors = measures.errors(picture, reference.picture, reference.caustic)
            means = measures.compare_means(picture, reference.picture)
            blocks = measures.block_differences(picture, reference.picture)
            entries.append(Entry(row, errors, means, blocks, reference.noise))
    return entries


def ladders(entries, measure):
    """(seconds, error) by (scene, variant), of measures that the scene has."""
    found = {}
    for entry in entries:
        error = getattr(entry.errors, measure)
        if error is not None:
            found.setdefault((entry.row.scene, entry.row.variant), []).append((entry.row.net, error))
    return {key: sorted(points) for key, points in found.items()}


def columns(entry):
    row, errors, means = entry.row, entry.errors, entry.means
    yield from (("scene", row.scene), ("variant", row.variant), ("budget_s", f"{row.budget:g}"))
    yield from (("processor_s", f"{row.processor:.2f}"), ("preparation_s", f"{row.preparation:.2f}"))
    yield from (("wall_s", f"{row.wall:.2f}"), ("threads", row.threads))
    for measure in MEASURES:
        error = getattr(errors, measure)
        yield f"relmse_{measure}" if measure != "median" else "median", "" if error is None else f"{error:.3e}"
    for channel, ratio, error in zip("rgb", means.ratio, means.error):
        yield from ((f"mean_{channel}", f"{ratio:.4f}"), (f"mean_{channel}_error", f"{error:.4f}"))
    yield from zip(("blocks", "blocks_error"), (f"{share:.4f}" for share in entry.blocks), strict=True)
    yield from (("means", means.verdict), ("version", row.version), ("settings", row.settings))


def to_csv(entries):
    text = io.StringIO()
    writer = csv.DictWriter(text, [name for name, _ in columns(entries[0])], lineterminator="\n")
    writer.writeheader()
    writer.writerows(dict(columns(entry)) for entry in entries)
    return text.getvalue()


def number(entry, measure):
    error = getattr(entry.errors, measure)
    return "–" if error is None else f"{error:.2e}" + ("†" if entry.near_noise(measure) else "")


def longest(entries):
    """The run of each method with the largest budget."""
    found = {}
    for entry in entries:
        found[entry.row.scene, entry.row.variant] = entry
    return list(found.values())


def to_markdown(entries):
    """Processor seconds after preparation, errors, and the means."""
    lines = ["| scene | method | s | relMSE | caustic | median | mean | means |", "|---|---|--:|--:|--:|--:|--:|---|"]
    for entry in entries:
        mean = sum(entry.means.ratio) / 3.0
        cells = [entry.row.scene, entry.row.variant, f"{entry.row.net:.1f}", *(number(entry, m) for m in MEASURES)]
        lines.append("| " + " | ".join([*cells, f"{mean:.3f}", entry.means.verdict]) + " |")
    return "\n".join(lines) + "\n"


def references_markdown(references):
    lines = ["| scene | caustic pixels | relMSE of its noise | caustic | median |", "|---|--:|--:|--:|--:|"]
    for name, reference in references.items():
        noise = reference.noise
        cells = [f"{getattr(noise, m):.1e}" if getattr(noise, m) is not None else "–" for m in MEASURES]
        lines.append(f"| {name} | {100 * reference.caustic.mean():.1f} % | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def equal_error_markdown(entries, baseline):
    """The longest run of each method: its time over that which `baseline` takes for the same error."""
    lines = ["| scene | method | s | all pixels | caustic pixels | median pixel |", "|---|---|--:|--:|--:|--:|"]
    by_measure = {measure: ladders(entries, measure) for measure in MEASURES}
    for scene, variant in by_measure["all"]:
        if variant == baseline or (scene, baseline) not in by_measure["all"]:
            continue
        cells = []
        for measure in MEASURES:
            found = by_measure[measure]
            ours, theirs = found.get((scene, baseline)), found.get((scene, variant))
            cells.append(str(equal_error.ratio(theirs[-1], ours)) if theirs else "–")
        seconds = by_measure["all"][scene, variant][-1][0]
        lines.append(f"| {scene} | {variant} | {seconds:.1f} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def unconfirmed(entries):
    """Scenes whose reference no other renderer's mean agrees with."""
    agree = {e.row.scene for e in entries if e.row.renderer != "ours" and e.means.verdict == "agrees"}
    return sorted({entry.row.scene for entry in entries} - agree)
