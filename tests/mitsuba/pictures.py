"""Pictures by several settings beside the truth: as they look, signed difference, FLIP (Andersson et al. 2020).

    pip install numpy flip-evaluator
    cargo run --release -p studies --bin tradeoff -- cornell-glass --part pictures --size 96
    python tests/mitsuba/pictures.py out/tradeoff/pictures-cornell-glass-cpu.json --out docs/images

writes accuracy-cornell-glass.png: the truth first, then a column for each setting, with three rows. Differences
are over the truth and a tenth of its mean, red too bright and blue too dark, full at a half. The lines that it
prints have names, times, relMSE and mean FLIP, in the order of the columns.
"""

import argparse
import json
import pathlib
import struct
import zlib

import numpy as np


def srgb(linear):
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1.0 / 2.4) - 0.055)


def write_png(path, picture):
    """8 bits a channel; picture is height × width × 3 in [0, 1]."""
    height, width, _ = picture.shape
    bytes_ = (np.clip(picture, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
    # Each row less the one above it (filter 2) packs better.
    above = np.vstack([np.zeros((1, width, 3), np.uint8), bytes_[:-1]])
    rows = (bytes_ - above).reshape(height, -1)
    raw = b"".join(b"\x02" + row.tobytes() for row in rows)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b"")
    )


def signed(difference):
    """White at 0, red above, blue below."""
    d = np.clip(2.0 * difference, -1.0, 1.0)
    return np.stack([1.0 + np.minimum(d, 0.0), 1.0 - np.abs(d), 1.0 - np.maximum(d, 0.0)], axis=2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("record", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("."))
    parser.add_argument("--scale", type=int, default=1, help="each pixel becomes a square of so many")
    args = parser.parse_args()
    import flip_evaluator

    record = json.loads(args.record.read_text())
    size = record["size"]
    shape = (size, size, 3)
    truth = np.array(record["truth"], dtype=np.float64).reshape(shape)
    # As bright as it may be with a hundredth of the pixels white.
    exposure = 0.9 / np.quantile(truth.max(axis=2), 0.99)
    look = srgb(truth * exposure)
    grey, gap = truth.mean(axis=2), max(1, size // 48)
    floor = 0.1 * grey.mean()
    columns = [np.vstack([look, np.ones((2 * (size + gap), size, 3))])]
    for shot in record["shots"]:
        pixels = np.array(shot["pixels"], dtype=np.float64).reshape(shape)
        seen = srgb(pixels * exposure)
        difference = (pixels.mean(axis=2) - grey) / (grey + floor)
        error = np.mean((pixels.mean(axis=2) - grey) ** 2 / (grey**2 + floor**2))
        map_, flip, _ = flip_evaluator.evaluate(look.astype(np.float32), seen.astype(np.float32), "LDR")
        line = np.ones((gap, size, 3))
        # Fewer levels than bytes have, for smaller files.
        maps = [np.round(31.0 * picture) / 31.0 for picture in (signed(difference), map_)]
        columns.append(np.vstack([seen, line, maps[0], line, maps[1]]))
        print(f"| {record['scene']} | {shot['name']} | {shot['seconds']:.2f} s | {error:.2e} | {flip:.3f} |")
    line = np.ones((columns[1].shape[0], gap, 3))
    columns[0] = columns[0][: line.shape[0]]
    picture = np.hstack([part for column in columns for part in (column, line)][:-1])
    picture = picture.repeat(args.scale, axis=0).repeat(args.scale, axis=1)
    args.out.mkdir(parents=True, exist_ok=True)
    write_png(args.out / f"accuracy-{record['scene']}.png", picture)


if __name__ == "__main__":
    main()
