"""Seeds and film positions of passes, as pure functions of (recording seed, pass index).

A pass is one sample per pixel. Seeds of the pool lie in [0, 2^30), seeds of the reference in
[2^30, 2^31): the two can never meet. Within one recording every pass has a seed of its own,
because the map from index to seed is a permutation of 30-bit numbers, not a hash.
"""
import hashlib

SEED_BITS = 30
MASK = (1 << SEED_BITS) - 1


def _keys(recording_seed, purpose):
    digest = hashlib.blake2b(b"%d/%s" % (recording_seed, purpose), digest_size=24).digest()
    return [int.from_bytes(digest[4 * i:4 * i + 4], "little") for i in range(6)]


def _permute(index, keys):
    """Permutation of [0, 2^30): odd factors, sums and shifted exclusive-or are each invertible."""
    value = index & MASK
    for add, factor in zip(keys[0::2], keys[1::2]):
        value = (value + add) & MASK
        value = (value * (factor | 1)) & MASK
        value ^= value >> (SEED_BITS // 2)
    return value


def pool_seed(recording_seed, index):
    return _permute(index, _keys(recording_seed, b"pool"))


def reference_seed(recording_seed, batch):
    return (1 << SEED_BITS) + _permute(batch, _keys(recording_seed, b"reference"))


def film_position(recording_seed, index):
    """Film position of a pass inside the pixel, [0, 1)^2, x right, y down from the upper edge."""
    digest = hashlib.blake2b(b"%d/film/%d" % (recording_seed, index), digest_size=8).digest()
    # 23 bits and a half: exact in float32, never 0 and never 1.
    x, y = (int.from_bytes(digest[i:i + 4], "little") >> 9 for i in (0, 4))
    return (x + 0.5) / 2**23, (y + 0.5) / 2**23
