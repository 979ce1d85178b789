import numcodecs
import numpy as np
import pytest
import spool
import zarr

from conftest import run_jobs


def decode(rgbe, exposure):
    scale = np.exp(np.float32(exposure[0]) + (rgbe[3].astype("f4") + 1) / np.float32(256) * (np.float32(exposure[1]) - np.float32(exposure[0])))
    return rgbe[:3].astype("f4") / np.float32(255) * scale


def sample_set(rng, height, width, spp, frames=None):
    lead = () if frames is None else (frames,)
    image = (*lead, 3, height, width)
    lohi = np.sort(rng.normal(0, 3, (*lead, 2)).astype("f4"), axis=-1)
    return {"color": rng.integers(0, 256, (*lead, 4, height, width, spp), np.uint8), "exposure": lohi,
            "position": rng.random((*image, spp), np.float32), "motion": rng.random((*image, spp), np.float32),
            "normal": rng.random((*image, spp)).astype("f2"), "diffuse": rng.random((*image, spp)).astype("f2"),
            "reference": rng.random(image, np.float32), "camera_position": rng.random((*lead, 3), np.float32),
            "view_proj_mat": rng.random((*lead, 4, 4), np.float32), "crop_offset": rng.integers(0, 9, (*lead, 2)).astype("i4")}


BLOSC = numcodecs.Blosc("lz4hc", 9, numcodecs.Blosc.AUTOSHUFFLE)


def write_store(path, arrays, compressor=BLOSC, frames=None, **chunking):
    store = zarr.ZipStore(str(path), mode="w")
    group = zarr.group(store)
    for name, array in arrays.items():
        chunks = list(array.shape)
        if frames is not None:
            chunks[0] = chunking.get("frames_per_chunk", 1)
        if array.ndim - (frames is not None) == 4:
            chunks[-1] = 4
        if "rows" in chunking and array.ndim >= 3 and name != "view_proj_mat":
            chunks[2 if frames is not None else 1] = chunking["rows"]
        group.array(name, array, chunks=chunks, compressor=compressor)
    store.close()


def assert_imported(path, arrays, frame=None):
    assert spool.check(path).ok
    pick = (lambda a: a) if frame is None else (lambda a: a[frame])
    with spool.open(path) as dump:
        assert np.allclose(dump.read("radiance"), np.moveaxis(decode(pick(arrays["color"]), pick(arrays["exposure"])), 0, -1), rtol=1e-6)
        for theirs, ours in ("position", "position"), ("motion", "motion"), ("normal", "normal"), ("diffuse", "albedo"):
            expected = np.moveaxis(pick(arrays[theirs]), 0, -1)
            assert dump.read(ours).dtype == expected.dtype and np.array_equal(dump.read(ours), expected), ours
        assert np.array_equal(dump.pixel("reference"), np.moveaxis(pick(arrays["reference"]), 0, -1))
        camera = dump.meta["camera"]
        assert np.allclose(camera["view_proj_mat"], pick(arrays["view_proj_mat"]).ravel())
        assert camera["crop_offset"] == pick(arrays["crop_offset"]).tolist()
        assert dump.sample_order == "exchangeable" and dump.meta["import"]["independent"] == "unknown"


@pytest.mark.parametrize("name, compressor, rows", [
    ("auto", BLOSC, None), ("bytes", numcodecs.Blosc("lz4", 5, numcodecs.Blosc.SHUFFLE), 3), ("bits", numcodecs.Blosc("zstd", 3, numcodecs.Blosc.BITSHUFFLE), None),
    ("plain shuffle", numcodecs.Blosc("zlib", 1, numcodecs.Blosc.NOSHUFFLE), None), ("none", None, 5), ("zstd", numcodecs.Zstd(3), None), ("zlib", numcodecs.Zlib(1), None)])
def test_stores_of_zarr_itself(tmp_path, name, compressor, rows):
    arrays = sample_set(np.random.default_rng(len(name)), 7, 10, 6)
    write_store(tmp_path / "a.zip", arrays, compressor, **({"rows": rows} if rows else {}))
    code, notes = run_jobs(("import noisebase", tmp_path / "a.zip", tmp_path / "a.spool", "tile=8"))[0]
    assert code == 0 and "8 bits" in notes, notes
    assert_imported(tmp_path / "a.spool", arrays)


@pytest.mark.parametrize("per_chunk", [1, 2])
def test_a_frame_of_a_sequence(tmp_path, per_chunk):
    arrays = sample_set(np.random.default_rng(5), 4, 6, 3, frames=3)
    write_store(tmp_path / "a.zip", arrays, frames=3, frames_per_chunk=per_chunk)
    asked, beyond, taken = run_jobs(("import noisebase", tmp_path / "a.zip", tmp_path / "a.spool"),
                                    ("import noisebase", tmp_path / "a.zip", tmp_path / "a.spool", "frame=3"),
                                    ("import noisebase", tmp_path / "a.zip", tmp_path / "a.spool", "frame=2"))
    assert asked[0] == 2 and "import.frame" in asked[1] and beyond[0] == 2 and taken[0] == 0, taken
    assert_imported(tmp_path / "a.spool", arrays, frame=2)


def test_rgbe_of_known_values(tmp_path):
    color = np.array([[255, 128, 0, 255], [255, 255, 255, 0], [255, 255, 255, 127]], np.uint8).T.reshape(4, 1, 3, 1)
    write_store(tmp_path / "a.zip", {"color": color, "exposure": np.array([-2, 3], "f4")})
    assert run_jobs(("import noisebase", tmp_path / "a.zip", tmp_path / "a.spool"))[0][0] == 0
    with spool.open(tmp_path / "a.spool") as dump:
        assert np.allclose(dump.read("radiance")[0, :, 0], [[20.085537, 10.082152, 0], [0.138005] * 3, [1.648721] * 3], rtol=5e-6)


def test_stores_that_are_no_sample_set_are_refused(tmp_path):
    rng = np.random.default_rng(1)
    good = sample_set(rng, 4, 6, 6)

    def refused(words, code, **changes):
        arrays = {name: array for name, array in {**good, **changes}.items() if array is not None}
        (tmp_path / "a.zip").unlink(missing_ok=True)
        write_store(tmp_path / "a.zip", arrays)
        got, message = run_jobs(("import noisebase", tmp_path / "a.zip", tmp_path / "a.spool"))[0]
        assert got == code and words in message, message
        assert not (tmp_path / "a.spool").exists()

    refused("no arrays color and exposure", 1, color=None)
    refused("expected |u1 with 4 components", 1, color=good["color"][:3])
    refused("exposure hi < lo", 1, exposure=np.array([2, 1], "f4"))
    refused("the file is damaged", 4, exposure=np.array([np.nan, 1], "f4"))
    refused("exposure is 100 to 200", 4, exposure=np.array([100, 200], "f4"))
    refused("but color is 6x4", 1, normal=good["normal"][:, :, :5])
    refused("expected <f2", 1, normal=good["normal"].astype("f4"))
    refused("dtype", 1, normal=good["normal"].astype("f8"))


def test_missing_chunks_and_zarr_3(tmp_path):
    import zipfile
    write_store(tmp_path / "a.zip", sample_set(np.random.default_rng(1), 4, 6, 6))
    with zipfile.ZipFile(tmp_path / "a.zip") as source, zipfile.ZipFile(tmp_path / "b.zip", "w") as target:
        for name in source.namelist():
            if name != "color/0.0.0.1":
                target.writestr(name, source.read(name))
    with zipfile.ZipFile(tmp_path / "c.zip", "w") as target:
        target.writestr("zarr.json", "{}")
    missing, newer = run_jobs(("import noisebase", tmp_path / "b.zip", tmp_path / "a.spool"), ("import noisebase", tmp_path / "c.zip", tmp_path / "a.spool"))
    assert missing[0] == 4 and "color/0.0.0.1 missing" in missing[1]
    assert newer[0] == 1 and "zarr 2" in newer[1]
