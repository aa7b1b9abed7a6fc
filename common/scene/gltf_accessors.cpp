#include "common/scene/gltf_accessors.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "common/scene/refuse_scene.hpp"

namespace sightline {
namespace {

/// Elements that a view-less accessor (all zeros) may claim without bytes to show for it.
constexpr std::size_t k_most_zero_elements = std::size_t{1} << 24;

std::size_t component_bytes(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

int component_count(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    default:
      return 0;
  }
}

template <class T>
T load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);  // strides and offsets need not be aligned
  return value;
}

/// Calls visit(read), where read(bytes) gives one component as a float.
template <class Visit>
void with_float_reader(int component_type, bool normalized, Visit visit) {
  // glTF 2.0, 3.6.2.2: signed types scale by their largest value and clamp at -1.
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return normalized
                 ? visit([](const std::uint8_t* p) { return std::max(load<std::int8_t>(p) / 127.0f, -1.0f); })
                 : visit([](const std::uint8_t* p) { return static_cast<float>(load<std::int8_t>(p)); });
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return normalized ? visit([](const std::uint8_t* p) { return *p / 255.0f; })
                        : visit([](const std::uint8_t* p) { return static_cast<float>(*p); });
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return normalized
                 ? visit([](const std::uint8_t* p) {
                     return std::max(load<std::int16_t>(p) / 32767.0f, -1.0f);
                   })
                 : visit([](const std::uint8_t* p) { return static_cast<float>(load<std::int16_t>(p)); });
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return normalized
                 ? visit([](const std::uint8_t* p) { return load<std::uint16_t>(p) / 65535.0f; })
                 : visit([](const std::uint8_t* p) { return static_cast<float>(load<std::uint16_t>(p)); });
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return visit([](const std::uint8_t* p) { return static_cast<float>(load<std::uint32_t>(p)); });
    default:
      return visit([](const std::uint8_t* p) { return load<float>(p); });
  }
}

/// Calls visit(read), where read(bytes) gives one unsigned index.
template <class Visit>
void with_index_reader(int component_type, Visit visit) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return visit([](const std::uint8_t* p) { return std::uint32_t{*p}; });
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return visit([](const std::uint8_t* p) { return std::uint32_t{load<std::uint16_t>(p)}; });
    default:
      return visit([](const std::uint8_t* p) { return load<std::uint32_t>(p); });
  }
}

bool is_index_type(int component_type) {
  return component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

std::string accessor_name(int accessor) {
  return "accessor " + std::to_string(accessor);
}

}  // namespace

GltfAccessors::GltfAccessors(const tinygltf::Model& model, const std::string& name)
    : model_(model), name_(name) {
  for (const tinygltf::Buffer& buffer : model.buffers) buffer_bytes_ += buffer.data.size();
}

std::span<const std::uint8_t> GltfAccessors::view(int buffer_view, const std::string& what) const {
  if (buffer_view < 0 || static_cast<std::size_t>(buffer_view) >= model_.bufferViews.size()) {
    refuse_scene(name_, what + ": names a buffer view that does not exist");
  }
  const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(buffer_view)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model_.buffers.size()) {
    refuse_scene(name_, what + ": its buffer does not exist");
  }
  const std::vector<unsigned char>& data = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset) {
    refuse_scene(name_, what + ": its buffer view " + std::to_string(buffer_view) +
                            " reaches beyond buffer " + std::to_string(view.buffer) + " (" +
                            std::to_string(data.size()) + " bytes)");
  }
  return std::span<const std::uint8_t>(data).subspan(view.byteOffset, view.byteLength);
}

GltfAccessors::Elements GltfAccessors::elements_in_view(int buffer_view, std::size_t offset,
                                                        std::size_t count, int component_type, int components,
                                                        const std::string& what) const {
  const std::span<const std::uint8_t> bytes = view(buffer_view, what);
  const std::size_t element = component_bytes(component_type) * static_cast<std::size_t>(components);
  const std::size_t given = model_.bufferViews[static_cast<std::size_t>(buffer_view)].byteStride;
  const std::size_t stride = given == 0 ? element : given;
  if (count > 0) {
    const bool first_fits = offset <= bytes.size() && element <= bytes.size() - offset;
    // Divided rather than multiplied: a lying count must not overflow its way in.
    if (!first_fits || count - 1 > (bytes.size() - offset - element) / stride) {
      refuse_scene(name_, what + ": " + std::to_string(count) + " elements reach beyond its buffer view (" +
                              std::to_string(bytes.size()) + " bytes)");
    }
  }
  return {count > 0 ? bytes.data() + offset : bytes.data(), count, stride, component_type, components, false};
}

GltfAccessors::Elements GltfAccessors::elements(int accessor, int components) const {
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= model_.accessors.size()) {
    refuse_scene(name_, accessor_name(accessor) + " does not exist");
  }
  const tinygltf::Accessor& a = model_.accessors[static_cast<std::size_t>(accessor)];
  if (component_bytes(a.componentType) == 0) {
    refuse_scene(name_, accessor_name(accessor) + ": component type " + std::to_string(a.componentType) +
                            " is not one of glTF 2.0");
  }
  if (component_count(a.type) != components) {
    refuse_scene(name_, accessor_name(accessor) + ": needs " + std::to_string(components) + " components");
  }
  if (a.bufferView < 0) {
    if (a.count > k_most_zero_elements) {
      refuse_scene(name_, accessor_name(accessor) + ": claims " + std::to_string(a.count) +
                              " elements and has no buffer view");
    }
    return {nullptr, a.count, 0, a.componentType, components, a.normalized};
  }
  Elements result = elements_in_view(a.bufferView, a.byteOffset, a.count, a.componentType, components,
                                     accessor_name(accessor));
  result.normalized = a.normalized;
  return result;
}

std::size_t GltfAccessors::count(int accessor, int components) const {
  return elements(accessor, components).count;
}

bool GltfAccessors::has_bytes(int accessor) const {
  return model_.accessors[static_cast<std::size_t>(accessor)].bufferView >= 0;
}

void GltfAccessors::read_floats(int accessor, int components, float* out) const {
  const Elements source = elements(accessor, components);
  const auto width = static_cast<std::size_t>(components);
  const std::size_t step = component_bytes(source.component_type);
  if (source.data == nullptr) {
    std::fill_n(out, source.count * width, 0.0f);
  } else if (source.component_type == TINYGLTF_COMPONENT_TYPE_FLOAT && source.stride == 4 * width) {
    std::memcpy(out, source.data, source.count * source.stride);
  } else {
    with_float_reader(source.component_type, source.normalized, [&](auto read) {
      for (std::size_t i = 0; i < source.count; ++i) {
        for (std::size_t c = 0; c < width; ++c)
          out[i * width + c] = read(source.data + i * source.stride + c * step);
      }
    });
  }

  const Sparse sparse = sparse_of(accessor, source);
  with_float_reader(source.component_type, source.normalized, [&](auto read) {
    for_each_replaced(accessor, sparse, source.count, [&](std::size_t index, const std::uint8_t* value) {
      for (std::size_t c = 0; c < width; ++c) out[index * width + c] = read(value + c * step);
    });
  });
}

GltfAccessors::Sparse GltfAccessors::sparse_of(int accessor, const Elements& source) const {
  const tinygltf::Accessor& a = model_.accessors[static_cast<std::size_t>(accessor)];
  if (!a.sparse.isSparse) return {};
  const std::string what = accessor_name(accessor) + ": sparse";
  if (a.sparse.count < 0 || a.sparse.indices.byteOffset < 0 || a.sparse.values.byteOffset < 0 ||
      !is_index_type(a.sparse.indices.componentType)) {
    refuse_scene(name_, what + " count, offset or index type is impossible");
  }
  const auto count = static_cast<std::size_t>(a.sparse.count);
  return {elements_in_view(a.sparse.indices.bufferView, static_cast<std::size_t>(a.sparse.indices.byteOffset),
                           count, a.sparse.indices.componentType, 1, what + " indices"),
          elements_in_view(a.sparse.values.bufferView, static_cast<std::size_t>(a.sparse.values.byteOffset),
                           count, source.component_type, source.components, what + " values")};
}

template <class Replace>
void GltfAccessors::for_each_replaced(int accessor, const Sparse& sparse, std::size_t count,
                                      Replace replace) const {
  with_index_reader(sparse.indices.component_type, [&](auto read_index) {
    for (std::size_t i = 0; i < sparse.indices.count; ++i) {
      const std::uint32_t index = read_index(sparse.indices.data + i * sparse.indices.stride);
      if (index >= count) {
        refuse_scene(
            name_, accessor_name(accessor) + ": sparse index " + std::to_string(index) + " is out of range");
      }
      replace(index, sparse.values.data + i * sparse.values.stride);
    }
  });
}

void GltfAccessors::append_indices(int accessor, std::uint32_t base, std::size_t vertex_count,
                                   std::vector<std::uint32_t>& out) const {
  const Elements source = elements(accessor, 1);
  if (!is_index_type(source.component_type)) {
    refuse_scene(name_, accessor_name(accessor) + ": indices must be unsigned 8, 16 or 32-bit integers");
  }
  const std::size_t first = out.size();
  out.resize(first + source.count);  // zeros where there is no view
  std::uint32_t* const target = out.data() + first;
  std::uint32_t largest = 0;
  with_index_reader(source.component_type, [&](auto read) {
    if (source.data != nullptr) {
      for (std::size_t i = 0; i < source.count; ++i) target[i] = read(source.data + i * source.stride);
    }
    for_each_replaced(accessor, sparse_of(accessor, source), source.count,
                      [&](std::size_t index, const std::uint8_t* value) { target[index] = read(value); });
  });
  for (std::size_t i = 0; i < source.count; ++i) {
    largest = std::max(largest, target[i]);
    target[i] += base;
  }
  if (source.count > 0 && largest >= vertex_count) {
    refuse_scene(name_, accessor_name(accessor) + ": index " + std::to_string(largest) +
                            " is out of range (" + std::to_string(vertex_count) + " vertices)");
  }
}

}  // namespace sightline
