#include "protocol/scene_chunks.hpp"

#include <algorithm>
#include <stdexcept>

#include <sodium/core.h>
#include <sodium/crypto_generichash_blake2b.h>

namespace sightline {
namespace {

template <typename Integer>
void append_little_endian(std::vector<std::uint8_t>& bytes, Integer value) {
  for (std::size_t i = 0; i < sizeof(Integer); ++i)
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

}  // namespace

std::span<const std::uint8_t> chunk_of(std::span<const std::uint8_t> scene, std::uint32_t index) noexcept {
  const std::size_t begin = std::size_t{index} * k_scene_chunk_bytes;
  return scene.subspan(begin, std::min(k_scene_chunk_bytes, scene.size() - begin));
}

SceneDigest digest_of(std::span<const std::uint8_t> bytes) {
  // Picks the fastest code for this machine; without it the hash is right and three times slower.
  [[maybe_unused]] static const int ready = sodium_init();
  SceneDigest digest{};
  static_assert(sizeof(digest) == crypto_generichash_blake2b_BYTES_MIN);
  if (crypto_generichash_blake2b(digest.data(), digest.size(), bytes.data(), bytes.size(), nullptr, 0) != 0)
    throw std::logic_error("BLAKE2b refused a digest of 16 bytes");
  return digest;
}

SceneDigest scene_digest_of(const SceneOffer& offer) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(sizeof(SceneDigest) * offer.chunk_digests.size() + 20);
  for (const SceneDigest& chunk : offer.chunk_digests) bytes.insert(bytes.end(), chunk.begin(), chunk.end());
  append_little_endian(bytes, offer.byte_count);
  append_little_endian(bytes, offer.object_count);
  append_little_endian(bytes, offer.triangle_count);
  return digest_of(bytes);
}

SceneOffer offer_of(std::span<const std::uint8_t> scene, std::uint32_t object_count,
                    std::uint64_t triangle_count) {
  SceneOffer offer;
  offer.byte_count = scene.size();
  offer.object_count = object_count;
  offer.triangle_count = triangle_count;
  const std::uint64_t chunks = chunk_count_of(scene.size());
  offer.chunk_digests.reserve(chunks);
  for (std::uint32_t i = 0; i < chunks; ++i) offer.chunk_digests.push_back(digest_of(chunk_of(scene, i)));
  offer.scene_digest = scene_digest_of(offer);
  return offer;
}

}  // namespace sightline
