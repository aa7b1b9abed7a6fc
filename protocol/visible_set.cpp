#include "protocol/visible_set.hpp"

#include <string>

#include "protocol/roaring_format.hpp"

namespace sightline {
namespace {

std::vector<std::uint8_t> serialized(const RoaringBitmap& bitmap) {
  std::vector<std::uint8_t> bytes(bitmap.getSizeInBytes(true));
  bitmap.write(reinterpret_cast<char*>(bytes.data()), true);
  return bytes;
}

/// Run containers only where they make the whole shorter: each saves on its own, but the first one also costs
/// the flags of all the others.
std::vector<std::uint8_t> shortest(RoaringBitmap bitmap) {
  const std::size_t size_without_runs = bitmap.getSizeInBytes(true);
  RoaringBitmap with_runs = bitmap;
  if (with_runs.runOptimize() && with_runs.getSizeInBytes(true) < size_without_runs)
    bitmap = std::move(with_runs);
  return serialized(bitmap);
}

DecodeError refused(const std::string& reason) {
  return DecodeError{"visible set: " + reason};
}

}  // namespace

VisibleSet::VisibleSet(std::span<const ObjectId> ascending_ids) {
  std::vector<std::uint32_t> indices;
  indices.reserve(ascending_ids.size());
  for (const ObjectId id : ascending_ids) indices.push_back(index_of(id));
  ids_.addMany(indices.size(), indices.data());
}

std::vector<ObjectId> VisibleSet::to_ids() const {
  std::vector<std::uint32_t> indices(ids_.cardinality());
  ids_.toUint32Array(indices.data());
  std::vector<ObjectId> ids;
  ids.reserve(indices.size());
  for (const std::uint32_t index : indices) ids.push_back(ObjectId{index});
  return ids;
}

std::vector<std::uint8_t> encode_keyframe(const VisibleSet& set) {
  return shortest(set.bitmap());
}

std::vector<std::uint8_t> encode_delta(const VisibleSet& base, const VisibleSet& set) {
  return shortest(base.bitmap() ^ set.bitmap());
}

std::variant<VisibleSet, DecodeError> decode_visible_set(const VisibleSetFrame& frame, const VisibleSet* base,
                                                         std::uint32_t object_count) {
  const bool is_keyframe = frame.base_seq == 0;
  if (!is_keyframe && base == nullptr) return refused("its base is not held");

  const auto checked = check_roaring(frame.bitmap);
  if (const auto* error = std::get_if<DecodeError>(&checked)) return *error;
  const RoaringSummary& summary = std::get<RoaringSummary>(checked);
  if (summary.cardinality > 0 && summary.largest >= object_count) {
    return refused("object " + std::to_string(summary.largest) + " of " + std::to_string(object_count));
  }
  if (is_keyframe && summary.cardinality != frame.visible_count)
    return refused("not as many objects as it says");

  RoaringBitmap ids =
      RoaringBitmap::readSafe(reinterpret_cast<const char*>(frame.bitmap.data()), frame.bitmap.size());
  if (!is_keyframe) {
    ids ^= base->bitmap();
    if (ids.cardinality() != frame.visible_count) return refused("not the base it was made for");
  }
  return VisibleSet(std::move(ids));
}

}  // namespace sightline
