#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>

#include "common/error.hpp"

namespace sightline {

/// `main_view generate`: scenes of any size for scale tests.
struct GenerateOptions {
  std::string kind;  ///< "city" or "crowd"
  std::uint32_t objects = 2000;
  std::uint64_t seed = 1;
  std::filesystem::path out;       ///< .glb
  std::filesystem::path path_out;  ///< camera path CSV; empty for none
};

/// Writes the files and one line about them to `log`. The same options give the same bytes.
/// Throws InputError for an unknown kind, a count out of range or a file that cannot be written.
ExitCode run_generate(const GenerateOptions& options, std::ostream& log);

}  // namespace sightline
