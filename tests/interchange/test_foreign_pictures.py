"""Which picture of a foreign file is read, in which colours and where: one rule at every door, by hand-made bytes."""
import struct

import numpy as np
import OpenImageIO as oiio
import pytest
import spool
import spool.exr

import exr_files as exr
from conftest import run_jobs

RNG = np.random.default_rng(34)
A, B, C = (RNG.random((4, 6, 3), np.float32) for _ in range(3))


def picture(path, *options):
    """Code, the image [y][x][3] or None, remarks or the error."""
    out = path.with_suffix(".read.exr")
    code, message = run_jobs(("picture", path, out, *options))[0]
    if code != 0:
        return code, None, message
    return code, read(out), message


def read(path):
    image = oiio.ImageInput.open(str(path))
    spec = image.spec()
    order = [spec.channelnames.index(c) for c in "RGB"]
    return image.read_image("float").reshape(spec.height, spec.width, spec.nchannels)[..., order]


TAKEN = {
    "the name of part 0 counts": ([exr.Part(exr.rgb(B), name="albedo"), exr.Part(exr.rgb(A), name="beauty")], "not used: albedo"),
    "behind a depth": ([exr.Part({"Z": A[..., 0]}, name="depth"), exr.Part(exr.rgb(A), name="rgba")], "not used: Z"),
    "a layer of an unknown name": ([exr.Part(exr.rgb(A, "my_image"))], "the picture is taken to be my_image"),
    "light that a renderer normalized": ([exr.Part(exr.rgb(A, "RADIANCE_PER_PIXEL_NORMALIZED") | exr.rgb(B, "SHADING_NORMAL"))], "not used: SHADING_NORMAL"),
    "red, green, blue": ([exr.Part(exr.rgb(A, "beauty", ("red", "green", "blue")))], ""),
    "the base before parts of it": ([exr.Part(exr.rgb(A) | exr.rgb(B, "diffuse") | exr.rgb(C, "specular"))], "not used: diffuse, specular"),
    "the default view": ([exr.Part(exr.rgb(A) | exr.rgb(B, "right"), exr.texts("multiView", ["left", "right"]))], "not used: right"),
    "R, G, B before r, g, b": ([exr.Part(exr.rgb(A) | exr.rgb(B, names="rgb"))], "not used: b, g, r"),
    "half beside float": ([exr.Part(exr.rgb(A.astype("f2").astype("f4"), dtype=("f2", "f4", "f4")))], ""),
    "a cryptomatte has colours": ([exr.Part(exr.rgb(A) | exr.rgb(B, "tags00"), exr.text("cryptomatte/a1b2/name", "tags"))], "not used: tags00"),
    "Blender's result": ([exr.Part(exr.rgb(A, "ViewLayer.Combined") | exr.rgb(B, "ViewLayer.Noisy Image"))], "ViewLayer.Combined is denoised"),
    "overscan": ([exr.Part(exr.rgb(np.pad(A, ((1, 1), (2, 2), (0, 0)))), origin=(-2, -1), display=(0, 0, 6, 4))], "outside of the display window"),
}


@pytest.mark.parametrize("kind", TAKEN)
def test_the_picture_is_taken(tmp_path, kind):
    parts, remark = TAKEN[kind]
    code, image, message = picture(exr.write(tmp_path / "a.exr", *parts))
    assert code == 0 and remark in message, message
    expected = A.astype("f2").astype("f4") if kind == "half beside float" else A
    assert np.array_equal(image, expected), kind


REFUSED = {
    "two pictures": ([exr.Part(exr.rgb(A, "beauty") | exr.rgb(B))], 1, "more than one picture", "--layer"),
    "names of other alphabets": ([exr.Part(exr.rgb(A, "schön") | exr.rgb(B, "größe"))], 1, "größe, schön", "--layer größe"),
    "a name that a shell would obey": ([exr.Part(exr.rgb(A, "it's") | exr.rgb(B, "key"))], 1, "it's, key", "--layer 'it'\\''s'"),
    "one part name twice": ([exr.Part(exr.rgb(A), name="rgba", view="left"), exr.Part(exr.rgb(B), name="rgba", view="right")],
                            1, "part 1 has the name of an earlier one", "give each part"),
    "parts without a name": ([exr.Part(exr.rgb(A)), exr.Part(exr.rgb(B))], 1, "part 0 has no name", "give each part"),
    "zstd": ([exr.Part(exr.rgb(A), compression=13)], 1, "(ZSTD) is unknown here", "where it was made"),
    "two view layers": ([exr.Part(exr.rgb(A, "One.Combined") | exr.rgb(B, "Two.Combined"))], 1, "One.Combined, Two.Combined", "--layer One.Combined"),
    "two unknown layers": ([exr.Part(exr.rgb(A, "fill") | exr.rgb(B, "key"))], 1, "fill, key", "--layer"),
    "two views as parts": ([exr.Part(exr.rgb(A), name="rgba.left", view="left"), exr.Part(exr.rgb(B), name="rgba.right", view="right")],
                           1, "rgba.left, rgba.right", "--layer"),
    "one layer in two parts": ([exr.Part(exr.rgb(A, "beauty"), name="one"), exr.Part(exr.rgb(B, "beauty"), name="two")], 1, "part 0 'one'", "--part one"),
    "X, Y, Z": ([exr.Part(exr.rgb(A, names="XYZ"))], 1, "no picture", "X,Y,Z"),
    "normals that were normalised": ([exr.Part(exr.rgb(A, "normalised_normal"))], 1, "no picture", "normalised_normal"),
    "normals": ([exr.Part(exr.rgb(A, "N", "XYZ"))], 1, "no picture", "N"),
    "a depth alone": ([exr.Part({"Z": A[..., 0]})], 1, "no picture", "Z"),
    "an alpha alone": ([exr.Part({"A": A[..., 0]})], 1, "no picture", "A"),
    "an albedo alone": ([exr.Part(exr.rgb(A, "albedo"))], 1, "no picture", "albedo"),
    "a variance": ([exr.Part(exr.rgb(A, "variance"))], 1, "no picture", "variance"),
    "whole numbers": ([exr.Part(exr.rgb(255 * A, dtype="u4"))], 1, "whole numbers (uint)", "linearise"),
    "luminance and chroma": ([exr.Part({"Y": A[..., 0], "RY": A[..., 1], "BY": A[..., 2]})], 1, "luminance and chroma", "R, G, B"),
    "ACEScg": ([exr.Part(exr.rgb(A), exr.chromaticities(*exr.AP1))], 1, "ACEScg (AP1)", "convert first"),
    "ACEScg by its identifier": ([exr.Part(exr.rgb(A), exr.text("colorInteropID", "lin_ap1_scene"))], 1, "ACEScg (AP1)", "colorInteropID"),
    "an ACES container": ([exr.Part(exr.rgb(A), exr.attribute("acesImageContainerFlag", "int", b"\1\0\0\0"))], 1, "ACES2065-1", "convert first"),
    "sRGB": ([exr.Part(exr.rgb(A), exr.text("colorInteropID", "srgb_rec709_scene"))], 1, "linearise", "srgb_rec709_scene"),
    "an unknown space": ([exr.Part(exr.rgb(A), exr.text("oiio:ColorSpace", "Sunny"))], 1, "'Sunny'", "not known here"),
    "data": ([exr.Part(exr.rgb(A), exr.text("colorInteropID", "data"))], 1, "no colours", "data"),
    "two statements": ([exr.Part(exr.rgb(A), exr.chromaticities(*exr.REC2020), exr.text("colorInteropID", "lin_rec709_scene"))],
                       1, "Rec. 2020", "Rec. 709"),
    "no chromaticities at all": ([exr.Part(exr.rgb(A), exr.chromaticities(0, 0, 0, 0, 0, 0, 0.3127, 0.3290))], 1, "make no sense", "chromaticities"),
    "nothing displayed": ([exr.Part(exr.rgb(A), origin=(6, 0), display=(0, 0, 6, 4))], 1, "x 6 to 11, y 0 to 3", "nothing is shown"),
    "HTJ2K": ([exr.Part(exr.rgb(A), compression=10)], 1, "(HTJ2K) is unknown here", "zip"),
    "a channel of an unknown name beside a depth": ([exr.Part({"V": A[..., 0], "W": A[..., 1]})], 1, "no picture", "V,W"),
    "subsampled": ([exr.Part(exr.rgb(A), sampling=2)], 1, "subsampled", "full size"),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_what_is_no_picture_or_more_than_one_is_refused(tmp_path, kind):
    parts, expected, *words = REFUSED[kind]
    code, _, message = picture(exr.write(tmp_path / "a.exr", *parts))
    assert code == expected and all(word in message for word in words), message


def test_layer_and_part_choose(tmp_path):
    path = exr.write(tmp_path / "a.exr", exr.Part(exr.rgb(A, "One.Combined") | exr.rgb(B, "Two.Combined") | {"One.Depth.Z": C[..., 0]}, name="first"),
                     exr.Part(exr.rgb(C), name="albedo"))
    for options, expected in ((("layer=One.Combined",), A), (("layer=Two",), B), (("part=albedo", "layer=albedo"), C), (("part=1", "layer=albedo"), C),
                              (("layer=One.Depth.Z",), np.repeat(C[..., :1], 3, axis=2)), (("part=first", "layer=one.combined"), A)):
        code, image, message = picture(path, *options)
        assert code == 0 and np.array_equal(image, expected), (options, message)
    for options, code, word in ((("layer=Three",), 2, "One.Combined"), (("part=2",), 2, "1 'albedo'"), (("layer=One.Depth",), 1, "One.Depth.Z"),
                                (("part=first",), 1, "--layer One.Combined")):
        found, _, message = picture(path, *options)
        assert found == code and word in message, (options, message)


def test_the_remedy_for_two_pictures_is_taken(tmp_path):
    path = exr.write(tmp_path / "a.exr", exr.Part(exr.rgb(A) | exr.rgb(B, "image") | {"A": A[..., 0]}))
    code, _, message = picture(path)
    assert code == 1 and "choose with --layer R,G,B" in message, message
    code, image, message = picture(path, "layer=R,G,B")
    assert code == 0 and np.array_equal(image, A), message


def to_xyz(c):
    points = np.array([[c[0], c[2], c[4]], [c[1], c[3], c[5]], [1 - c[0] - c[1], 1 - c[2] - c[3], 1 - c[4] - c[5]]])
    white = np.array([c[6] / c[7], 1, (1 - c[6] - c[7]) / c[7]])
    return points * np.linalg.solve(points, white)


@pytest.mark.parametrize("statement, primaries", [
    (exr.chromaticities(*exr.REC2020), exr.REC2020), (exr.chromaticities(*exr.XYZ), exr.XYZ),
    (exr.text("colorInteropID", "lin_rec2020_scene"), exr.REC2020), (exr.text("colorInteropID", "lin_ciexyzd65_scene"), exr.XYZ)])
def test_exact_colours_are_converted(tmp_path, statement, primaries):
    rec709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
    matrix = np.linalg.solve(to_xyz(rec709), to_xyz(primaries))
    code, image, message = picture(exr.write(tmp_path / "a.exr", exr.Part(exr.rgb(A), statement)))
    assert code == 0 and "to Rec. 709" in message
    assert np.allclose(image, A @ matrix.T, atol=2e-6) and not np.allclose(image, A, atol=1e-2)
    for s in range(2):
        exr.write(tmp_path / "f" / f"s_{s}.exr", exr.Part(exr.rgb((A, B)[s]), statement))
    code, message = run_jobs(("import exr-folder", tmp_path / "f", tmp_path / "a.spool"))[0]
    assert code == 0 and "radiance was converted from" in message, message
    assert np.allclose(spool.open(tmp_path / "a.spool").read("radiance")[:, :, 1], B @ matrix.T, atol=2e-6)


def folder(tmp_path, make):
    for s, pixels in enumerate((A, B, C)):
        exr.write(tmp_path / "f" / f"s_{s}.exr", *make(pixels))
    return tmp_path / "f"


def samples(tmp_path, source, *options):
    code, message = run_jobs(("import exr-folder", source, tmp_path / "a.spool", "force", *options))[0]
    return code, message, spool.open(tmp_path / "a.spool").read("radiance").transpose(2, 0, 1, 3) if code == 0 else None


FOLDERS = {
    "the noisy one": (lambda p: [exr.Part(exr.rgb(np.ones_like(p), "ViewLayer.Combined") | exr.rgb(p, "ViewLayer.Noisy Image"))], "is denoised"),
    "before the denoised one": (lambda p: [exr.Part(exr.rgb(p) | exr.rgb(np.ones_like(p), "RGBA_denoise"))], "not taken over: RGBA_denoise"),
    "beauty behind albedo": (lambda p: [exr.Part(exr.rgb(np.ones_like(p)), name="albedo"), exr.Part(exr.rgb(p), name="beauty")], ""),
    "half beside float": (lambda p: [exr.Part(exr.rgb(p, dtype=("f4", "f2", "f4")))], "half to float"),
}


@pytest.mark.parametrize("kind", FOLDERS)
def test_samples_are_the_noisy_picture(tmp_path, kind):
    make, remark = FOLDERS[kind]
    code, message, found = samples(tmp_path, folder(tmp_path, make))
    assert code == 0 and remark in message, message
    assert np.allclose(found, [A, B, C], atol=1e-3 if "half" in kind else 0)


NO_FOLDERS = {
    "denoised only": (lambda p: [exr.Part(exr.rgb(p, "beauty_denoised"))], "no noisy picture"),
    "two view layers": (lambda p: [exr.Part(exr.rgb(p, "One.Combined") | exr.rgb(p + 1, "Two.Combined"))], "One.Combined, Two.Combined"),
    "types that do not fit": (lambda p: [exr.Part(exr.rgb(9 * p, dtype=("u4", "f4", "f4")))], "R uint, G float"),
    "whole numbers": (lambda p: [exr.Part(exr.rgb(255 * p, dtype="u4"))], "whole numbers (uint)"),
    "an albedo under two names": (lambda p: [exr.Part(exr.rgb(p) | exr.rgb(p, "albedo") | exr.rgb(p, "Albedo"))], "import.map=albedo="),
    "a feature in another window": (lambda p: [exr.Part(exr.rgb(p), name="beauty"), exr.Part(exr.rgb(p), name="albedo", origin=(1, 0))],
                                    "another data window than radiance"),
}


@pytest.mark.parametrize("kind", NO_FOLDERS)
def test_no_folder_is_taken_for_what_it_is_not(tmp_path, kind):
    make, words = NO_FOLDERS[kind]
    code, message, _ = samples(tmp_path, folder(tmp_path, make))
    assert code == 1 and words in message, message
    assert not (tmp_path / "a.spool").exists()


def test_the_view_layer_of_radiance_gives_the_features(tmp_path):
    source = folder(tmp_path, lambda p: [exr.Part(
        exr.rgb(p + 1, "One.Combined") | exr.rgb(p, "Two.Combined") | {"One.Depth.Z": p[..., 0] + 1, "Two.Depth.Z": p[..., 0]})])
    for options in (("map=radiance=Two.Combined",), ("layer=Two",), ("layer=Two.Combined",)):
        code, message, found = samples(tmp_path, source, *options)
        assert code == 0 and np.array_equal(found, [A, B, C]), (options, message)
        assert np.array_equal(spool.open(tmp_path / "a.spool").read("depth")[:, :, 0, 0], A[..., 0])


def test_images_in_another_colour_space_than_the_first_are_refused(tmp_path):
    source = folder(tmp_path, lambda p: [exr.Part(exr.rgb(p))])
    exr.write(source / "s_1.exr", exr.Part(exr.rgb(B), exr.chromaticities(*exr.REC2020)))
    code, message, _ = samples(tmp_path, source)
    assert code == 1 and "another colour space than the first image" in message


def test_an_empty_file_is_called_so(tmp_path):
    (tmp_path / "a.exr").write_bytes(b"")
    assert run_jobs(("import deep-exr", tmp_path / "a.exr", tmp_path / "out.spool"))[0][0] == 4
    code, _, message = picture(tmp_path / "a.exr")
    assert code == 4 and "is empty" in message, message


def test_compression_with_loss_and_values_that_are_not_finite_are_named(tmp_path):
    odd = B.copy()
    odd[1, 2], odd[0, 0, 1] = np.inf, np.nan
    for s, pixels in enumerate((A, odd, C)):
        (tmp_path / "f").mkdir(exist_ok=True)
        spec = oiio.ImageSpec(6, 4, 3, "float")
        spec.attribute("compression", "dwaa" if s < 2 else "zip")
        image = oiio.ImageOutput.create(str(tmp_path / "f" / f"s_{s}.exr"))
        assert image.open(str(tmp_path / "f" / f"s_{s}.exr"), spec) and image.write_image(pixels) and image.close()
    for image, remark in (("s_0.exr", "DWA is a compression with loss"), ("s_2.exr", "")):
        code, _, message = picture(tmp_path / "f" / image)
        (tmp_path / "f" / image).with_suffix(".read.exr").unlink()
        assert code == 0 and remark in message and bool(remark) == ("loss" in message), message
    code, message, _ = samples(tmp_path, tmp_path / "f")
    assert code == 0 and "DWA is a compression with loss" in message and "values that are not finite" in message, message


OTHERS = {"npz": [(b"\x89HDF\r\n\x1a\n", "an HDF5 file"), (b"\x93NUMPY\1\0", "a single .npy array"), (b"\x80\4\x95", "a Python pickle"), (b"abcd", "wrong first bytes")],
          "noisebase": [(b"\x89HDF\r\n\x1a\n", "an HDF5 file"), (b"\x76\x2f\x31\1", "an OpenEXR image")],
          "bcd": [(b"\x76\x2f\x31\1", "an OpenEXR image"), (b"PK\3\4", "a zip archive")],
          "sbmc": [(b"\x89PNG\r\n\x1a\n", "a PNG picture")],
          "deep-exr": [(b"\x89PNG\r\n\x1a\n", "a PNG picture"), (b"\x76\x2f\x31\1\3\0\0\0", "version 3"), (b"\x76\x2f\x31\1\2\x80\0\0", "flags 0x8000")]}


@pytest.mark.parametrize("door", OTHERS)
def test_another_kind_of_file_is_not_called_damaged(tmp_path, door):
    for start, words in OTHERS[door]:
        path = tmp_path / ("a.bin" if door == "sbmc" else "a.dat")
        path.write_bytes(start + bytes(4096))
        code, message = run_jobs((f"import {door}", path, tmp_path / "out.spool"))[0]
        assert code == 1 and words in message and "damaged" not in message, (door, message)
        assert len(message) < 400


def test_values_that_are_too_large_do_not_become_infinite(tmp_path):
    with pytest.raises(spool.SpoolError, match="too large for float32"):
        spool.exr.write(tmp_path / "a.exr", {"R": np.full((2, 2), 1e39)})
    spool.exr.write(tmp_path / "a.exr", {"R": np.full((2, 2), np.inf)})


def test_a_file_of_many_layers_is_one_short_line(tmp_path):
    layers = {f"layer{i:05}.{c}": A[:1, :1, 0] for i in range(3000) for c in "RGB"}
    path = exr.write(tmp_path / "a.exr", exr.Part(layers))
    code, _, message = picture(path)
    assert code == 1 and "and 2992 more" in message and len(message) < 400, message
    code, _, message = picture(exr.write(path, exr.Part(layers | exr.rgb(A[:1, :1]))))
    assert code == 0 and "and 2992 more" in message and len(message) < 400, message
    code, _, message = picture(exr.write(path, exr.Part(exr.rgb(A) | {"x" * 200: A[..., 0]})))
    assert code == 0 and message.endswith("not used: 1 name"), message


OTHER_KINDS = {
    b"\x89HDF\r\n\x1a\n": ("an HDF5 file", "save its values as an OpenEXR image", "numpy.savez"),
    b"II*\0": ("a TIFF picture", "convert it", "--from exr-folder"), b"II+\0": ("a TIFF picture", "convert it", "--from exr-folder"),
    b"#?RADIANCE\n": ("a Radiance HDR picture", "convert it", "--from exr-folder"), b"PF\n4 4\n": ("a PFM picture", "convert it", "--from exr-folder"),
    b"\x89PNG\r\n\x1a\n": ("a PNG picture", "linearise it and convert it", "linearise it and"),
    b"P6\n4 4\n255\n": ("a PNM picture", "linearise it and", "linearise it and"),
    b"\0\0\0\x0cJXL \r\n": ("a JPEG XL picture", "linearise it and", "linearise it and"),
    b"\x93NUMPY\1\0": ("a single .npy array", "save its values as an OpenEXR image", "numpy.savez"),
    b"\x28\xb5\x2f\xfd": ("compressed by zstd", "unpack it and", "unpack it and"),
}


@pytest.mark.parametrize("start", OTHER_KINDS)
def test_a_file_of_another_kind_is_named_with_what_makes_it_right(tmp_path, start):
    kind, of_picture, of_arrays = OTHER_KINDS[start]
    path = tmp_path / "a.exr"
    path.write_bytes(start + bytes(64))
    code, _, message = picture(path)
    assert code == 1 and f"is {kind}, an OpenEXR image is needed" in message and of_picture in message, message
    code, message = run_jobs(("import npz", path, tmp_path / "a.spool", "layout=HWSC"))[0]
    assert code == 1 and f"is {kind}, a zip archive is needed" in message and of_arrays in message, message


@pytest.mark.parametrize("tiled", [True, False])
def test_bytes_that_a_chunk_without_compression_lacks_are_not_made_up(tmp_path, tiled):
    path = tmp_path / "a.exr"
    spec = oiio.ImageSpec(40, 32, 3, oiio.FLOAT)
    spec.attribute("compression", "none")
    pixels = RNG.random((32, 40, 3), np.float32)
    if tiled:
        spec.tile_width = spec.tile_height = 16
    out = oiio.ImageOutput.create(str(path))
    specs = [oiio.ImageSpec(spec) for _ in range(1 if tiled else 2)]
    for one, name in zip(specs, ("rgba", "albedo")):
        one.attribute("oiio:subimagename", name)
    assert out.open(str(path), tuple(specs))
    for i, one in enumerate(specs):
        assert (i == 0 or out.open(str(path), one, "AppendSubimage")) and out.write_image(pixels)
    out.close()
    assert np.array_equal(picture(path)[1], pixels)
    data = bytearray(path.read_bytes())
    chunks = 3 * 2 if tiled else 2 * 32
    table = next(i for i in range(8, len(data)) if struct.unpack_from("<Q", data, i)[0] == i + 8 * chunks)
    (chunk,) = struct.unpack_from("<Q", data, table + 8)  # the second of the first part
    place = chunk + (16 if tiled else 8)
    assert struct.unpack_from("<i", data, place)[0] == 12 * (16 * 16 if tiled else 40)
    struct.pack_into("<i", data, place, 1)
    path.write_bytes(data)
    code, _, message = picture(path)
    assert code == 4 and "a.exr: the EXR is cut or damaged (the chunk at " in message and "has 1 bytes of" in message, message
