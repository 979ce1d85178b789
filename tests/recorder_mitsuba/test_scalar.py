"""The fallback without LLVM: chunks, pool and reference draw numbers of their own at every size of the picture."""
import numpy as np
import pytest

import spool
from conftest import check_ok, record
from seeds import CHUNK_LIMIT, USER_LIMIT, chunk_seed, spread


def test_seeds_of_chunks_are_all_different_and_spread_keeps_them_so():
    few = [chunk_seed(user, chunk, reference) for user in (0, 1, USER_LIMIT - 1) for reference in (False, True)
           for chunk in [*range(2000), CHUNK_LIMIT - 2, CHUNK_LIMIT - 1]]
    assert len(set(few)) == len(few) and max(few) < 1 << 31
    assert len({spread(seed) for seed in few}) == len(few)
    assert spread(0) == 0 and spread(1) == 0x514E28B7         # MurmurHash3's finaliser, computed by hand from its definition


@pytest.mark.parametrize("size", [32, 30])
def test_seeds_differ_and_pool_and_reference_differ(tmp_path, size):
    """32 x 32 pixels: a product of size and seed distance once came to a multiple of 2^32."""
    pools, references = [], []
    for seed in (1, 2):
        out = tmp_path / ("%d.spool" % seed)
        check_ok(record("cornell-box", "-o", out, "--size", size, "--samples", 4, "--reference", 4, "--seed", seed,
                        "--variant", "scalar_rgb", "--channels", "film", "--max-depth", 3, "--chunk-lanes", size * size * 2))
        with spool.open(out) as dump:
            assert dump.meta["random_numbers"] == {"pool": size * size * 4, "pool_repeated": 0,
                                                   "reference": size * size * 4, "reference_repeated": 0}
            pools.append(dump.read("film"))
            references.append(dump.pixel("reference") - dump.read("radiance").mean(axis=2))
    assert (pools[0] != pools[1]).mean() > 0.999
    assert (pools[0][:, :, :2] != pools[0][:, :, 2:]).mean() > 0.999       # the second chunk
    assert all((np.abs(difference) > 1e-4).mean() > 0.5 for difference in references)
