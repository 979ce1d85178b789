#include "formats/interchange/judge_watch.h"

#include <algorithm>
#include <cmath>

#include "formats/stored_value.h"

namespace spool::interchange {

void JudgeWatch::note(const format::PixelRect& rect, format::DataType type,
                      std::span<const std::byte> planes, Finite& finite) const {
  finite.resize(3 * pixels_);
  size_t at = 0;
  for (size_t c = 0; c < 3; ++c)
    for (size_t y = rect.y0; y < rect.y1; ++y)
      for (size_t x = rect.x0; x < rect.x1; ++x)
        finite[c * pixels_ + y * width_ + x] =
            std::isfinite(format::stored_value(planes, type, at++));
}

Result<void> JudgeWatch::judge(const std::string& source) const {
  if (judges_.empty()) return {};
  if (std::ranges::none_of(judges_, [](bool finite) { return finite; })) {
    return fail(ErrorCode::kData,
                "{}: reference: no value is finite: render it again, or leave it out", source);
  }
  for (size_t i = 0; i < varies_.size(); ++i) {
    if (varies_[i] || !judges_[i]) continue;
    return fail(ErrorCode::kData,
                "{}: reference_variance of pixel {},{} is not finite: a variance is finite and at "
                "least 0",
                source, i % pixels_ % width_, i % pixels_ / width_);
  }
  return {};
}

}  // namespace spool::interchange
