#include "common/gl/object.hpp"

#include <array>
#include <string>

#include "common/error.hpp"

namespace sightline::gl {
namespace {

template <class Create, class... Arguments>
GLuint created(Create create, Arguments... arguments) {
  GLuint name = 0;
  create(arguments..., 1, &name);
  return name;
}

std::string first_line(const char* text) {
  const std::string whole(text);
  return whole.substr(0, whole.find('\n'));
}

/// Deletes the shader when the program has it or compiling failed.
class Shader {
 public:
  Shader(const char* program_name, GLenum stage, const char* glsl) : name_(glCreateShader(stage)) {
    glShaderSource(name_, 1, &glsl, nullptr);
    glCompileShader(name_);
    GLint compiled = 0;
    glGetShaderiv(name_, GL_COMPILE_STATUS, &compiled);
    if (compiled != 0) return;
    std::array<char, 1024> log{};
    glGetShaderInfoLog(name_, log.size(), nullptr, log.data());
    glDeleteShader(name_);
    throw MachineError(std::string("shader of ") + program_name +
                       " does not compile: " + first_line(log.data()));
  }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  ~Shader() { glDeleteShader(name_); }
  [[nodiscard]] GLuint get() const noexcept { return name_; }

 private:
  GLuint name_;
};

void link(const char* name, GLuint program) {
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked != 0) return;
  std::array<char, 1024> log{};
  glGetProgramInfoLog(program, log.size(), nullptr, log.data());
  throw MachineError(std::string("program ") + name + " does not link: " + first_line(log.data()));
}

}  // namespace

Buffer make_buffer() {
  return Buffer(created(glCreateBuffers));
}
TextureName make_texture(GLenum target) {
  return TextureName(created(glCreateTextures, target));
}
Framebuffer make_framebuffer() {
  return Framebuffer(created(glCreateFramebuffers));
}
VertexArray make_vertex_array() {
  return VertexArray(created(glCreateVertexArrays));
}
Query make_query(GLenum target) {
  return Query(created(glCreateQueries, target));
}

Program make_program(const char* name, const char* vertex_glsl, const char* fragment_glsl) {
  const Shader vertex(name, GL_VERTEX_SHADER, vertex_glsl);
  const Shader fragment(name, GL_FRAGMENT_SHADER, fragment_glsl);
  Program program(glCreateProgram());
  glAttachShader(program.get(), vertex.get());
  glAttachShader(program.get(), fragment.get());
  link(name, program.get());
  return program;
}

Program make_compute_program(const char* name, const char* compute_glsl) {
  const Shader compute(name, GL_COMPUTE_SHADER, compute_glsl);
  Program program(glCreateProgram());
  glAttachShader(program.get(), compute.get());
  link(name, program.get());
  return program;
}

}  // namespace sightline::gl
