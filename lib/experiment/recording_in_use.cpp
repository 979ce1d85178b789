#include "lib/experiment/recording_in_use.h"

#include <utility>

#include "lib/experiment/sample_kurtosis.h"

namespace spool {
namespace {

// 73 bytes a pixel.
constexpr long long kMostKept = 1 << 20;

std::shared_ptr<KeptSide> kept_side(const RecordedSamples& samples) {
  const long long pixels = static_cast<long long>(samples.width()) * samples.height();
  return pixels <= kMostKept ? std::make_shared<KeptSide>() : nullptr;
}

}  // namespace

Result<std::shared_ptr<const RecordedSamples>> RecordingInUse::get(const std::string& name) {
  if (known_ && name_ == name) return samples_;
  samples_ = nullptr;
  const StageClock clock;
  known_ = false;
  samples_ = load_(name);
  reading_ = clock.elapsed();
  kurtosis_ = samples_ ? sample_kurtosis(**samples_) : 0.0;
  side_ = samples_ ? kept_side(**samples_) : nullptr;
  name_ = name;
  known_ = true;
  return samples_;
}

StageTime RecordingInUse::take_reading() {
  return std::exchange(reading_, StageTime{});
}

}  // namespace spool
