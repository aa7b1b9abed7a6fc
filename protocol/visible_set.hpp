#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include <roaring/roaring.hh>

#include "common/direction_extent.hpp"
#include "common/object_id.hpp"
#include "protocol/codec.hpp"

// CRoaring's C++ class moved from the global namespace into this one after 0.2; naming both finds either.
namespace roaring {}

namespace sightline {

namespace roaring_names {
using namespace ::roaring;
using Bitmap = Roaring;
}  // namespace roaring_names
using RoaringBitmap = roaring_names::Bitmap;

/// Set of objects, compressed. Cheap to unite, compare and send. It may say in which directions each of them
/// was seen.
class VisibleSet {
 public:
  VisibleSet() = default;
  explicit VisibleSet(std::span<const ObjectId> ascending_ids);
  explicit VisibleSet(RoaringBitmap ids) : ids_(std::move(ids)) {}

  [[nodiscard]] bool contains(ObjectId id) const { return ids_.contains(index_of(id)); }
  [[nodiscard]] std::uint64_t size() const { return ids_.cardinality(); }
  [[nodiscard]] std::vector<ObjectId> to_ids() const;  ///< ascending
  [[nodiscard]] const RoaringBitmap& bitmap() const noexcept { return ids_; }
  /// One for each object, ascending ids; empty: anywhere.
  [[nodiscard]] std::span<const DirectionExtent> extents() const noexcept { return extents_; }
  /// Requires as many as there are objects, or none.
  void set_extents(std::vector<DirectionExtent> extents) { extents_ = std::move(extents); }
  /// Forgets the extents: the union's objects may be seen anywhere.
  void unite(const VisibleSet& other) {
    ids_ |= other.ids_;
    extents_.clear();
  }
  /// The same objects, wherever they were seen.
  bool operator==(const VisibleSet& other) const { return ids_ == other.ids_; }

 private:
  RoaringBitmap ids_;
  std::vector<DirectionExtent> extents_;
};

/// Bytes of a keyframe: the whole set in CRoaring's portable format.
[[nodiscard]] std::vector<std::uint8_t> encode_keyframe(const VisibleSet& set);

/// Bytes of a delta: the ids in exactly one of the two sets. Applying it twice gives the base back.
[[nodiscard]] std::vector<std::uint8_t> encode_delta(const VisibleSet& base, const VisibleSet& set);

/// Makes `set`'s extents those of `base` where these hold them without being much larger, and a little larger
/// elsewhere, so that what a slowly moving eye sees need not be sent again and again. Errs towards larger.
void settle_extents(const VisibleSet* base, VisibleSet& set);

/// The extents of a frame: those that `base` has not, or has otherwise (all without a base). `ids` names
/// their objects in CRoaring's portable format; `cells` has five bytes each. Both empty when there are none
/// to send.
struct EncodedExtents {
  std::vector<std::uint8_t> ids;
  std::vector<std::uint8_t> cells;
};
[[nodiscard]] EncodedExtents encode_extents(const VisibleSet* base, const VisibleSet& set);

/// Turns a frame's bitmap back into a set. `base` is the set numbered frame.base_seq, ignored for a keyframe.
/// Safe on untrusted bytes: the portable format is validated container by container before CRoaring reads it
/// (its own safe reader checks lengths, not order or cardinality), ids are below `object_count`, and the
/// result's size must equal frame.visible_count.
[[nodiscard]] std::variant<VisibleSet, DecodeError> decode_visible_set(const VisibleSetFrame& frame,
                                                                       const VisibleSet* base,
                                                                       std::uint32_t object_count);

}  // namespace sightline
