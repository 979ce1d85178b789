import numpy as np
import pytest
import spool

import sbmc_files
from conftest import run_jobs


def imported(tmp_path, source, *options):
    return (*run_jobs(("import sbmc", source, tmp_path / "a.spool", "tile=8", *options))[0], tmp_path / "a.spool")


@pytest.mark.parametrize("scaled, ts, spp", [(True, 8, 4), (False, 4, 1), (True, 16, 3)])
def test_values_of_a_set(tmp_path, scaled, ts, spp):
    made = sbmc_files.scene(np.random.default_rng(ts), 3 * ts, 2 * ts, spp)
    code, notes, path = imported(tmp_path, sbmc_files.write_set(tmp_path / "scene", made, ts, scaled=scaled))
    assert code == 0 and "stratified" in notes, notes
    assert spool.check(path).ok
    with spool.open(path) as dump:
        assert dump.sample_order == "exchangeable" and dump.meta["import"]["independent"] is False
        assert dump.meta["import"]["options"]["scale"] == ("normalised" if scaled else "raw")
        assert dump.meta["camera"]["aperture_radius"] == pytest.approx(0.5, rel=1e-6)
        exact = {"radiance": made["diffuse"] + made["specular"], "diffuse": made["diffuse"], "film": made["film"], "time": made["time"],
                 "visibility": made["visibility"], "hit": made["hit"], "albedo": made["albedo"], "albedo_ns": made["albedo_ns"],
                 "normal": made["normal"], "normal_ns": made["normal_ns"]}
        for name, values in exact.items():
            assert np.array_equal(dump.read(name).reshape(values.shape), values), name
        for name in "depth", "depth_ns", "lens":
            assert np.allclose(dump.read(name).reshape(made[name].shape), made[name], rtol=2e-6, atol=1e-7), name
        flags = dump.read("path")[..., 0]
        assert np.array_equal(flags, (made["flags"].astype("u4") << (5 * np.arange(6, dtype="u4"))).sum(-1, dtype="u4"))
        means, variances = made["means"].transpose(1, 2, 0), made["variances"].transpose(1, 2, 0)
        assert np.array_equal(dump.pixel("reference"), means[..., :3] + means[..., 3:6])
        assert np.array_equal(dump.pixel("reference_diffuse_variance"), variances[..., :3])
        assert np.array_equal(dump.pixel("reference_specular_variance"), variances[..., 3:6])
        assert "reference_variance" not in dump.layers


def test_a_pinhole_has_no_lens_and_a_crop_window_moves_the_film(tmp_path):
    made = sbmc_files.scene(np.random.default_rng(1), 8, 8, 2)
    folder = tmp_path / "scene"
    folder.mkdir()
    (folder / "0128_0064.bin").write_bytes(sbmc_files.tile(made, 0, 0, 8, aperture=0.0, shift=(128, 64)))
    code, notes, path = imported(tmp_path, folder)
    assert code == 0, notes
    with spool.open(path) as dump:
        assert "lens" not in dump.layers
        assert np.allclose(dump.read("film"), made["film"], atol=1e-4)


def test_a_list_of_tiles(tmp_path):
    made = sbmc_files.scene(np.random.default_rng(1), 8, 8, 1)
    sbmc_files.write_set(tmp_path / "scene", made, 4)
    (tmp_path / "list.txt").write_text("".join(f"scene/{path.name}\n" for path in sorted((tmp_path / "scene").iterdir())))
    code, notes, path = imported(tmp_path, tmp_path / "list.txt")
    assert code == 0, notes


def test_scale_that_cannot_be_told_is_asked_for(tmp_path):
    made = sbmc_files.scene(np.random.default_rng(1), 4, 4, 1)
    source = sbmc_files.write_set(tmp_path / "scene", made, 4, scaled=False)
    zero = sbmc_files.ZERO_PDF
    try:
        sbmc_files.ZERO_PDF = np.float32(0.25)  # no pdf is negative, none is zero
        (source / "0000_0000.bin").write_bytes(sbmc_files.tile(made, 0, 0, 4, scaled=True))
    finally:
        sbmc_files.ZERO_PDF = zero
    code, message, path = imported(tmp_path, source)
    assert code == 2 and "import.scale" in message
    assert imported(tmp_path, source, "scale=raw")[0] == 0


def test_sets_that_do_not_belong_together_are_refused(tmp_path):
    made = sbmc_files.scene(np.random.default_rng(1), 16, 8, 1)
    source = sbmc_files.write_set(tmp_path / "scene", made, 4)
    (source / "0004_0004.bin").unlink()
    code, message, path = imported(tmp_path, source)
    assert code == 4 and "1 of 8 tiles missing (first at 4,4)" in message
    (source / "9.bin").write_bytes(sbmc_files.tile(made, 0, 0, 4))
    code, message, path = imported(tmp_path, source)
    assert code == 1 and "a second tile at 0,0" in message
    (source / "9.bin").write_bytes(sbmc_files.tile(made, 4, 4, 4, radius=9.0))
    code, message, path = imported(tmp_path, source)
    assert code == 1 and "differs" in message
    (source / "9.bin").unlink()
    (source / "0004_0004.bin").write_bytes(sbmc_files.tile(made, 4, 4, 4, shift=(71, 0)))
    code, message, path = imported(tmp_path, source)
    assert code == 1 and "sub-pixel x" in message and "unusable" in message
    assert not path.exists()


@pytest.mark.parametrize("offset", range(0, 60, 4))
def test_every_header_field_is_judged(tmp_path, offset):
    made = sbmc_files.scene(np.random.default_rng(1), 4, 4, 1)
    source = sbmc_files.write_set(tmp_path / "scene", made, 4)
    # Zero is right for the place of the tile and possible for the numbers of the camera.
    fine = {52: (0,), 56: (0,), 20: (2147483647, 1), 36: (0, 1, 2147483647), 40: (0, 1), 44: (0, 1), 48: (0, 1), 16: (1,)}
    for value in 0, 1, 2147483647, -1:
        (source / "0000_0000.bin").write_bytes(sbmc_files.tile(made, 0, 0, 4, header=[(offset, value)]))
        code, message, path = imported(tmp_path, source, "force")
        if value not in fine.get(offset, ()):
            assert code in (1, 4), (offset, value, message)
        else:
            assert code in (0, 1, 4), (offset, value, message)
