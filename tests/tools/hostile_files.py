"""Small files that claim much: EXR headers, Zarr stores, BCD, SBMC, texts that nest. Made by hand, as no library writes them."""
import json
import os
import struct
import zipfile

import lz4.frame
import numcodecs

UINT, FLOAT = 0, 2
MULTI_PART, NO_IMAGE, TILED = 0x1000, 0x800, 0x200
HUGE = 0x7FFFFFFF


def attribute(name, kind, value, size=None):
    return b"%s\0%s\0" % (name.encode(), kind.encode()) + struct.pack("<i", len(value) if size is None else size) + value


def channel_list(names="BGR", kind=FLOAT):
    return b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", kind, 0, 1, 1) for name in names) + b"\0"


def header(width=4, height=4, compression=0, kind=None, name=None, extra=b"", channels=None, tiles=None):
    """One header without its end; `tiles`: width, height, mode."""
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    out = (attribute("channels", "chlist", channels or channel_list()) + attribute("compression", "compression", bytes([compression]))
           + attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
           + attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
           + attribute("screenWindowCenter", "v2f", bytes(8)) + attribute("screenWindowWidth", "float", struct.pack("<f", 1)))
    if kind:
        out += attribute("type", "string", kind.encode())
    if name:
        out += attribute("name", "string", name.encode())
    if tiles:
        out += attribute("tiles", "tiledesc", struct.pack("<IIB", *tiles))
    return out + extra + b"\0"


def exr(headers, flags=0, rest=bytes(64)):
    end = b"\0" if flags & MULTI_PART else b""
    return struct.pack("<II", 20000630, 2 | flags) + b"".join(headers) + end + rest


def lying_attributes():
    """Attributes of some bytes that claim gigabytes."""
    lies = {kind: attribute("custom", kind, bytes(8), HUGE) for kind in ("string", "stringvector", "floatvector", "opaque", "idmanifest")}
    lies["negative"] = attribute("custom", "string", bytes(8), -5)
    lies["a text in a list"] = attribute("custom", "stringvector", struct.pack("<i", HUGE) + bytes(8))
    lies["preview"] = attribute("preview", "preview", struct.pack("<II", 16384, 16384) + bytes(64))
    lies["behind a number"] = attribute("number", "int", bytes(4) + attribute("custom", "string", bytes(8), HUGE))
    lies["behind numbers"] = attribute("numbers", "floatvector", bytes(6), 6) + attribute("custom", "string", bytes(8), HUGE)
    lies["behind channels"] = attribute("more", "chlist", channel_list() + attribute("custom", "string", bytes(8), HUGE))
    return lies


def exr_bombs():
    """name -> bytes: every kind of lie in a file of one part, of several, with tiles, and deep."""
    bombs = {}
    for lie, extra in lying_attributes().items():
        bombs[f"flat, {lie}"] = exr([header(extra=extra)])
        bombs[f"tiled, {lie}"] = exr([header(extra=extra, tiles=(4, 4, 0))], TILED)
        bombs[f"deep, {lie}"] = exr([header(extra=extra, kind="deepscanline")], NO_IMAGE)
        bombs[f"second part, {lie}"] = exr([header(kind="scanlineimage", name="a", extra=attribute("chunkCount", "int", struct.pack("<i", 4))),
                                            header(kind="scanlineimage", name="b", extra=extra)], MULTI_PART)
    side = 1 << 20
    bombs["a table of lines"] = exr([header(side, side)])
    bombs["a table of tiles"] = exr([header(side, side, tiles=(1, 1, 0))], TILED)
    bombs["a table of small levels"] = exr([header(8192, 8192, tiles=(1, 1, 2))], TILED)
    bombs["a count of chunks"] = exr([header(kind="unknown", name="a", extra=attribute("chunkCount", "int", struct.pack("<i", HUGE)))], MULTI_PART)
    bombs["a tile"] = exr([header(64, 64, tiles=(side, side, 0))], TILED)
    bombs["long lines"] = exr([header(side, 1, compression=9)])
    bombs["long deep lines"] = exr([header(side, 256, kind="deepscanline", compression=3)], NO_IMAGE)
    return bombs


def deep_exr_with_meta(meta):
    """A deep file of our own: one pixel of one sample, and any text as its meta."""
    names = [f"radiance.{c}" for c in "RGB"]
    told = json.dumps([{"name": name, "group": 0, "dtype": "f32", "semantic": 1, "scope": "sample"} for name in names])
    extra = (attribute("spoolVersion", "double", struct.pack("<d", 1)) + attribute("spoolChannels", "string", told.encode())
             + attribute("spoolMeta", "string", meta) + attribute("spoolSampleOrder", "string", b"renderer")
             + attribute("chunkCount", "int", struct.pack("<i", 1)) + attribute("version", "int", struct.pack("<i", 1)))
    channels = channel_list(["Z", *sorted(names)])[:-1] + channel_list(["spool.index"], UINT)
    start = header(1, 1, kind="deepscanline", extra=extra, channels=channels)
    values = struct.pack("<4fI", 0, 1, 1, 1, 0)
    chunk = struct.pack("<iQQQi", 0, 4, len(values), len(values), 1) + values
    return exr([start], NO_IMAGE, struct.pack("<Q", 8 + len(start) + 8) + chunk)


def nested(depth, opening=b"[", closing=b"]"):
    return opening * depth + closing * depth


def zarr_store(path, arrays):
    """arrays: name -> (shape, chunks, dtype, compressor, {chunk: bytes}); a text as .zarray is taken as it is."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as store:
        store.writestr(".zgroup", '{"zarr_format": 2}')
        for name, array in arrays.items():
            if isinstance(array, bytes):
                store.writestr(f"{name}/.zarray", array)
                continue
            shape, chunks, dtype, compressor, members = array
            store.writestr(f"{name}/.zarray", json.dumps(
                {"zarr_format": 2, "shape": shape, "chunks": chunks, "dtype": dtype, "order": "C", "fill_value": 0, "filters": None,
                 "compressor": compressor and {"id": compressor}}))
            for key, value in members.items():
                store.writestr(f"{name}/{key}", value)


EXPOSURE = ([2], [2], "<f4", None, {"0": struct.pack("<ff", -1, 1)})


def zarr_bombs(folder):
    """name -> path of Noisebase stores of a kilobyte or so."""
    zeros = numcodecs.Zstd(3).encode(bytes(4 * 128 * 128 * 32))  # 2 MiB in a few bytes; 50 MB as floats
    stores = {
        "a large chunk": {"color": ([4, 2, 3, 2], [4, 8192, 8192, 2], "|u1", None, {"0.0.0.0": bytes(24)}), "exposure": EXPOSURE},
        "many chunks": {"color": ([4, 128, 1024, 32], [4, 128, 128, 32], "|u1", "zstd", {f"0.0.{i}.0": zeros for i in range(8)}),
                        "exposure": EXPOSURE},
        "frames in a chunk": {"color": ([1, 4, 2, 3, 2], [1, 4, 2, 3, 2], "|u1", None, {"0.0.0.0.0": bytes(48)}),
                              "exposure": ([1, 2], [1 << 26, 2], "<f4", "zstd", {"0.0": zeros})},
        "a deep text": {"color": nested(20000), "exposure": EXPOSURE},
    }
    paths = {}
    for name, arrays in stores.items():
        paths[name] = folder / f"{name.replace(' ', '_')}.zip"
        zarr_store(paths[name], arrays)
    return paths


def bcd_bombs():
    """name -> bytes: five numbers that say what follows, and little that does."""
    def raw(width, height, samples, channels, rest=bytes(48)):
        return struct.pack("<5i", 1, width, height, samples, channels) + rest
    whole = raw(2, 2, 1, 3)
    bombs = {"wide": raw(65536, 65536, 65536, 4), "many samples": raw(1, 1, 65536, 3), "tall": raw(1, 65536, 1, 3),
             "all negative": raw(-1, -1, -1, -1), "more than 32 bits": raw(65536, 16384, 4, 3), "no pixel": raw(0, 2, 1, 3),
             "many channels": raw(2, 2, 1, HUGE), "a value too few": whole[:-4], "a value too many": whole + bytes(4),
             "the header alone": whole[:20], "another BCD inside": raw(65536, 65536, 1, 3, whole * 50)}
    return whole, bombs


SBMC_HEADER = "<9i4f2i"
SBMC_IMAGE, SBMC_SAMPLE = 4 * 30, 4 * 63 + 2 * 6  # bytes a pixel


def sbmc_tile(tile=2, width=2, height=2, spp=1, frames=None, x=0, y=0, radius=3.0):
    """A tile of zeros whose header may say anything; `frames`: bytes with their lengths before them."""
    head = struct.pack(SBMC_HEADER, 20190401, tile, width, height, spp, 4096, 27, 30, 6, 1.0, 0.0, 0.4, radius, x, y)
    return head + (frames if frames is not None else sbmc_frame(4 * SBMC_IMAGE) + sbmc_frame(4 * SBMC_SAMPLE))


def sbmc_frame(size, stored=None, claim=None, **options):
    data = stored if stored is not None else lz4.frame.compress(bytes(size), store_size=False, **options)
    return struct.pack("<i", len(data) if claim is None else claim) + data


def sbmc_bombs(folder):
    """name -> path: tiles and lists of tiles that lie about their sizes, are cut, or name each other."""
    whole = sbmc_tile()
    tiles = {
        "a large image": sbmc_tile(1024, 65536, 16384), "many samples": sbmc_tile(2, spp=65536), "a large tile": sbmc_tile(1024, 1024, 1024),
        "small tiles": sbmc_tile(1, 16384, 16384), "a tile beyond": sbmc_tile(x=2), "a negative place": sbmc_tile(y=-2),
        "a frame of gigabytes": sbmc_tile(frames=sbmc_frame(0, bytes(16), HUGE)), "a negative frame": sbmc_tile(frames=sbmc_frame(0, bytes(16), -5)),
        "an empty frame": sbmc_tile(frames=sbmc_frame(0, b"")), "zeros packed tight": sbmc_tile(frames=sbmc_frame(1 << 18)),
        "a frame in a frame": sbmc_tile(frames=sbmc_frame(0, lz4.frame.compress(lz4.frame.compress(bytes(480))))),
        "a frame that says its size": sbmc_tile(frames=sbmc_frame(0, b"\x04\x22\x4d\x18\x48\x40" + b"\xff" * 7 + b"\x7f\0\0\0\0\0")),
        "a skippable frame": sbmc_tile(frames=sbmc_frame(0, struct.pack("<II", 0x184D2A50, 0xFFFFFFFF) + bytes(16))),
        "no scale": sbmc_tile(radius=float("inf")), "more behind it": whole + bytes(8), "cut in a frame": whole[:-9],
        "cut in a length": whole[:62], "the header alone": whole[:60],
    }
    paths = {}
    for name, data in tiles.items():
        paths[name] = folder / f"{name.replace(' ', '_')}.bin"
        paths[name].write_bytes(data)
    lists = {"itself": "a_list_of_itself.txt\n" * 200, "a pipe": "pipe.bin\n", "a device": "/dev/zero\n", "a folder": ".\n",
             "one tile often": "a_large_image.bin\n" * 200, "what is not there": "x" * 3000 + ".bin\n"}
    os.mkfifo(folder / "pipe.bin")
    for name, text in lists.items():
        paths[f"a list of {name}"] = folder / f"a_list_of_{name.replace(' ', '_')}.txt"
        paths[f"a list of {name}"].write_text(text)
    return whole, paths
