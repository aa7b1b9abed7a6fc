#include "control_view/keygen.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>
#include <zmq.h>

#include "common/error.hpp"

namespace sightline {

void write_new_keys(const std::string& file) {
  std::array<char, 41> public_key{};
  std::array<char, 41> secret_key{};
  if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
    throw MachineError("zmq_curve_keypair failed: this libzmq has no CURVE");
  }
  const std::string text = "# A secret: who has this file can pose as its owner.\npublic_key = \"" +
                           std::string(public_key.data()) + "\"\nsecret_key = \"" +
                           std::string(secret_key.data()) + "\"\n";

  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0) throw InputError(file + ": cannot be created: " + std::strerror(errno));
  const bool written = write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (close(descriptor) != 0 || !written) {
    unlink(file.c_str());
    throw InputError(file + ": cannot be written: " + std::strerror(errno));
  }
  std::printf("public_key = \"%s\"\n", public_key.data());
}

}  // namespace sightline
