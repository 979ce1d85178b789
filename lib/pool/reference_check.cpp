#include "lib/pool/reference_check.h"

#include <algorithm>
#include <cmath>

namespace spool {

Result<void> check_variance(const RgbImage& variance, const RgbImage& mean,
                            const std::string& name) {
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < mean[c].size(); ++i)
      if (std::isfinite(mean[c][i]) && !(variance[c][i] >= 0.0 && std::isfinite(variance[c][i])))
        return fail(ErrorCode::kData,
                    "{}: pixel {},{}: {} is no variance: give the variance of the reference's mean",
                    name, i % static_cast<std::size_t>(mean[c].width()),
                    i / static_cast<std::size_t>(mean[c].width()), variance[c][i]);
  return {};
}

Result<void> check_reference(const Reference& reference, const std::string& recording) {
  const bool any = std::ranges::any_of(reference.mean, [](const Plane& plane) {
    return std::ranges::any_of(plane.pixels(), [](double value) { return std::isfinite(value); });
  });
  if (!any)
    return fail(ErrorCode::kData,
                "{}: reference: no pixel is finite: record it again, or leave the layer out",
                recording);
  if (!reference.variance_of_mean) return {};
  return check_variance(*reference.variance_of_mean, reference.mean,
                        recording + ": reference_variance");
}

}  // namespace spool
