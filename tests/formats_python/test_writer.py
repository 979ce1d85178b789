import errno
import fcntl
import gc
import os
import subprocess
import sys
import warnings

import numpy as np
import pytest
import spool
from spool import partial_file

LAYERS = {"radiance": ("f4", "RGB")}
BLOCK = np.zeros((3, 8, 8, 2), "f4")


def writer(path, **options):
    return spool.Writer(path, 8, 8, 4, options.pop("layers", LAYERS), **{"tile_size": 8, "block_spp": 2, **options})


def usage(call, *arguments, **options):
    with pytest.raises(spool.SpoolError) as caught:
        call(*arguments, **options)
    assert caught.value.kind == "usage" and caught.value.code == 2 and "\n" not in str(caught.value)


def test_partial_name_until_finished(tmp_path):
    path = tmp_path / "a.spool"
    with writer(path) as output:
        output.write_block(0, 0, 0, BLOCK)
        assert os.listdir(tmp_path) == ["a.spool.partial"]
    assert os.listdir(tmp_path) == ["a.spool"]


def test_exception_leaves_the_partial_file(tmp_path):
    path = tmp_path / "a.spool"
    with pytest.raises(KeyError):
        with writer(path):
            raise KeyError
    assert os.listdir(tmp_path) == ["a.spool.partial"]
    usage(writer, path)
    with pytest.raises(spool.SpoolError) as caught:
        spool.open(tmp_path / "a.spool.partial")
    assert caught.value.kind == "incomplete"
    with writer(path, force=True) as output:
        usage(writer, path)
        usage(writer, path, force=True)  # a recording that runs is never replaced
        output.write_block(0, 0, 0, BLOCK)
    assert spool.check(path).ok and os.listdir(tmp_path) == ["a.spool"]


def test_partial_name_is_never_opened_as_complete(tmp_path):
    path = tmp_path / "a.spool"
    with writer(path) as output:
        output.write_block(0, 0, 0, BLOCK)
    partial = path.rename(tmp_path / "a.spool.partial")
    with pytest.raises(spool.SpoolError) as caught:
        spool.open(partial)
    assert caught.value.kind == "incomplete" and "run spool recover" in str(caught.value)
    assert spool.check(partial).ok


def test_existing_target_needs_force(tmp_path):
    path = tmp_path / "a.spool"
    path.write_bytes(b"precious")
    with pytest.raises(spool.SpoolError, match="exists: choose another name or give force=True"):
        writer(path)
    assert path.read_bytes() == b"precious"
    with writer(path, force=True):
        assert path.read_bytes() == b"precious"
    assert spool.check(path).ok


def test_a_file_that_was_finished_meanwhile_is_not_emptied(tmp_path, monkeypatch):
    """A second writer opens NAME.partial, the first one finishes, the second one gets the lock: of NAME."""
    path = tmp_path / "a.spool"
    first = writer(path)
    first.write_block(0, 0, 0, BLOCK)
    lock = fcntl.flock

    def lock_late(handle, how):
        monkeypatch.setattr(fcntl, "flock", lock)
        first.finish()
        lock(handle, how)
    monkeypatch.setattr(fcntl, "flock", lock_late)
    usage(writer, path, force=True)
    assert spool.check(path).ok and os.listdir(tmp_path) == ["a.spool"]


def test_target_that_appears_meanwhile_is_kept(tmp_path):
    path = tmp_path / "a.spool"
    output = writer(path)
    path.write_bytes(b"precious")
    usage(output.finish)
    assert path.read_bytes() == b"precious" and (tmp_path / "a.spool.partial").exists()


def test_wrong_blocks_are_refused_and_cost_nothing(tmp_path):
    path = tmp_path / "a.spool"
    with writer(path) as output:
        output.write_block(0, 0, 0, BLOCK)
        for arguments in ((0, 0, 0, BLOCK), (0, 0, 1, BLOCK), (0, 1, 0, BLOCK), (0, -1, 0, BLOCK), (0, 0, 4, BLOCK), (1, 0, 2, BLOCK),
                          (0, 0, 2, BLOCK[:2]), (0, 0, 2, BLOCK[..., :1]), (0, 0, 2, BLOCK.astype("i4")), ("depth", 0, 0, BLOCK)):
            usage(output.write_block, *arguments)
        output.write_block("radiance", 0, 2, BLOCK)
    assert spool.check(path).ok and spool.check(path).complete


def test_half_refuses_what_it_cannot_hold(tmp_path):
    with writer(tmp_path / "a.spool", layers={"radiance": ("f2", "RGB")}) as output:
        bright = BLOCK.copy()
        bright[1, 2, 3, 1] = 65520
        with pytest.raises(spool.SpoolError, match=r"65520.0 at \[1, 2, 3, 1\] does not fit float16"):
            output.write_block(0, 0, 0, bright)
        bright[1, 2, 3, 1] = np.inf
        output.write_block(0, 0, 0, bright)


def test_passes_must_be_whole_and_in_order(tmp_path):
    passes = np.zeros((8, 8, 1, 3))
    output = writer(tmp_path / "a.spool")
    usage(output.write_passes, 1, {"radiance": passes})
    output.write_passes(0, {"radiance": passes})
    usage(output.write_passes, 0, {"radiance": passes})
    usage(output.write_passes, 1, {"radiance": np.zeros((8, 8, 4, 3))})
    usage(output.write_passes, 1, {})
    with pytest.raises(spool.SpoolError, match=r"\(8, 8, 1, 4\), not \[y\]\[x\]\[sample\]\[component\] of 8 rows, 8 columns, "
                       r"any number of samples and 3 components"):
        output.write_passes(1, {"radiance": np.zeros((8, 8, 1, 4))})
    usage(output.finish)
    assert os.listdir(tmp_path) == ["a.spool.partial"]


@pytest.mark.parametrize("options", [
    {"layers": {}}, {"layers": {"albedo": ("f4", "RGB")}}, {"layers": {"radiance": ("u4", "RGB")}},
    {"layers": {"radiance": ("f8", "RGB")}}, {"layers": {"radiance": ("f4", "RGB"), "Depth": ("f4", "Z")}},
    {"tile_size": 12}, {"block_spp": 0}, {"sample_order": "sorted"},
    {"layers": {"radiance": ("f4", "RGB"), **{f"l{i}": ("f4", "X") for i in range(16)}}}])
def test_impossible_files_are_refused_before_anything_is_written(tmp_path, options):
    usage(writer, tmp_path / "a.spool", **options)
    assert not os.listdir(tmp_path)


def test_write_never_guesses(tmp_path):
    radiance = np.zeros((8, 8, 4, 3))
    path = tmp_path / "a.spool"
    usage(spool.write, path, radiance[0])
    usage(spool.write, path, radiance, half_vector=radiance)
    usage(spool.write, path, radiance.astype("i8"))
    usage(spool.write, path, radiance, scope={"film": "pass"})
    usage(spool.write, path, radiance, reference=radiance, scope={"reference": "sample"})
    assert not os.listdir(tmp_path)
    spool.write(path, radiance, half_vector=radiance, components={"half_vector": "XYZ"}, dtypes={"half_vector": "f2"})
    with spool.open(path) as dump:
        assert dump.layers["half_vector"].dtype == np.float16


class Failing:
    """os, with one call that fails from the k-th time on."""

    def __init__(self, name, after, number):
        self._name, self._after, self._number = name, after, number

    def __getattr__(self, name):
        real = getattr(os, name)
        if name != self._name:
            return real

        def call(*arguments):
            self._after -= 1
            if self._after < 0:
                raise OSError(self._number, os.strerror(self._number)) if self._number else KeyboardInterrupt
            return real(*arguments)
        return call


@pytest.mark.parametrize("after", range(7))
def test_full_disk_leaves_whole_records(tmp_path, monkeypatch, after):
    path = tmp_path / "a.spool"
    monkeypatch.setattr(partial_file, "os", Failing("write", after, errno.ENOSPC))
    with pytest.raises(spool.SpoolError) as caught:
        with writer(path) as output:
            output.write_block(0, 0, 0, BLOCK)
            output.write_block(0, 0, 2, BLOCK)
    assert caught.value.kind == "io" and "free space" in str(caught.value)
    sizes = [0, 64, 192, 448, 448 + 64 + 1536, 448 + 2 * 1600, 448 + 2 * 1600 + 64 + 256]
    assert os.listdir(tmp_path) == ["a.spool.partial"] and os.path.getsize(path.with_suffix(".spool.partial")) == sizes[after]


@pytest.mark.parametrize("name", ["write", "fsync"])
def test_an_interrupted_record_is_the_last(tmp_path, monkeypatch, name):
    monkeypatch.setattr(partial_file, "_SYNC_BYTES", 1)
    with pytest.raises(spool.SpoolError, match="not writable after: KeyboardInterrupt: record again"):
        with writer(tmp_path / "a.spool") as output:
            monkeypatch.setattr(partial_file, "os", Failing(name, 0, None))
            with pytest.raises(KeyboardInterrupt):
                output.write_block(0, 0, 0, BLOCK)
            monkeypatch.undo()
            output.write_block(0, 0, 0, BLOCK)  # what follows would not stand where the index says
    assert os.listdir(tmp_path) == ["a.spool.partial"]


def test_an_interrupted_write_of_arrays_leaves_no_file_behind(tmp_path, monkeypatch):
    monkeypatch.setattr(partial_file, "os", Failing("write", 4, None))
    with pytest.raises(KeyboardInterrupt):
        spool.write(tmp_path / "a.spool", np.ones((8, 8, 4, 3), "f4"), block_spp=2)
    assert not list(tmp_path.iterdir())


def test_short_writes_continue(tmp_path, monkeypatch):
    reference, path = tmp_path / "reference.spool", tmp_path / "short.spool"
    samples = np.random.default_rng(1).random((8, 8, 4, 3))
    spool.write(reference, samples, uuid=bytes(16))

    class Short:
        def __getattr__(self, name):
            return (lambda handle, data: os.write(handle, data[:7])) if name == "write" else getattr(os, name)
    monkeypatch.setattr(partial_file, "os", Short())
    spool.write(path, samples, uuid=bytes(16))
    assert path.read_bytes() == reference.read_bytes()


@pytest.mark.parametrize("name", ["fsync", "replace"])
def test_failed_fsync_or_rename_never_shows_the_file(tmp_path, monkeypatch, name):
    path = tmp_path / "a.spool"
    output = writer(path)
    failing = Failing(name, 0, errno.EIO)
    monkeypatch.setattr(partial_file, "os", failing)
    with pytest.raises(spool.SpoolError) as caught:
        output.finish()
    assert caught.value.kind == "io" and failing._after == -1  # not tried a second time
    assert os.listdir(tmp_path) == ["a.spool.partial"]


def test_the_callers_array_may_be_used_again(tmp_path):
    path, buffer = tmp_path / "reused.spool", np.empty((8, 8, 1, 3), "f4")
    with spool.Writer(path, 8, 8, 4, {"radiance": ("f4", "RGB")}) as writer:
        for sample in range(4):
            buffer[:] = sample
            writer.write_passes(sample, {"radiance": buffer})
    assert spool.open(path).read("radiance")[0, 0, :, 0].tolist() == [0, 1, 2, 3]


def test_a_mask_is_refused(tmp_path):
    masked = np.ma.masked_greater(np.ones((8, 8, 1, 3), "f4"), 0)
    with spool.Writer(tmp_path / "masked.spool", 8, 8, 1, {"radiance": ("f4", "RGB")}) as writer:
        with pytest.raises(spool.SpoolError, match="masks are not looked at"):
            writer.write_passes(0, {"radiance": masked})


def test_finishing_twice_is_finishing_once(tmp_path):
    with spool.Writer(tmp_path / "twice.spool", 4, 4, 1, {"radiance": ("f4", "RGB")}) as writer:
        writer.write_passes(0, {"radiance": np.ones((4, 4, 1, 3), "f4")})
        writer.finish()
    assert spool.open(tmp_path / "twice.spool").complete


def test_a_writer_that_went_lets_its_file_go(tmp_path):
    writer = spool.Writer(tmp_path / "left.spool", 4, 4, 1, {"radiance": ("f4", "RGB")})
    del writer
    gc.collect()
    spool.Writer(tmp_path / "left.spool", 4, 4, 1, {"radiance": ("f4", "RGB")}, force=True)._file.close()


def test_arrays_that_do_not_fit_leave_no_file_behind(tmp_path):
    radiance = np.ones((4, 4, 2, 3), "f4")
    for wrong in (np.ones((4, 5, 2, 3), "f4"), np.full((4, 4, 2, 3), 1e300)):
        with pytest.raises(spool.SpoolError):
            spool.write(tmp_path / "a.spool", radiance, albedo=wrong)
        assert not list(tmp_path.iterdir())
    spool.write(tmp_path / "a.spool", radiance, albedo=radiance)


@pytest.mark.parametrize("channels", [5, 0.5, object()])
def test_channels_that_are_none_are_refused_in_one_line(tmp_path, channels):
    usage(spool.Writer, tmp_path / "none.spool", 4, 4, 1, channels=channels)


@pytest.mark.parametrize("layers", [{"radiance": ("zz", "RGB")}, {"radiance": ("f4", 5)}, {"radiance": ("f4", "RGB"), "x": ("f4", "")},
                                    {"radiance": ("f4", "RGB", "foo")}])
def test_layers_that_are_none_are_refused_in_one_line(tmp_path, layers):
    with pytest.raises(spool.SpoolError, match="none.spool: "):
        spool.Writer(tmp_path / "none.spool", 4, 4, 1, layers)


@pytest.mark.parametrize("first, arrays", [("0", {}), (None, {}), (0, None), (0, np.ones(3)), (False, {})])
def test_passes_that_are_none_are_refused_in_one_line(tmp_path, first, arrays):
    with spool.Writer(tmp_path / "none.spool", 4, 4, 1, {"radiance": ("f4", "RGB")}) as writer:
        with pytest.raises(spool.SpoolError, match="none.spool: "):
            writer.write_passes(first, arrays)


def test_remarks_of_two_processes_all_arrive(tmp_path):
    spool.write(tmp_path / "a.spool", np.ones((2, 2, 1, 3), "f4"))
    code = "import sys, spool\nfor i in range(10): spool.append_meta(sys.argv[1], {sys.argv[2] + str(i): 1})"
    both = [subprocess.Popen([sys.executable, "-c", code, tmp_path / "a.spool", name],
                             env={"PYTHONPATH": os.pathsep.join(sys.path)}) for name in "ab"]
    assert [process.wait() for process in both] == [0, 0]
    assert len(spool.open(tmp_path / "a.spool").meta) == 20


def test_what_pack_remarks_is_warned_of_in_its_words(tmp_path):
    random = np.random.default_rng(1)
    unit = random.normal(size=(8, 8, 4, 3))
    unit /= np.linalg.norm(unit, axis=-1, keepdims=True)
    radiance = random.random((8, 8, 4, 3)).astype("f2")

    def warned(samples, **layers):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            spool.write(tmp_path / "a.spool", samples, force=True, **layers)
        assert all(each.filename == __file__ for each in caught)
        return [str(each.message).partition("a.spool: ")[2] for each in caught]
    assert warned(radiance, normal=unit, hit=np.ones((8, 8, 4), "u1")) == []
    assert warned(radiance, normal=unit / 2 + 0.5) == ["normal: encoded as n / 2 + 1 / 2 (no value is below 0): store 2 v - 1"]
    assert warned(radiance, normal_geo=np.rint((unit / 2 + 0.5) * 255)) == ["normal_geo: encoded in 8 bits, 0 to 255: store 2 v / 255 - 1"]
    film = random.random((8, 8, 4, 2))
    assert warned(radiance, film=film) == []
    film[0, 0, 0, 0] = np.nextafter(1.0, 0.0)  # which float32 does not have: it is stored as 1
    for scale, most in ((1.0, "1"), (8.0, "8")):
        (remark,) = warned(radiance, film=film * scale)
        assert remark.startswith("film: from ") and f"to {most}: positions inside the pixel are expected" in remark, remark
    radiance[0, 0, 0] = np.inf, np.nan, -65504
    assert warned(radiance, normal=np.abs(unit)) == ["values that are not finite, stored as they are: 2",
                                                     "values at the half-float limit, clamped by the renderer: 1"]
    assert np.isposinf(spool.open(tmp_path / "a.spool").read("radiance")[0, 0, 0, 0])
    with warnings.catch_warnings(), pytest.raises(UserWarning):
        warnings.simplefilter("error")
        spool.write(tmp_path / "b.spool", radiance)
    assert os.listdir(tmp_path) == ["a.spool"]


def test_layers_of_unequal_numbers_of_samples_are_named(tmp_path):
    light = np.ones((9, 10, 8, 3), "f4")
    with pytest.raises(spool.SpoolError, match=r"a\.spool: passes from 0 on: radiance has 8, albedo has 4: as many of each, up to the 8 of the file"):
        spool.write(tmp_path / "a.spool", light, albedo=light[:, :, :4])
