#include "tests/control_view/plain_raster.hpp"

#include <algorithm>

#include <glm/matrix.hpp>

#include "common/gl/gpu_scene.hpp"
#include "tests/control_view/plain_raster_texture.hpp"
#include "tests/control_view/plain_raster_triangle.hpp"

namespace sightline::test {
namespace {

/// What decides where in the order of draws a primitive comes: GpuScene's eight groups.
struct DrawState {
  PlainFaces faces;
  bool mask = false;

  bool operator==(const DrawState& other) const {
    return faces.double_sided == other.faces.double_sided && faces.mirrored == other.faces.mirrored &&
           mask == other.mask;
  }
};

constexpr int k_group_count = 8;

DrawState group_state(int group) {
  return {{(group & 1) != 0, (group & 2) != 0}, (group & 4) != 0};
}

DrawState state_of(const Object& object, const Material& material) {
  const bool mirrored = glm::determinant(glm::dmat3(object.scene_from_object)) < 0.0;
  return {{material.double_sided, mirrored}, material.alpha_mode == AlphaMode::mask};
}

/// One primitive of one object as one draw; fragments that fail the alpha test are not visited.
void draw_primitive(const Scene& scene, const Object& object, const Primitive& primitive,
                    const glm::mat4& clip_from_scene, ImageSize size, const FragmentVisitor& visit) {
  const Material& material = scene.materials[primitive.material];
  const DrawState state = state_of(object, material);
  const glm::mat4 scene_from_object(object.scene_from_object);
  std::vector<PlainVertex> corners;
  corners.reserve(primitive.index_count);
  for (std::uint32_t i = 0; i < primitive.index_count; ++i) {
    const std::uint32_t index = scene.indices[primitive.first_index + i];
    const glm::vec2 uv = scene.uvs.empty() ? glm::vec2(0.0f) : scene.uvs[index];
    corners.push_back(plain_vertex(clip_from_scene, scene_from_object, scene.positions[index], uv, size));
  }
  if (!state.mask) {
    draw_triangles(corners, state.faces, size, visit);
    return;
  }
  draw_triangles(corners, state.faces, size, [&](const PlainFragment& fragment) {
    if (alpha_passes(scene, material, fragment.uv)) visit(fragment);
  });
}

std::span<const Primitive> primitives_of(const Scene& scene, const Object& object) {
  const Mesh& mesh = scene.meshes[object.mesh];
  return std::span(scene.primitives).subspan(mesh.first_primitive, mesh.primitive_count);
}

bool is_blended(const Scene& scene, const Primitive& primitive) {
  return scene.materials[primitive.material].alpha_mode == AlphaMode::blend;
}

/// Pixels in which a blended primitive of `object` lies in front of the opaque `image`.
std::uint32_t blended_pixels(const Scene& scene, const Object& object, const glm::mat4& clip_from_scene,
                             const PlainImage& image) {
  const std::span<const Primitive> primitives = primitives_of(scene, object);
  const bool any = std::any_of(primitives.begin(), primitives.end(),
                               [&scene](const Primitive& primitive) { return is_blended(scene, primitive); });
  if (!any) return 0;
  std::vector<bool> marked(image.depth.size(), false);
  for (const Primitive& primitive : primitives) {
    if (!is_blended(scene, primitive)) continue;
    draw_primitive(scene, object, primitive, clip_from_scene, image.size, [&](const PlainFragment& fragment) {
      if (fragment.depth > image.depth[fragment.pixel]) marked[fragment.pixel] = true;
    });
  }
  return static_cast<std::uint32_t>(std::count(marked.begin(), marked.end(), true));
}

}  // namespace

PlainImage plain_item_buffer(const Scene& scene, const Eye& eye, std::span<const ObjectId> ids,
                             ImageSize size) {
  PlainImage image{size, std::vector<ItemCode>(size.pixel_count(), k_background_code),
                   std::vector<float>(size.pixel_count(), 0.0f)};
  const glm::mat4 clip_from_scene = gl::depth_clip_from_scene(eye, scene.world_origin_m);
  for (int group = 0; group < k_group_count; ++group) {
    for (const ObjectId id : ids) {
      const Object& object = scene.objects[index_of(id)];
      for (const Primitive& primitive : primitives_of(scene, object)) {
        const Material& material = scene.materials[primitive.material];
        if (is_blended(scene, primitive) || !(state_of(object, material) == group_state(group))) continue;
        draw_primitive(scene, object, primitive, clip_from_scene, size, [&](const PlainFragment& fragment) {
          if (!(fragment.depth > image.depth[fragment.pixel])) return;
          image.depth[fragment.pixel] = fragment.depth;
          image.codes[fragment.pixel] = code_of(id);
        });
      }
    }
  }
  return image;
}

PixelCounts plain_counts(const Scene& scene, std::span<const Eye> eyes, ImageSize size) {
  std::vector<ObjectId> ids;
  for (std::uint32_t i = 0; i < scene.object_count(); ++i) ids.push_back(ObjectId{i});
  std::vector<std::uint32_t> pixels(ids.size(), 0);
  for (const Eye& eye : eyes) {
    const PlainImage image = plain_item_buffer(scene, eye, ids, size);
    for (const ItemCode code : image.codes) {
      if (code != k_background_code) ++pixels[index_of(object_of(code))];
    }
    const glm::mat4 clip_from_scene = gl::depth_clip_from_scene(eye, scene.world_origin_m);
    for (const ObjectId id : ids) {
      pixels[index_of(id)] += blended_pixels(scene, scene.objects[index_of(id)], clip_from_scene, image);
    }
  }
  PixelCounts counts;
  for (const ObjectId id : ids) {
    if (pixels[index_of(id)] == 0) continue;
    counts.ids.push_back(id);
    counts.pixels.push_back(pixels[index_of(id)]);
  }
  return counts;
}

}  // namespace sightline::test
