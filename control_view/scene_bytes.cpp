#include "control_view/scene_bytes.hpp"

#include <cstdlib>

#include <sys/mman.h>

namespace sightline {
namespace {

constexpr std::size_t k_huge_page_bytes = 2u << 20;
constexpr std::size_t k_cache_line_bytes = 64;

}  // namespace

SceneBytes::SceneBytes(std::uint64_t byte_count) {
  void* memory = nullptr;
  const bool is_large = byte_count >= k_huge_page_bytes;
  if (posix_memalign(&memory, is_large ? k_huge_page_bytes : k_cache_line_bytes, byte_count) != 0) return;
  bytes_.reset(static_cast<std::uint8_t*>(memory), [](std::uint8_t* bytes) { std::free(bytes); });
  byte_count_ = byte_count;
  // Page by page of 4 KiB, taking this memory from the kernel costs several times what copying into it does;
  // huge pages take half of its processor time off an upload. (A virtual machine whose host has to find one
  // first takes some milliseconds for it.) Only a wish, and only where whole ones fit, so that no more than
  // byte_count is ever taken.
  if (is_large) (void)madvise(memory, byte_count / k_huge_page_bytes * k_huge_page_bytes, MADV_HUGEPAGE);
}

}  // namespace sightline
