#include "protocol/visible_set.hpp"

#include <algorithm>
#include <optional>
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

constexpr std::size_t k_extent_bytes = 5;

void append_cells(const DirectionExtent& extent, std::vector<std::uint8_t>& cells) {
  cells.insert(cells.end(), {extent.azimuth_first, extent.azimuth_last, extent.elevation_first,
                             extent.elevation_last, extent.distance});
}

DirectionExtent extent_at(std::span<const std::uint8_t> cells, std::size_t index) {
  const auto c = cells.subspan(index * k_extent_bytes, k_extent_bytes);
  return {c[0], c[1], c[2], c[3], c[4]};
}

std::optional<DecodeError> fault_of_extents(const VisibleSetFrame& frame) {
  if (frame.extents_of.empty() && frame.extents.empty()) return {};
  const auto checked = check_roaring(frame.extents_of);
  if (const auto* error = std::get_if<DecodeError>(&checked)) return *error;
  const std::uint64_t count = std::get<RoaringSummary>(checked).cardinality;
  if (frame.extents.size() % k_extent_bytes != 0 || frame.extents.size() / k_extent_bytes != count)
    return refused("not as many extents as it says");
  return {};
}

/// The extents that the frame names, for the others what the base says. False where it names an object that
/// is not in the set. Requires no fault_of_extents.
bool read_extents(const VisibleSetFrame& frame, const VisibleSet* base, VisibleSet& set) {
  const bool base_says = base != nullptr && !base->extents().empty();
  if (frame.extents_of.empty() && !base_says) return true;
  RoaringBitmap named;
  if (!frame.extents_of.empty()) {
    named = RoaringBitmap::readSafe(reinterpret_cast<const char*>(frame.extents_of.data()),
                                    frame.extents_of.size());
  }
  if (!named.isSubset(set.bitmap())) return false;
  const std::vector<ObjectId> ids = set.to_ids();
  const std::vector<ObjectId> new_ids = VisibleSet(named).to_ids();
  const std::vector<ObjectId> old_ids = base_says ? base->to_ids() : std::vector<ObjectId>();
  std::vector<DirectionExtent> extents;
  extents.reserve(ids.size());
  std::size_t next_new = 0, next_old = 0;
  for (const ObjectId id : ids) {
    while (next_old < old_ids.size() && old_ids[next_old] < id) ++next_old;
    if (next_new < new_ids.size() && new_ids[next_new] == id) {
      extents.push_back(extent_at(frame.extents, next_new++));
    } else {
      const bool known = next_old < old_ids.size() && old_ids[next_old] == id;
      extents.push_back(known ? base->extents()[next_old] : k_seen_anywhere);
    }
  }
  set.set_extents(std::move(extents));
  return true;
}

/// The base's extent of each object of a set; null where it has none.
std::vector<const DirectionExtent*> extents_in(const VisibleSet* base, const std::vector<ObjectId>& ids) {
  std::vector<const DirectionExtent*> found(ids.size(), nullptr);
  if (base == nullptr || base->extents().empty()) return found;
  const std::vector<ObjectId> base_ids = base->to_ids();
  std::size_t next = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    while (next < base_ids.size() && base_ids[next] < ids[i]) ++next;
    if (next < base_ids.size() && base_ids[next] == ids[i]) found[i] = &base->extents()[next];
  }
  return found;
}

// A cell is 1.4 by 0.7 degrees, a code of distance 6 percent.
constexpr int k_pad_cells = 1;
constexpr int k_loose_cells = 3;
constexpr int k_loose_distance_codes = 6;

DirectionExtent padded(const DirectionExtent& extent, int cells, int distance_codes) {
  DirectionExtent grown = extent;
  if (((extent.azimuth_last - extent.azimuth_first) & 255) + 2 * cells < 255) {
    grown.azimuth_first = static_cast<std::uint8_t>(extent.azimuth_first - cells);
    grown.azimuth_last = static_cast<std::uint8_t>(extent.azimuth_last + cells);
  } else {
    grown.azimuth_first = 0;
    grown.azimuth_last = 255;
  }
  grown.elevation_first = static_cast<std::uint8_t>(std::max(0, extent.elevation_first - cells));
  grown.elevation_last = static_cast<std::uint8_t>(std::min(255, extent.elevation_last + cells));
  grown.distance = static_cast<std::uint8_t>(std::max(0, extent.distance - distance_codes));
  return grown;
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

void settle_extents(const VisibleSet* base, VisibleSet& set) {
  if (set.extents().empty()) return;
  const std::vector<ObjectId> ids = set.to_ids();
  const auto before = extents_in(base, ids);
  std::vector<DirectionExtent> settled;
  settled.reserve(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const DirectionExtent& extent = set.extents()[i];
    const bool serves = before[i] != nullptr && holds(*before[i], extent) &&
                        holds(padded(extent, k_loose_cells, k_loose_distance_codes), *before[i]);
    settled.push_back(serves ? *before[i] : padded(extent, k_pad_cells, k_loose_distance_codes / 2));
  }
  set.set_extents(std::move(settled));
}

EncodedExtents encode_extents(const VisibleSet* base, const VisibleSet& set) {
  EncodedExtents encoded;
  const bool says_where = !set.extents().empty();
  if (!says_where && (base == nullptr || base->extents().empty())) return encoded;
  const std::vector<ObjectId> ids = set.to_ids();
  const auto before = extents_in(base, ids);
  std::vector<ObjectId> changed;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const DirectionExtent& extent = says_where ? set.extents()[i] : k_seen_anywhere;
    if (before[i] != nullptr && *before[i] == extent) continue;
    changed.push_back(ids[i]);
    append_cells(extent, encoded.cells);
  }
  if (!changed.empty()) encoded.ids = shortest(VisibleSet(changed).bitmap());
  return encoded;
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

  if (auto error = fault_of_extents(frame)) return *std::move(error);

  RoaringBitmap ids =
      RoaringBitmap::readSafe(reinterpret_cast<const char*>(frame.bitmap.data()), frame.bitmap.size());
  if (!is_keyframe) {
    ids ^= base->bitmap();
    if (ids.cardinality() != frame.visible_count) return refused("not the base it was made for");
  }
  VisibleSet set(std::move(ids));
  if (!read_extents(frame, is_keyframe ? nullptr : base, set)) return refused("extents of objects not in it");
  return set;
}

}  // namespace sightline
