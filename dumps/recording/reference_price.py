"""What a reference takes, and what a smaller one would: printed before it is made."""
from dumps.recording.progress import duration


def reference_hint(samples, reference, pool_seconds, reference_seconds, smaller=None, auto=False):
    """Lines on what the reference costs, and a smaller one would save and cost: its own variance stands in every squared error, and
    beside the mean of the whole pool, the best that can be judged, it has a share of samples / reference. smaller: about a quarter,
    where a recorder cannot make every number (default: a quarter)."""
    if not reference:
        return ["no reference: methods can only be judged against the pool itself (--reference 4096)"]
    if auto:
        return ["the reference takes at most %s (%d samples) and ends where it suffices" % (duration(reference_seconds), reference)]
    lines = ["the reference takes %s; its own noise adds %.3g %% to the squared error of a mean of all %d samples" % (
        duration(reference_seconds), 100 * samples / reference, samples)]
    smaller = reference // 4 if smaller is None else smaller
    if smaller >= samples and reference_seconds > pool_seconds:
        lines.append("--reference %d would save %s and add %.3g %%" % (
            smaller, duration(reference_seconds * (1 - smaller / reference)), 100 * samples / smaller))
    return lines
