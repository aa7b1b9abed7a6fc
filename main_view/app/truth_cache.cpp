#include "main_view/app/truth_cache.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <utility>

#include "common/error.hpp"
#include "main_view/app/output_file.hpp"

namespace sightline {
namespace {

constexpr std::string_view k_magic = "sightline truth 1 ";

std::string header_of(const TruthCache::Subject& subject) {
  return std::string(k_magic) + to_hex(subject.scene) + ' ' + std::to_string(subject.size.width) + 'x' +
         std::to_string(subject.size.height) + ' ' + subject.opengl + '\n';
}

[[noreturn]] void refuse(const std::filesystem::path& file) {
  throw InputError("--truth: " + file.string() +
                   " is no file of visible sets, or is damaged; remove it or name another");
}

/// The bytes of a file from the front; refuses to read past its end.
class Reader {
 public:
  Reader(const std::filesystem::path& file, std::string_view rest) : file_(file), rest_(rest) {}

  [[nodiscard]] bool done() const noexcept { return rest_.empty(); }
  std::string_view take(std::size_t bytes) {
    if (bytes > rest_.size()) refuse(file_);
    const std::string_view taken = rest_.substr(0, bytes);
    rest_.remove_prefix(bytes);
    return taken;
  }
  std::uint32_t number() {
    std::uint32_t value = 0;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }

 private:
  const std::filesystem::path& file_;
  std::string_view rest_;
};

void write_number(std::ostream& out, std::size_t value) {
  const auto number = static_cast<std::uint32_t>(value);
  out.write(reinterpret_cast<const char*>(&number), sizeof number);
}

}  // namespace

TruthCache::TruthCache(std::filesystem::path file, const Subject& subject)
    : file_(std::move(file)), object_count_(subject.object_count), header_(header_of(subject)) {
  if (!file_.empty()) read();
}

void TruthCache::read() {
  std::ifstream stream(file_, std::ios::binary);
  if (!stream) return;
  const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (!bytes.starts_with(k_magic)) refuse(file_);
  if (!bytes.starts_with(header_)) return;  // of another scene, size or driver
  for (Reader in(file_, std::string_view(bytes).substr(header_.size())); !in.done();) {
    const std::uint32_t key_bytes = in.number();
    const std::uint32_t count = in.number();
    Key key(in.take(key_bytes));
    const std::string_view ids = in.take(std::size_t{count} * sizeof(std::uint32_t));
    std::vector<ObjectId> visible(count);
    if (count > 0) std::memcpy(visible.data(), ids.data(), ids.size());
    const bool ascending =
        std::adjacent_find(visible.begin(), visible.end(), std::greater_equal<>()) == visible.end();
    if (!ascending || (count > 0 && index_of(visible.back()) >= object_count_)) refuse(file_);
    sets_.try_emplace(std::move(key), std::move(visible));
  }
}

TruthCache::Key TruthCache::key_of(std::span<const Eye> eyes) {
  Key key;
  for (const Eye& eye : eyes) {
    key.append(reinterpret_cast<const char*>(&eye.camera_from_world), sizeof eye.camera_from_world);
    key.append(reinterpret_cast<const char*>(&eye.clip_from_camera), sizeof eye.clip_from_camera);
  }
  return key;
}

const std::vector<ObjectId>* TruthCache::find(std::span<const Eye> eyes) const {
  const auto found = sets_.find(key_of(eyes));
  return found == sets_.end() ? nullptr : &found->second;
}

void TruthCache::add(std::span<const Eye> eyes, const std::vector<ObjectId>& visible) {
  if (file_.empty()) return;
  changed_ |= sets_.insert_or_assign(key_of(eyes), visible).second;
}

void TruthCache::save() {
  if (!changed_) return;
  read();
  write_whole_text(file_, [this](std::ostream& out) {
    out << header_;
    for (const auto& [key, visible] : sets_) {
      write_number(out, key.size());
      write_number(out, visible.size());
      out << key;
      out.write(reinterpret_cast<const char*>(visible.data()),
                static_cast<std::streamsize>(visible.size() * sizeof(ObjectId)));
    }
  });
  changed_ = false;
}

}  // namespace sightline
