# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""PNG of 8 bits, RGB or RGBA, read and written with what Python has."""
import struct
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"


def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def nearest(left, above, corner):
    """Paeth's predictor."""
    estimate = left + above - corner
    return min((left, above, corner), key=lambda value: abs(estimate - value))


def write_rows(file, width, rows, channels):
    """rows: bytes, each of width * channels. Filtered by Paeth."""
    filtered, before = [], bytes(width * channels)
    for row in rows:
        line = bytearray(b"\x04")
        for i, value in enumerate(row):
            left, corner = (row[i - channels], before[i - channels]) if i >= channels else (0, 0)
            line.append((value - nearest(left, before[i], corner)) & 255)
        filtered.append(bytes(line))
        before = row
    head = struct.pack(">IIBBBBB", width, len(rows), 8, 2 if channels == 3 else 6, 0, 0, 0)
    data = zlib.compress(b"".join(filtered), 9)
    file.write_bytes(SIGNATURE + chunk(b"IHDR", head) + chunk(b"sRGB", b"\0") + chunk(b"IDAT", data) + chunk(b"IEND", b""))


def write_png(file, width, height, texel):
    """texel(x, y): three numbers or four."""
    rows = [b"".join(bytes(texel(x, y)) for x in range(width)) for y in range(height)]
    write_rows(file, width, rows, len(texel(0, 0)))


def unfilter(kind, row, before, channels):
    for i in range(len(row)):
        left, corner = (row[i - channels], before[i - channels]) if i >= channels else (0, 0)
        above = before[i]
        row[i] = (row[i] + (0, left, above, (left + above) // 2, nearest(left, above, corner))[kind]) & 255
    return row


def read_rows(file):
    """(width, rows of RGB). Errors: ValueError for a PNG of another kind."""
    data, at, packed = file.read_bytes(), len(SIGNATURE), b""
    while at < len(data):
        (size,), name = struct.unpack_from(">I", data, at), data[at + 4 : at + 8]
        body = data[at + 8 : at + 8 + size]
        if name == b"IHDR":
            width, height, depth, kind, _, _, laced = struct.unpack(">IIBBBBB", body)
        packed += body if name == b"IDAT" else b""
        at += size + 12
    if depth != 8 or kind not in (2, 6) or laced:
        raise ValueError(f"{file}: no plain PNG of 8 bits")
    channels = 3 if kind == 2 else 4
    raw, stride, rows = zlib.decompress(packed), width * channels + 1, []
    before = bytes(stride - 1)
    for y in range(height):
        line = raw[y * stride : (y + 1) * stride]
        before = unfilter(line[0], bytearray(line[1:]), before, channels)
        rows.append(bytes(before[i] for i in range(len(before)) if i % channels < 3))
    return width, rows
