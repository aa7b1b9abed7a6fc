#include "protocol/envelope.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

#include "protocol/generated/sightline_generated.h"

namespace sightline {
namespace {

/// Ours are three deep; the rest is room for a later version's.
constexpr flatbuffers::uoffset_t k_max_depth = 16;
constexpr flatbuffers::uoffset_t k_max_tables = 64;

}  // namespace

bool is_aligned(std::span<const std::byte> frame) noexcept {
  return reinterpret_cast<std::uintptr_t>(frame.data()) % k_frame_alignment == 0;
}

std::variant<const wire::Envelope*, DecodeError> verified_envelope(std::span<const std::byte> frame,
                                                                   const DecodeLimits& limits) {
  if (frame.size() > std::min<std::size_t>(limits.max_frame_bytes, FLATBUFFERS_MAX_BUFFER_SIZE - 1)) {
    return DecodeError{"frame of " + std::to_string(frame.size()) + " bytes, at most " +
                       std::to_string(limits.max_frame_bytes)};
  }
  // Every FlatBuffers writer pads a buffer to its alignment, four at least. Without this check a frame cut
  // within its last padding would still pass.
  if (frame.size() % sizeof(flatbuffers::uoffset_t) != 0)
    return DecodeError{"frame length not a multiple of 4"};
  flatbuffers::Verifier verifier(reinterpret_cast<const std::uint8_t*>(frame.data()), frame.size(),
                                 k_max_depth, k_max_tables);
  if (!wire::VerifyEnvelopeBuffer(verifier)) return DecodeError{"not a well-formed SLN1 frame"};
  return wire::GetEnvelope(frame.data());
}

}  // namespace sightline
