#include "formats/interchange/import_watch.h"

#include <algorithm>
#include <utility>

namespace spool::interchange {
namespace {

bool shares_places(const ForeignLayer& layer) {
  return layer.name == "film" && layer.scope == format::Scope::kPass;
}

}  // namespace

ImportWatch::ImportWatch(const DumpPlan& plan)
    : samples_(plan.width, plan.height, plan.spp,
               std::any_of(plan.layers.begin(), plan.layers.end(), shares_places)),
      ranges_(uint64_t{plan.width} * plan.height),
      reference_(plan.width, plan.height),
      judges_(plan.width, plan.height),
      shuffled_(plan.shuffled) {}

void ImportWatch::add(const format::PixelRect& rect, uint32_t begin, uint32_t count,
                      format::DataType type, std::span<const ForeignLayer> layers,
                      std::span<const std::byte> block) {
  const size_t pixels = size_t{rect.width()} * rect.height();
  const size_t plane = pixels * count * format::bytes_per_value(type);
  for (const ForeignLayer& layer : layers) {
    const auto planes = block.first(layer.array.components * plane);
    block = block.subspan(planes.size());
    if (layer.scope == format::Scope::kPixel) {
      if (layer.array.components != 3 || type == format::DataType::kUint32) continue;
      if (layer.name == "reference") {
        reference_.add_reference(rect, type, planes);
        judges_.add_reference(rect, type, planes);
      }
      if (layer.name == "reference_variance") judges_.add_variance(rect, type, planes);
      continue;
    }
    if (layer.name == "radiance" && layer.array.components == 3) {
      samples_.add(rect, begin, count, type, planes);
      reference_.add_radiance(rect, count, type, planes);
    }
    ranges_.add(layer.name, layer.array.components, pixels, count, type, planes);
  }
}

Result<void> ImportWatch::judge(const std::string& source, format::SampleOrder claim,
                                format::SpoolWriter& writer,
                                std::vector<std::string>& notes) const {
  SPOOL_TRY(judges_.judge(source));
  std::vector<std::string> remarks = ranges_.remarks();
  if (std::string other = reference_.remark(); !other.empty()) remarks.push_back(std::move(other));
  if (const std::string objection = samples_.objection(); !objection.empty()) {
    if (claim == format::SampleOrder::kExchangeable && !shuffled_)
      return fail(
          ErrorCode::kData,
          "{}: {}, so the samples of a pixel are not exchangeable: pack what is independent, "
          "or do not claim it",
          source, objection);
    remarks.push_back(objection + "; the samples of a pixel are not independent");
  }
  if (remarks.empty()) return {};
  SPOOL_TRY(writer.write_meta(nlohmann::json{{"import_remarks", remarks}}.dump(
      -1, ' ', false, nlohmann::json::error_handler_t::replace)));
  notes.insert(notes.end(), remarks.begin(), remarks.end());
  return {};
}

}  // namespace spool::interchange
