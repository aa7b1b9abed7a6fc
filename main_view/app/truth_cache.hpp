#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/object_id.hpp"
#include "common/scene_digest.hpp"
#include "common/view.hpp"

namespace sightline {

/// Exact visible sets that an audit found, kept in a file for audits of the same views with other settings:
/// most of an audit's time goes into drawing every object to learn them.
///
/// A set is found again by the eyes' matrices, to the bit, so a file may hold any number of paths. It is for
/// one scene, one image size and one OpenGL; a file of another is begun anew.
class TruthCache {
 public:
  /// What the sets depend on beside the eyes.
  struct Subject {
    SceneDigest scene{};
    std::uint32_t object_count = 0;
    ImageSize size;
    std::string opengl;  ///< as gl::Context::description gives it
  };

  /// Reads `file` where it exists; with an empty name nothing is kept. Throws InputError naming a file that
  /// holds something else or is damaged.
  TruthCache(std::filesystem::path file, const Subject& subject);

  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }

  /// The visible objects, ascending; null where nobody has looked. Valid until the next add.
  [[nodiscard]] const std::vector<ObjectId>* find(std::span<const Eye> eyes) const;
  void add(std::span<const Eye> eyes, const std::vector<ObjectId>& visible);

  /// Writes what is known, with what others have written meanwhile. Does nothing when nothing was added.
  /// Throws InputError when the file cannot be written.
  void save();

 private:
  using Key = std::string;  ///< the bytes of the eyes' matrices
  [[nodiscard]] static Key key_of(std::span<const Eye> eyes);
  void read();

  std::filesystem::path file_;
  std::uint32_t object_count_;
  std::string header_;
  std::unordered_map<Key, std::vector<ObjectId>> sets_;
  bool changed_ = false;
};

}  // namespace sightline
