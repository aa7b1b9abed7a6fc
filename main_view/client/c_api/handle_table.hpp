#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "main_view/client/c_api/sightline.h"

namespace sightline::c_api {

/// What a handle is for; part of its value, so that one kind is never taken for another.
enum class HandleKind : std::uint64_t { scene = 0x5, client = 0xa };

/// The objects behind the handles of one kind.
///
/// A handle is a number: generation, kind and index of a slot. It is looked up, never dereferenced, so a
/// null, closed or made-up one is recognised. A slot's generation is odd while it is open, and counts up, so
/// that a handle is not valid again when its slot is (until 2^31 others have used that slot).
///
/// Who is inside is counted in the same word: any number of readers, or one writer. Nobody waits: whoever
/// cannot enter is told so. Constant-initialised, so that it serves before and after main.
template <typename Object, HandleKind kind>
class HandleTable {
  static_assert(sizeof(void*) == 8, "a handle needs 64 bits");

 public:
  static constexpr std::size_t k_capacity = 4096;

  constexpr HandleTable() = default;

  /// Leaves the slot when it goes out of scope.
  class Access {
   public:
    Access(sl_status status) noexcept : status_(status) {}
    Access(std::atomic<std::uint64_t>& word, std::uint64_t taken, Object* object) noexcept
        : word_(&word), taken_(taken), object_(object) {}
    ~Access() {
      if (word_ != nullptr) word_->fetch_sub(taken_, std::memory_order_release);
    }
    Access(const Access&) = delete;
    Access& operator=(const Access&) = delete;

    /// SL_OK, SL_ERROR_HANDLE or SL_ERROR_BUSY.
    [[nodiscard]] sl_status status() const noexcept { return status_; }
    /// Null unless SL_OK.
    [[nodiscard]] Object* get() const noexcept { return object_; }

   private:
    std::atomic<std::uint64_t>* word_ = nullptr;
    std::uint64_t taken_ = 0;
    Object* object_ = nullptr;
    sl_status status_ = SL_OK;
  };

  /// A handle for `object`, which the table keeps until take(); null when all slots are in use.
  [[nodiscard]] void* insert(Object* object) noexcept {
    const std::size_t start = next_.fetch_add(1, std::memory_order_relaxed);
    for (std::size_t i = 0; i < k_capacity; ++i) {
      const std::size_t index = (start + i) % k_capacity;
      Slot& slot = slots_[index];
      std::uint64_t word = slot.word.load(std::memory_order_relaxed);
      if (is_open(word) || (word & k_inside) != 0) continue;
      const std::uint64_t opened = word + k_one_generation;
      if (!slot.word.compare_exchange_strong(word, opened | k_writer, std::memory_order_acquire)) continue;
      slot.object = object;
      slot.word.store(opened, std::memory_order_release);
      return handle_of(opened, index);
    }
    return nullptr;
  }

  /// For a [shared] call.
  [[nodiscard]] Access read(const void* handle) noexcept { return enter(handle, 1, k_writer); }
  /// For a [one] call.
  [[nodiscard]] Access write(const void* handle) noexcept { return enter(handle, k_writer, k_inside); }

  /// Closes the handle and gives back its object; null with `status` where a call is still inside, or for no
  /// handle.
  [[nodiscard]] Object* take(const void* handle, sl_status& status) noexcept {
    const auto found = find(handle);
    status = SL_ERROR_HANDLE;
    if (!found) return nullptr;
    Slot& slot = slots_[found->index];
    std::uint64_t word = slot.word.load(std::memory_order_relaxed);
    do {
      if (generation_of(word) != found->generation) return nullptr;
      if ((word & k_inside) != 0) {
        status = SL_ERROR_BUSY;
        return nullptr;
      }
    } while (!slot.word.compare_exchange_weak(word, word | k_writer, std::memory_order_acquire));
    Object* object = slot.object;
    slot.object = nullptr;
    slot.word.store(word + k_one_generation, std::memory_order_release);
    status = SL_OK;
    return object;
  }

 private:
  struct Slot {
    std::atomic<std::uint64_t> word{0};  ///< generation, writer, readers
    Object* object = nullptr;
  };
  struct Found {
    std::size_t index;
    std::uint64_t generation;
  };

  static constexpr std::uint64_t k_one_generation = std::uint64_t{1} << 32;
  static constexpr std::uint64_t k_writer = std::uint64_t{1} << 31;
  static constexpr std::uint64_t k_inside = k_one_generation - 1;
  static constexpr unsigned k_kind_bits = 4, k_index_bits = 12;
  static_assert(k_capacity == std::size_t{1} << k_index_bits);

  static constexpr std::uint64_t generation_of(std::uint64_t word) noexcept { return word >> 32; }
  static constexpr bool is_open(std::uint64_t word) noexcept { return (generation_of(word) & 1) != 0; }

  static void* handle_of(std::uint64_t word, std::size_t index) noexcept {
    const std::uint64_t value = (generation_of(word) << (k_kind_bits + k_index_bits)) |
                                (static_cast<std::uint64_t>(kind) << k_index_bits) | index;
    return reinterpret_cast<void*>(static_cast<std::uintptr_t>(value));
  }

  static std::optional<Found> find(const void* handle) noexcept {
    const std::uint64_t value = reinterpret_cast<std::uintptr_t>(handle);
    if (((value >> k_index_bits) & 0xf) != static_cast<std::uint64_t>(kind)) return {};
    const std::uint64_t generation = value >> (k_kind_bits + k_index_bits);
    if ((generation & 1) == 0) return {};
    return Found{static_cast<std::size_t>(value & (k_capacity - 1)), generation};
  }

  /// Adds `taken` to the slot's word unless one of `obstacles` is in it.
  Access enter(const void* handle, std::uint64_t taken, std::uint64_t obstacles) noexcept {
    const auto found = find(handle);
    if (!found) return SL_ERROR_HANDLE;
    Slot& slot = slots_[found->index];
    std::uint64_t word = slot.word.load(std::memory_order_relaxed);
    do {
      if (generation_of(word) != found->generation) return SL_ERROR_HANDLE;
      if ((word & obstacles) != 0) return SL_ERROR_BUSY;
    } while (!slot.word.compare_exchange_weak(word, word + taken, std::memory_order_acquire,
                                              std::memory_order_relaxed));
    return Access(slot.word, taken, slot.object);
  }

  std::array<Slot, k_capacity> slots_{};
  std::atomic<std::size_t> next_{0};
};

}  // namespace sightline::c_api
