// The one order, and how it is handed to GL.

#include <algorithm>

#include "common/gl/gpu_scene.hpp"

namespace sightline::gl {

DrawStats GpuScene::draw(Layer layer, std::span<const ObjectId> ids, const PassPrograms& programs,
                         DrawOrder order) {
  DrawStats stats;
  for (GroupCommands& group : groups_) {
    group.commands.clear();
    group.texture_runs.clear();
  }
  if (order == DrawOrder::forward) {
    for (const ObjectId id : ids) collect(layer, id, order, stats);
  } else {
    for (auto id = ids.rbegin(); id != ids.rend(); ++id) collect(layer, *id, order, stats);
  }
  if (stats.objects == 0) return stats;

  glBindVertexArray(vertex_array_.get());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, materials_.get());
  upload_commands();
  for (std::size_t i = 0; i < k_group_count; ++i) {
    submit(order == DrawOrder::forward ? i : k_group_count - 1 - i, programs);
  }
  return stats;
}

void GpuScene::collect(Layer layer, ObjectId id, DrawOrder order, DrawStats& stats) {
  const std::uint32_t object = index_of(id);
  const std::uint32_t first = first_item_[object], count = first_item_[object + 1] - first;
  bool drawn = false;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t item = first + (order == DrawOrder::forward ? i : count - 1 - i);
    const DrawItem& what = items_[item];
    if (what.layer != layer || what.index_count == 0) continue;
    add_command(item, mirrored_[object] != 0);
    stats.triangles += what.index_count / 3;
    drawn = true;
  }
  if (drawn) ++stats.objects;
}

void GpuScene::add_command(std::uint32_t item, bool mirrored) {
  const DrawItem& what = items_[item];
  GroupCommands& group = groups_[what.sides_and_mask | (mirrored ? k_mirrored_bit : 0)];
  if (group.texture_runs.empty() || group.texture_runs.back().second != what.texture) {
    group.texture_runs.emplace_back(group.commands.size(), what.texture);
  }
  group.commands.push_back({what.index_count, 1, what.first_index, 0, item});
}

/// All groups in one upload. The old contents are orphaned, so that nothing waits for draws under way.
void GpuScene::upload_commands() {
  all_commands_.clear();
  for (GroupCommands& group : groups_) {
    group.first_byte = all_commands_.size() * sizeof(DrawCommand);
    all_commands_.insert(all_commands_.end(), group.commands.begin(), group.commands.end());
  }
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commands_.get());
  glNamedBufferData(commands_.get(), static_cast<GLsizeiptr>(all_commands_.size() * sizeof(DrawCommand)),
                    all_commands_.data(), GL_STREAM_DRAW);
}

void GpuScene::submit(std::size_t group_index, const PassPrograms& programs) {
  const GroupCommands& group = groups_[group_index];
  if (group.commands.empty()) return;
  if ((group_index & k_double_sided_bit) != 0) {
    glDisable(GL_CULL_FACE);
  } else {
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
  }
  glFrontFace((group_index & k_mirrored_bit) != 0 ? GL_CW : GL_CCW);
  const GLuint program = (group_index & k_mask_bit) != 0 ? programs.mask : programs.solid;
  glUseProgram(program);
  const GLint textured_location = glGetUniformLocation(program, "u_textured");

  for (std::size_t run = 0; run < group.texture_runs.size(); ++run) {
    const auto [first, texture] = group.texture_runs[run];
    const std::size_t end =
        run + 1 < group.texture_runs.size() ? group.texture_runs[run + 1].first : group.commands.size();
    const bool textured = texture != k_no_texture;
    glBindTextureUnit(0, textured ? textures_[texture].get() : white_.get());
    if (textured_location >= 0) glUniform1i(textured_location, textured ? 1 : 0);
    glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT,
                                reinterpret_cast<const void*>(group.first_byte + first * sizeof(DrawCommand)),
                                static_cast<GLsizei>(end - first), 0);
  }
}

DrawPositions GpuScene::opaque_positions(ObjectId id) const noexcept {
  const std::uint32_t object = index_of(id);
  const auto mirrored = static_cast<std::uint8_t>(mirrored_[object] != 0 ? k_mirrored_bit : 0);
  DrawPositions positions{~std::uint64_t{0}, 0};
  for (std::uint32_t item = first_item_[object]; item < first_item_[object + 1]; ++item) {
    const DrawItem& what = items_[item];
    if (what.layer != Layer::opaque || what.index_count == 0) continue;
    const auto group = static_cast<std::uint64_t>(what.sides_and_mask | mirrored);
    const std::uint64_t position = group << 32 | item;
    positions.first = std::min(positions.first, position);
    positions.last = std::max(positions.last, position);
  }
  return positions;
}

}  // namespace sightline::gl
