#include "main_view/client/c_api/descriptors.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include "main_view/client/c_api/failure.hpp"

namespace sightline::c_api {
namespace {

/// Two threads with a poller and a mailbox each, the context's and the socket's mailbox, the connection;
/// twice, for the scene goes its own way; and some that are opened for a moment.
constexpr std::size_t k_needed = 24;

}  // namespace

void require_descriptors() {
  std::array<int, k_needed> opened{};
  std::size_t count = 0;
  while (count < k_needed) {
    const int descriptor = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) break;
    opened[count++] = descriptor;
  }
  const int reason = errno;
  for (std::size_t i = 0; i < count; ++i) close(opened[i]);
  if (count == k_needed) return;
  fail(SL_ERROR_MACHINE, "open files: a connection takes " + std::to_string(k_needed) + ", but after " +
                             std::to_string(count) + " " + std::strerror(reason));
}

}  // namespace sightline::c_api
