"""Names of metrics as texts write them."""

METRICS = {"mse": "MSE", "rmse": "RMSE", "relmse": "relMSE", "mae": "MAE", "relmae": "relMAE", "smape": "SMAPE", "ssim": "SSIM",
           "ms_ssim": "MS-SSIM", "psnr_tm": "PSNR in dB", "flip_ldr": "FLIP", "flip_hdr": "HDR-FLIP"}


BIASED = " (biased)"  # behind metrics judged by the samples that images were made of


def metric_name(metric):
    """relmse as texts write it; a mark behind it stays."""
    metric, mark, _ = metric.partition(BIASED)
    first, _, rest = metric.partition("_")
    if metric in METRICS or first not in METRICS:
        return METRICS.get(metric, metric.replace("_", " ")) + mark
    return METRICS[first] + ", " + rest.replace("_", " ") + mark
