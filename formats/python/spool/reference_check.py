"""What a reference and its variance have to be, or no verb opens their recording (lib/pool/reference_check.h)."""
import numpy as np

from .error import SpoolError


def check_judges(path, reference, variance):
    """Arrays [y][x][c], or None where there is none; what has another shape is refused by its writer."""
    if reference is not None and reference.size and not np.isfinite(reference).any():
        raise SpoolError("usage", f"{path}: reference: no value is finite: render it again, or leave it out")
    if variance is None or variance.ndim != 3:
        return
    judges = np.ones(variance.shape, bool) if reference is None or reference.shape != variance.shape else np.isfinite(reference)
    with np.errstate(invalid="ignore"):
        wrong = np.argwhere(judges & ~((variance >= 0) & np.isfinite(variance)))
    if len(wrong):
        y, x, *_ = wrong[0]
        raise SpoolError("usage", f"{path}: reference_variance of pixel {x},{y} is {variance[tuple(wrong[0])]}: "
                                  "a variance is finite and at least 0")
