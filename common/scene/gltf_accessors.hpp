#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tiny_gltf.h>

namespace sightline {

/// Typed reading of a model's accessors. tinygltf checks none of the numbers an accessor, view or buffer
/// claims: every one is checked here before a byte is read. All members throw InputError prefixed with the
/// file's name.
class GltfAccessors {
 public:
  /// Refers to both for its lifetime.
  GltfAccessors(const tinygltf::Model& model, const std::string& name);

  /// Elements of an accessor, after checking that it exists, is of the `components` wanted and lies in its
  /// buffer.
  [[nodiscard]] std::size_t count(int accessor, int components) const;

  /// Whether every element has bytes of its own: false for an accessor without a buffer view (all zeros),
  /// also where sparse replacements give some of them bytes. `accessor` must exist.
  [[nodiscard]] bool has_bytes(int accessor) const;

  /// Appends every element as floats: normalised integers as the specification scales them, other integers as
  /// they are, sparse replacements applied. `components` is 1 to 4; Vector has as many floats.
  template <class Vector>
  void append_floats(int accessor, std::vector<Vector>& out) const {
    const std::size_t first = out.size();
    out.resize(first + count(accessor, Vector::length()));
    if (first < out.size()) read_floats(accessor, Vector::length(), &out[first][0]);
  }

  /// Appends every element of an index accessor (8, 16 or 32 bits, unsigned), sparse replacements applied and
  /// `base` added to each.
  /// Refuses an index at or above `vertex_count`.
  void append_indices(int accessor, std::uint32_t base, std::size_t vertex_count,
                      std::vector<std::uint32_t>& out) const;

  /// The bytes of a buffer view.
  [[nodiscard]] std::span<const std::uint8_t> view(int buffer_view, const std::string& what) const;

  /// The files' own bytes: what a count must be justified by.
  [[nodiscard]] std::uint64_t buffer_bytes() const noexcept { return buffer_bytes_; }

 private:
  /// Strided elements inside a checked range; null data where an accessor without a view claims zeros.
  struct Elements {
    const std::uint8_t* data = nullptr;
    std::size_t count = 0;
    std::size_t stride = 0;
    int component_type = 0;
    int components = 0;
    bool normalized = false;
  };

  /// Replacements of a sparse accessor; none where it is not sparse.
  struct Sparse {
    Elements indices;
    Elements values;
  };

  [[nodiscard]] Elements elements(int accessor, int components) const;
  [[nodiscard]] Sparse sparse_of(int accessor, const Elements& source) const;
  /// Calls replace(index, bytes of the value) for each; refuses an index at or above `count`.
  template <class Replace>
  void for_each_replaced(int accessor, const Sparse& sparse, std::size_t count, Replace replace) const;
  [[nodiscard]] Elements elements_in_view(int buffer_view, std::size_t offset, std::size_t count,
                                          int component_type, int components, const std::string& what) const;
  void read_floats(int accessor, int components, float* out) const;

  const tinygltf::Model& model_;
  const std::string& name_;
  std::uint64_t buffer_bytes_ = 0;
};

}  // namespace sightline
