// libFuzzer target: any bytes as a frame, and what decodes as a visible set as one. Seeds: the golden frames,
// as tests/protocol/golden_to_corpus writes them.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "protocol/codec.hpp"
#include "protocol/roaring_format.hpp"
#include "protocol/visible_set.hpp"

namespace {

using namespace sightline;

constexpr std::uint32_t k_object_count = 1'000'000;

void decode_as_set(const VisibleSetFrame& frame) {
  static const VisibleSet base(std::vector<ObjectId>{ObjectId{1}, ObjectId{70'000}});
  const auto decoded = decode_visible_set(frame, &base, k_object_count);
  const auto* set = std::get_if<VisibleSet>(&decoded);
  if (set == nullptr) return;
  if (set->size() != frame.visible_count) std::abort();
  for (const ObjectId id : set->to_ids()) {
    if (index_of(id) >= k_object_count) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto decoded = decode({reinterpret_cast<const std::byte*>(data), size});
  if (const auto* message = std::get_if<Message>(&decoded)) {
    // What was accepted must be writable and read back as the same.
    const auto again = decode(encode(*message));
    if (!std::holds_alternative<Message>(again) || !(std::get<Message>(again) == *message)) std::abort();
    if (const auto* frame = std::get_if<VisibleSetFrame>(message)) decode_as_set(*frame);
  }

  // The same bytes as a bare bitmap: most inputs do not get through the envelope.
  VisibleSetFrame frame;
  frame.bitmap.assign(data, data + size);
  const auto summary = check_roaring(frame.bitmap);
  if (const auto* found = std::get_if<RoaringSummary>(&summary)) {
    frame.visible_count = static_cast<std::uint32_t>(found->cardinality);
    if (found->cardinality <= 2 * k_object_count) decode_as_set(frame);
  }
  return 0;
}
