#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>

namespace sightline {

/// The bytes of one frame where they already lie: a link takes and gives them without a copy. Copies of a
/// Frame share the bytes, which nobody changes; any thread may drop the last one.
class Frame {
 public:
  Frame() = default;
  /// `owner` keeps `bytes` alive.
  Frame(std::shared_ptr<const void> owner, std::span<const std::byte> bytes) noexcept
      : owner_(std::move(owner)), bytes_(bytes) {}

  [[nodiscard]] const std::byte* data() const noexcept { return bytes_.data(); }
  [[nodiscard]] std::size_t size() const noexcept { return bytes_.size(); }
  [[nodiscard]] bool empty() const noexcept { return bytes_.empty(); }
  [[nodiscard]] auto begin() const noexcept { return bytes_.begin(); }
  [[nodiscard]] auto end() const noexcept { return bytes_.end(); }

 private:
  std::shared_ptr<const void> owner_;
  std::span<const std::byte> bytes_;
};

}  // namespace sightline
