"""Seeds and options: pure functions, no Blender."""
from array import array

import pytest

from dumps.cycles import options, pass_folder, passes, seeds
from dumps.recording import whole_files
from dumps.recording.failure import Failure


def test_seeds_of_one_recording_are_all_different():
    assert len({seeds.pool_seed(1, i) for i in range(65536)}) == 65536
    assert len({seeds.reference_seed(1, i) for i in range(65536)}) == 65536


def test_pool_and_reference_seeds_live_in_disjoint_ranges_of_31_bits():
    for recording in (0, 1, 7, 2**31 - 1):
        for i in range(1000):
            assert 0 <= seeds.pool_seed(recording, i) < 2**30
            assert 2**30 <= seeds.reference_seed(recording, i) < 2**31


def test_seeds_do_not_change():
    assert [seeds.pool_seed(1, i) for i in range(2)] == [987492100, 224948348]


def test_film_positions_fill_the_pixel_evenly_and_are_exact_in_float32():
    import struct
    places = [seeds.film_position(3, i) for i in range(4096)]
    for axis in (0, 1):
        values = [p[axis] for p in places]
        assert all(0 < v < 1 and struct.unpack("f", struct.pack("f", v))[0] == v for v in values)
        counts = [sum(1 for v in values if int(v * 16) == b) for b in range(16)]
        # chi-square of 16 bins, 15 degrees of freedom: 44.3 is exceeded with probability 1e-4
        assert sum((c - 256) ** 2 / 256 for c in counts) < 44.3


@pytest.mark.parametrize("spp, expected", [(0, (1, 0)), (16, (1, 16)), (64, (1, 64)), (128, (2, 64)),
                                           (4096, (64, 64)), (16384, (128, 128))])
def test_reference_has_64_batches_of_at_most_128_samples(spp, expected):
    assert options.batch_plan(spp) == expected


@pytest.mark.parametrize("arguments, message", [
    (["--size", "0"], "--size"), (["--size", "64x64x64"], "--size"), (["--size", "wide"], "--size"),
    (["--samples", "0"], "--samples"), (["--samples", "65537"], "--samples"), (["--seed", "-1"], "--seed"),
    (["--reference", "129"], "--reference"), (["--mode", "naive"], "--mode"),
    (["--mode", "sequence", "--first", "4"], "--first"), (["--colour"], "--colour")])
def test_bad_options_are_one_line_and_wrong_use(arguments, message):
    with pytest.raises(Failure) as caught:
        options.parse_options(["-o", "folder", *arguments])
    assert caught.value.code == 2 and message in str(caught.value) and "\n" not in str(caught.value)


def test_a_torn_last_line_is_cut_off_and_its_pass_counts_as_missing(tmp_path):
    folder = pass_folder.PassFolder(str(tmp_path), {"width": 1, "height": 1})
    folder.add("pass", 0, b"abcd", {})
    folder.add("pass", 1, b"efgh", {})
    folder.lock.close()
    log = tmp_path / "passes.jsonl"
    log.write_bytes(log.read_bytes()[:-7])
    again = pass_folder.PassFolder(str(tmp_path), {"width": 1, "height": 1})
    assert again.has("pass", 0) and not again.has("pass", 1)
    again.add("pass", 1, b"efgh", {})
    assert len(log.read_text().splitlines()) == 2


@pytest.mark.parametrize("harm", [lambda p: p.write_bytes(b"abce"), lambda p: p.unlink(),
                                  lambda p: p.write_bytes(b"abc")])
def test_a_pass_that_changed_on_disk_counts_as_missing(tmp_path, harm):
    folder = pass_folder.PassFolder(str(tmp_path), {"width": 1, "height": 1})
    folder.add("pass", 0, b"abcd", {})
    folder.lock.close()
    harm(tmp_path / "pass_00000.f32")
    assert not pass_folder.PassFolder(str(tmp_path), {"width": 1, "height": 1}).has("pass", 0)


def test_two_recorders_in_one_folder_are_refused(tmp_path):
    first = pass_folder.PassFolder(str(tmp_path), {"width": 1, "height": 1})
    with pytest.raises(Failure, match="another recorder"):
        pass_folder.PassFolder(str(tmp_path), {"width": 1, "height": 1})
    first.lock.close()


def test_a_full_disk_is_one_line_and_leaves_no_half_pass(tmp_path, monkeypatch):
    folder = pass_folder.PassFolder(str(tmp_path), {"width": 1, "height": 1})
    folder.add("pass", 0, b"abcd", {})
    written = whole_files.write_synced

    def full(name, mode, write):
        written(name, mode, lambda stream: stream.write(b"ef"))
        raise OSError(28, "No space left on device", name)

    monkeypatch.setattr(whole_files, "write_synced", full)
    with pytest.raises(Failure, match="No space left.*free some space") as caught:
        folder.add("pass", 1, b"efgh", {})
    assert caught.value.code == 3
    assert [p.name for p in tmp_path.glob("pass_*")] == ["pass_00000.f32"]


def test_albedo_of_surfaces_without_a_diffuse_part_is_what_they_mirror_and_let_through(monkeypatch):
    """With numpy and without it, to the last bit; a colour with one dark channel stays what it is."""
    flat = {"DiffCol": array("f", [0.8, 0.0, 0.1, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
            "GlossCol": array("f", [0.04, 0.04, 0.04, 0.9, 0.6, 0.2, 0.7, 0.7, 0.7, 0, 0, 0]),
            "TransCol": array("f", [0, 0, 0, 0, 0, 0, 0.6, 0.2, 0.1, 0, 0, 0])}
    expected = array("f", [0.8, 0.0, 0.1, 0.9, 0.6, 0.2, 1.0, 0.9, 0.8, 0, 0, 0])
    plain, rows = passes.CHANNELS["albedo"], []
    for numpy in (passes.numpy, None):
        monkeypatch.setattr(passes, "numpy", numpy)
        rows.append(plain.mix(flat))
    assert rows[0] == rows[1] and rows[0] == pytest.approx(expected, abs=1e-7)


def test_help_names_the_exit_codes(capsys):
    with pytest.raises(SystemExit):
        options.parse_options(["--help"])
    assert "3 Blender or the system refused" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("name", ["new\nline", "bad\udcffutf", "bell\a"])
def test_a_name_that_no_line_holds_is_refused_before_anything_renders(name):
    for arguments in (["--scene", name, "-o", "folder"], ["--blend", name + ".blend", "-o", "folder"], ["-o", name]):
        with pytest.raises(Failure) as caught:
            options.parse_options(arguments)
        assert caught.value.code == 2 and "rename it" in str(caught.value) and str(caught.value).isprintable()


def test_what_to_type_next_is_as_a_shell_takes_it():
    import shlex

    from dumps.recording import recordings
    names = ["-lead.spool", "it's \"q\".spool", "a$(touch b).spool", "größe.spool"]
    words = shlex.split(recordings.next_step(names))
    assert words[3:7] == ["./-lead.spool", *names[1:]]
