#include "examples/osg/spawned_daemon.hpp"

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace sightline::osg_example {

SpawnedDaemon::SpawnedDaemon(const std::filesystem::path& executable,
                             const std::vector<std::string>& arguments) {
  std::string pattern = (std::filesystem::temp_directory_path() / "sightline_osg_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp: cannot make " + pattern);
  folder_ = pattern;
  std::vector<std::string> command = {executable.string(), "serve", "--die-with-parent", "--bind",
                                      endpoint()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  std::vector<char*> words;
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  if (posix_spawn(&process_, words[0], nullptr, nullptr, words.data(), environ) != 0) {
    std::filesystem::remove_all(folder_);
    throw std::runtime_error(executable.string() + ": cannot be started");
  }
}

SpawnedDaemon::~SpawnedDaemon() {
  kill(process_, SIGTERM);
  waitpid(process_, nullptr, 0);
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

}  // namespace sightline::osg_example
