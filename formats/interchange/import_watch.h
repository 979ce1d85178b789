// What an importer notices while it writes: samples that are not what the order of the recording
// claims, features in another convention, a reference that is another picture.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "formats/dump_header.h"
#include "formats/interchange/dump_plan.h"
#include "formats/interchange/feature_ranges.h"
#include "formats/interchange/judge_watch.h"
#include "formats/interchange/reference_watch.h"
#include "formats/sample_watch.h"
#include "formats/spool_writer.h"
#include "lib/core/error.h"

namespace spool::interchange {

class ImportWatch {
 public:
  explicit ImportWatch(const DumpPlan& plan);

  // A block of samples [begin, begin + count) of the layers of a group, or of their one value a
  // pixel; radiance is a group of its own.
  void add(const format::PixelRect& rect, uint32_t begin, uint32_t count, format::DataType type,
           std::span<const ForeignLayer> layers, std::span<const std::byte> block);

  // kData where no verb would open the recording, or it claims that its samples are in no
  // meaningful order and they are not, unless the importer shuffled them; else what was noticed is
  // added to the notes and kept in `meta.import_remarks`.
  Result<void> judge(const std::string& source, format::SampleOrder claim,
                     format::SpoolWriter& writer, std::vector<std::string>& notes) const;

 private:
  format::SampleWatch samples_;
  FeatureRanges ranges_;
  ReferenceWatch reference_;
  JudgeWatch judges_;
  bool shuffled_;
};

}  // namespace spool::interchange
