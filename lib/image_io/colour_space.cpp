#include "lib/image_io/colour_space.h"

#include <array>
#include <cmath>
#include <string_view>

#include "lib/image_io/layer_kinds.h"

namespace spool {
namespace {

using Chromaticities = std::array<double, 8>;

constexpr Chromaticities kRec709 = {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290};
constexpr Chromaticities kXyz = {1, 0, 0, 1, 0, 0, 1.0 / 3, 1.0 / 3};
constexpr double kAlike = 1e-3;  // of chromaticities, as programs round them

enum class Kind { kLinear, kEncoded, kNoColour, kNotStated };

struct Space {
  std::string_view name;   // for messages
  std::string_view words;  // what files call it, in lower case with '_', separated by spaces
  Kind kind;
  Chromaticities primaries = kRec709;
};

// The identifiers of the Color Interop Forum, and what OpenImageIO, ACES and renderers write.
constexpr Space kSpaces[] = {
    {"Rec. 709",
     " lin_rec709_scene lin_rec709 lin_srgb linear scene_linear linear_srgb linear_rec_709_srgb "
     "linear_rec709 linear_rec_709 utility_linear_srgb utility_linear_rec_709 lin_rec709_srgb "
     "linear_bt_709 rec709_linear srgb_linear non_color_linear_rec709 ",
     Kind::kLinear},
    {"P3-D65",
     " lin_p3d65_scene lin_p3d65 linear_p3_d65 ",
     Kind::kLinear,
     {0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290}},
    {"Rec. 2020",
     " lin_rec2020_scene lin_rec2020 linear_rec_2020 linear_rec2020 ",
     Kind::kLinear,
     {0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290}},
    {"Adobe RGB",
     " lin_adobergb_scene lin_adobergb linear_adobergb ",
     Kind::kLinear,
     {0.64, 0.33, 0.21, 0.71, 0.15, 0.06, 0.3127, 0.3290}},
    {"CIE XYZ", " lin_ciexyzd65_scene lin_ciexyzd65 cie_xyz_d65 ", Kind::kLinear, kXyz},
    {"ACES2065-1 (AP0)",
     " lin_ap0_scene lin_ap0 aces2065_1 aces_aces2065_1 ap0 ",
     Kind::kLinear,
     {0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767}},
    {"ACEScg (AP1)",
     " lin_ap1_scene lin_ap1 acescg aces_acescg ap1 ",
     Kind::kLinear,
     {0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767}},
    {"DCI-P3",
     " lin_p3dci lin_p3 ",
     Kind::kLinear,
     {0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.314, 0.351}},
    {"", " unknown ", Kind::kNotStated},
    {"data", " data raw non_color ", Kind::kNoColour},
};

// Beginnings of names of encoded spaces, after which a space follows.
constexpr std::string_view kEncodings[] = {"srgb",    "g18_",   "g22_",    "g24_",  "g26_",
                                           "gamma",   "rec709", "rec_709", "bt709", "acescc",
                                           "acescct", "log",    "adx",     "pq_",   "hlg_"};

std::string squeezed(std::string_view text) {
  std::string word;
  for (const char c : lower_case(text)) {
    const bool kept = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (kept) word += c;
    if (!kept && !word.empty() && word.back() != '_') word += '_';
  }
  while (word.ends_with('_'))
    word.pop_back();
  return word;
}

bool alike(const double* a, const double* b, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    if (!(std::abs(a[i] - b[i]) < kAlike)) return false;
  return true;
}

bool alike(const Chromaticities& a, const Chromaticities& b) {
  return alike(a.data(), b.data(), a.size());
}

ColourMatrix product(const ColourMatrix& a, const ColourMatrix& b) {
  ColourMatrix result{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 3; ++k)
        result[r][c] += a[r][k] * b[k][c];
  return result;
}

// R = G = B = 1 is the white of luminance 1 [SMPTE RP 177].
ColourMatrix to_xyz(const Chromaticities& given) {
  ColourMatrix points{};
  for (std::size_t c = 0; c < 3; ++c)
    points[0][c] = given[2 * c], points[1][c] = given[2 * c + 1],
    points[2][c] = 1.0 - given[2 * c] - given[2 * c + 1];
  const double x = given[6], y = given[7];
  const std::array<double, 3> white = {x / y, 1.0, (1.0 - x - y) / y};
  const ColourMatrix weights = inverse(points);
  ColourMatrix result{};
  for (std::size_t c = 0; c < 3; ++c) {
    double scale = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      scale += weights[c][k] * white[k];
    for (std::size_t r = 0; r < 3; ++r)
      result[r][c] = points[r][c] * scale;
  }
  return result;
}

bool is_finite(const ColourMatrix& m) {
  for (const auto& row : m)
    for (const double value : row)
      if (!(std::abs(value) < 1e6)) return false;  // of primaries on a line
  return true;
}

const Space* known_space(std::string_view word) {
  for (const Space& space : kSpaces)
    if (space.words.find(fmt::format(" {} ", word)) != std::string_view::npos) return &space;
  return nullptr;
}

std::string name_of(const Chromaticities& given) {
  for (const Space& space : kSpaces)
    if (space.kind == Kind::kLinear && alike(space.primaries, given))
      return std::string(space.name);
  return fmt::format("primaries {:.4g},{:.4g} {:.4g},{:.4g} {:.4g},{:.4g} white {:.4g},{:.4g}",
                     given[0], given[1], given[2], given[3], given[4], given[5], given[6],
                     given[7]);
}

struct Statement {
  std::string key;  // the attribute
  Chromaticities primaries = kRec709;
};

// The value of one attribute of text; nothing where it is absent or empty.
Result<std::optional<Statement>> stated(const ExrPart& part, const std::string& key,
                                        const std::string& file) {
  const auto found = part.attributes.texts.find(key);
  if (found == part.attributes.texts.end() || squeezed(found->second).empty()) return std::nullopt;
  const std::string word = squeezed(found->second);
  const Space* space = known_space(word);
  if (space != nullptr && space->kind == Kind::kNotStated) return std::nullopt;
  if (space != nullptr && space->kind == Kind::kLinear) return Statement{key, space->primaries};
  bool encoded = false;
  for (const std::string_view start : kEncodings)
    encoded = encoded || word.starts_with(start);
  return fail(ErrorCode::kData, "{}: {} is '{}': {}", file, key, found->second,
              encoded ? "encoded values are no light: linearise them first, to lin_rec709_scene"
              : space ? "the channels are no colours: choose another layer or part"
                      : "not known here: convert to lin_rec709_scene first");
}

}  // namespace

Result<std::optional<ColourConversion>> conversion_to_rec709(const ExrPart& part,
                                                             const std::string& file) {
  std::optional<Statement> statement;
  if (part.chromaticities) statement = Statement{"chromaticities", *part.chromaticities};
  for (const char* key : {"colorInteropID", "oiio:ColorSpace", "colorSpace", "colorspace"}) {
    SPOOL_ASSIGN(const auto found, stated(part, key, file));
    if (!found) continue;
    if (statement && !alike(statement->primaries, found->primaries))
      return fail(ErrorCode::kData, "{}: {} is {} and {} is {}: remove the attribute that is wrong",
                  file, statement->key, name_of(statement->primaries), key,
                  name_of(found->primaries));
    if (!statement) statement = found;
  }
  const auto aces = part.attributes.numbers.find("acesImageContainerFlag");
  if (!statement && aces != part.attributes.numbers.end() && aces->second == 1.0)
    statement = Statement{"acesImageContainerFlag", known_space("ap0")->primaries};
  if (!statement || alike(statement->primaries, kRec709)) return std::nullopt;
  const Chromaticities& given = statement->primaries;
  const std::string name = name_of(given);
  const bool xyz = alike(given.data(), kXyz.data(), 6);
  if (!xyz && !alike(&given[6], &kRec709[6], 2))
    return fail(ErrorCode::kData,
                "{}: {}: {}, whose white is not that of Rec. 709: convert first, e.g. oiiotool "
                "--colorconvert",
                file, statement->key, name);
  const ColourMatrix matrix = product(inverse(to_xyz(kRec709)), to_xyz(given));
  if (!is_finite(matrix))
    return fail(ErrorCode::kData, "{}: {} make no sense ({}): remove or correct them", file,
                statement->key, name);
  return ColourConversion{xyz ? "CIE XYZ" : name, matrix};
}

}  // namespace spool
