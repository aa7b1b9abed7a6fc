#include <vector>

#include "control_view/engines/pixel_counter.hpp"

namespace sightline {
namespace {

using namespace gl;  // the entry points

// What glHistogram did, without its limit on the number of entries.
const char* const k_count_glsl = R"(#version 450 core
layout(local_size_x = 16, local_size_y = 16) in;
layout(binding = 0) uniform usampler2D u_codes;
layout(std430, binding = 2) buffer Counts { uint counts[]; };
layout(location = 0) uniform uint u_x;
layout(location = 1) uniform uint u_y;
layout(location = 2) uniform uint u_width;
layout(location = 3) uniform uint u_height;
void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= u_width || at.y >= u_height) return;
  uint code = texelFetch(u_codes, ivec2(at + uvec2(u_x, u_y)), 0).r;
  if (code != 0u) atomicAdd(counts[code - 1u], 1u);
}
)";

constexpr GLuint k_group_side = 16;

class ComputeCounter final : public PixelCounter {
 public:
  explicit ComputeCounter(std::uint32_t object_count)
      : program_(gl::make_compute_program("compute_counter", k_count_glsl)),
        counts_(gl::make_buffer()),
        read_back_(object_count) {
    glNamedBufferStorage(counts_.get(), bytes(), nullptr, 0);
  }

  void add_opaque(const View& view, std::span<const ObjectId>, CountAccumulator& sum) override {
    const gl::PixelRect area = view.rect.value_or(gl::PixelRect{0, 0, view.buffer.size()});
    constexpr std::uint32_t zero = 0;
    glClearNamedBufferData(counts_.get(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &zero);
    glUseProgram(program_.get());
    glBindTextureUnit(0, view.buffer.code_texture());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, counts_.get());
    glUniform1ui(0, area.x);
    glUniform1ui(1, area.y);
    glUniform1ui(2, area.size.width);
    glUniform1ui(3, area.size.height);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
    glDispatchCompute((area.size.width + k_group_side - 1) / k_group_side,
                      (area.size.height + k_group_side - 1) / k_group_side, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(counts_.get(), 0, bytes(), read_back_.data());
    for (std::uint32_t object = 0; object < read_back_.size(); ++object) {
      if (read_back_[object] != 0) sum.add(ObjectId{object}, read_back_[object]);
    }
  }

 private:
  [[nodiscard]] GLsizeiptr bytes() const {
    return static_cast<GLsizeiptr>(read_back_.size() * sizeof(std::uint32_t));
  }

  gl::Program program_;
  gl::Buffer counts_;
  std::vector<std::uint32_t> read_back_;
};

}  // namespace

std::unique_ptr<PixelCounter> make_compute_counter(std::uint32_t object_count) {
  return std::make_unique<ComputeCounter>(object_count);
}

}  // namespace sightline
