#include "lib/image_io/layer_choice.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "lib/core/visible_text.h"

namespace spool {
namespace {

constexpr std::size_t kToldNames = 8;  // more than listed() shows need no care

using Layers = std::vector<const ExrLayer*>;

template <class Test>
Layers those(const Layers& layers, Test&& test) {
  Layers found;
  std::copy_if(layers.begin(), layers.end(), std::back_inserter(found),
               [&](const ExrLayer* layer) { return test(*layer); });
  return found;
}

class Chooser {
 public:
  Chooser(const std::string& file, const std::vector<ExrPart>& parts,
          const std::vector<ExrLayer>& layers, const LayerChoice& choice, Taken taken)
      : file_(file), parts_(parts), layers_(layers), choice_(choice), taken_(taken) {}

  Result<ChosenLayer> choose() const {
    SPOOL_ASSIGN(Layers open, of_part());
    if (choice_.layer.empty()) return by_kind(open);
    if (const Layers exact = named(open); !exact.empty()) {
      if (exact.size() > 1) return ambiguous(exact);
      if (!exact[0]->is_picture()) return no_colours(*exact[0]);
      return ChosenLayer{*exact[0], ""};
    }
    if (auto channel = of_channel(open)) return ChosenLayer{std::move(*channel), ""};
    const std::string start = choice_.layer + ".";
    const Layers within =
        those(open, [&](const ExrLayer& layer) { return layer.name.starts_with(start); });
    if (!within.empty()) return by_kind(within);
    return fail(ErrorCode::kUsage, "{}: no layer or channel {}: there are {}", file_, choice_.layer,
                listed(names(open)));
  }

 private:
  Result<Layers> of_part() const {
    Layers all;
    for (const ExrLayer& layer : layers_)
      all.push_back(&layer);
    if (choice_.part.empty())
      return those(all, [&](const ExrLayer& layer) { return parts_[layer.part].flat; });
    std::size_t number = parts_.size();
    const char* end = choice_.part.data() + choice_.part.size();
    const auto read = std::from_chars(choice_.part.data(), end, number);
    if (read.ec != std::errc() || read.ptr != end) number = parts_.size();
    Layers found =
        those(all, [&](const ExrLayer& layer) { return parts_[layer.part].name == choice_.part; });
    if (found.empty())
      found = those(all, [&](const ExrLayer& layer) { return layer.part == number; });
    if (!found.empty()) return found;
    std::vector<std::string> known;
    for (std::size_t p = 0; p < parts_.size(); ++p)
      known.push_back(fmt::format("{} '{}'", p, parts_[p].name));
    return fail(ErrorCode::kUsage, "{}: no part {}: there are {}", file_, choice_.part,
                listed(known));
  }

  // As spelt, else in another letter case.
  Layers named(const Layers& open) const {
    Layers found = those(open, [&](const ExrLayer& layer) {
      return layer.name == choice_.layer ||
             (layer.name.empty() && layer.colour && spelt(layer) == choice_.layer);
    });
    if (!found.empty()) return found;
    return those(open, [&](const ExrLayer& layer) {
      return lower_case(layer.name) == lower_case(choice_.layer);
    });
  }

  // "depth.Z": one channel, taken as grey.
  std::optional<ExrLayer> of_channel(const Layers& open) const {
    for (const ExrLayer* layer : open) {
      for (const auto& [channel, index] : layer->channels) {
        if (parts_[layer->part].channels[index].name != choice_.layer &&
            (layer->name.empty() ? channel : layer->name + "." + channel) != choice_.layer)
          continue;
        ExrLayer one = *layer;
        one.channels = {{channel, index}};
        one.colour.reset();
        one.grey = index;
        return one;
      }
    }
    return std::nullopt;
  }

  Result<ChosenLayer> by_kind(const Layers& open) const {
    Layers pictures = those(open, [](const ExrLayer& layer) { return layer.is_picture(); });
    // A file of several views says which one is shown where views are unknown.
    if (const Layers first =
            those(pictures, [](const ExrLayer& layer) { return layer.view.empty(); });
        std::any_of(first.begin(), first.end(),
                    [](const ExrLayer* layer) { return layer->kind != LayerKind::kOther; }))
      pictures = first;
    const auto of = [&](LayerKind kind) {
      return those(pictures, [&](const ExrLayer& layer) { return layer.kind == kind; });
    };
    const Layers noisy = of(LayerKind::kNoisy), denoised = of(LayerKind::kDenoised);
    Layers found = taken_ == Taken::kSamples ? noisy : of(LayerKind::kPicture);
    std::string remark;
    if (taken_ == Taken::kSamples && !noisy.empty()) {
      remark = fmt::format("radiance is {}: what stands beside it is denoised", spelt(*noisy[0]));
    } else if (taken_ == Taken::kPicture && !noisy.empty() && !found.empty()) {
      remark = fmt::format("{} is denoised, {} is not", spelt(*found[0]), spelt(*noisy[0]));
    }
    if (found.empty()) found = of(LayerKind::kPicture);
    if (found.empty()) {
      found = of(LayerKind::kUnknown);
      if (taken_ == Taken::kPicture) {
        found.insert(found.end(), noisy.begin(), noisy.end());
        found.insert(found.end(), denoised.begin(), denoised.end());
      }
      if (found.size() == 1)
        remark = fmt::format("the picture is taken to be {}", spelt(*found[0]));
    }
    if (found.size() > 1) return ambiguous(found);
    if (!found.empty()) return ChosenLayer{*found[0], remark};
    if (!denoised.empty())
      return fail(ErrorCode::kData,
                  "{}: {} is denoised, and no noisy picture is beside it: samples are needed",
                  file_, spelt(*denoised[0]));
    return nothing(open);
  }

  std::vector<std::string> names(const Layers& layers) const {
    std::vector<std::string> names;
    for (const ExrLayer* layer : layers)  // a file may have a hundred thousand
      names.push_back(names.size() < kToldNames ? told(*layer, parts_, layers_) : layer->name);
    return names;
  }

  // "choose with --layer beauty"
  std::string remedy(const std::string& option, const std::string& name) const {
    if (option.empty()) return "save the one that is meant in a file of its own";
    return fmt::format("choose with {}{}", option, shell_word(name));
  }

  tl::unexpected<Error> ambiguous(const Layers& found) const {
    const bool by_layer = found[0]->name != found[1]->name;
    return fail(ErrorCode::kData, "{}: more than one picture ({}): {}", file_, listed(names(found)),
                by_layer ? remedy(choice_.layer_option, spelt(*found[0]))
                         : remedy(choice_.part_option, parts_[found[0]->part].name));
  }

  tl::unexpected<Error> no_colours(const ExrLayer& layer) const {
    const std::string first = parts_[layer.part].channels[layer.channels.begin()->second].name;
    return fail(ErrorCode::kData, "{}: {} has no channels R, G, B: for one of its channels, {}",
                file_, told(layer, parts_, layers_), remedy(choice_.layer_option, first));
  }

  tl::unexpected<Error> nothing(const Layers& open) const {
    if (open.empty()) return not_flat(file_, parts_, 0);
    const auto chroma = [](const ExrLayer& layer) {
      return layer.channels.contains("RY") && layer.channels.contains("BY");
    };
    if (!those(open, chroma).empty())
      return fail(ErrorCode::kData,
                  "{}: luminance and chroma (Y, RY, BY) are not R, G, B: convert them first",
                  file_);
    return fail(ErrorCode::kData, "{}: no picture in R, G, B or Y, there are {}: {}", file_,
                listed(names(open)), remedy(choice_.layer_option, "NAME"));
  }

  const std::string& file_;
  const std::vector<ExrPart>& parts_;
  const std::vector<ExrLayer>& layers_;
  const LayerChoice& choice_;
  Taken taken_;
};

}  // namespace

Result<ChosenLayer> choose_layer(const std::string& file, const std::vector<ExrPart>& parts,
                                 const std::vector<ExrLayer>& layers, const LayerChoice& choice,
                                 Taken taken) {
  return Chooser(file, parts, layers, choice, taken).choose();
}

}  // namespace spool
