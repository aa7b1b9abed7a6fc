#include "examples/osg/glb_reader.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <osg/BlendFunc>
#include <osg/CullFace>
#include <osg/Geode>
#include <osg/Geometry>
#include <osg/MatrixTransform>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace sightline::osg_example {
namespace {

using Json = nlohmann::json;
constexpr std::uint32_t k_magic = 0x46546c67;       // "glTF"
constexpr std::uint32_t k_json_chunk = 0x4e4f534a;  // "JSON"
constexpr std::uint32_t k_binary_chunk = 0x004e4942;
constexpr int k_deepest_node = 1000;

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what);
}

std::uint32_t word_at(const std::vector<char>& bytes, std::size_t offset) {
  if (offset + 4 > bytes.size()) fail("ends too early");
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

struct Glb {
  Json json;
  std::vector<char> binary;
};

Glb read_container(const std::vector<char>& bytes) {
  if (word_at(bytes, 0) != k_magic || word_at(bytes, 4) != 2) fail("is not binary glTF 2.0");
  Glb glb;
  for (std::size_t offset = 12; offset < bytes.size();) {
    const std::size_t length = word_at(bytes, offset);
    const std::uint32_t kind = word_at(bytes, offset + 4);
    offset += 8;
    if (length > bytes.size() - offset) fail("ends inside a chunk");
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(offset);
    const auto end = begin + static_cast<std::ptrdiff_t>(length);
    if (kind == k_json_chunk) glb.json = Json::parse(begin, end);
    if (kind == k_binary_chunk) glb.binary.assign(begin, end);
    offset += length;
  }
  return glb;
}

/// The elements of one accessor: where they begin, how far apart and how many.
struct Elements {
  const char* first = nullptr;
  std::size_t stride = 0;
  std::size_t count = 0;
};

class Reader {
 public:
  explicit Reader(Glb glb) : glb_(std::move(glb)) {}

  osg::ref_ptr<osg::Node> scene() {
    osg::ref_ptr<osg::Group> root = new osg::Group;
    const Json& json = glb_.json;
    const auto scene = json.value("scene", std::size_t{0});
    for (const Json& index : json.at("scenes").at(scene).at("nodes")) {
      root->addChild(node(index.get<std::size_t>()));
    }
    return root;
  }

 private:
  osg::ref_ptr<osg::Node> node(std::size_t index) {
    const Json& nodes = glb_.json.at("nodes");
    const Json& json = nodes.at(index);
    // A node has one parent; so a file in which they form a circle ends here, too.
    if (++nodes_read_ > nodes.size() || ++depth_ > k_deepest_node) fail("has nodes that form no tree");
    osg::ref_ptr<osg::Geode> geode = json.contains("mesh") ? mesh(json["mesh"].get<std::size_t>()) : nullptr;
    osg::ref_ptr<osg::Node> shape = geode;
    const osg::Matrixd placement = matrix_of(json);
    const osg::Vec3d middle = geode ? recentered(*geode) : osg::Vec3d();
    if (middle != osg::Vec3d()) {
      osg::ref_ptr<osg::MatrixTransform> back = new osg::MatrixTransform(osg::Matrixd::translate(middle));
      back->addChild(geode);
      shape = back;
    }
    const bool plain = placement.isIdentity() && !json.contains("children");
    if (plain && shape) {
      shape->setName(json.value("name", ""));
      --depth_;
      return shape;
    }
    osg::ref_ptr<osg::MatrixTransform> group = new osg::MatrixTransform(placement);
    group->setName(json.value("name", ""));
    if (shape) group->addChild(shape);
    for (const Json& child : json.value("children", Json::array())) {
      group->addChild(node(child.get<std::size_t>()));
    }
    --depth_;
    return group;
  }

  /// Moves a mesh that is far from its origin to it, and returns from where; nothing for a near one. A GPU
  /// transforms in 32 bits: what is a kilometre from the origin would tremble, and crack, by tenths of a
  /// millimetre. Whole metres, so that hardly any coordinate is rounded.
  static osg::Vec3d recentered(osg::Geode& geode) {
    constexpr double k_far_m = 64.0;
    const osg::Vec3d center = geode.getBoundingBox().center();
    const osg::Vec3d middle(std::round(center.x()), std::round(center.y()), std::round(center.z()));
    if (!(middle.length() > k_far_m)) return {};
    for (unsigned i = 0; i < geode.getNumDrawables(); ++i) {
      osg::Geometry& geometry = *geode.getDrawable(i)->asGeometry();
      for (osg::Vec3& vertex : *static_cast<osg::Vec3Array*>(geometry.getVertexArray())) {
        vertex = osg::Vec3(osg::Vec3d(vertex) - middle);
      }
      geometry.dirtyBound();
    }
    return middle;
  }

  static osg::Matrixd matrix_of(const Json& json) {
    if (json.contains("matrix")) {
      // Column by column for column vectors is row by row for OpenSceneGraph's row vectors: the same order.
      const auto entries = json["matrix"].get<std::array<double, 16>>();
      return osg::Matrixd(entries.data());
    }
    const auto scale = json.value("scale", std::array<double, 3>{1, 1, 1});
    const auto rotation = json.value("rotation", std::array<double, 4>{0, 0, 0, 1});
    const auto translation = json.value("translation", std::array<double, 3>{0, 0, 0});
    return osg::Matrixd::scale(scale[0], scale[1], scale[2]) *
           osg::Matrixd::rotate(osg::Quat(rotation[0], rotation[1], rotation[2], rotation[3])) *
           osg::Matrixd::translate(translation[0], translation[1], translation[2]);
  }

  osg::ref_ptr<osg::Geode> mesh(std::size_t index) {
    osg::ref_ptr<osg::Geode> geode = new osg::Geode;
    for (const Json& primitive : glb_.json.at("meshes").at(index).at("primitives")) {
      geode->addDrawable(geometry(primitive));
    }
    return geode;
  }

  osg::ref_ptr<osg::Geometry> geometry(const Json& primitive) {
    osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
    geometry->setUseDisplayList(false);
    geometry->setUseVertexBufferObjects(true);
    const auto vertices = positions(primitive.at("attributes").at("POSITION").get<std::size_t>());
    geometry->setVertexArray(vertices);
    // OpenGL's names of the modes are glTF's.
    const auto mode = primitive.value("mode", GLenum{GL_TRIANGLES});
    if (primitive.contains("indices")) {
      geometry->addPrimitiveSet(
          indices(primitive["indices"].get<std::size_t>(), mode, vertices->getNumElements()));
    } else {
      geometry->addPrimitiveSet(
          new osg::DrawArrays(mode, 0, static_cast<GLsizei>(vertices->getNumElements())));
    }
    apply_material(primitive, *geometry);
    return geometry;
  }

  osg::ref_ptr<osg::Vec3Array> positions(std::size_t accessor) {
    if (glb_.json.at("accessors").at(accessor).at("componentType") != GL_FLOAT)
      fail("has positions that are not float32");
    const Elements elements = elements_of(accessor, 12);
    osg::ref_ptr<osg::Vec3Array> array = new osg::Vec3Array(static_cast<unsigned>(elements.count));
    for (std::size_t i = 0; i < elements.count; ++i) {
      std::memcpy((*array)[i].ptr(), elements.first + i * elements.stride, 12);
    }
    return array;
  }

  osg::ref_ptr<osg::PrimitiveSet> indices(std::size_t accessor, GLenum mode, std::size_t vertex_count) {
    const auto type = glb_.json.at("accessors").at(accessor).at("componentType").get<GLenum>();
    const std::size_t size = type == GL_UNSIGNED_BYTE ? 1 : type == GL_UNSIGNED_SHORT ? 2 : 4;
    const Elements elements = elements_of(accessor, size);
    osg::ref_ptr<osg::DrawElementsUInt> set = new osg::DrawElementsUInt(mode);
    set->reserve(elements.count);
    for (std::size_t i = 0; i < elements.count; ++i) {
      std::uint32_t value = 0;  // little-endian: the low bytes come first
      std::memcpy(&value, elements.first + i * elements.stride, size);
      if (value >= vertex_count) fail("has an index that names no vertex");
      set->push_back(value);
    }
    return set;
  }

  Elements elements_of(std::size_t index, std::size_t element_size) const {
    const Json& accessor = glb_.json.at("accessors").at(index);
    if (accessor.contains("sparse")) fail("has sparse accessors");
    const Json& view = glb_.json.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    const auto view_offset = view.value("byteOffset", std::size_t{0});
    const auto offset = accessor.value("byteOffset", std::size_t{0});
    const auto length = view.at("byteLength").get<std::size_t>();
    Elements elements;
    elements.count = accessor.at("count").get<std::size_t>();
    elements.stride = view.value("byteStride", element_size);
    const std::size_t room = length < offset + element_size ? 0 : length - offset - element_size;
    if (view_offset > glb_.binary.size() || length > glb_.binary.size() - view_offset ||
        elements.count == 0 || length < offset + element_size || elements.stride < element_size ||
        elements.stride > 252 || (elements.count - 1) > room / elements.stride) {
      fail("has an accessor outside its buffer");
    }
    elements.first = glb_.binary.data() + view_offset + offset;
    return elements;
  }

  void apply_material(const Json& primitive, osg::Geometry& geometry) {
    const Json material = primitive.contains("material")
                              ? glb_.json.at("materials").at(primitive["material"].get<std::size_t>())
                              : Json::object();
    const auto color = material.value("pbrMetallicRoughness", Json::object())
                           .value("baseColorFactor", std::array<float, 4>{1, 1, 1, 1});
    osg::ref_ptr<osg::Vec4Array> colors = new osg::Vec4Array(osg::Array::BIND_OVERALL, 1);
    (*colors)[0].set(color[0], color[1], color[2], color[3]);
    geometry.setColorArray(colors);
    const bool blended = material.value("alphaMode", "OPAQUE") == "BLEND";
    geometry.setStateSet(state(blended, material.value("doubleSided", false)));
  }

  /// One of four, shared by all that look the same: OpenSceneGraph sorts what it draws by state.
  osg::StateSet* state(bool blended, bool double_sided) {
    osg::ref_ptr<osg::StateSet>& state = states_[(blended ? 2U : 0U) + (double_sided ? 1U : 0U)];
    if (state) return state;
    state = new osg::StateSet;
    if (!double_sided) state->setAttributeAndModes(new osg::CullFace(osg::CullFace::BACK));
    if (blended) {
      state->setAttributeAndModes(new osg::BlendFunc);
      state->setRenderingHint(osg::StateSet::TRANSPARENT_BIN);
    }
    return state;
  }

  Glb glb_;
  std::size_t nodes_read_ = 0;
  int depth_ = 0;
  std::array<osg::ref_ptr<osg::StateSet>, 4> states_;
};

}  // namespace

osg::ref_ptr<osg::Node> read_glb(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be opened");
  return read_glb({std::istreambuf_iterator<char>(stream), {}}, file.string());
}

osg::ref_ptr<osg::Node> read_glb(const std::vector<char>& bytes, const std::string& name) {
  try {
    return Reader(read_container(bytes)).scene();
  } catch (const std::exception& error) {
    throw std::runtime_error(name + ": " + error.what());
  }
}

}  // namespace sightline::osg_example
