#include "main_view/app/sets_file.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <string>
#include <string_view>

#include "common/error.hpp"

namespace sightline {
namespace {

constexpr std::string_view k_header = "frame,ids";

/// The lines of one file; whatever is wrong is refused with the number of the line at hand.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : file_(file), stream_(file) {
    if (!next() || text_ != k_header) refuse("the header must be " + std::string(k_header));
  }

  bool next() {
    ++number_;
    if (!std::getline(stream_, text_)) return false;
    if (!text_.empty() && text_.back() == '\r') text_.pop_back();
    return true;
  }

  [[nodiscard]] std::string_view text() const noexcept { return text_; }

  /// Takes a number below `end` off the front of `text`.
  std::uint32_t take_number(std::string_view& text, std::uint32_t end, const char* what) const {
    std::uint32_t number = 0;
    const auto [stopped, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || number >= end) {
      refuse(std::string(what) + " must be a number below " + std::to_string(end));
    }
    text.remove_prefix(static_cast<std::size_t>(stopped - text.data()));
    return number;
  }

  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(file_.string() + ": line " + std::to_string(number_) + ": " + why);
  }

 private:
  const std::filesystem::path& file_;
  std::ifstream stream_;
  std::string text_;
  std::size_t number_ = 0;
};

std::vector<ObjectId> take_ids(const Lines& lines, std::string_view text, std::uint32_t object_count) {
  std::vector<ObjectId> ids;
  while (!text.empty()) {
    if (!ids.empty()) {
      if (text.front() != ' ') lines.refuse("ids must have one space between them");
      text.remove_prefix(1);
    }
    ids.push_back(ObjectId{lines.take_number(text, object_count, "an id")});
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

}  // namespace

std::vector<FrameSet> read_frame_sets(const std::filesystem::path& file, std::uint32_t frame_count,
                                      std::uint32_t object_count) {
  Lines lines(file);
  std::vector<FrameSet> sets;
  while (lines.next()) {
    std::string_view text = lines.text();
    FrameSet set;
    set.frame = lines.take_number(text, frame_count, "the frame");
    if (!sets.empty() && set.frame <= sets.back().frame) lines.refuse("frames do not ascend");
    if (text.empty() || text.front() != ',') lines.refuse("a comma must follow the frame");
    text.remove_prefix(1);
    set.everything = text == "*";
    if (!set.everything) set.ids = take_ids(lines, text, object_count);
    sets.push_back(std::move(set));
  }
  if (sets.empty()) lines.refuse("holds no set");
  return sets;
}

}  // namespace sightline
