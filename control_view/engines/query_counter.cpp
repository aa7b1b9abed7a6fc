#include <array>
#include <string>
#include <vector>

#include <glm/gtc/type_ptr.hpp>

#include "control_view/engines/pixel_counter.hpp"

namespace sightline {
namespace {

using namespace gl;  // the entry points

// A fragment belongs to its object when the item buffer says so. Depth alone would not do: where two objects
// coincide both pass an equality test, and only the one drawn first owns the pixel.
const char* const k_owner_fragment_body = R"(
layout(binding = 1) uniform usampler2D u_codes;
flat in uint v_code;
flat in uint v_material;
in vec2 v_uv;
void main() {
  if (texelFetch(u_codes, ivec2(gl_FragCoord.xy), 0).r != v_code) discard;
  if (ALPHA_TEST && !alpha_passes(v_uv, v_material)) discard;
}
)";

const char* const k_blended_fragment = "#version 450 core\nvoid main() {}\n";

gl::Program make_owner_program(bool alpha_test) {
  const std::string vertex = std::string(gl::k_transform_glsl) + gl::k_item_vertex_glsl_body;
  const std::string fragment = std::string(gl::k_material_glsl) +
                               "const bool ALPHA_TEST = " + (alpha_test ? "true" : "false") + ";" +
                               k_owner_fragment_body;
  return gl::make_program("query_owner", vertex.c_str(), fragment.c_str());
}

gl::Program make_blended_program() {
  const std::string vertex = std::string(gl::k_transform_glsl) + gl::k_item_vertex_glsl_body;
  return gl::make_program("query_blended", vertex.c_str(), k_blended_fragment);
}

/// One GL_SAMPLES_PASSED query an object, against the finished depth buffer. The stencil lets each pixel pass
/// once an object, so that coincident triangles of one object do not count twice.
class QueryCounter final : public PixelCounter {
 public:
  QueryCounter()
      : solid_(make_owner_program(false)),
        masked_(make_owner_program(true)),
        blended_(make_blended_program()) {}

  void add_opaque(const View& view, std::span<const ObjectId> ids, CountAccumulator& sum) override {
    // Reversed depth: the surface itself is at the buffer's value, what is behind it is smaller.
    begin_pass(view, GL_GEQUAL);
    glBindTextureUnit(1, view.buffer.code_texture());
    for (const gl::Program* program : {&solid_, &masked_}) set_transform(*program, view);
    query_each(view, Layer::opaque, ids, {solid_.get(), masked_.get()}, sum);
    end_pass();
  }

  gl::DrawStats add_blended(const View& view, std::span<const ObjectId> ids, CountAccumulator& sum) override {
    if (ids.empty()) return {};
    begin_pass(view, GL_GREATER);
    set_transform(blended_, view);
    const gl::DrawStats stats = query_each(view, Layer::blended, ids, {blended_.get(), blended_.get()}, sum);
    end_pass();
    return stats;
  }

 private:
  static void begin_pass(const View& view, GLenum depth_test) {
    view.buffer.bind_depth_only(view.rect);
    glDepthFunc(depth_test);
    glDepthMask(GL_FALSE);
    glEnable(GL_STENCIL_TEST);
    glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
  }

  static void end_pass() {
    glDisable(GL_STENCIL_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GREATER);
  }

  static void set_transform(const gl::Program& program, const View& view) {
    const glm::mat4 clip_from_scene = gl::depth_clip_from_scene(view.eye, view.scene.world_origin_m());
    glUseProgram(program.get());
    glUniformMatrix4fv(0, 1, GL_FALSE, glm::value_ptr(clip_from_scene));
  }

  gl::DrawStats query_each(const View& view, Layer layer, std::span<const ObjectId> ids,
                           const gl::PassPrograms& programs, CountAccumulator& sum) {
    while (queries_.size() < ids.size()) queries_.push_back(gl::make_query(GL_SAMPLES_PASSED));
    gl::DrawStats stats;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const auto mark = static_cast<GLint>(i % 255) + 1;
      if (mark == 1) {
        glClearStencil(0);
        glClear(GL_STENCIL_BUFFER_BIT);
      }
      glStencilFunc(GL_NOTEQUAL, mark, 0xff);
      glBeginQuery(GL_SAMPLES_PASSED, queries_[i].get());
      const gl::DrawStats one = view.scene.draw(layer, ids.subspan(i, 1), programs);
      glEndQuery(GL_SAMPLES_PASSED);
      stats.objects += one.objects;
      stats.triangles += one.triangles;
    }
    for (std::size_t i = 0; i < ids.size(); ++i) {
      GLuint pixels = 0;
      glGetQueryObjectuiv(queries_[i].get(), GL_QUERY_RESULT, &pixels);
      sum.add(ids[i], pixels);
    }
    return stats;
  }

  gl::Program solid_, masked_, blended_;
  std::vector<gl::Query> queries_;
};

}  // namespace

std::unique_ptr<PixelCounter> make_query_counter() {
  return std::make_unique<QueryCounter>();
}

}  // namespace sightline
