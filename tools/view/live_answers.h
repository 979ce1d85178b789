// The answers of `spool view` to its page, by name: choices, replay, reference, pixel.
#pragma once

#include <memory>

#include "tools/view/answers.h"
#include "tools/view/live_replays.h"

namespace spool::tools {

// `choices`: recordings with size and exposure, samplers and filters by label.
// `replay`, `reference`: planes (tools/show/plane_text.h).
// `pixel`: as `spool pixel --json`.
Answers live_answers(const std::shared_ptr<LiveReplays>& replays);

}  // namespace spool::tools
