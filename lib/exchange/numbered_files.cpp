#include "lib/exchange/numbered_files.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <tuple>

#include "formats/record_layout.h"
#include "lib/image_io/layer_kinds.h"

namespace spool::exchange {
namespace {

constexpr size_t kDigits = 18;  // fit int64_t

struct NumberedFile {
  std::filesystem::path path;
  std::string name;
  std::string before, after;  // the number, in lower case
  std::string high;           // digits before the last 18
  int64_t number = 0;
  bool dash = false;  // a '-' before the number, which `before` does not contain
};

std::optional<NumberedFile> parse(const std::filesystem::path& path) {
  NumberedFile file{path, path.filename().string(), {}, {}, {}, 0, false};
  const std::string stem = path.stem().string();
  const size_t end = stem.find_last_of("0123456789");
  if (end == std::string::npos) return std::nullopt;
  const size_t text = stem.find_last_not_of("0123456789", end);
  const size_t begin = text == std::string::npos ? 0 : text + 1;
  file.dash = begin > 0 && stem[begin - 1] == '-';
  file.before = lower_case(stem.substr(0, begin - (file.dash ? 1 : 0)));
  file.after = lower_case(stem.substr(end + 1));
  const std::string digits = stem.substr(begin, end + 1 - begin);
  const size_t low = digits.size() > kDigits ? digits.size() - kDigits : 0;
  file.high = digits.substr(0, low);
  file.high.erase(0, file.high.find_first_not_of('0'));
  std::from_chars(digits.data() + low, digits.data() + digits.size(), file.number);
  return file;
}

void give_signs(std::vector<NumberedFile>& files) {
  std::set<std::pair<std::string, std::string>> without_dash;
  for (const NumberedFile& file : files)
    if (!file.dash) without_dash.emplace(file.before, file.after);
  for (NumberedFile& file : files) {
    if (!file.dash) continue;
    const bool separated =
        file.before.find_last_of("_ .-") + 1 == file.before.size();  // also where it is empty
    if (separated || without_dash.contains({file.before, file.after}))
      file.number = -file.number;
    else
      file.before += '-';
  }
}

Result<void> check_sequence(const std::vector<NumberedFile>& files, const std::string& in) {
  for (size_t i = 1; i < files.size(); ++i) {
    const NumberedFile &one = files[i - 1], &two = files[i];
    if (two.high != one.high)
      return fail(ErrorCode::kData,
                  "{}: the numbers of {} and {} differ before their last {} digits: number the "
                  "samples 1, 2, 3",
                  in, one.name, two.name, kDigits);
    if (two.number == one.number)
      return fail(ErrorCode::kData,
                  "{}: sample {} is there twice, {} and {} (the last number in a name counts): "
                  "number the samples last, and move what is no sample away",
                  in, one.number, one.name, two.name);
    if (two.number != one.number + 1 && (two.before != one.before || two.after != one.after))
      return fail(
          ErrorCode::kData,
          "{}: {} is followed by {}, which is named otherwise: move what is no sample away, "
          "or number the samples without gaps",
          in, one.name, two.name);
    if (two.number != one.number + 1)
      return fail(ErrorCode::kData,
                  "{}: sample {} is missing, {} is followed by {}: render it, or number the "
                  "samples without gaps",
                  in, one.number + 1, one.name, two.name);
  }
  return {};
}

void add_notes(const std::vector<NumberedFile>& files, const std::vector<std::string>& left_out,
               std::vector<std::string>& notes) {
  if (!left_out.empty())
    notes.push_back(fmt::format(
        "not read (hidden, a folder, or no *.exr): {}{}", left_out.front(),
        left_out.size() == 1 ? std::string() : fmt::format(" and {} more", left_out.size() - 1)));
  const auto other = std::find_if(files.begin(), files.end(), [&](const NumberedFile& file) {
    return file.before != files[0].before || file.after != files[0].after;
  });
  if (other != files.end())
    notes.push_back(
        fmt::format("names differ beside their numbers: {} and {}", files[0].name, other->name));
  if (files[0].number < 0)
    notes.push_back(fmt::format("the samples are numbered {} to {}: a '-' is a sign in {}",
                                files[0].number, files.back().number, files[0].name));
}

}  // namespace

Result<NumberedFiles> numbered_files(const std::filesystem::path& in, const std::string& except) {
  std::vector<NumberedFile> files;
  std::vector<std::string> left_out;
  std::error_code error, unknown;
  for (const auto& entry : std::filesystem::directory_iterator(in, error)) {
    const std::string name = entry.path().filename().string();
    if (name == except) continue;
    if (name.starts_with('.') || lower_case(entry.path().extension().string()) != ".exr" ||
        entry.is_directory(unknown)) {
      left_out.push_back(name);
      continue;
    }
    auto file = parse(entry.path());
    if (!file)
      return fail(ErrorCode::kData,
                  "{}: no number in the name: number the samples, move other files away",
                  entry.path().string());
    files.push_back(std::move(*file));
  }
  if (error)
    return fail(ErrorCode::kIo, "{}: cannot be listed ({}): give a folder of EXR images",
                in.string(), error.message());
  if (files.empty())
    return fail(ErrorCode::kData, "{}: no *.exr in it: give a folder of EXR images", in.string());
  if (files.size() > format::kMaxSpp)
    return fail(ErrorCode::kData, "{}: {} images: at most {} samples are possible", in.string(),
                files.size(), format::kMaxSpp);
  give_signs(files);
  std::sort(files.begin(), files.end(), [](const NumberedFile& a, const NumberedFile& b) {
    return std::tie(a.high, a.number, a.name) < std::tie(b.high, b.number, b.name);
  });
  SPOOL_TRY(check_sequence(files, in.string()));
  std::sort(left_out.begin(), left_out.end());
  NumberedFiles result;
  add_notes(files, left_out, result.notes);
  for (NumberedFile& file : files)
    result.paths.push_back(std::move(file.path));
  return result;
}

}  // namespace spool::exchange
