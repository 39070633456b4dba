"""Pictures with several settings beside the reference: tone-mapped, signed difference, FLIP (Andersson et al. 2020).

    pip install numpy flip-evaluator
    cargo run --release -p studies --bin tradeoff -- cornell-glass --part pictures --size 96
    python tests/mitsuba/pictures.py out/tradeoff/pictures-cornell-glass-cpu.json --out docs/images

writes accuracy-cornell-glass.png: the reference first, then a column for each setting, with three rows. Differences
are relative to the reference plus a tenth of its mean, red for too bright and blue for too dark, saturated at one half.
The printed lines have names, times, relMSE and mean FLIP, in the order of the columns.
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
    """Writes 8 bits per channel; picture is height × width × 3 in [0, 1]."""
    height, width, _ = picture.shape
    bytes_ = (np.clip(picture, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
    # The difference from the row above (filter 2) compresses better.
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
    parser.add_argument("--scale", type=int, default=1, help="side in pixels of the square that replaces each pixel")
    args = parser.parse_args()
    import flip_evaluator

    record = json.loads(args.record.read_text())
    size = record["size"]
    shape = (size, size, 3)
    truth = np.array(record["truth"], dtype=np.float64).reshape(shape)
    # The exposure at which about a hundredth of the pixels exceeds 0.9.
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
        # 32 levels instead of 256, for smaller files.
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
