#include "protocol/roaring_format.hpp"

#include <bit>
#include <cstddef>

namespace sightline {
namespace {

// Names and values of the specification.
constexpr std::uint32_t k_cookie_without_runs = 12346;
constexpr std::uint32_t k_cookie_with_runs =
    12347;  // in the low 16 bits; the high ones hold the count less one
constexpr std::uint32_t k_max_containers = 1u << 16;
constexpr std::uint32_t k_offsets_from_containers =
    4;  // with runs, fewer containers than this have no offsets
constexpr std::uint32_t k_max_array_cardinality = 4096;
constexpr std::size_t k_bitset_bytes = 8192;

/// Little-endian reads at growing positions. A read past the end gives 0 and is remembered.
class Cursor {
 public:
  explicit Cursor(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] std::size_t position() const noexcept { return position_; }
  [[nodiscard]] bool at_end() const noexcept { return position_ == bytes_.size(); }

  /// The next `count` bytes; an empty span when there are not as many.
  std::span<const std::uint8_t> take(std::size_t count) {
    if (count > bytes_.size() - position_) return {};
    const auto taken = bytes_.subspan(position_, count);
    position_ += count;
    return taken;
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t position_ = 0;
};

std::uint32_t read_16(std::span<const std::uint8_t> bytes, std::size_t index) {
  return bytes[2 * index] | std::uint32_t{bytes[2 * index + 1]} << 8;
}

std::uint32_t read_32(std::span<const std::uint8_t> bytes, std::size_t index) {
  return read_16(bytes, 2 * index) | read_16(bytes, 2 * index + 1) << 16;
}

/// Reads one container of `cardinality` and gives its largest low half, or a reason.
using ContainerResult = std::variant<std::uint32_t, const char*>;

ContainerResult check_array(Cursor& cursor, std::uint32_t cardinality) {
  const auto values = cursor.take(2 * std::size_t{cardinality});
  if (values.empty()) return "array container cut short";
  std::uint32_t last = read_16(values, 0);
  for (std::uint32_t i = 1; i < cardinality; ++i) {
    const std::uint32_t value = read_16(values, i);
    if (value <= last) return "array container not ascending";
    last = value;
  }
  return last;
}

ContainerResult check_bitset(Cursor& cursor, std::uint32_t cardinality) {
  const auto bytes = cursor.take(k_bitset_bytes);
  if (bytes.empty()) return "bitset container cut short";
  std::uint32_t counted = 0;
  std::uint32_t last = 0;
  for (std::uint32_t i = 0; i < k_bitset_bytes; ++i) {
    if (bytes[i] == 0) continue;
    counted += static_cast<std::uint32_t>(std::popcount(bytes[i]));
    last = 8 * i + static_cast<std::uint32_t>(std::bit_width(bytes[i])) - 1;
  }
  if (counted != cardinality) return "bitset container of another cardinality than its header says";
  return last;
}

ContainerResult check_runs(Cursor& cursor, std::uint32_t cardinality) {
  const auto count_bytes = cursor.take(2);
  if (count_bytes.empty()) return "run container cut short";
  const std::uint32_t run_count = read_16(count_bytes, 0);
  if (run_count == 0) return "run container without runs";
  const auto runs = cursor.take(4 * std::size_t{run_count});
  if (runs.empty()) return "run container cut short";

  std::uint32_t counted = 0;
  std::uint32_t last = 0;
  for (std::uint32_t i = 0; i < run_count; ++i) {
    const std::uint32_t start = read_16(runs, 2 * i);
    const std::uint32_t length_less_one = read_16(runs, 2 * i + 1);
    if (i > 0 && start <= last + 1) return "run container with runs that are unsorted, overlap or touch";
    last = start + length_less_one;
    if (last > 0xFFFF) return "run container with a run over its end";
    counted += length_less_one + 1;
  }
  if (counted != cardinality) return "run container of another cardinality than its header says";
  return last;
}

DecodeError refused(const std::string& reason) {
  return DecodeError{"bitmap: " + reason};
}

}  // namespace

std::variant<RoaringSummary, DecodeError> check_roaring(std::span<const std::uint8_t> bytes) {
  Cursor cursor(bytes);
  const auto cookie_bytes = cursor.take(4);
  if (cookie_bytes.empty()) return refused("no header");
  const std::uint32_t cookie = read_32(cookie_bytes, 0);

  std::uint32_t container_count = 0;
  std::span<const std::uint8_t> run_flags;  // empty: no container holds runs
  if (cookie == k_cookie_without_runs) {
    const auto count_bytes = cursor.take(4);
    if (count_bytes.empty()) return refused("no container count");
    container_count = read_32(count_bytes, 0);
    if (container_count > k_max_containers) return refused("more than 65536 containers");
  } else if ((cookie & 0xFFFF) == k_cookie_with_runs) {
    container_count = (cookie >> 16) + 1;
    run_flags = cursor.take((container_count + 7) / 8);
    if (run_flags.empty()) return refused("run flags cut short");
    const std::uint32_t used_bits = (container_count - 1) % 8 + 1;
    if (run_flags.back() >> used_bits != 0) return refused("run flags of containers that are not there");
  } else {
    return refused("unknown cookie");
  }

  const auto headers = cursor.take(4 * std::size_t{container_count});
  if (headers.size() != 4 * std::size_t{container_count}) return refused("container headers cut short");
  std::span<const std::uint8_t> offsets;
  if (run_flags.empty() || container_count >= k_offsets_from_containers) {
    offsets = cursor.take(4 * std::size_t{container_count});
    if (offsets.size() != 4 * std::size_t{container_count}) return refused("offsets cut short");
  }

  RoaringSummary summary;
  std::uint32_t last_key = 0;
  for (std::uint32_t i = 0; i < container_count; ++i) {
    const std::uint32_t key = read_16(headers, 2 * std::size_t{i});
    const std::uint32_t cardinality = read_16(headers, 2 * std::size_t{i} + 1) + 1;
    if (i > 0 && key <= last_key) return refused("container keys not ascending");
    last_key = key;
    if (!offsets.empty() && read_32(offsets, i) != cursor.position()) {
      return refused("a container is not where its offset says");
    }
    const bool has_runs = !run_flags.empty() && (run_flags[i / 8] >> (i % 8) & 1) != 0;
    const ContainerResult result = has_runs ? check_runs(cursor, cardinality)
                                   : cardinality <= k_max_array_cardinality
                                       ? check_array(cursor, cardinality)
                                       : check_bitset(cursor, cardinality);
    if (const auto* reason = std::get_if<const char*>(&result)) return refused(*reason);
    summary.cardinality += cardinality;
    summary.largest = key << 16 | std::get<std::uint32_t>(result);
  }
  if (!cursor.at_end()) return refused("bytes after the last container");
  return summary;
}

}  // namespace sightline
