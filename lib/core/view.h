// Intermediate images of a method, by the names of docs/method.md: kept only on request.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/core/image.h"

namespace spool {

struct View {
  std::string name;  // "f.2", "P.1", "level", "band_energy.2.3"
  Plane image;       // of pieces
};

// A family of views as people see it in a list: "f.k", "the coarse images".
struct ViewDescription {
  std::string name;  // of a family, its indices as letters
  std::string meaning;
};

// Collects the views whose name, or the part of it before the first dot, was asked for; "all" asks
// for every one. An empty request collects nothing and costs nothing.
class Views {
 public:
  Views() = default;
  explicit Views(std::vector<std::string> wanted) : wanted_(std::move(wanted)) {}

  // Whether `name` is kept, or as the name of a family one of its members.
  bool wants(std::string_view name) const {
    return std::any_of(wanted_.begin(), wanted_.end(), [&](const std::string& w) {
      return asks_for(w, name) ||
             (w.size() > name.size() && w.starts_with(name) && w[name.size()] == '.');
    });
  }
  void add(std::string name, const Plane& image) {
    const bool kept = std::any_of(wanted_.begin(), wanted_.end(),
                                  [&](const std::string& w) { return asks_for(w, name); });
    if (kept) views_.push_back({std::move(name), image});
  }
  // The next of a family that has one view a round: "error.0", "error.1".
  void add_next(const std::string& family, const Plane& image) {
    if (wanted_.empty()) return;
    std::size_t count = 0;
    for (const View& view : views_)
      count += view.name.starts_with(family + ".") ? 1 : 0;
    add(family + "." + std::to_string(count), image);
  }
  const std::vector<std::string>& wanted() const { return wanted_; }
  const std::vector<View>& collected() const { return views_; }

 private:
  static bool asks_for(std::string_view wanted, std::string_view name) {
    return wanted == "all" || (name.starts_with(wanted) &&
                               (name.size() == wanted.size() || name[wanted.size()] == '.'));
  }

  std::vector<std::string> wanted_;
  std::vector<View> views_;
};

}  // namespace spool
