"""How the reference is cut into batches."""


def batch_plan(reference):
    """(samples per batch, batches): a power of two of samples, at most 128, and at least 64 batches
    where there are that many samples. The variance of the mean comes from the batch means."""
    if not reference:
        return 1, 0
    batch = 1
    while batch < 128 and reference // (2 * batch) >= 64:
        batch *= 2
    return batch, reference // batch
