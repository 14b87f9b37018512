"""Universal Mach-O files: one library for several processors, as macOS loads it."""

from __future__ import annotations

import struct

__all__ = ["universal_binary"]

_FAT_MAGIC = 0xCAFEBABE  # big-endian, like the whole header
_THIN_MAGIC = 0xFEEDFACF  # 64 bits, little-endian
_ALIGNMENT_BITS = 14  # pages of 16 KiB, the larger ones of both processors


def universal_binary(images: list[bytes]) -> bytes:
    """The images one after the other, each page-aligned, after a table of them."""
    alignment = 1 << _ALIGNMENT_BITS
    table = struct.pack(">II", _FAT_MAGIC, len(images))
    body = b""
    offset = alignment
    for image in images:
        magic, processor, variant = struct.unpack_from("<III", image)
        if magic != _THIN_MAGIC:
            raise ValueError(f"not a 64-bit Mach-O file: it starts with {magic:#010x}")
        table += struct.pack(">IIIII", processor, variant, offset, len(image), _ALIGNMENT_BITS)
        padded = image + bytes(-len(image) % alignment)
        body += padded
        offset += len(padded)
    return table + bytes(alignment - len(table)) + body[: len(body) - (-len(images[-1]) % alignment)]
