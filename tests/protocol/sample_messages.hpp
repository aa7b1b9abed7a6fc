#pragma once

#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "protocol/messages.hpp"
#include "protocol/scene_data.hpp"
#include "protocol/visible_set.hpp"

namespace sightline {

struct NamedMessage {
  std::string name;
  Message message;
};

/// For GoogleTest, which would print bytes.
inline void PrintTo(const NamedMessage& frame, std::ostream* stream) {
  *stream << frame.name;
}

/// One fixed message of each kind, both forms of a visible set: what the golden frames hold.
[[nodiscard]] std::vector<NamedMessage> golden_messages();

/// The scene that the golden offer and chunk are of.
[[nodiscard]] SceneData golden_scene();

/// A valid message with every field set at random; `kind` is its index in Message.
[[nodiscard]] Message random_message(std::size_t kind, std::mt19937_64& random);

/// A valid pair of matrices.
[[nodiscard]] Eye random_eye(std::mt19937_64& random);

/// `count` different ids below `object_count`, ascending.
[[nodiscard]] std::vector<ObjectId> random_ids(std::size_t count, std::uint32_t object_count,
                                               std::mt19937_64& random);

/// `ids` with `changed_count` of them replaced by others, half leaving and half coming.
[[nodiscard]] std::vector<ObjectId> with_changes(const std::vector<ObjectId>& ids, std::size_t changed_count,
                                                 std::uint32_t object_count, std::mt19937_64& random);

}  // namespace sightline
