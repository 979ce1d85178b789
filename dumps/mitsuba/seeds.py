"""One seed for each chunk of a recording; no two chunks of pool and reference share one.

(user seed, pool or reference, chunk) -> 31 bits: 10 of the user's, one of the kind, 20 of the chunk.
"""
USER_LIMIT, CHUNK_LIMIT = 1 << 10, 1 << 20
SPARE = CHUNK_LIMIT - 1        # of no chunk: for traces that are thrown away


def chunk_seed(user, chunk, reference=False):
    assert 0 <= user < USER_LIMIT and 0 <= chunk < CHUNK_LIMIT
    return (user << 21) + (CHUNK_LIMIT if reference else 0) + chunk


def spread(seed):
    """A bijection of 32 bits, so different seeds stay different, and neighbouring ones end far apart.

    A scalar sampler starts one PCG32 at its 32-bit seed as it stands; starts that differ in few bits give sequences
    whose states differ by a multiple of one power of two for ever. The finaliser is that of MurmurHash3 (public
    domain, A. Appleby).
    """
    seed ^= seed >> 16
    seed = seed * 0x85EBCA6B & 0xFFFFFFFF
    seed ^= seed >> 13
    seed = seed * 0xC2B2AE35 & 0xFFFFFFFF
    return seed ^ seed >> 16
